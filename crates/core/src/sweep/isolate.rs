//! The spans of an ellipse, solid or with an elliptic hole, without an earlier row to start from: slow, but always
//! correct.
//!
//! **Method.** As for polygons the coverage at place `u` is `C(u) = W(u + 1) − W(u)`, with `W` the integral of the
//! height `w` of the section inside the band. It is not a polynomial, so its passages through the threshold are
//! isolated first: on an interval the section of a convex set is concave in `x`, which bounds `w` there by its ends and
//! its greatest value, and so bounds the slope of `C`. An interval on which the slope keeps its sign holds at most one
//! passage; one on which `C` cannot reach the threshold holds none; any other is halved. Nothing is missed,
//! however thin the wall is.
//!
//! **Error.** Below 1e-11: closed forms of numbers below 10^4. Frame: the anchor at the origin; cell sides.

use crate::sweep::ellipse_band::EllipseBand;
use crate::sweep::span::{DOUBT, Level, NEAR, Spans};

/// The width, in cells, below which intervals are not halved. Narrower ones are decided with more digits.
const NARROW: f64 = 1e-6;

/// An ellipse and perhaps a hole, both cut to the band.
#[derive(Clone, Debug)]
pub(crate) struct HollowEllipse {
    pub(crate) threshold: f64,
    pub(crate) outer: EllipseBand,
    pub(crate) inner: Option<EllipseBand>,
}

/// A place, and the coverage there minus the threshold.
type Sample = (f64, f64);

impl HollowEllipse {
    pub(crate) fn isolate_all(&self, spans: &mut Spans) {
        let (left, right) = self.outer.reach();
        let ends = ((left - 1.0, -self.threshold), (right, -self.threshold));
        self.isolate(ends.0, ends.1, spans);
        spans.set_level(right, Level::Below);
    }

    fn excess(&self, u: f64) -> f64 {
        let covered = |band: &EllipseBand| band.coverage(&band.at(u), &band.at(u + 1.0));
        let outer = covered(&self.outer);
        let inner = self.inner.as_ref().map_or(0.0, covered);
        if outer == 1.0 && inner == 0.0 {
            // Full without any doubt, even where the threshold is 1.
            return (1.0 - self.threshold).max(2.0 * DOUBT);
        }
        outer - inner - self.threshold
    }

    fn slopes(&self, from: f64, to: f64) -> (f64, f64) {
        let (low, high) = self.outer.bounds(from, to);
        let (low_ahead, high_ahead) = self.outer.bounds(from + 1.0, to + 1.0);
        let (least, most) = (low_ahead - high, high_ahead - low);
        let Some(inner) = &self.inner else {
            return (least, most);
        };
        let (low, high) = inner.bounds(from, to);
        let (low_ahead, high_ahead) = inner.bounds(from + 1.0, to + 1.0);
        (least - high_ahead + low, most - low_ahead + high)
    }

    fn isolate(&self, from: Sample, to: Sample, spans: &mut Spans) {
        let (before, after) = (Level::of(from.1), Level::of(to.1));
        let (least, most) = self.slopes(from.0, to.0);
        let width = to.0 - from.0;
        if least >= 0.0 || most <= 0.0 {
            return self.passage(from, to, spans);
        }
        if before == after && before != Level::Doubtful {
            // Two lines, as steep as the slope can be, from the ends towards the threshold.
            let (near, far) = if before == Level::Above {
                (least, most)
            } else {
                (most, least)
            };
            let meeting = (from.1 - to.1 + far * width) / (far - near);
            let extreme = from.1 + near * meeting;
            if Level::of(extreme) == before {
                return spans.set_level(from.0, before);
            }
        }
        if width < NARROW {
            spans.set_level(from.0, Level::Doubtful);
            return spans.set_level(to.0, after);
        }
        let middle = from.0 + width / 2.0;
        let middle = (middle, self.excess(middle));
        self.isolate(from, middle, spans);
        self.isolate(middle, to, spans);
    }

    fn passage(&self, from: Sample, to: Sample, spans: &mut Spans) {
        let (before, after) = (Level::of(from.1), Level::of(to.1));
        spans.set_level(from.0, before);
        if before == after {
            return;
        }
        let sense = if to.1 > from.1 { 1.0 } else { -1.0 };
        if before != Level::Doubtful && after != Level::Doubtful {
            let at = self.solve(from, to, 0.0, 1e-5);
            let certain = |u: f64, level: Level| Level::of(self.excess(u)) == level;
            let (left, right) = (at - 0.5 * NEAR, at + 0.5 * NEAR);
            if left > from.0 && right < to.0 && certain(left, before) && certain(right, after) {
                return spans.set_level(at, after);
            }
        }
        if before != Level::Doubtful {
            let at = self.solve(from, to, -sense * DOUBT, 1e-13);
            spans.set_level(at, Level::Doubtful);
        }
        if after != Level::Doubtful {
            let at = self.solve(from, to, sense * DOUBT, 1e-13);
            spans.set_level(at, after);
        }
    }

    /// Returns where the excess reaches a height, by Newton's method kept inside a bracket.
    fn solve(&self, from: Sample, to: Sample, height: f64, precision: f64) -> f64 {
        let rising = to.1 > from.1;
        let (mut low, mut high) = (from.0, to.0);
        let share = (height - from.1) / (to.1 - from.1);
        let mut at = low + (high - low) * share.clamp(0.0, 1.0);
        for _ in 0..60 {
            let gap = self.excess(at) - height;
            if (gap > 0.0) == rising {
                high = at;
            } else {
                low = at;
            }
            let next = at - gap / self.slope(at);
            if (next - at).abs() < precision {
                return next.clamp(from.0, to.0);
            }
            let next = if next > low && next < high {
                next
            } else {
                low + (high - low) / 2.0
            };
            at = next;
        }
        at
    }

    fn slope(&self, u: f64) -> f64 {
        let outer = self.outer.height(u + 1.0) - self.outer.height(u);
        let inner = self
            .inner
            .as_ref()
            .filter(|inner| inner.is_here())
            .map_or(0.0, |inner| inner.height(u + 1.0) - inner.height(u));
        outer - inner
    }
}
