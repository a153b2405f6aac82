//! The most recent frames, as many as fit into a given amount of memory.

use std::collections::VecDeque;
use std::sync::Arc;

use taxel_core::frame::{Frame, Label};
use taxel_files::acquire::FrameRate;
use taxel_files::formats::recording::FrameMark;

use crate::tui::live::message::ProvisionalChange;
use crate::tui::live::reading::hold;
use crate::tui::live::update::LiveRefusal;

/// The maximum number of bursts that the rate is computed from: two seconds of a fast source.
const RATED: usize = 20;

/// Returns the memory that a frame takes, in bytes.
pub(in crate::tui) fn bytes_of(frame: &Frame) -> usize {
    size_of::<Frame>() + size_of_val(frame.values())
}

/// Returns true if two frames are the same one: a confirmed frame has the values that it had before it was confirmed.
pub(super) fn is_same(one: &Frame, other: &Frame) -> bool {
    let values = one.values().iter().zip(other.values());
    (one.number, one.size()) == (other.number, other.size())
        && values
            .into_iter()
            .all(|(one, other)| one.to_bits() == other.to_bits())
}

#[derive(Clone, Debug)]
pub struct FrameHistory {
    frames: VecDeque<Arc<Frame>>,
    first: u64,
    /// The memory that the frames take, in bytes.
    bytes: usize,
    /// The memory that they may take, in bytes; the newest frame is kept even if it takes more.
    most: usize,
    rate: FrameRate,
}

impl FrameHistory {
    /// Creates an empty history that takes at most `most` bytes.
    pub fn new(most: usize) -> Self {
        Self {
            frames: VecDeque::new(),
            first: 0,
            bytes: 0,
            most,
            rate: FrameRate::over(RATED),
        }
    }

    pub fn push(&mut self, frame: Arc<Frame>) {
        match frame.time {
            Some(time) => self.rate.add(time),
            None => self.rate = FrameRate::over(RATED),
        }
        self.bytes += bytes_of(&frame);
        self.frames.push_back(frame);
        while self.bytes > self.most && self.frames.len() > 1 {
            if let Some(oldest) = self.frames.pop_front() {
                self.bytes -= bytes_of(&oldest);
                self.first += 1;
            }
        }
    }

    /// Returns the number of the newest frame; None before the first one.
    pub fn newest(&self) -> Option<u64> {
        let length = self.frames.len() as u64;
        (length > 0).then(|| self.first + length - 1)
    }

    pub fn next_number(&self) -> u64 {
        self.first + self.frames.len() as u64
    }

    /// Returns the number of the oldest frame that is still here; None before the first one.
    pub fn oldest(&self) -> Option<u64> {
        (!self.frames.is_empty()).then_some(self.first)
    }

    /// Returns the frame of a number; None if it is not here any more, or not yet.
    pub fn get(&self, number: u64) -> Option<&Arc<Frame>> {
        let index = number.checked_sub(self.first)?;
        self.frames.get(usize::try_from(index).ok()?)
    }

    pub fn back_from(&self, number: u64, count: usize) -> impl Iterator<Item = &Arc<Frame>> {
        let numbers = (self.first..=number).rev().take(count);
        numbers.filter_map(|number| self.get(number))
    }

    /// Returns the frames per second, by the times of the last frames; None if they have no times, or came all at
    /// once.
    pub fn rate(&self) -> Option<f64> {
        self.rate.seconds_per_frame().map(f64::recip)
    }
}

#[derive(Clone, Debug)]
pub(super) struct FrameCursor {
    history: FrameHistory,
    /// The number in the history of the first frame since the source was watched again; 0 if it was not watched
    /// again.
    watched_from: u64,
    provisional: Option<Arc<Frame>>,
    /// The frame that the page stays at; None if the page follows the source.
    frozen: Option<NumberedFrame>,
    /// The largest value of each cell since peak hold was switched on; None if it is off.
    held: Option<Arc<Frame>>,
}

#[derive(Clone, Debug)]
pub(super) struct NumberedFrame {
    pub(super) number: u64,
    pub(super) frame: Arc<Frame>,
}

/// The outcome of a change of the frame that is not confirmed yet.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) enum ProvisionalOutcome {
    Same,
    /// The shown frame may have changed.
    Changed,
    /// The frame before was withdrawn: another frame has its number, or will have it.
    Withdrawn,
}

impl FrameCursor {
    /// Creates an empty history that takes at most `most` bytes, and follows the source.
    pub(super) fn new(most: usize) -> Self {
        Self {
            history: FrameHistory::new(most),
            watched_from: 0,
            provisional: None,
            frozen: None,
            held: None,
        }
    }

    pub(super) fn next_number(&self) -> u64 {
        self.history.next_number()
    }

    /// Returns the number of frames in the history.
    pub(super) fn frames(&self) -> u64 {
        let next = self.history.next_number();
        self.history.oldest().map_or(0, |oldest| next - oldest)
    }

    /// Returns the frames per second; see [`FrameHistory::rate`].
    pub(super) fn rate(&self) -> Option<f64> {
        self.history.rate()
    }

    pub(super) fn follows(&self) -> bool {
        self.frozen.is_none()
    }

    /// Returns the number of frames from the shown one to the newest; None if the page follows the source.
    pub(super) fn frozen(&self) -> Option<u64> {
        let shown = self.frozen.as_ref()?.number;
        Some(self.next_number().saturating_sub(shown + 1))
    }

    pub(super) fn holds_peak(&self) -> bool {
        self.held.is_some()
    }

    /// Returns the shown frame; None before the first one.
    pub(super) fn shown(&self) -> Option<NumberedFrame> {
        if let Some(frozen) = &self.frozen {
            return Some(frozen.clone());
        }
        // A held peak is made of confirmed frames.
        let next = self.provisional.as_ref().filter(|_| !self.holds_peak());
        self.at(match next {
            Some(_) => self.next_number(),
            None => self.history.newest()?,
        })
    }

    /// Returns the frame to draw: the shown one, or the held peak if the page follows the source.
    pub(super) fn drawn(&self) -> Option<Arc<Frame>> {
        let held = self.held.as_ref().filter(|_| self.follows());
        held.cloned().or_else(|| Some(self.shown()?.frame))
    }

    /// Returns the frame of a number in the history; None if it is not here any more, or not yet.
    fn at(&self, number: u64) -> Option<NumberedFrame> {
        let next = self.provisional.as_ref();
        let next = next.filter(|_| number == self.next_number());
        let frame = Arc::clone(self.history.get(number).or(next)?);
        Some(NumberedFrame { number, frame })
    }

    /// Returns the shown frame if it came since the source was last watched anew.
    pub(super) fn of_this_watch(&self) -> Result<NumberedFrame, LiveRefusal> {
        let shown = self.shown().ok_or(LiveRefusal::NoFrame)?;
        if shown.number < self.watched_from {
            return Err(LiveRefusal::EarlierWatch(shown.frame.number));
        }
        Ok(shown)
    }

    /// Returns the number in the history of the shown frame, or of the newest one if the shown one is not confirmed
    /// yet; None before the first one.
    fn confirmed(&self) -> Option<u64> {
        let newest = self.history.newest()?;
        let frozen = self.frozen.as_ref().map(|frozen| frozen.number);
        Some(frozen.unwrap_or(newest).min(newest))
    }

    pub(super) fn up_to_shown(&self, count: usize) -> Result<Vec<Arc<Frame>>, LiveRefusal> {
        let shown = self.confirmed().ok_or(LiveRefusal::NoFrame)?;
        // Those before a change of the sensor have no part in it.
        let size = self.history.get(shown).map(|frame| frame.size());
        let frames = self.history.back_from(shown, count).cloned();
        let frames: Vec<_> = frames
            .take_while(|frame| Some(frame.size()) == size)
            .collect();
        if frames.is_empty() {
            return Err(LiveRefusal::LeftHistory);
        }
        Ok(frames)
    }

    pub(super) fn newest(&self, count: usize) -> impl Iterator<Item = &Arc<Frame>> {
        let newest = self.history.newest();
        let frames = newest.map(|newest| self.history.back_from(newest, count));
        frames.into_iter().flatten()
    }

    pub(super) fn push(&mut self, frame: &Arc<Frame>) {
        if let Some(held) = &mut self.held {
            hold(Arc::make_mut(held), frame);
        }
        self.history.push(Arc::clone(frame));
    }

    /// Takes a change of the frame that is not confirmed yet. Its number in the history is `number`, now or once it
    /// is confirmed.
    pub(super) fn take_provisional(
        &mut self,
        change: &ProvisionalChange,
        number: u64,
    ) -> ProvisionalOutcome {
        let next = match change {
            ProvisionalChange::Unchanged => return ProvisionalOutcome::Same,
            ProvisionalChange::Shown(frame) => Some(Arc::clone(frame)),
            ProvisionalChange::Gone => None,
        };
        let before = std::mem::replace(&mut self.provisional, next);
        let Some(before) = before else {
            return match self.provisional {
                Some(_) => ProvisionalOutcome::Changed,
                None => ProvisionalOutcome::Same,
            };
        };
        // A frame that has left the history cannot be compared any more; its mark stays.
        if self.history.oldest() > Some(number) {
            return ProvisionalOutcome::Changed;
        }
        let present = self.at(number);
        let present = present.filter(|present| is_same(&present.frame, &before));
        let outcome = match present {
            Some(_) => ProvisionalOutcome::Changed,
            None => ProvisionalOutcome::Withdrawn,
        };
        if self.frozen.as_ref().is_some_and(|own| own.number == number) {
            // The confirmed frame also has a time.
            self.frozen = present.or_else(|| self.at(self.confirmed()?));
        }
        outcome
    }

    pub(super) fn freeze(&mut self) {
        self.frozen = match self.frozen {
            Some(_) => None,
            None => self.shown(),
        };
    }

    pub(super) fn scrub(&mut self, by: i64) -> bool {
        let (Some(oldest), Some(newest)) = (self.history.oldest(), self.history.newest()) else {
            return false;
        };
        let shown = self.shown().map_or(newest, |shown| shown.number);
        let next = shown.saturating_add_signed(by);
        self.frozen = self.at(next.clamp(oldest, newest.max(shown)));
        true
    }

    pub(super) fn stay_at_oldest(&mut self) {
        self.frozen = self.history.oldest().and_then(|oldest| self.at(oldest));
    }

    pub(super) fn follow(&mut self) {
        self.frozen = None;
    }

    pub(super) fn switch_peak(&mut self) {
        self.held = match self.held {
            Some(_) => None,
            // Not of a frame that may be withdrawn.
            None => self
                .confirmed()
                .and_then(|number| self.history.get(number).cloned()),
        };
    }

    /// Follows the source from the next frame on. The source counts its frames from 0 again.
    pub(super) fn restart(&mut self) {
        self.watched_from = self.next_number();
        (self.frozen, self.provisional, self.held) = (None, None, None);
    }
}

#[derive(Clone, Debug, Default)]
pub(super) struct FrameMarks {
    own: Vec<(u64, FrameMark)>,
    pub(in crate::tui) recorded: Vec<FrameMark>,
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

    pub(super) fn recorded(&self) -> &[FrameMark] {
        &self.recorded
    }

    pub(super) fn has(&self, number: u64, frame: &Frame) -> bool {
        let label = frame.label.as_ref().and_then(Label::number);
        let is_recorded = |label: i64| {
            self.recorded
                .iter()
                .any(|mark| i64::try_from(mark.number) == Ok(label))
        };
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

#[cfg(test)]
mod tests {
    use taxel_core::frame::FrameSize;

    use super::*;
    use crate::frames::HISTORY_BYTES;

    #[test]
    fn the_oldest_frames_are_dropped_when_memory_is_full() {
        let mut history = FrameHistory::new(HISTORY_BYTES);
        assert_eq!((history.oldest(), history.newest()), (None, None));
        let each = bytes_of(&Frame::new(
            FrameSize::new(512, 512).expect("an allowed size"),
        ));
        let most = HISTORY_BYTES / each;
        for number in 0..2 * most as u64 {
            let mut frame = Frame::new(FrameSize::new(512, 512).expect("an allowed size"));
            frame.number = number;
            history.push(Arc::new(frame));
            assert!(history.bytes <= HISTORY_BYTES);
        }
        let newest = history.newest().expect("some are here");
        assert_eq!(newest, 2 * most as u64 - 1);
        assert_eq!(history.oldest(), Some(newest + 1 - most as u64));
        assert_eq!(history.get(newest).map(|frame| frame.number), Some(newest));
        assert!(history.get(0).is_none() && history.get(newest + 1).is_none());
        assert_eq!(history.back_from(newest, 3).count(), 3);
        assert_eq!(history.back_from(newest, 2 * most).count(), most);
    }

    #[test]
    fn the_rate_follows_the_last_times() {
        let mut history = FrameHistory::new(HISTORY_BYTES);
        let mut push = |time| {
            let mut frame = Frame::new(FrameSize::new(2, 2).expect("an allowed size"));
            frame.time = time;
            history.push(Arc::new(frame));
            history.rate()
        };
        assert_eq!([push(Some(0.0)), push(Some(0.5))], [None, Some(2.0)]);
        let mut time = 0.5;
        let faster = std::iter::repeat_with(|| {
            time += 0.25;
            push(Some(time))
        });
        assert_eq!(faster.take(RATED + 1).last(), Some(Some(4.0)));
        assert_eq!(push(None), None, "the newest frame has no time");
    }
}
