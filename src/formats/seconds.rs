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

/// Returns the time of the frame with this label, in seconds since the first one, if frames are `step` seconds apart:
/// labels that are left out are gaps. `first` keeps the first label.
pub(crate) fn of_label(label: i64, first: &mut Option<i64>, step: Option<f64>) -> Option<f64> {
    #[expect(clippy::cast_precision_loss, reason = "fewer than 2^52 frames")]
    let steps = label.saturating_sub(*first.get_or_insert(label)) as f64;
    step.map(|step| to_nanoseconds(steps * step))
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

    #[test]
    fn a_label_that_is_left_out_is_a_gap() {
        let mut first = None;
        let times = [1, 3, 5].map(|label| of_label(label, &mut first, Some(0.02)));
        assert_eq!(times, [Some(0.0), Some(0.04), Some(0.08)]);
        assert_eq!(of_label(6, &mut first, None), None);
    }
}
