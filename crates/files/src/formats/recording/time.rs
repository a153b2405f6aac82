//! Reads the times of frames.
//!
//! Nanoseconds since 1970 have more digits than a float, so numbers are subtracted as they are written: in whole
//! picoseconds. A number with an exponent, or with more than 20 digits, is taken as the nearest float.
//!
//! Timestamps are an ISO 8601 date and a time of day, or a time of day alone:
//! ```text
//! 2024-05-01T12:00:00.125Z      2024/05/01 12:00:00+02:00     12:00:00.125
//! ```
//! Dates that begin with the day or the month are not read, because 01.02. and 02/01 may be the same day.

use std::ops::RangeInclusive;

use crate::formats::recording::text;
use crate::formats::seconds::{since, to_nanoseconds};

/// The longest time from one frame to the next, in seconds: more than 30 years.
const LONGEST_STEP: f64 = 1e9;

/// Rounds the seconds from one frame to the next to the nanosecond. None unless the result is above 0 and at most
/// [`LONGEST_STEP`].
pub(super) fn step(seconds: f64) -> Option<f64> {
    let seconds = to_nanoseconds(seconds);
    (seconds > 0.0 && seconds <= LONGEST_STEP).then_some(seconds)
}

/// A unit of time; its number is how many of it a second has.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum TimeUnit {
    /// ns
    Nanoseconds = 1_000_000_000,
    /// us
    Microseconds = 1_000_000,
    /// ms
    Milliseconds = 1_000,
    /// s
    Seconds = 1,
}

impl TimeUnit {
    /// Returns the unit of this name: s, ms, us or ns.
    pub(super) fn named(name: &str) -> Option<Self> {
        match name {
            "s" | "sec" | "seconds" => Some(Self::Seconds),
            "ms" | "msec" | "millis" => Some(Self::Milliseconds),
            "us" | "usec" | "micros" | "\u{b5}s" | "\u{3bc}s" => Some(Self::Microseconds),
            "ns" | "nsec" | "nanos" => Some(Self::Nanoseconds),
            _ => None,
        }
    }

    pub(super) fn name(self) -> &'static str {
        match self {
            Self::Nanoseconds => "nanoseconds",
            Self::Microseconds => "microseconds",
            Self::Milliseconds => "milliseconds",
            Self::Seconds => "seconds",
        }
    }

    fn picoseconds(self) -> i128 {
        1_000_000_000_000 / i128::from(self as u32)
    }

    /// Converts a number in this unit to seconds.
    pub(super) fn seconds(self, number: f64) -> f64 {
        // A quotient of whole numbers is rounded only once.
        number / f64::from(self as u32)
    }
}

/// Reads the name of a column of times: `time`, `t_ms`, `Time (ms)`, `timestamp`. Returns its unit, if it has one; None
/// for any other name. ROS writes `%time`.
#[expect(
    clippy::option_option,
    reason = "a time without a unit is not the same as no time"
)]
pub(super) fn time_name(name: &str) -> Option<Option<TimeUnit>> {
    const NAMES: [&str; 7] = [
        "time",
        "t",
        "timestamp",
        "timestamps",
        "stamp",
        "date",
        "datetime",
    ];
    let name = name.trim().trim_start_matches('%').to_lowercase();
    let end = name.find(|character: char| !character.is_alphabetic());
    let (word, rest) = name.split_at(end.unwrap_or(name.len()));
    let unit = rest.trim_matches(|character: char| " _-.()[]/".contains(character));
    if !NAMES.contains(&word) {
        return None;
    }
    if unit.is_empty() {
        return Some(None);
    }
    TimeUnit::named(unit).map(Some)
}

#[derive(Clone, Copy, Debug, PartialEq)]
pub(crate) enum Time {
    Picoseconds(i128),
    Seconds(f64),
}

impl Time {
    pub(super) fn of_whole(whole: i128, unit: TimeUnit) -> Self {
        Self::Picoseconds(whole * unit.picoseconds())
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
    let negative = field.starts_with(b"-");
    let digits = field.strip_prefix(b"+").unwrap_or(field);
    let digits = digits.strip_prefix(b"-").unwrap_or(digits);
    let (mut whole, mut count, mut parts) = (0_i128, 0, None::<i128>);
    for &byte in digits {
        match byte {
            b'0'..=b'9' if count < 20 => {
                whole = whole * 10 + i128::from(byte - b'0');
                count += 1;
                parts = parts.map(|parts| parts * 10);
            }
            b'.' | b',' if parts.is_none() => parts = Some(1),
            _ => return None,
        }
    }
    let parts = parts.unwrap_or(1);
    let number = (whole * unit.picoseconds() + parts / 2) / parts;
    (count > 0).then_some(if negative { -number } else { number })
}

#[derive(Clone, Copy, Debug, PartialEq)]
pub(crate) struct Moment {
    /// The seconds since 1970, or since midnight if there is no date.
    pub(super) seconds: f64,
    /// Whether the timestamp has a date; otherwise it starts again at midnight.
    pub(super) is_dated: bool,
}

/// Reads a timestamp; None for anything else. Second 60, a leap second, counts as the first second of the next
/// minute.
pub(crate) fn read_moment(field: &[u8]) -> Option<Moment> {
    let text = str::from_utf8(field).ok()?.trim();
    let (day, clock) = match text.split_once(['T', 't', ' ']) {
        Some((date, clock)) => (Some(iso_day(date)?), clock.trim_start()),
        None if !text.contains(':') => (Some(iso_day(text)?), "00:00:00"),
        None => (None, text),
    };
    let (clock, offset) = match clock.rfind(['+', '-']) {
        Some(sign) => (&clock[..sign], offset(&clock[sign..])?),
        None => (clock.trim_end_matches(['Z', 'z']), 0),
    };
    let (hours, minutes, seconds) = clock_parts(clock.trim_end())?;
    let minutes = f64::from(day.unwrap_or(0)) * 1440.0 + f64::from(60 * hours + minutes - offset);
    Some(Moment {
        seconds: 60.0 * minutes + seconds,
        is_dated: day.is_some(),
    })
}

/// Reads hours, minutes and seconds: `12:00:00.125`.
fn clock_parts(clock: &str) -> Option<(i32, i32, f64)> {
    let mut parts = clock.splitn(3, ':');
    let hours = two_digits(parts.next()?, 23)?;
    let minutes = two_digits(parts.next()?, 59)?;
    let seconds = parts.next()?;
    let is_number = seconds.starts_with(|first: char| first.is_ascii_digit());
    let seconds = text::read_value(seconds.as_bytes())?;
    (is_number && seconds < 61.0).then_some((hours, minutes, seconds))
}

/// Returns the number of a day of the Gregorian calendar since 1970; earlier days are negative. The month counts from
/// 1.
pub(super) fn day(year: i32, month: i32, day: i32) -> i32 {
    // If years begin in March, the leap day is their last day.
    let (year, month) = if month < 3 {
        (year - 1, month + 9)
    } else {
        (year, month - 3)
    };
    let days = year * 365 + year / 4 - year / 100 + year / 400 + (month * 153 + 2) / 5 + day;
    days - 719_469
}

/// Returns the day of `2024-05-01` or `2024/05/01`.
fn iso_day(date: &str) -> Option<i32> {
    let mut parts = date.splitn(3, ['-', '/']);
    let year = whole(parts.next()?, 4..=4, 9999)?;
    let month = two_digits(parts.next()?, 12).filter(|&month| month > 0)?;
    let of_month = two_digits(parts.next()?, 31).filter(|&day| day > 0)?;
    // Day 0 of a month is the last day of the month before.
    let last = match month {
        12 => 31,
        _ => day(year, month + 1, 0) - day(year, month, 0),
    };
    (of_month <= last).then(|| day(year, month, of_month))
}

/// Reads the offset from UTC in minutes: `+02:00`, `-0330`, `+02`.
fn offset(text: &str) -> Option<i32> {
    let (sign, digits) = text.split_at_checked(1)?;
    let (hours, minutes) = match digits.split_at_checked(2)? {
        (hours, "") => (hours, "00"),
        (hours, minutes) => (hours, minutes.strip_prefix(':').unwrap_or(minutes)),
    };
    let minutes = 60 * two_digits(hours, 23)? + two_digits(minutes, 59)?;
    Some(if sign == "-" { -minutes } else { minutes })
}

/// Reads a number of one or two digits that is not above `most`.
fn two_digits(text: &str, most: i32) -> Option<i32> {
    whole(text, 1..=2, most)
}

fn whole(text: &str, digits: RangeInclusive<usize>, most: i32) -> Option<i32> {
    let is_number =
        digits.contains(&text.len()) && text.bytes().all(|digit| digit.is_ascii_digit());
    let number = is_number.then(|| text.parse().ok()).flatten()?;
    (number <= most).then_some(number)
}

/// The clock of a recording or a stream. After a gap in a stream it passes to the next decoder, so that times
/// continue from the same frame.
#[derive(Clone, Copy, Debug, Default)]
pub(crate) struct FrameClock {
    /// The unit of numbers; seconds if it is not named.
    pub(super) unit: Option<TimeUnit>,
    start: Option<Time>,
    /// The midnights that a clock without a date has passed, and its last time.
    midnights: (u32, Option<f64>),
}

impl FrameClock {
    pub(super) fn unit(&self) -> TimeUnit {
        self.unit.unwrap_or(TimeUnit::Seconds)
    }

    /// Returns the time in a field whose value is `number`.
    pub(super) fn number(&self, field: &[u8], number: f64) -> Time {
        let unit = self.unit();
        let exact = picoseconds(field, unit).map(Time::Picoseconds);
        exact.unwrap_or(Time::Seconds(unit.seconds(number)))
    }

    /// Returns the time of a timestamp. Must be called once for each timestamp, in their order: if a clock without a date
    /// falls by more than half a day, it has passed midnight.
    pub(crate) fn moment(&mut self, moment: Moment) -> Time {
        const DAY: f64 = 86_400.0;
        if moment.is_dated {
            return Time::Seconds(moment.seconds);
        }
        let (days, last) = &mut self.midnights;
        let last = last.replace(moment.seconds);
        *days += u32::from(last.is_some_and(|last| last - moment.seconds > DAY / 2.0));
        Time::Seconds(f64::from(*days) * DAY + moment.seconds)
    }

    /// Returns the seconds from the first frame to a frame with this time.
    pub(crate) fn since_first(&mut self, time: Time) -> f64 {
        time.since(*self.start.get_or_insert(time))
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_step_is_rounded_before_it_is_checked() {
        for seconds in [0.0167, 1e9, 1e-9] {
            assert_eq!(step(seconds), Some(seconds), "{seconds}");
        }
        for seconds in [1e-10, 1e308, 0.0, -0.1, f64::NAN] {
            assert_eq!(step(seconds), None, "{seconds}");
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

    #[test]
    fn moments_are_read() {
        for (text, seconds) in [
            ("1970-01-01T00:00:00Z", 0.0),
            ("2024-05-01T12:00:00.125Z", 1_714_564_800.125),
            ("2024/05/01 12:00:00", 1_714_564_800.0),
            ("2024-05-01 14:00:00+02:00", 1_714_564_800.0),
            ("2024-05-01t08:30:00-0330", 1_714_564_800.0),
            ("2024-02-29T23:59:60Z", 1_709_251_200.0),
            ("1969-12-31T23:59:59Z", -1.0),
            ("2024-05-01", 1_714_521_600.0),
            ("12:00:00.5", 43_200.5),
            ("9:05:07", 32_707.0),
        ] {
            let is_dated = text.contains(['-', '/']);
            let expected = Moment { seconds, is_dated };
            assert_eq!(read_moment(text.as_bytes()), Some(expected), "{text}");
        }
    }

    #[test]
    fn other_dates_times_and_numbers_are_not_read() {
        for text in [
            "",
            "12",
            "12:00",
            "01.05.2024 12:00:00",
            "05/01/2024 12:00:00",
            "2024-13-01T00:00:00",
            "2024-05-00T00:00:00",
            "2024-04-31T00:00:00",
            "2023-02-29T00:00:00",
            "24:00:00",
            "12:60:00",
            "12:00:61",
            "12:00:-1",
            "12:00:nan",
            "12:00:",
            "12:00:00:00",
            "12:00:00+",
            "12:00:00+1",
            "T12:00:00",
            "12:00:00 PM",
            "12:00:00,125",
            "1 days 00:00:00",
            "+2024-05-01T00:00:00",
            "a:b:c",
        ] {
            assert_eq!(read_moment(text.as_bytes()), None, "{text}");
        }
        assert_eq!(read_moment(b"12:00:\xff"), None);
    }

    #[test]
    fn days_follow_each_other() {
        for (before, after) in [
            ((2022, 8, 31), (2022, 9, 1)),
            ((2021, 12, 31), (2022, 1, 1)),
            ((2024, 2, 28), (2024, 2, 29)),
            ((2023, 2, 28), (2023, 3, 1)),
            ((1900, 2, 28), (1900, 3, 1)),
            ((2000, 2, 29), (2000, 3, 1)),
        ] {
            let number = |(year, month, of_month)| day(year, month, of_month);
            assert_eq!(number(before) + 1, number(after), "{before:?}");
        }
    }
}
