//! Times of frames in seconds: without the noise of their subtraction, and the usual step from one to the next.

use crate::parameter::number::to_decimals;

/// A longer time between two frames is a gap, unless most are about as long.
#[cfg(feature = "acquire")]
const GAP: f64 = 1.0;

/// Times up to here are exact to less than a nanosecond; those from 1970 on are to less than a microsecond.
const FINE: f64 = 1e6;

/// A number of seconds, to the nanosecond; finite.
pub(crate) fn to_nanoseconds(seconds: f64) -> f64 {
    to_decimals(finite(seconds), 9)
}

/// The seconds from `start` to `time`, both finite, as exactly as these are: 2.3 s − 2.2 s is 0.1 s. Finite.
pub(crate) fn since(start: f64, time: f64) -> f64 {
    let is_fine = start.abs().max(time.abs()) < FINE;
    to_decimals(finite(time - start), if is_fine { 9 } else { 6 })
}

/// The nearest finite number: a file may give times whose product or difference overflows.
fn finite(seconds: f64) -> f64 {
    seconds.clamp(f64::MIN, f64::MAX)
}

/// The usual time from a frame to the next, given the times between frames in any order: their mean without gaps, as where
/// a connection was lost. The median alone would be 0 where several frames come at once. None where there is no time
/// above 0.
#[cfg(feature = "acquire")]
pub(crate) fn usual_step(steps: &mut [f64]) -> Option<f64> {
    steps.sort_by(f64::total_cmp);
    let median = steps.get(steps.len() / 2)?;
    let longest = GAP.max(3.0 * median);
    let usual = || steps.iter().filter(|step| (0.0..=longest).contains(*step));
    #[expect(clippy::cast_precision_loss, reason = "a mean")]
    let mean = usual().sum::<f64>() / usual().count() as f64;
    Some(to_nanoseconds(mean)).filter(|&step| step > 0.0)
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

    #[cfg(feature = "acquire")]
    #[test]
    fn gaps_and_times_that_go_back_do_not_count() {
        assert_eq!(usual_step(&mut [0.1, 98.1, 0.1, -2.3, 0.1]), Some(0.1));
        // Three frames at once, each third of a second.
        let mut burst = [0.0, 0.0, 0.3].repeat(20);
        burst.push(5.0);
        assert_eq!(usual_step(&mut burst), Some(0.1));
        assert_eq!(
            usual_step(&mut [10.0, 12.0, 31.0]),
            Some(to_nanoseconds(53.0 / 3.0))
        );
        assert_eq!(usual_step(&mut []), None);
        assert_eq!(usual_step(&mut [0.0, 0.0]), None);
        assert_eq!(usual_step(&mut [f64::NAN]), None);
    }
}
