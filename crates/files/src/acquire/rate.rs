//! The rate at which frames come, measured from their times.

use std::collections::VecDeque;

use crate::formats::seconds::to_nanoseconds;

const TOGETHER: f64 = 0.1;

/// A burst that lasts longer than this many seconds is followed by a gap, such as a lost connection, unless most
/// bursts last about as long.
const GAP: f64 = 1.0;

/// A measurement of the rate of the last frames.
///
/// Often several frames come at once: a read returns everything that is in a pipe, or a program sends in bursts. The
/// times between such frames say nothing about the rate, so frames within a tenth of a second count as one burst, and
/// a burst lasts until the next one begins:
/// ```text
/// times   0  0  0            0.5  0.5  0.5            1.0
/// bursts  3 frames in 0.5 s  3 frames in 0.5 s        open      6 frames in 1 s
/// ```
#[derive(Clone, Debug)]
pub struct FrameRate {
    /// The number of frames of each burst, and its length in seconds.
    bursts: VecDeque<(f64, f64)>,
    most: usize,
    /// The burst that has not ended: the time of its first frame, and its number of frames.
    open: Option<(f64, f64)>,
}

impl FrameRate {
    /// Measures the rate over the last bursts, at most this many; each lasts a tenth of a second or longer.
    pub fn over(most: usize) -> Self {
        Self {
            bursts: VecDeque::new(),
            most,
            open: None,
        }
    }

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
                if self.bursts.len() == self.most {
                    self.bursts.pop_front();
                }
                self.bursts.push_back((frames, seconds));
            }
        }
        self.open = Some((time, 1.0));
    }

    /// The mean time from a frame to the next, in seconds, without gaps. None if all frames have come in one
    /// burst: their times do not show the rate.
    pub fn seconds_per_frame(&self) -> Option<f64> {
        let frames: f64 = self.usual().map(|(frames, _)| frames).sum();
        let seconds: f64 = self.usual().map(|(_, seconds)| seconds).sum();
        Some(to_nanoseconds(seconds / frames)).filter(|&step| step > 0.0)
    }

    fn usual(&self) -> impl Iterator<Item = &(f64, f64)> {
        let mut lengths: Vec<f64> = self.bursts.iter().map(|burst| burst.1).collect();
        lengths.sort_by(f64::total_cmp);
        let median = lengths.get(lengths.len().saturating_sub(1) / 2);
        let longest = median.map_or(GAP, |median| GAP.max(3.0 * median));
        let bursts = self.bursts.iter();
        bursts.filter(move |(_, seconds)| *seconds <= longest)
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn step(times: impl IntoIterator<Item = f64>) -> Option<f64> {
        let mut rate = FrameRate::over(4096);
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
        // A pause of more than a second between bursts is no gap.
        assert_eq!(step(bursts(500, 1.5, 4)), Some(0.003));
        assert_eq!(step(bursts(500, 1.5, 2)), Some(0.003));
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
    fn gaps_and_times_that_go_back_do_not_count() {
        let usual = [0.0, 0.125, 98.25, 98.375, 96.0, 96.125];
        assert_eq!(step(usual), Some(0.125));
        // Times go back, and frames that are earlier than the open burst do not count as one burst.
        assert_eq!(step([1.0, 1.5, 0.0, 0.5, 1.0, 1.5, 2.0]), Some(0.5));
        let mut with_gap: Vec<f64> = bursts(3, 0.3, 20).collect();
        with_gap.extend(bursts(3, 0.3, 2).map(|time| 11.0 + time));
        assert_eq!(step(with_gap), Some(0.1));
        // Slow, but without a gap.
        assert_eq!(
            step([0.0, 10.0, 22.0, 53.0]),
            Some(to_nanoseconds(53.0 / 3.0))
        );
        let steady = (0..1000).map(|frame| f64::from(frame) * 0.02);
        assert_eq!(step(steady), Some(0.02));
    }

    #[test]
    fn only_the_last_bursts_count() {
        let mut rate = FrameRate::over(4);
        for time in [0.0, 1.0, 2.0, 3.0, 3.25, 3.5, 3.75, 4.0] {
            rate.add(time);
        }
        assert_eq!(rate.seconds_per_frame(), Some(0.25));
    }
}
