//! The threshold of the live page, as keys change it.

use taxel_core::frame::{FrameError, Rule};
use taxel_files::formats::value::{counted, fitting, measured};

use crate::tui::live::{nine_digits, round_up};

/// Formats how many frames have come for a tare, and how many it needs: `3 of 30 frames`.
pub(super) fn progress_text((taken, wanted): (u64, u64)) -> String {
    format!("{taken} of {}", counted(wanted, "frame"))
}

pub(super) fn text(rule: Rule, unit: &str) -> String {
    match rule {
        Rule::AtLeast(threshold) => format!("{}{unit}", measured(threshold, 7)),
        Rule::Percent(percent) => format!("{} % of max", fitting(percent, 5)),
        Rule::Hysteresis { low, high } => {
            format!("{} to {}{unit}", measured(low, 7), measured(high, 7))
        }
        Rule::Noise(deviations) => format!("{} × noise", fitting(deviations, 5)),
    }
}

/// Moves the threshold up or down by a step: a hundredth of the top of the range, in round numbers. In percent the
/// step is 5 %, in deviations of the noise it is 1. Without a threshold, it becomes half of the top of the range: above
/// the noise of most sensors, and below most touches.
pub(super) fn step(rule: Option<Rule>, direction: i8, top: f64) -> Result<Rule, FrameError> {
    let by = f64::from(direction);
    let step = round_up(top / 100.0) * by;
    match rule {
        None => Rule::at_least(nine_digits(top / 2.0)),
        Some(Rule::Percent(percent)) => Rule::percent(stepped(percent, 5.0 * by, (5.0, 100.0))),
        Some(Rule::Hysteresis { low, high }) => {
            Rule::hysteresis(nine_digits(low + step), nine_digits(high + step))
        }
        Some(Rule::Noise(deviations)) => Rule::noise(stepped(deviations, by, (1.0, 1000.0))),
        Some(Rule::AtLeast(threshold)) => Rule::at_least(nine_digits(threshold + step)),
    }
}

/// Returns a value after a step within bounds. A value already beyond a bound stays if the step would lead further
/// away: a step down never goes up, and a step up never down.
fn stepped(value: f64, step: f64, (least, most): (f64, f64)) -> f64 {
    let next = value + step;
    if step < 0.0 {
        next.max(least).min(value)
    } else {
        next.min(most).max(value)
    }
}

pub(super) fn other_unit(rule: Option<Rule>, largest: f64) -> Result<Rule, FrameError> {
    match rule {
        Some(Rule::Percent(percent)) => {
            Rule::at_least(nine_digits(Rule::percent_of(percent, largest)))
        }
        Some(Rule::AtLeast(threshold)) => {
            Rule::percent((100.0 * threshold / largest).round().clamp(1.0, 100.0))
        }
        _ => Rule::percent(50.0),
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_step_never_goes_the_other_way() {
        let percent = |value, direction| step(Some(Rule::Percent(value)), direction, 1.0);
        for (before, direction, after) in [
            (3.0, -1, 3.0),
            (3.0, 1, 8.0),
            (7.0, -1, 5.0),
            (98.0, 1, 100.0),
            (50.0, -1, 45.0),
            (100.0, 1, 100.0),
        ] {
            assert_eq!(percent(before, direction), Ok(Rule::Percent(after)));
        }
        let noise = |value, direction| step(Some(Rule::Noise(value)), direction, 1.0);
        assert_eq!(noise(0.5, -1), Ok(Rule::Noise(0.5)));
        assert_eq!(noise(0.5, 1), Ok(Rule::Noise(1.5)));
        assert_eq!(noise(2.0, -1), Ok(Rule::Noise(1.0)));
    }
}
