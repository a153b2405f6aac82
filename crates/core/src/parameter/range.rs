//! Ranges of numbers. A bound may or may not belong to the range, and may grow with the sensor.

use std::fmt;

#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) enum Bound {
    At(f64),
    /// Only numbers beyond the bound are allowed.
    Beyond(f64),
    /// The bound is this factor times the larger side of the sensor, and is allowed.
    Side(f64),
}

/// The numbers that a parameter allows. Written as "above 0, up to 16".
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Range {
    low: Bound,
    high: Bound,
    side: f64,
}

impl Range {
    pub(super) fn new(low: Bound, high: Bound, side: u8) -> Self {
        let side = f64::from(side);
        Self { low, high, side }
    }

    /// Returns the number of a bound, and whether that number itself is allowed.
    fn bound(&self, bound: Bound) -> (f64, bool) {
        match bound {
            Bound::At(value) => (value, true),
            Bound::Beyond(value) => (value, false),
            Bound::Side(factor) => (factor * self.side, true),
        }
    }

    /// Returns true if a number is allowed. NaN and the infinities never are.
    pub fn contains(&self, value: f64) -> bool {
        let ((low, with_low), (high, with_high)) = (self.bound(self.low), self.bound(self.high));
        (value > low || with_low && value == low) && (value < high || with_high && value == high)
    }

    /// Returns the message that names the bound that excludes a number: "is below -16", "is not above 0". The number
    /// must not be in the range.
    pub(super) fn missed_by(&self, value: f64) -> String {
        let ((low, with_low), (high, with_high)) = (self.bound(self.low), self.bound(self.high));
        if value.is_nan() {
            "is not a number".to_owned()
        } else if with_low && value < low {
            format!("is below {low}")
        } else if !with_low && value <= low {
            format!("is not above {low}")
        } else if with_high {
            format!("is above {high}")
        } else {
            format!("is not below {high}")
        }
    }

    pub(crate) fn nearest(&self, value: f64, step: f64) -> f64 {
        let ((low, with_low), (high, with_high)) = (self.bound(self.low), self.bound(self.high));
        let low = if with_low { low } else { low + step };
        let high = if with_high { high } else { high - step };
        value.min(high).max(low)
    }
}

impl fmt::Display for Range {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        let ((low, with_low), (high, with_high)) = (self.bound(self.low), self.bound(self.high));
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
