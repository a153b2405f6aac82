//! Frames that were marked, by a key or in the recording itself.

use crate::formats::recording::FrameMark;
use crate::frame::Frame;

/// The marks of a source.
#[derive(Clone, Debug, Default)]
pub(super) struct FrameMarks {
    /// Those that a key has set, in the order of their numbers.
    own: Vec<FrameMark>,
    /// Those that the recording itself has, by the labels of frames.
    recorded: Vec<FrameMark>,
}

impl FrameMarks {
    /// Those that a key has set, in the order of their numbers.
    pub(super) fn own(&self) -> &[FrameMark] {
        &self.own
    }

    /// Takes those of the recording.
    pub(super) fn set_recorded(&mut self, recorded: &[FrameMark]) {
        self.recorded = recorded.to_vec();
    }

    /// Whether a frame is marked.
    pub(super) fn has(&self, frame: &Frame) -> bool {
        let label = frame.label.and_then(|label| u64::try_from(label).ok());
        let is = |marks: &[FrameMark], number: u64| marks.iter().any(|mark| mark.number == number);
        is(&self.own, frame.number) || label.is_some_and(|label| is(&self.recorded, label))
    }

    /// Marks a frame, or takes its mark off. Returns whether it is marked now.
    pub(super) fn switch(&mut self, frame: &Frame) -> bool {
        let (number, time) = (frame.number, frame.time);
        let index = self.own.binary_search_by_key(&number, |mark| mark.number);
        match index {
            Ok(index) => drop(self.own.remove(index)),
            Err(index) => self.own.insert(index, FrameMark { number, time }),
        }
        index.is_err()
    }

    /// Takes the mark that a key has set off the frame of a number.
    pub(super) fn take_off(&mut self, number: u64) {
        self.own.retain(|mark| mark.number != number);
    }

    /// Gives up those that a key has set.
    pub(super) fn clear(&mut self) {
        self.own.clear();
    }
}
