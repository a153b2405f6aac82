//! Time while frames come: ticks, silences, the time of each frame, and their rate.

use std::collections::VecDeque;
use std::time::{Duration, Instant};

use crate::formats::seconds::to_nanoseconds;

/// The time between two ticks, and the longest wait until it is asked again whether more is wanted.
pub(super) const TICK: Duration = Duration::from_millis(100);

#[derive(Debug)]
pub(super) struct Ticker {
    last: Instant,
}

impl Ticker {
    pub(super) fn new() -> Self {
        Self {
            last: Instant::now(),
        }
    }

    pub(super) fn is_due(&mut self) -> bool {
        let now = Instant::now();
        let is_due = now - self.last >= TICK;
        if is_due {
            self.last = now;
        }
        is_due
    }
}

/// The time without a frame after which a source is reported as silent, unless its frames come more rarely.
const SILENCE: Duration = Duration::from_secs(2);

const MISSED: u32 = 3;

const LONGEST_INTERVAL: Duration = Duration::from_secs(20);

#[derive(Debug)]
pub(super) struct SilenceWatch {
    last_frame: Instant,
    /// The time between the last two frames that did not arrive together; None before the first frame.
    interval: Option<Duration>,
    frame_came: bool,
    bytes: u64,
    looked: Option<Instant>,
    /// Whether the silence was reported: without bytes, and with bytes that are no frame.
    reported: [bool; 2],
}

impl SilenceWatch {
    pub(super) fn new(now: Instant) -> Self {
        Self {
            last_frame: now,
            interval: None,
            frame_came: false,
            bytes: 0,
            looked: None,
            reported: [false; 2],
        }
    }

    pub(super) fn note_frame(&mut self, now: Instant) {
        if !std::mem::replace(&mut self.frame_came, true) {
            let since_last = now - self.last_frame;
            let usual = since_last.min(LONGEST_INTERVAL);
            self.interval = Some(self.interval.map_or(Duration::ZERO, |_| usual));
        }
        self.begin(now);
    }

    pub(super) fn reopen(&mut self, bytes: u64, now: Instant) {
        self.bytes = bytes;
        self.begin(now);
    }

    fn begin(&mut self, now: Instant) {
        (self.last_frame, self.looked, self.reported) = (now, None, [false; 2]);
    }

    /// The bytes per second that arrived in a silence, if it must be reported: once without bytes, and once
    /// with bytes. `bytes` is the number of bytes so far.
    pub(super) fn look(&mut self, bytes: u64, now: Instant) -> Option<f64> {
        if std::mem::take(&mut self.frame_came) {
            self.bytes = bytes;
        }
        let missed = |interval: Duration| (interval * MISSED).max(SILENCE);
        let usual = self.interval.map_or(SILENCE, missed);
        let since = self.looked.unwrap_or(self.last_frame);
        if now - self.last_frame < usual || now - since < SILENCE {
            return None;
        }
        let came = bytes.saturating_sub(std::mem::replace(&mut self.bytes, bytes));
        self.looked = Some(now);
        if std::mem::replace(&mut self.reported[usize::from(came > 0)], true) {
            return None;
        }
        #[expect(clippy::cast_precision_loss, reason = "a rate for a message")]
        let bytes = came as f64;
        Some(bytes / (now - since).as_secs_f64())
    }
}

/// How many seconds a source's clock may run ahead of this machine's across a gap: the last frame before the gap may
/// have come late.
const LATE: f64 = 1.0;

/// A clock that gives each frame a time: its own, else that of its arrival. Times keep growing even if only some frames
/// carry one.
#[derive(Debug, Default)]
pub(super) struct ArrivalClock {
    /// The time of the last frame that carried one, else of the first frame, and when it arrived.
    base: Option<(f64, Instant)>,
    last: f64,
    /// Whether the next time that a frame carries may come from another clock.
    rejoined: bool,
    /// The seconds added to the frames' own times after the source's clock restarted.
    shift: Option<f64>,
}

impl ArrivalClock {
    /// Notes a gap: the source is read anew from here on.
    pub(super) fn rejoin(&mut self) {
        self.rejoined = true;
    }

    /// The time of a frame that has just arrived, given the time that it carries, if any; None for a frame
    /// without one that arrived at some other time.
    pub(super) fn time(&mut self, own: Option<f64>, arrives: bool) -> Option<f64> {
        self.time_at(own, arrives, Instant::now())
    }

    fn time_at(&mut self, own: Option<f64>, arrives: bool, now: Instant) -> Option<f64> {
        let time = match own {
            Some(own) => self.continued(own, now),
            None if arrives => self.arrival(now),
            None => return None,
        };
        self.last = time;
        Some(time)
    }

    fn arrival(&mut self, now: Instant) -> f64 {
        // The first time of a frame's own counts from those of the arrivals before it.
        self.rejoined |= self.base.is_none();
        let (base, when) = *self.base.get_or_insert((0.0, now));
        to_nanoseconds(base + (now - when).as_secs_f64())
    }

    /// The time of a frame, given its own. After a gap the source's clock may have restarted or been set;
    /// then the length of the gap is taken from this machine's clock, so that times keep growing.
    fn continued(&mut self, own: f64, now: Instant) -> f64 {
        let mut time = self.shifted(own);
        if std::mem::take(&mut self.rejoined)
            && let Some((base, when)) = self.base
        {
            let continued = base + (now - when).as_secs_f64();
            if time <= self.last || time > continued + LATE {
                self.shift = Some(continued - own);
                time = self.shifted(own);
            }
        }
        self.base = Some((time, now));
        time
    }

    fn shifted(&self, own: f64) -> f64 {
        self.shift.map_or(own, |shift| to_nanoseconds(own + shift))
    }
}

const TOGETHER: f64 = 0.1;

/// A burst that lasts longer than this many seconds is followed by a gap, such as a lost connection, unless most
/// bursts last about as long.
const GAP: f64 = 1.0;

/// The largest deviation of a burst from the mean, as a share of it, of frames that come evenly. A clock that counts
/// hundredths of a second deviates that much from a tenth.
const UNEVEN: f64 = 0.1;

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
    bursts: VecDeque<Burst>,
    most: usize,
    /// The burst that has not ended: the time of its first frame, and its number of frames.
    open: Option<(f64, u32)>,
    falls: usize,
}

#[derive(Clone, Copy, Debug)]
struct Burst {
    frames: u32,
    seconds: f64,
}

impl FrameRate {
    /// Measures the rate over the last bursts, at most this many; each lasts a tenth of a second or longer.
    pub fn over(most: usize) -> Self {
        Self {
            bursts: VecDeque::new(),
            most,
            open: None,
            falls: 0,
        }
    }

    /// Adds the time of the next frame, in seconds. If it is earlier than the open burst, that burst is dropped and a
    /// new one begins.
    pub fn add(&mut self, time: f64) {
        if let Some((start, frames)) = &mut self.open {
            let seconds = time - *start;
            if (0.0..TOGETHER).contains(&seconds) {
                *frames += 1;
                return;
            }
            if seconds >= TOGETHER {
                let frames = *frames;
                if self.bursts.len() == self.most {
                    self.bursts.pop_front();
                }
                self.bursts.push_back(Burst { frames, seconds });
            }
            self.falls += usize::from(seconds < 0.0);
        }
        self.open = Some((time, 1));
    }

    /// The mean time from a frame to the next, in seconds, without gaps. None if all frames have come in one
    /// burst: their times do not show the rate.
    pub fn seconds_per_frame(&self) -> Option<f64> {
        let (frames, seconds) = self.usual().fold((0.0, 0.0), |(frames, seconds), burst| {
            (frames + f64::from(burst.frames), seconds + burst.seconds)
        });
        Some(to_nanoseconds(seconds / frames)).filter(|&step| step > 0.0)
    }

    /// The mean time from a frame to the next, like [`Self::seconds_per_frame`], if frames came evenly; None if
    /// more than a tenth of the times between gaps differ, or if most times are gaps or go back.
    pub(crate) fn even_seconds_per_frame(&self) -> Option<f64> {
        let step = self.seconds_per_frame()?;
        let is_even = |burst: &Burst| {
            let expected = f64::from(burst.frames) * step;
            (burst.seconds - expected).abs() <= UNEVEN * expected
        };
        let usual = self.usual().count();
        let breaks = self.bursts.len() - usual + self.falls;
        let even = self.usual().filter(|burst| is_even(burst)).count();
        (10 * even >= 9 * usual && breaks < usual).then_some(step)
    }

    fn usual(&self) -> impl Iterator<Item = &Burst> {
        let mut lengths: Vec<f64> = self.bursts.iter().map(|burst| burst.seconds).collect();
        lengths.sort_by(f64::total_cmp);
        let median = lengths.get(lengths.len().saturating_sub(1) / 2);
        let longest = median.map_or(GAP, |median| GAP.max(3.0 * median));
        let bursts = self.bursts.iter();
        bursts.filter(move |burst| burst.seconds <= longest)
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn silence_comes_with_the_rate_of_all_bytes_since_the_last_frame() {
        let begun = Instant::now();
        let mut watch = SilenceWatch::new(begun);
        // Junk, checked before two seconds have gone by and after.
        let looks = [(100, 1), (200, 2)];
        let rates =
            looks.map(|(bytes, second)| watch.look(bytes, begun + Duration::from_secs(second)));
        assert_eq!(rates, [None, Some(100.0)]);
    }

    /// The seconds at which a silence is reported while the source is looked at each second, with the bytes
    /// per second. Frames come at the given seconds, and 10 bytes each second from `junk` on.
    fn silences(frames: &[u64], junk: u64) -> Vec<(u64, f64)> {
        let begun = Instant::now();
        let mut watch = SilenceWatch::new(begun);
        let looks = 1..=60;
        let found = looks.filter_map(|second| {
            let now = begun + Duration::from_secs(second);
            if frames.contains(&second) {
                watch.note_frame(now);
            }
            let bytes = 10 * second.saturating_sub(junk);
            let rate = watch.look(bytes, now)?;
            Some((second, rate))
        });
        found.collect()
    }

    #[test]
    fn a_silence_is_reported_once_and_only_if_it_is_unusual() {
        assert_eq!(silences(&[], 60), [(2, 0.0)], "nothing comes");
        let each_second: Vec<u64> = (1..=9).collect();
        assert_eq!(silences(&each_second, 60), [(12, 0.0)]);
        let slow: Vec<u64> = (1..=9).map(|n| 4 * n).collect();
        // The time between two frames is not known yet.
        assert_eq!(silences(&slow, 60), [(2, 0.0), (6, 0.0), (48, 0.0)]);
        assert_eq!(silences(&[], 9), [(2, 0.0), (10, 5.0)], "then junk comes");
    }

    /// Each frame comes a second after the one before.
    fn times(frames: &[Option<f64>]) -> Vec<f64> {
        let (mut clock, begun) = (ArrivalClock::default(), Instant::now());
        let frames = (0..).zip(frames);
        frames
            .filter_map(|(second, &own)| {
                clock.time_at(own, true, begun + Duration::from_secs(second))
            })
            .collect()
    }

    #[test]
    fn times_go_on_if_only_some_frames_have_one() {
        let own = |time| Some(time);
        for (frames, expected) in [
            ([None, None, None, None], [0.0, 1.0, 2.0, 3.0]),
            ([own(0.0), own(0.5), None, None], [0.0, 0.5, 1.5, 2.5]),
            ([own(0.0), None, own(1.7), None], [0.0, 1.0, 1.7, 2.7]),
            ([None, None, own(0.0), own(0.9)], [0.0, 1.0, 2.0, 2.9]),
        ] {
            assert_eq!(times(&frames), expected, "{frames:?}");
        }
    }

    #[test]
    fn a_frame_without_a_time_does_not_change_the_times_of_later_frames() {
        let own = |time| Some(time);
        for (frames, expected) in [
            // The source is faster than this machine's clock, as when it is read from a file, or its frames are late.
            ([own(3.0), None, own(7.0), own(8.0)], [3.0, 4.0, 7.0, 8.0]),
            ([own(0.0), None, own(0.5), own(0.6)], [0.0, 1.0, 0.5, 0.6]),
        ] {
            assert_eq!(times(&frames), expected, "{frames:?}");
        }
    }

    #[test]
    fn times_go_on_after_a_gap_even_if_its_first_frame_has_none() {
        let (mut clock, begun) = (ArrivalClock::default(), Instant::now());
        let mut time = |own, second| clock.time_at(own, true, begun + Duration::from_secs(second));
        assert_eq!(time(Some(50.0), 0), Some(50.0));
        clock.rejoin();
        let mut time = |own, second| clock.time_at(own, true, begun + Duration::from_secs(second));
        let times = [time(None, 1), time(Some(0.0), 2), time(Some(0.5), 3)];
        assert_eq!(times, [51.0, 52.0, 52.5].map(Some));
    }

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
    fn an_even_rate_needs_equal_steps() {
        let even = |times: &[f64]| {
            let mut rate = FrameRate::over(4096);
            for &time in times {
                rate.add(time);
            }
            rate.even_seconds_per_frame()
        };
        assert_eq!(even(&[0.0, 0.1, 5.0, 5.2, 90.0]), None);
        assert_eq!(even(&[0.0, 1.0, -0.5]), None);
        assert_eq!(even(&[0.0, 0.25, 40.0]), None);
        assert_eq!(even(&[0.0, 0.25, 0.5, 40.0]), Some(0.25));
        // Rounded to hundredths.
        let rounded = [0.0, 0.14, 0.29, 0.43, 0.57, 0.71, 0.86, 1.0];
        assert_eq!(even(&rounded), Some(0.142_857_143));
        // One frame is missing.
        let missing = (0..600_u32).filter(|&frame| frame != 300);
        let times: Vec<f64> = missing.map(|frame| f64::from(frame) / 64.0).collect();
        assert!(even(&times).is_some_and(|step| (step - 1.0 / 64.0).abs() < 1e-4));
        assert_eq!(even(&[]), None);
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
