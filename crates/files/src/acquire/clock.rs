//! Time while frames come: ticks, silences, and the pace of a recording that is played.

use std::time::{Duration, Instant};

use taxel_core::frame::Frame;

use crate::acquire::event::Playback;

/// The time between two ticks, and the longest wait until it is asked again whether more is wanted.
pub(super) const TICK: Duration = Duration::from_millis(100);

/// The time without a frame after which a source is reported as silent, unless its frames come more rarely.
const SILENCE: Duration = Duration::from_secs(2);

const MISSED: u32 = 3;

const LONGEST_INTERVAL: Duration = Duration::from_secs(20);

/// Notices that no frames come. It is asked at each tick.
#[derive(Debug)]
pub(super) struct SilenceWatch {
    /// When the last frames came, or the source was opened, and how many there were.
    last: Instant,
    frames: u64,
    /// The time between the last two ticks with frames.
    interval: Duration,
    /// The beginning of the time for which arriving bytes are counted, and the bytes before it.
    window: (Instant, u64),
    /// Whether the silence was reported: without bytes, and with bytes that are no frame.
    reported: [bool; 2],
}

impl SilenceWatch {
    pub(super) fn new(now: Instant) -> Self {
        Self {
            last: now,
            frames: 0,
            interval: Duration::ZERO,
            window: (now, 0),
            reported: [false; 2],
        }
    }

    /// Begins again, after the source was opened or frames have come, with this number of bytes so far.
    pub(super) fn begin(&mut self, bytes: u64, now: Instant) {
        (self.last, self.window, self.reported) = (now, (now, bytes), [false; 2]);
    }

    /// The bytes per second that arrived in a silence, if it must be reported: once without bytes, and once with bytes.
    /// Given are the numbers of frames and bytes so far.
    pub(super) fn look(&mut self, frames: u64, bytes: u64, now: Instant) -> Option<f64> {
        let since = now - self.last;
        if frames > self.frames {
            // The wait for the first frame does not show how often they come.
            if self.frames > 0 {
                self.interval = since.min(LONGEST_INTERVAL);
            }
            self.frames = frames;
            self.begin(bytes, now);
            return None;
        }
        let (from, before) = self.window;
        if since < SILENCE.max(self.interval * MISSED) || now - from < SILENCE {
            return None;
        }
        self.window = (now, bytes);
        let came = bytes.saturating_sub(before);
        if std::mem::replace(&mut self.reported[usize::from(came > 0)], true) {
            return None;
        }
        #[expect(clippy::cast_precision_loss, reason = "a rate for a message")]
        Some(came as f64 / (now - from).as_secs_f64())
    }
}

/// The seconds per frame of a recording that does not state them: ten frames a second.
const STEP: f64 = 0.1;

/// The longest time between two frames, in seconds, for which playback waits. A longer one may come from a clock that
/// was set; it is played as [`PLAYED`] seconds.
const PAUSE: f64 = 60.0;

const PLAYED: f64 = 2.0;

/// The longest wait for a frame, in seconds: a day.
const LONGEST: f64 = 86_400.0;

/// The pace of a recording, from its beginning: when its next frame is due.
#[derive(Debug)]
pub(super) struct Pace {
    begun: Instant,
    speed: f64,
    /// The seconds between the last two frames; until these are known, those that the recording states.
    step: f64,
    /// The time of the last frame; None before the first one of a round.
    last: Option<f64>,
    /// The seconds from the first to the last frame, with long pauses shortened.
    played: f64,
}

impl Pace {
    pub(super) fn new(playback: Playback, now: Instant) -> Self {
        let speed = match playback {
            Playback::Paced { speed, .. } if speed > 0.0 => speed,
            _ => 1.0,
        };
        Self {
            begun: now,
            speed,
            step: STEP,
            last: None,
            played: 0.0,
        }
    }

    /// Sets the seconds from one frame to the next, for frames without a time.
    pub(super) fn set_step(&mut self, step: f64) {
        self.step = step;
    }

    /// Takes the next frame.
    pub(super) fn take(&mut self, frame: &Frame) {
        let Some(last) = self.last else {
            // Times may count from another channel's first frame, or from the start of a longer recording.
            self.last = Some(frame.time.unwrap_or(0.0));
            return;
        };
        let time = frame.time.unwrap_or(last + self.step);
        self.last = Some(time);
        // After a clock was set back, the frame is due at once.
        let gap = (time - last).max(0.0);
        let is_long = gap > PAUSE;
        if gap > 0.0 && !is_long {
            self.step = gap;
        }
        self.played += if is_long { PLAYED } else { gap };
    }

    /// Ends a round: the next one begins once the last frame has lasted as long as the one before it. Returns false if
    /// there was no frame.
    pub(super) fn begin_again(&mut self) -> bool {
        self.played += self.step;
        self.last.take().is_some()
    }

    /// The time until the last frame that was taken is due.
    pub(super) fn left(&self, now: Instant) -> Duration {
        let passed = (now - self.begun).as_secs_f64();
        // Of infinite times at an infinite speed, the quotient is NaN; `max` drops it.
        let left = (self.played / self.speed - passed).max(0.0);
        Duration::from_secs_f64(left.min(LONGEST))
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn seconds(number: u64) -> Duration {
        Duration::from_secs(number)
    }

    /// The seconds at which a silence is reported while the source is looked at each second, with the bytes per second.
    /// Frames come at the given seconds, and 10 bytes each second from `junk` on.
    fn silences(frames: &[u64], junk: u64) -> Vec<(u64, f64)> {
        let begun = Instant::now();
        let mut watch = SilenceWatch::new(begun);
        let looks = 1..=60;
        let found = looks.filter_map(|second| {
            let came = frames.iter().filter(|&&frame| frame <= second).count();
            let bytes = 10 * second.saturating_sub(junk);
            let rate = watch.look(came as u64, bytes, begun + seconds(second))?;
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
        assert_eq!(silences(&[], 0), [(2, 10.0)], "junk since the beginning");
    }

    /// The seconds that frames at these times are played at twice the speed.
    fn played(times: &[Option<f64>]) -> f64 {
        let begun = Instant::now();
        let repeat = false;
        let mut pace = Pace::new(Playback::Paced { speed: 2.0, repeat }, begun);
        pace.set_step(4.0);
        for &time in times {
            let mut frame = Frame::default();
            frame.time = time;
            pace.take(&frame);
        }
        let first = pace.left(begun).as_secs_f64();
        assert!(pace.left(begun + seconds(1)).as_secs_f64() <= first);
        2.0 * first
    }

    #[test]
    fn frames_are_due_by_their_times_and_a_long_pause_is_played_as_a_moment() {
        let own = |times: &[f64]| played(&times.iter().copied().map(Some).collect::<Vec<_>>());
        // The first frame is due at once, even if its time is late.
        assert_eq!(own(&[1000.0]), 0.0);
        assert_eq!(own(&[1000.0, 1000.5]), 0.5);
        assert_eq!(played(&[None, None, None]), 8.0);
        assert_eq!(own(&[0.0, 0.5, 1e9, 1e9 + 0.5, 3.0, 3.5, 300.0]), 5.5);
        assert_eq!(own(&[0.0, 59.0]), 59.0);
        assert_eq!(own(&[0.0, f64::INFINITY]), 2.0);
    }

    #[test]
    fn the_last_frame_of_a_round_lasts_as_long_as_the_one_before() {
        let begun = Instant::now();
        let mut pace = Pace::new(Playback::Live, begun);
        assert!(!pace.begin_again(), "there is none");
        pace = Pace::new(Playback::Live, begun);
        for _ in 0..2 {
            for time in [1000.0, 1005.0] {
                let mut frame = Frame::default();
                frame.time = Some(time);
                pace.take(&frame);
            }
            assert!(pace.begin_again());
        }
        assert_eq!(pace.left(begun), seconds(20));
    }
}
