//! The recording of a watched source, in the file of `--write`.

use std::path::Path;
use std::time::{Duration, Instant};

use taxel_core::frame::Frame;
use taxel_files::ReadError;
use taxel_files::acquire::{
    AcquireError, AcquireEvent, AcquireOptions, FrameRecorder, FrameSource, RecorderError,
};
use taxel_files::formats::recording::{RecordingMetadata, unknown_format};
use taxel_files::formats::stream::{NoFrameReason, StreamCounts, StreamFormat, StreamRefusal};
use taxel_files::formats::value::counted;

use crate::cli::arguments::frames::WatchArguments;
use crate::cli::error::{CliError, note_advice, stream_advice};

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

const REPORT: Duration = Duration::from_secs(1);

/// The reports about a source: lines that begin with its name, warnings with the word before it.
pub(super) struct SourceReports<'a> {
    source: &'a FrameSource,
    /// The format of streams that the settings name; None if a flag names one.
    format: Option<StreamFormat>,
    note: &'a mut dyn FnMut(&str),
    dropped: u64,
    reported: Option<Instant>,
}

impl<'a> SourceReports<'a> {
    pub(super) fn new(
        source: &'a FrameSource,
        options: &AcquireOptions,
        note: &'a mut dyn FnMut(&str),
    ) -> Self {
        Self {
            source,
            format: options.stream_format,
            note,
            dropped: 0,
            reported: None,
        }
    }

    pub(super) fn say(&mut self, text: &str) {
        let line = format!("{}: {text}", self.source.name());
        (self.note)(&line);
    }

    pub(super) fn warn(&mut self, text: &str) {
        let line = format!("warning: {}: {text}", self.source.name());
        (self.note)(&line);
    }

    pub(super) fn remark(&mut self, event: AcquireEvent<'_>) {
        let text = match event {
            AcquireEvent::Silent(silence) => silence.reason(self.source.unused_baud().is_none()),
            AcquireEvent::Lost(error) => AcquireEvent::lost(error),
            AcquireEvent::Back { gap } => AcquireEvent::back_after(gap),
            AcquireEvent::Note(note) if note.is_plain() => return,
            AcquireEvent::Note(note) => {
                return self.warn(&format!("{note}{}", note_advice(note)));
            }
            AcquireEvent::Anew(how) => how.to_string(),
            _ => return,
        };
        self.say(&text);
    }

    pub(super) fn refused(&self, reason: &impl ToString) -> CliError {
        CliError::Frames {
            name: self.source.name(),
            message: reason.to_string(),
        }
    }

    pub(super) fn damage(&self, error: AcquireError) -> CliError {
        match error {
            AcquireError::Recording(error) => self.damaged(error),
            AcquireError::NotStream { .. } => {
                // A pipe does not bring its bytes again.
                let advice = match self.source {
                    source if !source.is_in_file() => {
                        "save it to a file, then type taxel frames FILE"
                    }
                    FrameSource::Standard => "read it with taxel frames -",
                    _ => "watch it again when it is complete",
                };
                self.refused(&format!("{error}; {advice}"))
            }
            AcquireError::Io { .. } => self.refused(&error),
        }
    }

    fn damaged(&self, error: ReadError) -> CliError {
        CliError::Recording {
            name: self.source.name(),
            error,
        }
    }

    /// Reports dropped frames, unless that was done a moment ago.
    pub(super) fn tick(&mut self, counts: &StreamCounts) {
        if self.reported.is_none_or(|last| last.elapsed() >= REPORT) {
            self.report_dropped(counts);
        }
    }

    fn report_dropped(&mut self, counts: &StreamCounts) {
        if counts.dropped <= self.dropped {
            return;
        }
        self.dropped = counts.dropped;
        self.reported = Some(Instant::now());
        let dropped = counted(counts.dropped, "frame");
        let mut text = format!("{dropped} dropped so far (torn, short, long or garbled)");
        if let Some(sample) = &counts.sample {
            text += &format!(", the last: {sample}");
        }
        if let Some(reason) = &counts.reason {
            text += &format!(" ({reason})");
        }
        self.warn(&text);
    }

    pub(super) fn check_shape(&self, counts: &StreamCounts) -> Result<(), CliError> {
        match counts.refusal() {
            // An echo that leaves out values of some messages is refused too, since the others are not all frames.
            None if counts.cut => Err(self.undecoded(StreamRefusal::Cut)),
            None => Ok(()),
            Some(refusal) => Err(self.undecoded(refusal)),
        }
    }

    /// Returns the error for a stream that cannot be decoded without more flags; it says which flags help. An unknown
    /// format is an error of recordings for a file, and of streams for any other source.
    fn undecoded(&self, refusal: StreamRefusal) -> CliError {
        match (refusal, self.source) {
            (StreamRefusal::Unknown, FrameSource::File(_)) => self.damaged(unknown_format()),
            _ => self.refused(&format!(
                "{refusal}{}{}",
                stream_advice(refusal),
                self.format_advice()
            )),
        }
    }

    pub(super) fn end(&mut self, counts: &StreamCounts) -> Result<(), CliError> {
        self.check_shape(counts)?;
        self.report_dropped(counts);
        match counts.no_frame_reason() {
            None => Ok(()),
            Some(NoFrameReason::Empty) => Err(CliError::Empty {
                name: self.source.name(),
            }),
            Some(NoFrameReason::Refused(refusal)) => Err(self.undecoded(refusal)),
            Some(reason @ NoFrameReason::Undecoded { reason: None, .. }) => {
                let advice = "check --rows, --columns and --format";
                Err(self.refused(&format!("{reason}; {advice}{}", self.format_advice())))
            }
            Some(reason) => Err(self.refused(&format!("{reason}{}", self.format_advice()))),
        }
    }

    fn format_advice(&self) -> String {
        self.format.map_or_else(String::new, |format| {
            format!(
                "; the settings say format {:?}, which --format overrides",
                format.name()
            )
        })
    }
}
