//! The recording of a watched source, in the file of `--write`.

use std::path::Path;

use crate::acquire::{FrameRecorder, FrameSource, RecorderError};
use crate::cli::arguments::watch::WatchArguments;
use crate::cli::commands::watch::reports::SourceReports;
use crate::cli::error::CliError;
use crate::formats::recording::RecordingMetadata;
use crate::formats::value::counted;
use crate::frame::Frame;

/// A recording, and its metadata, which is written again when something new becomes known.
pub(super) struct WatchRecording<'a> {
    path: &'a Path,
    recorder: FrameRecorder,
    metadata: RecordingMetadata,
}

impl<'a> WatchRecording<'a> {
    /// Begins the recording that is asked for; None if none is. No file appears before the first frame.
    pub(super) fn create(
        source: &FrameSource,
        asked: &'a WatchArguments,
    ) -> Result<Option<Self>, RecorderError> {
        let Some(path) = &asked.write else {
            return Ok(None);
        };
        source.refuse_as_target(path)?;
        let metadata = RecordingMetadata {
            source: source.name(),
            rule: asked.processing.set_rule(),
            ..RecordingMetadata::default()
        };
        let recorder = FrameRecorder::create(path, asked.existing, &metadata)?;
        Ok(Some(Self {
            path,
            recorder,
            metadata,
        }))
    }

    pub(super) fn describe(
        &mut self,
        change: impl FnOnce(&mut RecordingMetadata),
    ) -> Result<(), CliError> {
        change(&mut self.metadata);
        let described = self.recorder.describe(&self.metadata);
        described.map_err(CliError::Recorder)
    }

    /// Records a frame. The first frame of another size is reported: such frames are left out of the recording.
    pub(super) fn add(
        &mut self,
        frame: &Frame,
        time: Option<f64>,
        reports: &mut SourceReports<'_>,
    ) -> Result<(), CliError> {
        let before = self.recorder.left_out();
        self.recorder.add(frame, time).map_err(CliError::Recorder)?;
        if let (0, 1, Some(size)) = (before, self.recorder.left_out(), self.recorder.size()) {
            reports.say(&format!(
                "frame {} has {} cells; the recording has frames of {} and leaves out others",
                frame.number,
                frame.size().in_words(),
                size.in_words()
            ));
        }
        Ok(())
    }

    pub(super) fn tick(&mut self) -> Result<(), CliError> {
        self.recorder.tick().map_err(CliError::Recorder)
    }

    pub(super) fn note_reason(&mut self, error: &CliError) {
        self.recorder.note_reason(&error.to_string());
    }

    /// Ends the recording, and reports the frames that are not in it. `explained` tells whether the error of the watch
    /// explains a missing file: the file could not be created, or the source could not be read.
    pub(super) fn finish(
        self,
        explained: bool,
        reports: &mut SourceReports<'_>,
    ) -> Result<(), CliError> {
        let left_out = self.recorder.left_out();
        if left_out > 0 {
            let frames = counted(left_out, "frame");
            reports.say(&format!("{frames} of another size not recorded"));
        }
        let frames = self.recorder.finish().map_err(CliError::Recorder)?;
        if frames == 0 && !explained {
            let path = self.path.display();
            reports.say(&format!("no frame came, so {path} was not written"));
        }
        Ok(())
    }
}
