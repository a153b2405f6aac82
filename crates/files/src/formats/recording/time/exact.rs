//! Times as exact as they are written.
//!
//! Nanoseconds since 1970 have more digits than a float, so numbers are subtracted as they are written: in whole
//! picoseconds. A number with an exponent, or with more than 20 digits, is taken as the nearest float.

use crate::formats::recording::time::unit::TimeUnit;
use crate::formats::seconds::{since, to_nanoseconds};

/// A time, exactly as it is written.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(in crate::formats) enum Time {
    Picoseconds(i128),
    Seconds(f64),
}

impl Time {
    /// Reads the time in a field whose value is `number`.
    pub(in crate::formats::recording) fn read(field: &[u8], number: f64, unit: TimeUnit) -> Self {
        match picoseconds(field, unit) {
            Some(exact) => Self::Picoseconds(exact),
            None => Self::Seconds(unit.seconds(number)),
        }
    }

    /// Returns the time of a whole number.
    pub(in crate::formats::recording) fn of_whole(whole: i128, unit: TimeUnit) -> Self {
        Self::Picoseconds(whole * i128::from(unit.picoseconds()))
    }

    #[expect(clippy::cast_precision_loss, reason = "the nearest float")]
    fn seconds(self) -> f64 {
        match self {
            Self::Picoseconds(exact) => exact as f64 / 1e12,
            Self::Seconds(seconds) => seconds,
        }
    }

    pub(in crate::formats::recording) fn plus(self, other: Self) -> Self {
        match (self, other) {
            (Self::Picoseconds(one), Self::Picoseconds(other)) => Self::Picoseconds(one + other),
            _ => Self::Seconds(self.seconds() + other.seconds()),
        }
    }

    /// Returns the seconds from `start` to this time, to the nanosecond.
    pub(in crate::formats::recording) fn since(self, start: Self) -> f64 {
        let seconds = match (start, self) {
            (Self::Picoseconds(start), Self::Picoseconds(own)) => {
                Self::Picoseconds(own - start).seconds()
            }
            _ => since(start.seconds(), self.seconds()),
        };
        to_nanoseconds(seconds)
    }
}

/// Returns the picoseconds of a decimal number of up to 20 digits without an exponent, rounded to whole ones.
fn picoseconds(field: &[u8], unit: TimeUnit) -> Option<i128> {
    const MOST_DIGITS: u32 = 20;
    let (negative, digits) = match field {
        [b'-', digits @ ..] => (true, digits),
        [b'+', digits @ ..] => (false, digits),
        _ => (false, field),
    };
    let (mut number, mut count, mut decimals, mut point) = (0_i128, 0_u32, 0_u32, false);
    for &byte in digits {
        match byte {
            b'0'..=b'9' => {
                number = number * 10 + i128::from(byte - b'0');
                count += 1;
                decimals += u32::from(point);
            }
            b'.' | b',' if !point => point = true,
            _ => return None,
        }
        if count > MOST_DIGITS {
            return None;
        }
    }
    if count == 0 {
        return None;
    }
    let parts = 10_i128.pow(decimals);
    let number = (number * i128::from(unit.picoseconds()) + parts / 2) / parts;
    Some(if negative { -number } else { number })
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn fractions_of_a_picosecond_are_rounded() {
        let seconds = |text: &str| picoseconds(text.as_bytes(), TimeUnit::Seconds);
        assert_eq!(seconds("1.0000000000005"), Some(1_000_000_000_001));
        assert_eq!(seconds("-1,0000000000005"), Some(-1_000_000_000_001));
        assert_eq!(seconds("1.0000000000004999"), Some(1_000_000_000_000));
        let nanoseconds = picoseconds(b"0.0005", TimeUnit::Nanoseconds);
        assert_eq!(nanoseconds, Some(1));
    }
}
