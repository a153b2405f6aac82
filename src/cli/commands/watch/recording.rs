//! The recording of a watched source, in the file of `--write`.

use std::time::{Duration, Instant};

use taxel_files::acquire::{
    AcquireEvent, AcquireOptions, FrameRecorder, FrameSource, RecorderError,
};
use taxel_files::formats::recording::{Format, RecordingMetadata, StreamCounts};
use taxel_files::formats::value::counted;
use taxel_files::{ReadError, ReadErrorKind};

use crate::cli::arguments::frames::WatchArguments;
use crate::cli::error::{CliError, note_advice};

/// Begins the recording that is asked for; None if none is. No file appears before the first frame.
pub(super) fn begin(
    source: &FrameSource,
    asked: &WatchArguments,
) -> Result<Option<FrameRecorder>, RecorderError> {
    let Some(path) = &asked.write else {
        return Ok(None);
    };
    source.refuse_as_target(path)?;
    let metadata = RecordingMetadata {
        source: source.name(),
        rule: asked.processing.set_rule(),
        ..RecordingMetadata::default()
    };
    FrameRecorder::create(path, asked.existing, &metadata).map(Some)
}

const REPORT: Duration = Duration::from_secs(1);

/// The reports about a source: lines that begin with its name, warnings with the word before it.
pub(super) struct SourceReports<'a> {
    source: &'a FrameSource,
    /// The format of streams that the settings name; None if a flag names one.
    format: Option<&'static Format>,
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
            AcquireEvent::Silent { reason, .. } | AcquireEvent::Anew(reason) => reason.to_owned(),
            AcquireEvent::Lost(error) => AcquireEvent::lost(error),
            AcquireEvent::Back { gap } => AcquireEvent::back_after(gap),
            AcquireEvent::Note(note) if note.is_plain() => return,
            AcquireEvent::Note(note) => {
                return self.warn(&format!("{note}{}", note_advice(note)));
            }
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

    /// The error that ended the source. If a stream cannot be decoded without more flags, it says which of them help.
    pub(super) fn damage(&self, error: ReadError) -> CliError {
        let advice = match error.kind {
            ReadErrorKind::UnknownFormat => "; --format names one",
            ReadErrorKind::Unsized => "; give --rows and --columns",
            _ => "",
        };
        if advice.is_empty() || matches!(self.source, FrameSource::File(_)) {
            let name = self.source.name();
            return CliError::Recording { name, error };
        }
        self.refused(&format!("{error}{advice}{}", self.format_advice()))
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

    /// Reports dropped frames, and that there was no frame at all.
    pub(super) fn end(&mut self, counts: &StreamCounts) -> Result<(), CliError> {
        self.report_dropped(counts);
        let Some(reason) = counts.no_frame() else {
            return Ok(());
        };
        if counts.bytes == 0 {
            let name = self.source.name();
            return Err(CliError::Empty { name });
        }
        let advice = match counts.reason {
            None => "; check --rows, --columns and --format",
            Some(_) => "",
        };
        Err(self.refused(&format!("{reason}{advice}{}", self.format_advice())))
    }

    fn format_advice(&self) -> String {
        self.format.map_or_else(String::new, |format| {
            let name = format.stream.unwrap_or(format.name);
            format!("; the settings say format {name:?}, which --format overrides")
        })
    }
}
