//! The answers to the frames of a source, on standard output.

use taxel_core::frame::{Frame, FrameError, Processing, Tare, TareFrames, View};
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
                self.leave_out(frame.number, &error, reports);
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

    pub(super) fn leave_out(
        &mut self,
        number: u64,
        error: &FrameError,
        reports: &mut SourceReports<'_>,
    ) {
        self.unfit += 1;
        if self.unfit == 1 {
            reports.say(&format!("frame {number} is not printed: {error}"));
        }
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

pub(super) struct TareQueue {
    tare: TareFrames,
    waiting: Vec<Frame>,
    /// The last frames, of one other size: the tare begins again with them if enough of them come.
    others: Vec<Frame>,
}

pub(super) type LeftOut = (u64, FrameError);

impl TareQueue {
    pub(super) fn new(frames: u64) -> Option<Self> {
        (frames > 0).then(|| Self {
            tare: TareFrames::new(frames),
            waiting: Vec::new(),
            others: Vec::new(),
        })
    }

    pub(super) fn is_complete(&self) -> bool {
        self.tare.missing() == 0
    }

    /// Adds a frame. Returns the frames, perhaps this one, of which it is certain now that they do not wait for the
    /// tare: their size is another one.
    pub(super) fn add(&mut self, frame: Frame, view: &View) -> Result<Vec<LeftOut>, FrameError> {
        let left_out = match self.tare.add(&frame, view) {
            Ok(goes_on) => {
                self.tare.check_memory(frame.values().len())?;
                if !goes_on {
                    std::mem::swap(&mut self.waiting, &mut self.others);
                }
                self.waiting.push(frame);
                std::mem::take(&mut self.others)
            }
            Err(error) if error.is_of_size() && !self.waiting.is_empty() => {
                let others = self.tare.others();
                let mut left_out = Vec::new();
                if others <= 1 {
                    left_out.append(&mut self.others);
                }
                if others == 0 {
                    left_out.push(frame);
                } else {
                    self.others.push(frame);
                }
                left_out
            }
            Err(error) => return Err(error),
        };
        let with_reason = |frame: Frame| Some((frame.number, self.tare.refusal(&frame, view)?));
        Ok(left_out.into_iter().filter_map(with_reason).collect())
    }

    pub(super) fn incomplete(&self) -> FrameError {
        let wanted = self.tare.wanted();
        let frames = wanted - self.tare.missing();
        FrameError::Tare { frames, wanted }
    }

    pub(super) fn finish(self) -> Result<(Tare, Vec<Frame>), FrameError> {
        Ok((self.tare.finish()?, self.waiting))
    }
}

#[cfg(test)]
mod tests {
    use taxel_core::frame::FrameSize;

    use super::*;

    /// Returns the numbers of the frames that a tare of this many frames leaves out, and of those that wait until it is
    /// complete. The frames have these sides.
    fn queued(wanted: u64, sides: &[u16]) -> Result<(Vec<u64>, Vec<u64>), FrameError> {
        let mut queue = TareQueue::new(wanted).expect("at least one");
        let mut left_out = Vec::new();
        for (number, &side) in (0..).zip(sides) {
            let mut frame = Frame::new(FrameSize::new(side, side).expect("an allowed size"));
            frame.number = number;
            left_out.extend(queue.add(frame, &View::default())?);
        }
        let numbers = left_out.iter().map(|(number, _)| *number).collect();
        let (_, waiting) = queue.finish()?;
        Ok((numbers, waiting.iter().map(|frame| frame.number).collect()))
    }

    #[test]
    fn each_frame_is_left_out_or_waits_for_the_tare() {
        for (wanted, sides, left_out, waiting) in [
            (3, &[2, 6, 2, 2][..], &[1][..], &[0, 2, 3][..]),
            // The tare begins again with the frames of the other size, the first of them, too.
            (3, &[2, 6, 6, 6], &[0], &[1, 2, 3]),
            (3, &[2, 2, 6, 6, 6], &[0, 1], &[2, 3, 4]),
            // Only successive frames count.
            (4, &[2, 6, 4, 6, 4, 2, 2, 2], &[1, 2, 3, 4], &[0, 5, 6, 7]),
            (4, &[2, 6, 2, 6, 6, 6, 6], &[1, 0, 2], &[3, 4, 5, 6]),
        ] {
            let found = queued(wanted, sides).expect("complete");
            assert_eq!(found, (left_out.to_vec(), waiting.to_vec()), "{sides:?}");
        }
    }
}
