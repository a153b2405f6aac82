//! Exact ranges of decimals, `start:end:step` with the end included: the values of one axis of a sweep.
//!
//! The numbers are integers scaled by a power of ten. So `5:5.99:0.01` has exactly one hundred values, and no error
//! accumulates: value `i` is the `f64` nearest to the exact decimal `start + i·step`. If the steps do not reach the end
//! exactly, the last value is the largest one below the end. A single number is a range of one value. Units are those
//! of the parameter. The form is a convention of this project.

use std::fmt;
use std::str::FromStr;

use crate::index::narrow;
use crate::parameter::number::{self, grouped};
use crate::quote::shortened;

/// The largest number of values of a range.
pub const MAX_VALUES: u64 = 1_000_000;

/// The largest number of decimals of a number. In units of the last of them, [`MAX_UNITS`] is just below 1000.
const MAX_PLACES: u32 = 12;

/// One, in units of the last decimal that a number can have.
pub(crate) const ONE: i128 = 10_i128.pow(MAX_PLACES);

/// The largest number in units of the last decimal. Every decimal of 15 digits has a distinct `f64`, which is written
/// as the same decimal again.
const MAX_UNITS: f64 = 999_999_999_999_999.0;

/// Decimals from a start to an end in equal steps; never empty. As text, `start:end:step` with the end included, or a
/// single number: `5:5.99:0.01` has exactly one hundred values.
///
/// The numbers are exact decimals, and value `i` is the `f64` nearest to `start + i·step`. If the steps do not reach
/// the end exactly, the last value is the largest one below the end. Units are those of the parameter.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash)]
pub struct DecimalRange {
    start: i64,
    step: i64,
    places: u32,
    count: u64,
}

impl DecimalRange {
    /// Creates the range of a single whole number.
    pub const fn whole(value: i32) -> Self {
        Self::from_units(value as i64, 1, 0, 1)
    }

    /// Creates the range of `count` values from `start` on, at distances of `step`, in units of the last of `places`
    /// decimals. `count` and `step` are above 0.
    ///
    /// The fields are in units of as few decimals as the values need, and the step of a single value is 1. So equal
    /// ranges have equal fields, however they were written.
    pub(crate) const fn from_units(mut start: i64, step: i64, mut places: u32, count: u64) -> Self {
        let mut step = if count == 1 { 10_i64.pow(places) } else { step };
        while places > 0 && start % 10 == 0 && step % 10 == 0 {
            (start, step, places) = (start / 10, step / 10, places - 1);
        }
        Self {
            start,
            step,
            places,
            count,
        }
    }

    /// Returns the number of values, 1 to [`MAX_VALUES`].
    pub fn count(&self) -> u64 {
        self.count
    }

    /// Returns the `f64` nearest to value `index`, counted from 0; beyond the last value, as if the range went on, up
    /// to the largest `i64` in units of the last decimal.
    pub fn value(&self, index: u64) -> f64 {
        let units = i64::try_from(index)
            .ok()
            .and_then(|index| index.checked_mul(self.step))
            .and_then(|way| way.checked_add(self.start));
        scaled(units.unwrap_or(i64::MAX), self.places)
    }

    /// Returns the last value.
    pub fn last(&self) -> f64 {
        self.value(self.count - 1)
    }

    /// Returns the distance from one value to the next.
    pub fn step(&self) -> f64 {
        scaled(self.step, self.places)
    }

    /// Creates the range of a single number, rounded to some decimals; None if the number has too many digits to be
    /// exact, or is not finite.
    pub(crate) fn rounded(value: f64, places: u32) -> Option<Self> {
        units(value, places).map(|start| Self::from_units(start, 1, places, 1))
    }

    /// Returns the values with these indices as a range of their own; None if `indices` is empty or leaves the range.
    pub fn part(&self, indices: std::ops::Range<u64>) -> Option<Self> {
        if indices.is_empty() || indices.end > self.count {
            return None;
        }
        let way = i64::try_from(indices.start).ok()?.checked_mul(self.step)?;
        let (start, count) = (self.start + way, indices.end - indices.start);
        Some(Self::from_units(start, self.step, self.places, count))
    }

    /// Returns every `stride`-th value, from the first on; None if the stride is 0 or too large for a step.
    pub(crate) fn every(&self, stride: u64) -> Option<Self> {
        let step = self.step.checked_mul(i64::try_from(stride).ok()?)?;
        (stride > 0)
            .then(|| Self::from_units(self.start, step, self.places, self.count.div_ceil(stride)))
    }

    /// Returns a finer range that has all these values: divides the steps evenly so that they are at most `most`, and
    /// goes on to just before the value after the last. A single value stays alone. None if a number gets too long.
    pub(crate) fn divided(&self, most: f64) -> Option<Self> {
        if self.count == 1 || self.step() <= most {
            return Some(*self);
        }
        // Most steps can be divided with two more decimals.
        let places = Some(self.places + 2).filter(|&places| places <= MAX_PLACES)?;
        let (start, step) = (self.start.checked_mul(100)?, self.step.checked_mul(100)?);
        let is_fine = |parts: &i64| step % parts == 0 && scaled(step / parts, places) <= most;
        let parts = (1..=step).find(is_fine)?;
        let count = self.count.checked_mul(parts.unsigned_abs())?;
        Some(Self::from_units(start, step / parts, places, count))
    }

    /// Iterates over all values in order.
    pub fn values(&self) -> impl DoubleEndedIterator<Item = f64> + ExactSizeIterator {
        (0..narrow(self.count)).map(|index| self.value(index.into()))
    }

    /// Returns the first value and the step, exactly, in units of 1 / [`ONE`]. Symmetries are decided with them.
    pub(crate) fn exact(&self) -> [i128; 2] {
        let unit = ONE / 10_i128.pow(self.places);
        [self.start, self.step].map(|units| i128::from(units) * unit)
    }
}

/// Returns `units · 10^-places`, correctly rounded: both numbers of the quotient are exact.
#[expect(clippy::cast_precision_loss, reason = "at most 2^53")]
fn scaled(units: i64, places: u32) -> f64 {
    units as f64 / 10_u64.pow(places) as f64
}

/// Returns a number in units of `10^-places`, rounded; None if it has more than 15 digits.
fn units(value: f64, places: u32) -> Option<i64> {
    // The error of the product is below a quarter, so a decimal of 15 digits becomes its own units.
    let units = libm::round(value * 10_f64.powi(places.cast_signed()));
    #[expect(clippy::cast_possible_truncation, reason = "a whole number below 2^53")]
    (units.abs() <= MAX_UNITS).then_some(units as i64)
}

/// Returns the number of decimals of the shortest decimal that reads back as a number.
fn places(value: f64) -> u32 {
    // An `f64` is never displayed with an exponent.
    let text = value.to_string();
    narrow(
        text.split_once('.')
            .map_or(0, |(_, fraction)| fraction.len()),
    )
}

impl FromStr for DecimalRange {
    type Err = RangeError;

    fn from_str(whole: &str) -> Result<Self, RangeError> {
        let parts: Vec<&str> = whole.split(':').map(str::trim).collect();
        let texts = match parts[..] {
            [single] => [single, single, "1"],
            [start, end, step] => [start, end, step],
            _ => return Err(RangeError::Form(shortened(whole.trim()))),
        };
        let mut numbers = [0.0; 3];
        for (number, text) in numbers.iter_mut().zip(texts) {
            *number = number::read(text).ok_or_else(|| RangeError::Number(shortened(text)))?;
        }
        let most = numbers.map(places).into_iter().fold(0, u32::max);
        let exact = |number: f64| units(number, most).filter(|_| most <= MAX_PLACES);
        let [Some(first), Some(last), Some(by)] = numbers.map(exact) else {
            // The number with the most decimals decides how many digits each of them needs.
            return Err(RangeError::Digits(shortened(whole.trim())));
        };
        let [start, end, step] = texts.map(shortened);
        if by <= 0 {
            return Err(RangeError::Step(step));
        }
        if last < first {
            return Err(RangeError::Backwards { start, end });
        }
        let count = (last - first).unsigned_abs() / by.unsigned_abs() + 1;
        if count > MAX_VALUES {
            return Err(RangeError::Many(count));
        }
        Ok(Self::from_units(first, by, most, count))
    }
}

impl fmt::Display for DecimalRange {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        // The shortest decimal that reads back as the nearest `f64` is the exact decimal itself.
        write!(f, "{}", self.value(0))?;
        if self.count > 1 {
            write!(f, ":{}:{}", self.last(), self.step())?;
        }
        Ok(())
    }
}

/// Returns the message about text that is not a plain decimal.
fn not_a_number(text: &str) -> String {
    match number::with_point(text) {
        Some(number) => format!("\"{text}\" is not a number; write {number}"),
        None if text.trim().is_empty() => "missing, expected a number such as 0.25".to_owned(),
        None => format!("\"{text}\" is not a decimal number, such as 0.25"),
    }
}

/// The error for numbers or text that are not a range.
#[derive(Clone, Debug, PartialEq, Eq, thiserror::Error)]
pub enum RangeError {
    /// The text is neither one number nor three.
    #[error("\"{0}\" is not a range, expected a number or start:end:step")]
    Form(String),
    /// A part of the text is not a plain decimal.
    #[error("{}", not_a_number(.0))]
    Number(String),
    /// A number has more digits than are exact.
    #[error(
        "\"{0}\" has too many digits: at most {MAX_PLACES} after the point, and 15 in all once each number has as many \
         decimals as the longest"
    )]
    Digits(String),
    /// The step is not above 0.
    #[error("step {0} is not above 0")]
    Step(String),
    /// The end lies before the start.
    #[error("the end {end} is below the start {start}")]
    Backwards {
        /// The start as given, shortened.
        start: String,
        /// The end as given, shortened.
        end: String,
    },
    /// There are too many values.
    #[error("a range of {} values; at most {} are allowed", grouped(*.0), grouped(MAX_VALUES))]
    Many(u64),
}

impl RangeError {
    /// Returns the part of the message that says what was expected, for a place that shows the text itself.
    pub fn expected(&self) -> String {
        match self {
            Self::Form(_) => "expected a number or start:end:step".to_owned(),
            Self::Number(_) => "not a number".to_owned(),
            Self::Digits(_) => format!("at most 15 digits, {MAX_PLACES} decimals"),
            Self::Step(_) => "expected a step above 0".to_owned(),
            Self::Backwards { start, .. } => format!("expected an end of {start} or more"),
            Self::Many(count) => {
                let (count, most) = (grouped(*count), grouped(MAX_VALUES));
                format!("{count} values, at most {most}")
            }
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_finer_range_goes_on_to_just_before_the_next_value() {
        for (range, most, expected) in [
            ("7.6:8.4:0.2", 0.05, "7.6:8.55:0.05"),
            ("0:357:3", 1.0, "0:359:1"),
            ("0:0.75:0.25", 0.05, "0:0.95:0.05"),
            ("0:0.9:0.3", 0.04, "0:1.17:0.03"),
            ("0:359:1", 1.0, "0:359:1"),
            ("4.5", 0.05, "4.5"),
        ] {
            let range: DecimalRange = range.parse().expect("a range");
            let finer = range.divided(most).expect("few digits");
            assert_eq!(finer.to_string(), expected, "{range}");
        }
    }

    #[test]
    fn a_rounded_number_equals_the_decimal_that_it_is_written_as() {
        for (value, expected) in [
            (1.0, "1"),
            (0.1 + 0.2, "0.3"),
            (2.0 / 3.0, "0.666666667"),
            (-1e-12, "0"),
            (64.0, "64"),
        ] {
            assert_eq!(DecimalRange::rounded(value, 9), expected.parse().ok());
        }
        for odd in [f64::NAN, f64::INFINITY, 1e6] {
            assert_eq!(DecimalRange::rounded(odd, 9), None, "{odd}");
        }
    }

    #[test]
    fn a_range_has_the_nearest_floats_of_its_decimals() -> Result<(), Box<dyn std::error::Error>> {
        let range: DecimalRange = "5:5.99:0.01".parse()?;
        assert_eq!(
            (range.count(), range.value(0), range.value(37), range.last()),
            (100, 5.0, 5.37, 5.99)
        );
        assert_eq!(range.to_string(), "5:5.99:0.01");
        assert_eq!(
            "1:2:0"
                .parse::<DecimalRange>()
                .expect_err("refused")
                .to_string(),
            "step 0 is not above 0"
        );
        for odd in ["NaN", "0:1:inf", "0:1:0.30000000000000004", "2:1:0.5"] {
            assert!(odd.parse::<DecimalRange>().is_err(), "{odd}");
        }
        assert_eq!(
            range.part(10..20).map(|part| part.to_string()).as_deref(),
            Some("5.1:5.19:0.01")
        );
        assert_eq!(range.part(90..101), None);
        let values = "0:0.3:0.1".parse::<DecimalRange>()?;
        assert_eq!(values.values().len(), 4);
        assert!(values.values().rev().eq([0.3, 0.2, 0.1, 0.0]));
        Ok(())
    }
}
