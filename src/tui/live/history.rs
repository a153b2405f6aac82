//! The most recent frames, as many as fit into a given amount of memory.

use std::collections::VecDeque;
use std::sync::Arc;

use crate::acquire::FrameRate;
use crate::frame::Frame;

/// The memory for frames, in bytes, unless another size is set.
pub const HISTORY_BYTES: usize = 32 << 20;

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

#[cfg(test)]
mod tests {
    use super::*;
    use crate::frame::FrameSize;

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
