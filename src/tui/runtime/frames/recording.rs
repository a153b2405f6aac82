//! The file to which frames are recorded while they are watched.
//!
//! ```text
//! begin            creates the file         the source's thread, or the disk's
//! add              each frame               the source's thread
//! tick             what has waited          the source's thread
//! flush            all that waits, synced   the source's thread at its end; the disk's before the program is stopped
//! write_metadata   threshold, tare, marks   the disk's thread; meanwhile the source's waits to add
//! finish           the rest, synced         the disk's thread
//! ```
//! A disk may hang in each of these functions, so none is called on the screen's thread.

use std::path::{Path, PathBuf};
use std::sync::{Arc, Mutex};

use taxel_core::frame::Frame;
use taxel_core::lock::locked;
use taxel_files::acquire::{FrameRecorder, RecorderError};
use taxel_files::formats::recording::{RecordedView, RecordingMetadata};
use taxel_files::formats::value::grouped;
use taxel_files::storage::Existing;

use crate::tui::live::message::{LiveEvent, RecordedFrames};
use crate::tui::runtime::disk::files::WriteAccess;

#[derive(Debug)]
pub(in crate::tui::runtime) struct Recording {
    path: Mutex<PathBuf>,
    /// Whether the program chose the name, so that it may choose another one.
    is_name_chosen: bool,
    recorder: Mutex<RecorderState>,
}

#[derive(Debug)]
enum RecorderState {
    New,
    Open(Box<FrameRecorder>),
    Closed,
}

impl Recording {
    pub(in crate::tui::runtime) fn new(path: PathBuf) -> Arc<Self> {
        Arc::new(Self::unbegun(path))
    }

    fn unbegun(path: PathBuf) -> Self {
        Self {
            path: Mutex::new(path),
            is_name_chosen: false,
            recorder: Mutex::new(RecorderState::New),
        }
    }

    pub(in crate::tui::runtime) fn in_free_file(
        access: &WriteAccess,
        metadata: &RecordingMetadata,
    ) -> Result<(String, Arc<Self>), String> {
        for name in chosen_names() {
            let path = access.path(&name, Existing::Kept)?;
            if !is_free(&path) {
                continue;
            }
            let recording = Self {
                is_name_chosen: true,
                ..Self::unbegun(path)
            };
            recording.begin(Existing::Kept, metadata)?;
            return Ok((name, Arc::new(recording)));
        }
        let most = grouped(MOST_CHOSEN);
        Err(format!(
            "{most} recordings are here already; move some elsewhere"
        ))
    }

    pub(in crate::tui::runtime) fn path(&self) -> PathBuf {
        locked(&self.path).clone()
    }

    pub(in crate::tui::runtime) fn chosen_name(&self) -> Option<String> {
        let path = locked(&self.path);
        let name = path.file_name().filter(|_| self.is_name_chosen)?;
        Some(name.to_string_lossy().into_owned())
    }

    /// Creates the file, unless the recording was finished before it could begin.
    pub(in crate::tui::runtime) fn begin(
        &self,
        existing: Existing,
        metadata: &RecordingMetadata,
    ) -> Result<(), String> {
        let mut state = locked(&self.recorder);
        if !matches!(*state, RecorderState::New) {
            return Ok(());
        }
        *state = RecorderState::Closed;
        let recorder = FrameRecorder::create(&self.path(), existing, metadata);
        let recorder = recorder.map_err(|error| error.to_string())?;
        *state = RecorderState::Open(Box::new(recorder));
        Ok(())
    }

    /// Adds a frame. Returns the number of recorded frames, None if nothing is recorded any more.
    pub(in crate::tui::runtime) fn add(
        &self,
        frame: &Frame,
        time: Option<f64>,
    ) -> Result<Option<RecordedFrames>, String> {
        self.write(|recorder| match recorder.add(frame, time) {
            Err(RecorderError::Exists { .. }) if self.is_name_chosen => {
                self.add_elsewhere(recorder, frame, time)
            }
            added => added,
        })
    }

    /// Adds the first frame to the next free file, because another program has taken the name.
    fn add_elsewhere(
        &self,
        recorder: &mut FrameRecorder,
        frame: &Frame,
        time: Option<f64>,
    ) -> Result<(), RecorderError> {
        let taken = self.path();
        let paths = chosen_names().map(|name| taken.with_file_name(name));
        for path in paths.filter(|path| is_free(path)) {
            let mut next = recorder.elsewhere(&path)?;
            match next.add(frame, time) {
                Err(RecorderError::Exists { .. }) => {}
                added => {
                    *recorder = next;
                    *locked(&self.path) = path;
                    return added;
                }
            }
        }
        Err(RecorderError::Exists { path: taken })
    }

    pub(in crate::tui::runtime) fn tick(&self) -> Result<Option<RecordedFrames>, String> {
        self.write(FrameRecorder::tick)
    }

    pub(in crate::tui::runtime) fn flush(&self) -> Result<Option<RecordedFrames>, String> {
        self.write(FrameRecorder::flush)
    }

    /// Writes threshold, tare and marks into the metadata, in place of those before.
    pub(in crate::tui::runtime) fn write_metadata(&self, view: RecordedView) -> Result<(), String> {
        let RecordedView { rule, tare, marks } = view;
        let described = self.write(|recorder| {
            recorder.describe(|own| (own.rule, own.tare, own.marks) = (rule, tare, marks))
        });
        described.map(drop)
    }

    fn write(
        &self,
        write: impl FnOnce(&mut FrameRecorder) -> Result<(), RecorderError>,
    ) -> Result<Option<RecordedFrames>, String> {
        let mut state = locked(&self.recorder);
        let RecorderState::Open(recorder) = &mut *state else {
            return Ok(None);
        };
        let written = write(recorder);
        let recorded = RecordedFrames {
            frames: recorder.frames(),
            left_out: recorder.left_out(),
        };
        drop(state);
        written.map(|()| Some(recorded)).map_err(|error| {
            self.close();
            error.to_string()
        })
    }

    /// Finishes the recording. Returns None if nothing was recorded any more, which has been reported before.
    pub(in crate::tui::runtime) fn finish(&self) -> Option<LiveEvent> {
        Some(match self.close()? {
            Ok(frames) => LiveEvent::Recorded(self.path().to_string_lossy().into_owned(), frames),
            Err(error) => LiveEvent::NotFinished(error.to_string()),
        })
    }

    /// Ends the recording; the frames in the file stay. Returns how many there are; None if the recording was ended
    /// before. After a failure, the caller reports that first error and drops this result.
    fn close(&self) -> Option<Result<RecordedFrames, RecorderError>> {
        let before = std::mem::replace(&mut *locked(&self.recorder), RecorderState::Closed);
        let RecorderState::Open(recorder) = before else {
            return None;
        };
        let left_out = recorder.left_out();
        let finished = recorder.finish();
        Some(finished.map(|frames| RecordedFrames { frames, left_out }))
    }
}

const MOST_CHOSEN: u64 = 10_000;

fn chosen_names() -> impl Iterator<Item = String> {
    (1..=MOST_CHOSEN).map(|number| format!("touch-{number}.npy"))
}

fn is_free(path: &Path) -> bool {
    !path.exists() && !path.with_extension("json").exists()
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_chosen_name_that_another_program_has_taken_is_replaced_by_the_next_free_one() {
        let folder = tempfile::tempdir().expect("a folder");
        let access = WriteAccess::below(folder.path().to_owned());
        let metadata = RecordingMetadata::default();
        let begun = || Recording::in_free_file(&access, &metadata).expect("a free name");
        let recordings = [begun(), begun()];
        let names = recordings.each_ref().map(|(name, _)| name.as_str());
        assert_eq!(names, ["touch-1.npy"; 2]);
        for (own, name) in recordings.iter().zip(["touch-1.npy", "touch-2.npy"]) {
            let recorded = own.1.add(&Frame::default(), None).expect("recorded");
            assert_eq!(recorded.map(|recorded| recorded.frames), Some(1));
            assert_eq!(own.1.chosen_name().as_deref(), Some(name));
            assert!(own.1.finish().is_some());
            assert!(folder.path().join(name).exists());
        }
        // A name that the user gave is not changed.
        let path = folder.path().join("own.npy");
        let own = Recording::new(path.clone());
        own.begin(Existing::Kept, &metadata).expect("begun");
        std::fs::write(&path, "").expect("written");
        assert!(own.add(&Frame::default(), None).is_err());
    }
}
