//! The frames of the live page, and which of them is shown: the newest one, the largest values so far, or a frame that
//! the user stays at.

use std::sync::Arc;

use crate::frame::Frame;
use crate::tui::live::history::{FrameHistory, is_same};
use crate::tui::live::message::ProvisionalChange;
use crate::tui::live::reading::hold;
use crate::tui::live::refusal::LiveRefusal;

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

    /// Returns the number of frames that have come since the source was last watched anew.
    pub(super) fn arrived(&self) -> u64 {
        self.next_number() - self.watched_from
    }

    pub(super) fn next_number(&self) -> u64 {
        self.history.next_number()
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
