//! The newest frame, for those that show it: a newer one takes its place, and nobody waits.

use std::sync::{Mutex, PoisonError};

use crate::frame::Frame;

/// A slot for one frame, shared by the thread that acquires and the one that draws.
#[derive(Debug, Default)]
pub struct LatestFrame(Mutex<Slot>);

#[derive(Debug, Default)]
struct Slot {
    frame: Option<Frame>,
    is_new: bool,
    /// Frames that were overwritten before they were taken.
    skipped: u64,
}

impl LatestFrame {
    /// Puts a frame into the slot; true if the one before it was taken, so that whoever draws is to be woken.
    pub fn put(&self, frame: &Frame) -> bool {
        let mut slot = self.0.lock().unwrap_or_else(PoisonError::into_inner);
        match &mut slot.frame {
            Some(own) => own.copy_from(frame),
            None => slot.frame = Some(frame.clone()),
        }
        let was_new = std::mem::replace(&mut slot.is_new, true);
        slot.skipped += u64::from(was_new);
        !was_new
    }

    /// Copies the newest frame, if there is one that was not taken yet. Returns the number of all frames that were
    /// overwritten before they were taken.
    pub fn take(&self, frame: &mut Frame) -> Option<u64> {
        let mut slot = self.0.lock().unwrap_or_else(PoisonError::into_inner);
        let slot = &mut *slot;
        let newest = slot.frame.as_ref().filter(|_| slot.is_new)?;
        frame.copy_from(newest);
        slot.is_new = false;
        Some(slot.skipped)
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_newest_frame_wins_and_the_others_are_counted() {
        let latest = LatestFrame::default();
        let mut frame = Frame::new(1, 1);
        assert_eq!(latest.take(&mut frame), None);
        for number in 0..3 {
            frame.number = number;
            assert_eq!(latest.put(&frame), number == 0);
        }
        let mut shown = Frame::new(2, 2);
        assert_eq!((latest.take(&mut shown), shown.number), (Some(2), 2));
        assert_eq!(latest.take(&mut shown), None);
        assert!(latest.put(&frame));
    }
}
