//! Reads timestamps as tables contain them: an ISO 8601 date and a time of day, or a time of day alone.
//! ```text
//! 2024-05-01T12:00:00.125Z      2024/05/01 12:00:00+02:00     12:00:00.125
//! ```
//! Dates that begin with the day or the month are not read, because 01.02. and 02/01 may be the same day.

use crate::formats::recording::text::row::{self, Field};

/// A timestamp.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(in crate::formats) struct Moment {
    /// The seconds since 1970, or since midnight if there is no date.
    pub(in crate::formats::recording) seconds: f64,
    /// Whether the timestamp has a date; otherwise it starts again at midnight.
    pub(in crate::formats::recording) is_dated: bool,
}

/// Reads a timestamp; None for anything else. Second 60, a leap second, counts as the first second of the next
/// minute.
pub(in crate::formats::recording) fn read(field: &[u8]) -> Option<Moment> {
    let text = str::from_utf8(field).ok()?.trim();
    let (day, clock) = match text.split_once(['T', 't', ' ']) {
        Some((date, clock)) => (Some(iso_day(date)?), clock.trim_start()),
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
    let Field::Value(seconds) = row::value(seconds.as_bytes()) else {
        return None;
    };
    (is_number && seconds < 61.0).then_some((hours, minutes, seconds))
}

/// The message for a line with a single value above rows of numbers.
pub(in crate::formats) const ABOVE_ROWS: &str =
    "found one value above rows of numbers; if it is the time of a frame, begin such lines with #";

/// Returns true if a line is a timestamp alone.
pub(in crate::formats) fn is_alone(line: &[u8]) -> bool {
    !line.iter().any(|byte| b",;".contains(byte)) && read(line).is_some()
}

/// Splits a line into the timestamp at its beginning and the numbers after it; None if either is missing. A comma
/// separates cells. If they are not separated by commas, as in `12:00:00,125 7 3`, there is no timestamp.
pub(in crate::formats) fn leading(line: &[u8]) -> Option<(Moment, &[u8])> {
    let mark = if line.contains(&b';') { b';' } else { b',' };
    let line = line.trim_ascii_start();
    let end_of = |from: usize| {
        let is_end = |&byte: &u8| byte == mark || byte.is_ascii_whitespace();
        let end = line[from..].iter().position(is_end);
        end.map(|end| from + end)
    };
    let first = end_of(0)?;
    let is_clock = line[..first].contains(&b':');
    if !is_clock && !line[..first].contains(&b'-') && !line[..first].contains(&b'/') {
        return None;
    }
    // The timestamp may be a date, a blank and a time.
    let end = if is_clock { first } else { end_of(first + 1)? };
    let moment = read(&line[..end])?;
    let rest = line[end..].trim_ascii_start();
    let Some(cells) = rest.strip_prefix(&[mark]) else {
        return Some((moment, rest)).filter(|_| !rest.is_empty());
    };
    let digits = cells
        .iter()
        .take_while(|digit| digit.is_ascii_digit())
        .count();
    let may_be_fraction = mark == b',' && digits > 0 && !cells[digits..].contains(&b',');
    (!may_be_fraction && !cells.trim_ascii().is_empty()).then_some((moment, cells))
}

/// Counts the midnights that clocks without a date pass: when the time falls by more than half a day.
#[derive(Clone, Copy, Debug, Default)]
pub(in crate::formats) struct Midnights {
    days: u32,
    last: Option<f64>,
}

impl Midnights {
    /// Returns the seconds of the next timestamp.
    pub(in crate::formats) fn seconds(&mut self, moment: Moment) -> f64 {
        const DAY: f64 = 86_400.0;
        if moment.is_dated {
            return moment.seconds;
        }
        let last = self.last.replace(moment.seconds);
        self.days += u32::from(last.is_some_and(|last| last - moment.seconds > DAY / 2.0));
        f64::from(self.days) * DAY + moment.seconds
    }
}

/// Returns the number of a day of the Gregorian calendar since 1970; earlier days are negative. The month counts from
/// 1.
pub(in crate::formats::recording) fn day(year: i32, month: i32, day: i32) -> i32 {
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
    let year = parts.next().filter(|year| year.len() == 4)?;
    let year = year
        .bytes()
        .all(|digit| digit.is_ascii_digit())
        .then_some(year)?;
    let month = two_digits(parts.next()?, 12).filter(|&month| month > 0)?;
    let of_month = two_digits(parts.next()?, 31).filter(|&day| day > 0)?;
    let year = year.parse().ok()?;
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
    let is_number = matches!(text.len(), 1 | 2) && text.bytes().all(|digit| digit.is_ascii_digit());
    let number = is_number.then(|| text.parse().ok()).flatten()?;
    (number <= most).then_some(number)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_line_of_numbers_may_begin_with_a_moment() {
        for (line, seconds, rest) in [
            ("2024-05-01T12:00:00.5Z,1,2", 1_714_564_800.5, "1,2"),
            ("2024-05-01 12:00:00,1,2,3", 1_714_564_800.0, "1,2,3"),
            (" 2024/05/01 12:00:00 1 2", 1_714_564_800.0, "1 2"),
            ("12:00:00, 1 2 3", 43_200.0, " 1 2 3"),
            ("12:00:00.25\t-1", 43_200.25, "-1"),
            ("12:00:00,,2", 43_200.0, ",2"),
            ("12:00:00;1;2;3", 43_200.0, "1;2;3"),
            ("12:00:00;1", 43_200.0, "1"),
        ] {
            let found = leading(line.as_bytes());
            let found = found.map(|(moment, rest)| (moment.seconds, rest));
            assert_eq!(found, Some((seconds, rest.as_bytes())), "{line}");
        }
        for line in [
            "12:00:00,25;1,5;2",
            "12:00:00,125 7 3",
            "12:00:00,125",
            "12:00:00",
            "12:00:00,",
            "2024-05-01,1,2",
            "01/02/2024 12:00:00,1,2",
            "-1 12:00:00 5",
            "1 2 3",
            "",
        ] {
            assert_eq!(leading(line.as_bytes()), None, "{line}");
        }
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
            ("12:00:00.5", 43_200.5),
            ("9:05:07", 32_707.0),
        ] {
            let is_dated = text.len() > 12;
            let expected = Moment { seconds, is_dated };
            assert_eq!(read(text.as_bytes()), Some(expected), "{text}");
        }
    }

    #[test]
    fn other_dates_times_and_numbers_are_not_read() {
        for text in [
            "",
            "12",
            "12:00",
            "2024-05-01",
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
            assert_eq!(read(text.as_bytes()), None, "{text}");
        }
        assert_eq!(read(b"12:00:\xff"), None);
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
