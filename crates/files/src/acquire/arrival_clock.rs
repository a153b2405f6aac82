//! Gives each frame a time: its own, which keeps growing across a gap in the source, or that of its arrival.

use std::time::Instant;

use crate::formats::seconds::to_nanoseconds;

/// How many seconds a source's clock may run ahead of this machine's across a gap: the last frame before the gap may
/// have come late.
const LATE: f64 = 1.0;

/// A clock that gives each frame a time: its own, else that of its arrival. Times keep growing even if only some frames
/// carry one.
#[derive(Debug, Default)]
pub(super) struct ArrivalClock {
    /// The time of the last frame that carried one, else of the first frame, and when it arrived.
    base: Option<(f64, Instant)>,
    /// The time of the last frame.
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

    /// Returns the time of a frame that has just arrived, given the time that it carries, if any; None for a frame
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

    /// Returns the time of arrival of a frame without a time of its own.
    fn arrival(&mut self, now: Instant) -> f64 {
        // The first time of a frame's own counts from those of the arrivals before it.
        self.rejoined |= self.base.is_none();
        let (base, when) = *self.base.get_or_insert((0.0, now));
        to_nanoseconds(base + (now - when).as_secs_f64())
    }

    /// Returns the time of a frame, given its own. After a gap the source's clock may have restarted or been set;
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

#[cfg(test)]
mod tests {
    use std::time::Duration;

    use super::*;

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
}
