//! The rate at which frames come, measured from their times.

use std::collections::VecDeque;

use crate::formats::seconds::to_nanoseconds;

/// Frames within this many seconds count as one burst.
const TOGETHER: f64 = 0.1;

/// The most bursts: two seconds of a fast source.
const MOST: usize = 20;

/// A measurement of the rate of the last frames.
///
/// Often several frames come at once: a read returns everything that is in a pipe, or a program sends in bursts. The
/// times between such frames say nothing about the rate, so frames within a tenth of a second count as one burst, and
/// a burst lasts until the next one begins:
/// ```text
/// times   0  0  0            0.5  0.5  0.5            1.0
/// bursts  3 frames in 0.5 s  3 frames in 0.5 s        open      6 frames in 1 s
/// ```
#[derive(Clone, Debug, Default)]
pub struct FrameRate {
    /// The number of frames of each burst, and its length in seconds.
    bursts: VecDeque<(f64, f64)>,
    /// The burst that has not ended: the time of its first frame, and its number of frames.
    open: Option<(f64, f64)>,
}

impl FrameRate {
    /// Adds the time of the next frame, in seconds. If it is earlier than the open burst, that burst is dropped and a
    /// new one begins.
    pub fn add(&mut self, time: f64) {
        if let Some((start, frames)) = &mut self.open {
            let seconds = time - *start;
            if (0.0..TOGETHER).contains(&seconds) {
                *frames += 1.0;
                return;
            }
            if seconds >= TOGETHER {
                let frames = *frames;
                if self.bursts.len() == MOST {
                    self.bursts.pop_front();
                }
                self.bursts.push_back((frames, seconds));
            }
        }
        self.open = Some((time, 1.0));
    }

    /// The mean time from a frame to the next, in seconds. None if all frames have come in one burst: their times do not
    /// show the rate.
    pub fn seconds_per_frame(&self) -> Option<f64> {
        let frames: f64 = self.bursts.iter().map(|(frames, _)| frames).sum();
        let seconds: f64 = self.bursts.iter().map(|(_, seconds)| seconds).sum();
        Some(to_nanoseconds(seconds / frames)).filter(|&step| step > 0.0)
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn step(times: impl IntoIterator<Item = f64>) -> Option<f64> {
        let mut rate = FrameRate::default();
        times.into_iter().for_each(|time| rate.add(time));
        rate.seconds_per_frame()
    }

    /// The times of `count` bursts, one every `period` seconds: `frames` frames at once, in two reads.
    fn bursts(frames: u32, period: f64, count: u32) -> impl Iterator<Item = f64> {
        (0..count).flat_map(move |burst| {
            let start = f64::from(burst) * period;
            (0..frames).map(move |frame| start + if 2 * frame < frames { 0.0 } else { 4e-4 })
        })
    }

    #[test]
    fn frames_that_come_at_once_are_not_mistaken_for_fast_ones() {
        assert_eq!(step(bursts(100, 0.25, 9)), Some(0.0025));
        // 16 frames a read.
        let step = step(bursts(16, 0.016, 200)).expect("known");
        assert!((step - 0.001).abs() < 1e-5, "{step}");
    }

    #[test]
    fn frames_of_a_single_burst_have_no_rate() {
        assert_eq!(step(bursts(500, 1.0, 1)), None);
        assert_eq!(step([0.0, 0.0, 0.0]), None);
        assert_eq!(step([]), None);
        assert_eq!(step([f64::NAN, f64::NAN]), None);
    }

    #[test]
    fn times_that_go_back_do_not_count() {
        assert_eq!(step([1.0, 1.5, 0.0, 0.5, 1.0, 1.5, 2.0]), Some(0.5));
        let steady = (0..1000).map(|frame| f64::from(frame) * 0.02);
        assert_eq!(step(steady), Some(0.02));
    }

    #[test]
    fn only_the_last_bursts_count() {
        let slow = (0..9).map(f64::from);
        let fast = (1..=20).map(|frame| 8.0 + f64::from(frame) * 0.25);
        assert_eq!(step(slow.chain(fast)), Some(0.25));
    }
}
