//! Times of frames in seconds, without the rounding noise of subtraction.

use crate::parameter::number::to_decimals;

/// The limit up to which times are exact to less than a nanosecond. Times since 1970 are exact to less than a
/// microsecond.
const FINE: f64 = 1e6;

/// Rounds a number of seconds to the nanosecond; the result is finite.
pub(crate) fn to_nanoseconds(seconds: f64) -> f64 {
    to_decimals(finite(seconds), 9)
}

/// Returns the seconds from `start` to `time`, both finite, as exactly as these are: 2.3 s − 2.2 s is 0.1 s. The
/// result is finite.
pub(crate) fn since(start: f64, time: f64) -> f64 {
    let is_fine = start.abs().max(time.abs()) < FINE;
    to_decimals(finite(time - start), if is_fine { 9 } else { 6 })
}

/// Returns the nearest finite number: the times of a file may have a product or difference that overflows.
fn finite(seconds: f64) -> f64 {
    seconds.clamp(f64::MIN, f64::MAX)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_difference_has_no_noise() {
        assert_eq!(since(2.2, 2.3), 0.1);
        assert_eq!(since(100.0, 100.1), 0.1);
        assert_eq!(since(1.7e9, 1.7e9 + 0.1), 0.1);
        assert_eq!(since(1.0, 1.000_000_002), 2e-9);
        assert_eq!(since(0.3, 0.1), -0.2);
        assert_eq!(since(0.0, 1e301), 1e301);
    }
}
