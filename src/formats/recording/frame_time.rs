//! Reads the times of frames in tables and arrays, as seconds since the first one.
//!
//! Nanoseconds since 1970 have more digits than a float, so numbers are subtracted as they are written: in whole
//! picoseconds. A number with an exponent, or with more than 20 digits, is taken as the nearest float.

use std::ops::Range;

use crate::formats::recording::moment::{self, Midnights};
use crate::formats::recording::separator::Separator;
use crate::formats::recording::text_row::Field;
use crate::formats::seconds::{since, to_nanoseconds};

/// A unit of time; smaller units come first.
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord)]
pub(crate) enum TimeUnit {
    Nanoseconds,
    Microseconds,
    Milliseconds,
    Seconds,
    Minutes,
}

impl TimeUnit {
    /// Returns the name of the unit in messages.
    pub(crate) fn name(self) -> &'static str {
        match self {
            Self::Nanoseconds => "nanoseconds",
            Self::Microseconds => "microseconds",
            Self::Milliseconds => "milliseconds",
            Self::Seconds => "seconds",
            Self::Minutes => "minutes",
        }
    }

    /// Returns the number of picoseconds in the unit.
    fn picoseconds(self) -> u64 {
        match self {
            Self::Nanoseconds => 1_000,
            Self::Microseconds => 1_000_000,
            Self::Milliseconds => 1_000_000_000,
            Self::Seconds => 1_000_000_000_000,
            Self::Minutes => 60_000_000_000_000,
        }
    }

    /// Converts a number in this unit to seconds.
    pub(crate) fn seconds(self, number: f64) -> f64 {
        // A quotient of whole numbers is rounded only once.
        match self {
            Self::Nanoseconds => number / 1e9,
            Self::Microseconds => number / 1e6,
            Self::Milliseconds => number / 1e3,
            Self::Seconds => number,
            Self::Minutes => number * 60.0,
        }
    }

    /// Guesses the unit of a time without one: milliseconds or smaller if that makes it a date between 2000 and 2100,
    /// otherwise seconds. A machine's clock may count in any unit since its start; no number shows which.
    pub(crate) fn by_size(number: f64) -> Self {
        const DATES: Range<f64> = 946_684_800.0..4_102_444_800.0;
        let smaller = [Self::Milliseconds, Self::Microseconds, Self::Nanoseconds];
        let mut dated = smaller.into_iter();
        let dated = dated.find(|unit| DATES.contains(&unit.seconds(number)));
        dated.unwrap_or(Self::Seconds)
    }
}

/// The fields of a line that hold its time.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) struct TimeFields {
    /// The field with the time, or with its whole seconds.
    pub(super) field: usize,
    /// The unit; None if nothing names it.
    pub(super) unit: Option<TimeUnit>,
    /// The field with the rest of the second, and its unit.
    pub(super) rest: Option<(usize, TimeUnit)>,
}

impl TimeFields {
    /// Makes the fields of a time in a single field.
    pub(super) fn new(field: usize, unit: Option<TimeUnit>) -> Self {
        Self {
            field,
            unit,
            rest: None,
        }
    }
}

/// A time, exactly as it is written.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) enum Time {
    Picoseconds(i128),
    Seconds(f64),
}

impl Time {
    /// Reads the time in a field whose value is `number`.
    pub(super) fn read(field: &[u8], number: f64, unit: TimeUnit) -> Self {
        match picoseconds(field, unit) {
            Some(exact) => Self::Picoseconds(exact),
            None => Self::Seconds(unit.seconds(number)),
        }
    }

    #[expect(clippy::cast_precision_loss, reason = "the nearest float")]
    fn seconds(self) -> f64 {
        match self {
            Self::Picoseconds(exact) => exact as f64 / 1e12,
            Self::Seconds(seconds) => seconds,
        }
    }

    pub(super) fn plus(self, other: Self) -> Self {
        match (self, other) {
            (Self::Picoseconds(one), Self::Picoseconds(other)) => Self::Picoseconds(one + other),
            _ => Self::Seconds(self.seconds() + other.seconds()),
        }
    }

    /// Returns the seconds from `start` to this time, to the nanosecond.
    pub(super) fn since(self, start: Self) -> f64 {
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

/// The text of a frame's time.
#[derive(Clone, Copy, Debug, Default)]
pub(super) struct TimeText<'a> {
    /// The time, or its whole seconds.
    pub(super) time: Option<&'a [u8]>,
    /// The rest of the second.
    pub(super) rest: Option<&'a [u8]>,
}

/// A clock that reads the times of a table.
#[derive(Debug)]
pub(super) struct TableClock {
    /// The separator between fields, which decides about the decimal sign.
    separator: Separator,
    /// The unit; None if it is not named, until the size of the first time decides it.
    unit: Option<TimeUnit>,
    /// The unit of the rest of a second.
    rest: Option<TimeUnit>,
    /// The first time.
    start: Option<Time>,
    /// The count of midnights, for clocks without a date.
    midnights: Midnights,
}

impl TableClock {
    /// Makes the clock of a table with these time fields.
    pub(super) fn new(separator: Separator, fields: Option<TimeFields>) -> Self {
        Self {
            separator,
            unit: fields.and_then(|fields| fields.unit),
            rest: fields.and_then(|fields| fields.rest).map(|(_, unit)| unit),
            start: None,
            midnights: Midnights::default(),
        }
    }

    /// Returns the unit of times; None if no unit is named and there was no number yet.
    pub(super) fn unit(&self) -> Option<TimeUnit> {
        self.unit
    }

    /// Returns the seconds from the first time to this one; None if there is no time, or a text that cannot be read.
    pub(super) fn seconds(&mut self, text: TimeText<'_>) -> Option<f64> {
        let field = text.time?;
        match self.separator.value(field) {
            Field::Value(number) => {
                let unit = *self.unit.get_or_insert_with(|| TimeUnit::by_size(number));
                let time = Time::read(field, number, unit);
                let time = match (self.rest, text.rest) {
                    (Some(unit), Some(rest)) => match self.separator.value(rest) {
                        Field::Value(number) => time.plus(Time::read(rest, number, unit)),
                        _ => return None,
                    },
                    _ => time,
                };
                Some(self.since_first(time))
            }
            Field::Wrong => moment::read(field).map(|moment| self.moment(moment)),
            Field::NoCell => None,
        }
    }

    /// Returns the seconds from the first time to a timestamp.
    pub(super) fn moment(&mut self, moment: moment::Moment) -> f64 {
        let seconds = self.midnights.seconds(moment);
        self.since_first(Time::Seconds(seconds))
    }

    fn since_first(&mut self, time: Time) -> f64 {
        time.since(*self.start.get_or_insert(time))
    }
}

#[cfg(test)]
mod tests {
    use super::*;

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

    #[test]
    fn times_are_subtracted_as_they_are_written() {
        let step = |unit, fields: [&[u8]; 2]| {
            let fields_of_line = Some(TimeFields::new(0, unit));
            let mut clock = TableClock::new(Separator::Byte(b';'), fields_of_line);
            let seconds = fields.map(|time| {
                let text = TimeText {
                    time: Some(time),
                    rest: None,
                };
                clock.seconds(text)
            });
            assert_eq!(seconds[0], Some(0.0));
            seconds[1]
        };
        let nanoseconds = Some(TimeUnit::Nanoseconds);
        for (unit, fields, expected) in [
            (
                nanoseconds,
                [&b"1714564800123456789"[..], b"1714564800124456790"],
                0.001_000_001,
            ),
            (
                None,
                [b"1714564800123456789", b"1714564800124456790"],
                0.001_000_001,
            ),
            (None, [b"1714564800123456", b"1714564800124456"], 0.001),
            (None, [b"1714564800123", b"1714564800124"], 0.001),
            (
                None,
                [b"1714564800.123456789", b"1714564800,124456790"],
                0.001_000_001,
            ),
            (None, [b"12345", b"12395"], 50.0),
            (None, [b"2.2", b"2.3"], 0.1),
            (None, [b"0.30000000000000004", b"0.1"], -0.2),
            (Some(TimeUnit::Milliseconds), [b"-0.5", b"+.5"], 0.001),
            (Some(TimeUnit::Minutes), [b"0.1", b"0.15"], 3.0),
            (None, [b"1e3", b"1000.5"], 0.5),
            (Some(TimeUnit::Seconds), [b"1e300", b"0"], -1e300),
            (
                None,
                [b"0", b"123456789012345678901"],
                123_456_789_012_345_680_000.0,
            ),
        ] {
            assert_eq!(step(unit, fields), Some(expected), "{fields:?}");
        }
    }

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
