//! A file that frames are recorded in while they are watched.
//!
//! ```text
//! begin    creates the file            the source's thread, or the one of the disk
//! add      each frame                  the source's thread
//! tick     what has waited, marks      the source's thread
//! finish   the rest, synced            the one of the disk
//! ```
//! A disk may hang in each of them, so none is called on the screen's thread.

use std::path::{Path, PathBuf};
use std::sync::{Arc, Mutex, MutexGuard, PoisonError};

use crate::acquire::{FrameRecorder, RecorderError};
use crate::formats::recording::{FrameMark, RecordingMetadata};
use crate::frame::Frame;
use crate::storage::Existing;
use crate::tui::live::message::LiveEvent;
use crate::tui::runtime::write_access::WriteAccess;

/// A panic while it was locked does not matter: what it holds is always whole.
pub(super) fn locked<T>(mutex: &Mutex<T>) -> MutexGuard<'_, T> {
    mutex.lock().unwrap_or_else(PoisonError::into_inner)
}

/// A file that is recorded in, shared by the source's thread and the one that finishes it.
#[derive(Debug)]
pub(super) struct Recording {
    /// The file.
    path: PathBuf,
    /// Held for as long as the disk takes to write.
    recorder: Mutex<RecorderState>,
    /// Marks that are not in the description yet. Locked for a moment only: the screen's thread puts them here.
    marks: Mutex<Option<Vec<FrameMark>>>,
}

/// How far a recording is.
#[derive(Debug)]
enum RecorderState {
    /// The file has not been created yet.
    New,
    /// Frames are written.
    Open(Box<FrameRecorder>),
    /// It is finished or has failed.
    Closed,
}

impl Recording {
    /// A recording whose file has not been created yet.
    pub(super) fn new(path: PathBuf) -> Arc<Self> {
        Arc::new(Self {
            path,
            recorder: Mutex::new(RecorderState::New),
            marks: Mutex::default(),
        })
    }

    /// Begins one in the first file `touch-1.npy`, `touch-2.npy` … that is not there. Returns its name, too.
    ///
    /// # Errors
    /// Why there is none, in a sentence.
    pub(super) fn in_free_file(
        access: &WriteAccess,
        metadata: &RecordingMetadata,
    ) -> Result<(String, Arc<Self>), String> {
        for name in (1..10_000).map(|number| format!("touch-{number}.npy")) {
            let path = access.path(&name, Existing::Kept)?;
            if path.exists() || path.with_extension("json").exists() {
                continue;
            }
            let recording = Self::new(path);
            recording.begin(Existing::Kept, metadata)?;
            return Ok((name, recording));
        }
        Err("10,000 recordings are here already; move some elsewhere".to_owned())
    }

    /// The file.
    pub(super) fn path(&self) -> &Path {
        &self.path
    }

    /// Creates the file, unless the recording was finished before it could begin.
    ///
    /// # Errors
    /// What the system refuses, in a sentence.
    pub(super) fn begin(
        &self,
        existing: Existing,
        metadata: &RecordingMetadata,
    ) -> Result<(), String> {
        let mut state = locked(&self.recorder);
        if !matches!(*state, RecorderState::New) {
            return Ok(());
        }
        *state = RecorderState::Closed;
        let recorder = FrameRecorder::create(&self.path, existing, metadata);
        let recorder = recorder.map_err(|error| error.to_string())?;
        *state = RecorderState::Open(Box::new(recorder));
        Ok(())
    }

    /// Has marks written into the description by the next one that writes.
    pub(super) fn mark(&self, marks: &[FrameMark]) {
        *locked(&self.marks) = Some(marks.to_vec());
    }

    /// Adds a frame. Returns how many are recorded, None where none are any more.
    ///
    /// # Errors
    /// A sentence. The recording ends then; what is in it so far stays.
    pub(super) fn add(&self, frame: &Frame, time: Option<f64>) -> Result<Option<u64>, String> {
        let mut state = locked(&self.recorder);
        let RecorderState::Open(recorder) = &mut *state else {
            return Ok(None);
        };
        let added = recorder.add(frame, time);
        let frames = recorder.frames();
        added
            .map(|()| Some(frames))
            .map_err(|error| close(&mut state, &error))
    }

    /// Writes out what has waited for long enough, and marks. Returns how many frames are recorded.
    ///
    /// # Errors
    /// A sentence. The recording ends then.
    pub(super) fn tick(&self) -> Result<Option<u64>, String> {
        let mut state = locked(&self.recorder);
        let RecorderState::Open(recorder) = &mut *state else {
            return Ok(None);
        };
        let written = self
            .write_marks(recorder)
            .and_then(|()| recorder.tick())
            .map(|()| recorder.frames());
        written.map(Some).map_err(|error| close(&mut state, &error))
    }

    /// Writes the marks that wait.
    fn write_marks(&self, recorder: &mut FrameRecorder) -> Result<(), RecorderError> {
        let marks = locked(&self.marks).take();
        marks.map_or(Ok(()), |marks| recorder.mark(marks))
    }

    /// Finishes it. None where nothing is recorded any more: that has been said.
    pub(super) fn finish(&self) -> Option<LiveEvent> {
        let mut state = locked(&self.recorder);
        let before = std::mem::replace(&mut *state, RecorderState::Closed);
        let RecorderState::Open(mut recorder) = before else {
            return None;
        };
        let marked = self.write_marks(&mut recorder);
        Some(match marked.and_then(|()| recorder.finish()) {
            Ok(frames) => LiveEvent::Recorded(self.path.to_string_lossy().into_owned(), frames),
            Err(error) => LiveEvent::NotFinished(error.to_string()),
        })
    }
}

/// Ends a recording that has failed; what is in the file so far stays. Returns why.
fn close(state: &mut RecorderState, error: &RecorderError) -> String {
    if let RecorderState::Open(recorder) = std::mem::replace(state, RecorderState::Closed) {
        // The first error is the one that is reported.
        let _ = recorder.finish();
    }
    error.to_string()
}
