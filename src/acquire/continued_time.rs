//! Times of frames that go on growing over a gap in their source.

use std::time::Instant;

use crate::formats::seconds::to_nanoseconds;

/// How far a source's clock may run ahead of this machine's across a gap, in seconds: the last frame before the gap may have
/// come late.
const LATE: f64 = 1.0;

/// Continues the frames' own times over gaps.
#[derive(Debug, Default)]
pub(super) struct ContinuedTime {
    /// The time of the last frame that had one of its own, and when it came.
    given: Option<(f64, Instant)>,
    /// Whether there was a gap since then.
    rejoined: bool,
    /// What is added to the frames' own times after the source's clock restarted.
    shift: Option<f64>,
}

impl ContinuedTime {
    /// Notes a gap: the source is read anew from here on.
    pub(super) fn rejoin(&mut self) {
        self.rejoined = true;
    }

    /// The time of a frame, given its own. After a gap the source's clock may have restarted or been set; then the time of the
    /// gap is taken from this machine's clock, so that times keep growing.
    pub(super) fn of(&mut self, own: f64, now: Instant) -> f64 {
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
