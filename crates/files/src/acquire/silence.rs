//! Notices when a live source gives no more frames.

use std::time::{Duration, Instant};

/// The time without a frame after which a source is reported as silent, unless its frames come more rarely.
const SILENCE: Duration = Duration::from_secs(2);

/// The number of intervals without a frame after which a source is silent.
const MISSED: u32 = 3;

/// The longest time between two frames that counts as usual.
const LONGEST_INTERVAL: Duration = Duration::from_secs(20);

/// The wait for the next frame of a live source.
#[derive(Debug)]
pub(super) struct SilenceWatch {
    /// When the last frame came, or the source was opened.
    last_frame: Instant,
    /// The time between the last two frames that did not arrive together; None before the first frame.
    interval: Option<Duration>,
    /// Whether a frame has come since the last look.
    frame_came: bool,
    /// The number of bytes up to the last frame or the last look at the silence.
    bytes: u64,
    /// The time of the last look at the silence.
    looked: Option<Instant>,
    /// Whether the silence was reported: without bytes, and with bytes that are no frame.
    reported: [bool; 2],
}

impl SilenceWatch {
    /// Starts to wait for the first frame.
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

    /// Notes that a frame has just arrived.
    pub(super) fn note_frame(&mut self, now: Instant) {
        if !std::mem::replace(&mut self.frame_came, true) {
            let since_last = now - self.last_frame;
            let usual = since_last.min(LONGEST_INTERVAL);
            self.interval = Some(self.interval.map_or(Duration::ZERO, |_| usual));
        }
        self.begin(now);
    }

    /// Notes that the source is open again. `bytes` is the number of bytes so far.
    pub(super) fn reopen(&mut self, bytes: u64, now: Instant) {
        self.bytes = bytes;
        self.begin(now);
    }

    /// Notes that the wait for the next frame begins now.
    fn begin(&mut self, now: Instant) {
        (self.last_frame, self.looked, self.reported) = (now, None, [false; 2]);
    }

    /// Returns the bytes per second that arrived in a silence, if it must be reported: once without bytes, and once
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

    /// Returns the seconds at which a silence is reported while the source is looked at each second, with the bytes
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
}
