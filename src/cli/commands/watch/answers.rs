//! The answers to the frames of a source, on standard output.

use taxel_core::frame::{Frame, Processing};
use taxel_files::formats::json;
use taxel_files::formats::recording::FrameAnswer;
use taxel_files::formats::value::counted;

use crate::cli::commands::watch::recording::SourceReports;
use crate::cli::error::CliError;
use crate::cli::output::line_writer::LineWriter;

pub(super) struct Answers {
    output: Output,
    /// Whether frames are recorded: then the watch goes on if answers cannot be written, since frames do not come
    /// again.
    is_recorded: bool,
    /// Whether frames may be left unanswered if the reader is slow.
    may_give_up: bool,
    answered: u64,
    /// The number of frames not answered because crop, tare, mask or gain do not fit their size.
    unfit: u64,
}

enum Output {
    Open(LineWriter),
    Closed,
    Failed(CliError),
}

impl Answers {
    pub(super) fn new(lines: LineWriter, is_live: bool, is_recorded: bool) -> Self {
        Self {
            output: Output::Open(lines),
            is_recorded,
            may_give_up: is_live && is_recorded,
            answered: 0,
            unfit: 0,
        }
    }

    /// Processes a frame and sends its line, with the name of its channel. A frame whose size does not fit crop, tare,
    /// mask or gain is left out if others did fit: the sensor continues.
    pub(super) fn add(
        &mut self,
        (frame, channel): (&Frame, Option<&str>),
        processing: &mut Processing,
        reports: &mut SourceReports<'_>,
    ) -> Result<(), CliError> {
        let Output::Open(lines) = &mut self.output else {
            return Ok(());
        };
        let processed = match processing.run(frame) {
            Ok(processed) => processed,
            Err(error) if self.answered > 0 && error.is_of_size() => {
                self.unfit += 1;
                if self.unfit == 1 {
                    reports.say(&format!("frame {} is not printed: {error}", frame.number));
                }
                return Ok(());
            }
            Err(error) => return Err(reports.refused(&error)),
        };
        self.answered += 1;
        let answer = FrameAnswer {
            frame,
            channel,
            processed,
        };
        let line = json::ascii(&answer) + "\n";
        if lines.send((line.into_bytes(), processed.imprint), self.may_give_up) {
            return Ok(());
        }
        self.end(reports)
    }

    pub(super) fn go_on_alone(&mut self) -> bool {
        (self.is_recorded, self.may_give_up) = (false, false);
        matches!(self.output, Output::Open(_))
    }

    pub(super) fn tick(&mut self, reports: &mut SourceReports<'_>) -> Result<(), CliError> {
        match &self.output {
            Output::Open(lines) if lines.is_over() => self.end(reports),
            _ => Ok(()),
        }
    }

    fn end(&mut self, reports: &mut SourceReports<'_>) -> Result<(), CliError> {
        let Output::Open(lines) = std::mem::replace(&mut self.output, Output::Closed) else {
            return Ok(());
        };
        match lines.finish() {
            Err(error @ CliError::Write(_)) if self.is_recorded => {
                if error.is_closed_pipe() {
                    reports.say("standard output is closed; the recording continues");
                } else {
                    reports.say(&format!("{error}; the recording continues"));
                    self.output = Output::Failed(error);
                }
                Ok(())
            }
            written => written,
        }
    }

    /// Waits until all answers are written, and reports the frames without one. A single frame of another size was
    /// reported already.
    pub(super) fn finish(self, reports: &mut SourceReports<'_>) -> Result<(), CliError> {
        if self.unfit > 1 {
            let frames = counted(self.unfit, "frame");
            reports.say(&format!("{frames} of another size not printed"));
        }
        let written = match self.output {
            Output::Open(lines) => {
                if lines.given_up > 0 {
                    let frames = counted(lines.given_up, "frame");
                    reports.say(&format!("{frames} recorded but not printed"));
                }
                lines.finish()
            }
            Output::Closed => Ok(()),
            Output::Failed(error) => Err(error),
        };
        match written {
            Err(error) if self.is_recorded && error.is_closed_pipe() => Ok(()),
            written => written,
        }
    }
}
