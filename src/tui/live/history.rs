//! The most recent frames, as many as fit into a given amount of memory, and the one of them that is shown.

use std::collections::VecDeque;
use std::sync::Arc;

use taxel_core::frame::Frame;
use taxel_files::acquire::FrameRate;

/// Returns the memory that a frame takes, in bytes.
pub fn bytes_of(frame: &Frame) -> usize {
    size_of::<Frame>() + size_of_val(frame.values())
}

/// Frames are numbered from 0 as they come; a source that is watched again counts its own frames from 0 again.
#[derive(Clone, Debug)]
pub struct FrameHistory {
    frames: VecDeque<Arc<Frame>>,
    /// The number of the oldest frame that is still here.
    first: u64,
    bytes: usize,
    /// The memory that the frames may take, in bytes; the newest one is kept even if it takes more.
    most: usize,
    rate: FrameRate,
    /// The frame that the page stays at, as it was when it was frozen; None if the page follows the source.
    frozen: Option<(u64, Arc<Frame>)>,
}

impl FrameHistory {
    /// Creates an empty history that takes at most `most` bytes, and follows the source.
    pub fn new(most: usize) -> Self {
        Self {
            frames: VecDeque::new(),
            first: 0,
            bytes: 0,
            most,
            rate: FrameRate::default(),
            frozen: None,
        }
    }

    pub fn push(&mut self, frame: &Arc<Frame>) {
        match frame.time {
            Some(time) => self.rate.add(time),
            None => self.rate = FrameRate::default(),
        }
        self.bytes += bytes_of(frame);
        self.frames.push_back(Arc::clone(frame));
        while self.bytes > self.most && self.frames.len() > 1 {
            if let Some(oldest) = self.frames.pop_front() {
                self.bytes -= bytes_of(&oldest);
                self.first += 1;
            }
        }
    }

    /// Returns the numbers of the frames that are here.
    pub fn numbers(&self) -> std::ops::Range<u64> {
        self.first..self.first + self.frames.len() as u64
    }

    /// Returns the frame of a number; None if it is not here any more, or not yet.
    pub fn get(&self, number: u64) -> Option<&Arc<Frame>> {
        let index = number.checked_sub(self.first)?;
        self.frames.get(usize::try_from(index).ok()?)
    }

    /// Returns the newest frames, the newest one first.
    pub fn newest_first(&self) -> impl Iterator<Item = &Arc<Frame>> {
        self.frames.iter().rev()
    }

    /// Returns the frames per second, by the times of the last frames; None if they have no times, or came all at
    /// once.
    pub fn rate(&self) -> Option<f64> {
        self.rate.seconds_per_frame().map(f64::recip)
    }

    pub fn follows(&self) -> bool {
        self.frozen.is_none()
    }

    /// Returns the number of frames from the shown one to the newest; None if the page follows the source.
    pub fn behind(&self) -> Option<u64> {
        let (shown, _) = self.frozen.as_ref()?;
        Some(self.numbers().end.saturating_sub(shown + 1))
    }

    /// Returns the shown frame with its number; None before the first one.
    pub fn shown(&self) -> Option<(u64, Arc<Frame>)> {
        let newest = self.frames.back().map(Arc::clone);
        let following = || newest.map(|newest| (self.numbers().end - 1, newest));
        self.frozen.clone().or_else(following)
    }

    /// Returns up to this number of frames that end with the shown one and have its size, the last one first.
    pub fn up_to_shown(&self, count: usize) -> Vec<Arc<Frame>> {
        let skipped = usize::try_from(self.behind().unwrap_or(0)).unwrap_or(usize::MAX);
        let newest = self.newest_first().skip(skipped).take(count);
        let mut frames: Vec<_> = newest.cloned().collect();
        let same_size = |frame: &&Arc<Frame>| frame.size() == frames[0].size();
        frames.truncate(frames.iter().take_while(same_size).count());
        frames
    }

    pub fn freeze(&mut self) {
        self.frozen = self.shown();
    }

    pub fn follow(&mut self) {
        self.frozen = None;
    }

    /// Stays at the frame of this number, or at the nearest one that is here.
    pub fn stay_at(&mut self, number: u64) {
        let numbers = self.numbers();
        let number = number.clamp(numbers.start, numbers.end.saturating_sub(1));
        self.frozen = self.get(number).map(|frame| (number, Arc::clone(frame)));
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
        assert_eq!(history.numbers(), 0..0);
        let size = FrameSize::new(512, 512).expect("an allowed size");
        let most = (HISTORY_BYTES / bytes_of(&Frame::new(size))) as u64;
        for _ in 0..2 * most {
            history.push(&Arc::new(Frame::new(size)));
            assert!(history.bytes <= HISTORY_BYTES);
        }
        assert_eq!(history.numbers(), most..2 * most);
        assert!(history.get(most - 1).is_none() && history.get(2 * most).is_none());
        assert_eq!(history.up_to_shown(3).len(), 3);
    }

    #[test]
    fn the_rate_follows_the_last_times() {
        let mut history = FrameHistory::new(HISTORY_BYTES);
        let mut push = |time| {
            let mut frame = Frame::new(FrameSize::new(2, 2).expect("an allowed size"));
            frame.time = time;
            history.push(&Arc::new(frame));
            history.rate()
        };
        assert_eq!([push(Some(0.0)), push(Some(0.5))], [None, Some(2.0)]);
        let times = (1..).map(|step| 0.5 + 0.25 * f64::from(step));
        let rates = times.map(|time| push(Some(time))).take(21);
        assert_eq!(rates.last(), Some(Some(4.0)));
        assert_eq!(push(None), None, "the newest frame has no time");
    }
}
