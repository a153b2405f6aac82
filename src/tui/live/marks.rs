//! Marked frames: by a key, or in the recording itself.
//!
//! A key marks one frame of the history, by its number in the history: the numbers of the source begin at 0 again if
//! it is watched anew, or if a recording is played in a loop.

use crate::formats::recording::FrameMark;
use crate::frame::Frame;

#[derive(Clone, Debug, Default)]
pub(super) struct FrameMarks {
    own: Vec<(u64, FrameMark)>,
    recorded: Vec<FrameMark>,
    /// Whether the marks set by keys have changed since [`FrameMarks::take_change`] was called last.
    is_changed: bool,
}

impl FrameMarks {
    pub(super) fn own(&self) -> Vec<FrameMark> {
        self.own_from(0)
    }

    pub(super) fn own_from(&self, first: u64) -> Vec<FrameMark> {
        let own = self.own.iter().filter(|(number, _)| *number >= first);
        own.map(|(_, mark)| *mark).collect()
    }

    /// Returns true if the marks set by keys have changed since the last call.
    pub(super) fn take_change(&mut self) -> bool {
        std::mem::take(&mut self.is_changed)
    }

    pub(super) fn set_recorded(&mut self, recorded: &[FrameMark]) {
        self.recorded = recorded.to_vec();
    }

    pub(super) fn recorded(&self) -> &[FrameMark] {
        &self.recorded
    }

    pub(super) fn has(&self, number: u64, frame: &Frame) -> bool {
        let label = frame.label.and_then(|label| u64::try_from(label).ok());
        let is_recorded = |label: u64| self.recorded.iter().any(|mark| mark.number == label);
        self.index(number).is_ok() || label.is_some_and(is_recorded)
    }

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

    pub(super) fn take_off(&mut self, number: u64) {
        if let Ok(index) = self.index(number) {
            self.own.remove(index);
            self.is_changed = true;
        }
    }

    pub(super) fn clear(&mut self) {
        self.own.clear();
    }

    fn index(&self, number: u64) -> Result<usize, usize> {
        self.own.binary_search_by_key(&number, |own| own.0)
    }
}
