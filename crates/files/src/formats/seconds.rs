//! Times of frames in seconds, without the rounding noise of subtraction.

use taxel_core::parameter::number::to_decimals;

/// Rounds a number of seconds to the nanosecond; the result is finite.
pub(crate) fn to_nanoseconds(seconds: f64) -> f64 {
    to_decimals(finite(seconds), 9)
}

/// Returns the seconds from `start` to `time`, both finite, as exactly as these are: 2.3 s − 2.2 s is 0.1 s. The
/// result is finite.
pub(crate) fn since(start: f64, time: f64) -> f64 {
    let decimals = certain_decimals(start.abs().max(time.abs()));
    to_decimals(finite(time - start), decimals)
}

/// Returns the number of decimals, at most nine, that are certain in the difference of times up to this one: nine up
/// to 48 days, and six for times since 1970.
fn certain_decimals(time: f64) -> i32 {
    // Each time may be half of this away from what was measured.
    let step = time.next_up() - time;
    let mut decimals = 9;
    while decimals > 0 && 2.0 * step * 10_f64.powi(decimals) >= 1.0 {
        decimals -= 1;
    }
    decimals
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
        assert_eq!(since(4e9, 4e9 + 1e-6), 1e-6);
        // A machine that has run for three weeks, and for a year.
        assert_eq!(since(1.8e6, 1.8e6 + 2.345e-6), 2.345e-6);
        assert_eq!(since(3.1e7, 3.1e7 + 0.100_000_12), 0.100_000_12);
        assert_eq!(since(1e11, 1e11 + 0.1), 0.1);
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
