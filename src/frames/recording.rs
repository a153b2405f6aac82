//! The recording of the frames of a source while they are watched.

use std::path::{Path, PathBuf};
use std::sync::Mutex;

use taxel_core::lock::locked;
use taxel_files::acquire::{FrameRecorder, FrameSource, RecorderError};
use taxel_files::formats::recording::RecordingMetadata;
use taxel_files::storage::Existing;

use crate::frames::WatchRequest;

/// A file that frames are recorded in. The thread of the source adds them; another one may describe and finish it.
/// Any of this waits for the disk, so nothing is called on the screen's thread.
#[derive(Debug)]
pub struct Recording {
    pub(crate) path: PathBuf,
    /// None after it was finished, or has failed.
    recorder: Mutex<Option<FrameRecorder>>,
}

#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub struct RecordedFrames {
    pub frames: u64,
    /// The number of frames that were left out because they are of another size.
    pub left_out: u64,
}

impl Recording {
    /// Begins the recording that a request asks for, if it asks for one.
    pub fn asked(
        source: &FrameSource,
        request: &WatchRequest,
    ) -> Result<Option<Self>, RecorderError> {
        let Some((path, existing)) = &request.write else {
            return Ok(None);
        };
        source.refuse_as_target(path)?;
        let metadata = RecordingMetadata {
            source: source.name(),
            rule: request.pipeline.rule(),
            ..RecordingMetadata::default()
        };
        Self::create(path, *existing, &metadata).map(Some)
    }

    /// Begins a recording. No file appears before the first frame.
    pub fn create(
        path: &Path,
        existing: Existing,
        metadata: &RecordingMetadata,
    ) -> Result<Self, RecorderError> {
        let recorder = FrameRecorder::create(path, existing, metadata)?;
        Ok(Self {
            path: path.to_owned(),
            recorder: Mutex::new(Some(recorder)),
        })
    }

    /// Adds to the file. Returns the frames in it; None if nothing is recorded any more. A failure ends the recording.
    pub fn write(
        &self,
        write: impl FnOnce(&mut FrameRecorder) -> Result<(), RecorderError>,
    ) -> Result<Option<RecordedFrames>, RecorderError> {
        let mut open = locked(&self.recorder);
        let Some(recorder) = &mut *open else {
            return Ok(None);
        };
        let written = write(recorder);
        let recorded = RecordedFrames {
            frames: recorder.frames,
            left_out: recorder.left_out,
        };
        let failed = written.is_err().then(|| open.take()).flatten();
        drop(open);
        // Any error here follows from the first one.
        let _ = failed.map(FrameRecorder::finish);
        written.map(|()| Some(recorded))
    }

    /// Ends the recording, and returns the frames in the file; None if it had ended before.
    pub fn finish(&self) -> Result<Option<RecordedFrames>, RecorderError> {
        let recorder = locked(&self.recorder).take();
        let finish = |recorder: FrameRecorder| {
            let left_out = recorder.left_out;
            let frames = recorder.finish()?;
            Ok(RecordedFrames { frames, left_out })
        };
        recorder.map(finish).transpose()
    }
}
