//! Ranges of numbers, with ends that belong to them or not, or that grow with the sensor.

use std::fmt;

/// One end of a range.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) enum Bound {
    /// This number is allowed.
    At(f64),
    /// Only what lies beyond this number is.
    Beyond(f64),
    /// The larger side of the sensor, times this.
    Side(f64),
}

/// Which numbers are allowed. Shown as "above 0, up to 16".
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Range {
    pub(super) low: Bound,
    pub(super) high: Bound,
    pub(super) side: f64,
}

impl Range {
    fn end(&self, end: Bound) -> (f64, bool) {
        match end {
            Bound::At(value) => (value, true),
            Bound::Beyond(value) => (value, false),
            Bound::Side(factor) => (factor * self.side, true),
        }
    }

    /// Whether a number is allowed; one that is not finite is not.
    pub fn contains(&self, value: f64) -> bool {
        let ((low, with_low), (high, with_high)) = (self.end(self.low), self.end(self.high));
        (value > low || with_low && value == low) && (value < high || with_high && value == high)
    }

    /// The allowed number nearest to `value`; beside an end that is not allowed itself, one `step` inside.
    pub(super) fn nearest(&self, value: f64, step: f64) -> f64 {
        let ((low, with_low), (high, with_high)) = (self.end(self.low), self.end(self.high));
        let low = if with_low { low } else { low + step };
        let high = if with_high { high } else { high - step };
        value.min(high).max(low)
    }
}

impl fmt::Display for Range {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        let ((low, with_low), (high, with_high)) = (self.end(self.low), self.end(self.high));
        let above = if with_low { "" } else { "above " };
        let to = match (with_low, with_high) {
            (true, true) => " to ",
            (true, false) => " to below ",
            (false, true) => ", up to ",
            (false, false) => ", below ",
        };
        write!(f, "{above}{low}{to}{high}")
    }
}
