//! The units of time in recordings.

use std::ops::Range;

use crate::formats::seconds::to_nanoseconds;

/// The longest time from one frame to the next, in seconds: more than 30 years.
const LONGEST_STEP: f64 = 1e9;

/// A unit of time; smaller units come first.
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord)]
pub(in crate::formats::recording) enum TimeUnit {
    Nanoseconds,
    Microseconds,
    Milliseconds,
    Seconds,
    Minutes,
}

impl TimeUnit {
    /// Returns the name of the unit in messages.
    pub(in crate::formats::recording) fn name(self) -> &'static str {
        match self {
            Self::Nanoseconds => "nanoseconds",
            Self::Microseconds => "microseconds",
            Self::Milliseconds => "milliseconds",
            Self::Seconds => "seconds",
            Self::Minutes => "minutes",
        }
    }

    /// Returns the number of picoseconds in the unit.
    pub(super) fn picoseconds(self) -> u64 {
        match self {
            Self::Nanoseconds => 1_000,
            Self::Microseconds => 1_000_000,
            Self::Milliseconds => 1_000_000_000,
            Self::Seconds => 1_000_000_000_000,
            Self::Minutes => 60_000_000_000_000,
        }
    }

    /// Converts a number in this unit to seconds.
    pub(in crate::formats::recording) fn seconds(self, number: f64) -> f64 {
        // A quotient of whole numbers is rounded only once.
        match self {
            Self::Nanoseconds => number / 1e9,
            Self::Microseconds => number / 1e6,
            Self::Milliseconds => number / 1e3,
            Self::Seconds => number,
            Self::Minutes => number * 60.0,
        }
    }

    /// Converts the time from one frame to the next from this unit to seconds, rounded to the nanosecond. None unless
    /// that is above 0 and at most [`LONGEST_STEP`].
    pub(in crate::formats::recording) fn step_in_seconds(self, number: f64) -> Option<f64> {
        let seconds = to_nanoseconds(self.seconds(number));
        (seconds > 0.0 && seconds <= LONGEST_STEP).then_some(seconds)
    }

    /// Guesses the unit of a time without one: milliseconds or smaller if that makes it a date between 2000 and 2100,
    /// otherwise seconds. A machine's clock may count in any unit since its start; no number shows which.
    pub(in crate::formats::recording) fn by_size(number: f64) -> Self {
        const DATES: Range<f64> = 946_684_800.0..4_102_444_800.0;
        let smaller = [Self::Milliseconds, Self::Microseconds, Self::Nanoseconds];
        let mut dated = smaller.into_iter();
        let dated = dated.find(|unit| DATES.contains(&unit.seconds(number)));
        dated.unwrap_or(Self::Seconds)
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_step_is_rounded_before_it_is_checked() {
        for (number, unit, expected) in [
            (16.7, TimeUnit::Milliseconds, Some(0.0167)),
            (1e9, TimeUnit::Seconds, Some(1e9)),
            (1.0, TimeUnit::Nanoseconds, Some(1e-9)),
            (1e-10, TimeUnit::Milliseconds, None),
            (1e-10, TimeUnit::Seconds, None),
            (1e308, TimeUnit::Minutes, None),
            (0.0, TimeUnit::Seconds, None),
            (-0.1, TimeUnit::Seconds, None),
            (f64::NAN, TimeUnit::Seconds, None),
        ] {
            assert_eq!(unit.step_in_seconds(number), expected, "{number} {unit:?}");
        }
    }

    #[test]
    fn only_a_present_day_date_has_a_smaller_unit_than_seconds() {
        for (number, expected) in [
            (1_714_564_800.0, TimeUnit::Seconds),
            (1_714_564_800_123.0, TimeUnit::Milliseconds),
            (1_714_564_800_123_456.0, TimeUnit::Microseconds),
            (1_714_564_800_123_456_789.0, TimeUnit::Nanoseconds),
            // Running for five days: in nanoseconds and in microseconds.
            (4.3e14, TimeUnit::Seconds),
            (4.3e11, TimeUnit::Seconds),
            (5e12, TimeUnit::Seconds),
            (5e18, TimeUnit::Seconds),
            (-1_714_564_800_123.0, TimeUnit::Seconds),
            (f64::INFINITY, TimeUnit::Seconds),
        ] {
            assert_eq!(TimeUnit::by_size(number), expected, "{number}");
        }
    }
}
