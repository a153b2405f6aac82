//! Gives frames times: their own, which go on growing over a gap in their source, or those of their arrival.

use std::time::Instant;

use crate::formats::seconds::to_nanoseconds;

/// How many seconds a source's clock may run ahead of this machine's across a gap: the last frame before the gap may
/// have come late.
const LATE: f64 = 1.0;

/// A clock that continues the frames' own times over gaps.
#[derive(Debug, Default)]
struct ContinuedTime {
    /// The time of the last frame that had one of its own, and when it came.
    given: Option<(f64, Instant)>,
    /// Whether there was a gap since then.
    rejoined: bool,
    /// The seconds added to the frames' own times after the source's clock restarted.
    shift: Option<f64>,
}

/// A clock that gives each frame a time: its own, else that of its arrival since the first frame without one.
#[derive(Debug, Default)]
pub(super) struct ArrivalClock {
    /// The clock for frames with a time of their own.
    own: ContinuedTime,
    /// The arrival of the first frame without a time of its own.
    first: Option<Instant>,
}

impl ArrivalClock {
    /// Notes a gap: the source is read anew from here on.
    pub(super) fn rejoin(&mut self) {
        self.own.rejoin();
    }

    /// Returns the time of a frame that came now, given its own; None for a frame without one that arrived at some
    /// other time.
    pub(super) fn time(&mut self, own: Option<f64>, arrives: bool) -> Option<f64> {
        let now = Instant::now();
        if let Some(own) = own {
            return Some(self.own.of(own, now));
        }
        let first = arrives.then(|| *self.first.get_or_insert(now))?;
        Some(to_nanoseconds((now - first).as_secs_f64()))
    }
}

impl ContinuedTime {
    /// Notes a gap: the source is read anew from here on.
    fn rejoin(&mut self) {
        self.rejoined = true;
    }

    /// Returns the time of a frame, given its own. After a gap the source's clock may have restarted or been set;
    /// then the length of the gap is taken from this machine's clock, so that times keep growing.
    fn of(&mut self, own: f64, now: Instant) -> f64 {
        let mut time = self.shifted(own);
        if std::mem::take(&mut self.rejoined)
            && let Some((last, when)) = self.given
        {
            let continued = last + (now - when).as_secs_f64();
            if time <= last || time > continued + LATE {
                self.shift = Some(continued - own);
                time = self.shifted(own);
            }
        }
        self.given = Some((time, now));
        time
    }

    fn shifted(&self, own: f64) -> f64 {
        self.shift.map_or(own, |shift| to_nanoseconds(own + shift))
    }
}
