//! Frames that were marked, by a key or in the recording itself.
//!
//! A key marks one frame of the history, by its number there: the source's own numbers begin at 0 again where it is watched
//! anew, or where a recording is played in a loop.

use crate::formats::recording::FrameMark;
use crate::frame::Frame;

/// The marks of a source.
#[derive(Clone, Debug, Default)]
pub(super) struct FrameMarks {
    /// Those that a key has set, each with the frame's number in the history, in the order of these.
    own: Vec<(u64, FrameMark)>,
    /// Those that the recording itself has, by the labels of frames.
    recorded: Vec<FrameMark>,
    /// Whether a key's marks have changed since that was asked last.
    is_changed: bool,
}

impl FrameMarks {
    /// Those that a key has set, in the order in which their frames came.
    pub(super) fn own(&self) -> Vec<FrameMark> {
        self.own.iter().map(|(_, mark)| *mark).collect()
    }

    /// Whether they have changed since this was asked last.
    pub(super) fn take_change(&mut self) -> bool {
        std::mem::take(&mut self.is_changed)
    }

    /// Takes those of the recording.
    pub(super) fn set_recorded(&mut self, recorded: &[FrameMark]) {
        self.recorded = recorded.to_vec();
    }

    /// Whether the frame of a number in the history is marked.
    pub(super) fn has(&self, number: u64, frame: &Frame) -> bool {
        let label = frame.label.and_then(|label| u64::try_from(label).ok());
        let is_recorded = |label: u64| self.recorded.iter().any(|mark| mark.number == label);
        self.index(number).is_ok() || label.is_some_and(is_recorded)
    }

    /// Marks the frame of a number in the history, or takes its mark off. Returns whether it is marked now.
    pub(super) fn switch(&mut self, number: u64, frame: &Frame) -> bool {
        let mark = FrameMark {
            number: frame.number,
            time: frame.time,
        };
        self.is_changed = true;
        let index = self.index(number);
        match index {
            Ok(index) => drop(self.own.remove(index)),
            Err(index) => self.own.insert(index, (number, mark)),
        }
        index.is_err()
    }

    /// Takes the mark that a key has set off the frame of a number in the history.
    pub(super) fn take_off(&mut self, number: u64) {
        if let Ok(index) = self.index(number) {
            self.own.remove(index);
            self.is_changed = true;
        }
    }

    /// Gives up those that a key has set.
    pub(super) fn clear(&mut self) {
        self.own.clear();
    }

    /// Where the mark of a number in the history is, or would be.
    fn index(&self, number: u64) -> Result<usize, usize> {
        self.own.binary_search_by_key(&number, |own| own.0)
    }
}
