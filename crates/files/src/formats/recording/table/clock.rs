//! Reads the times of a table's frames, as seconds since the first one.

use crate::formats::recording::event::RecordingNote;
use crate::formats::recording::text::lines;
use crate::formats::recording::text::row::Field;
use crate::formats::recording::text::separator::Separator;
use crate::formats::recording::time::exact::Time;
use crate::formats::recording::time::frame_clock::FrameClock;
use crate::formats::recording::time::moment;
use crate::formats::recording::time::unit::TimeUnit;
use crate::quote::shortened;

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
    /// The unit of the rest of a second.
    rest: Option<TimeUnit>,
    /// The clock of the frames.
    clock: FrameClock,
    /// Whether a time could not be read.
    lacks_time: bool,
    /// The text in place of the first such time, until it is noted.
    unread: Option<String>,
}

impl TableClock {
    /// Makes the clock of a table with these time fields.
    pub(super) fn new(separator: Separator, fields: Option<TimeFields>) -> Self {
        let mut clock = FrameClock::default();
        clock.set_unit(fields.and_then(|fields| fields.unit));
        Self {
            separator,
            rest: fields.and_then(|fields| fields.rest).map(|(_, unit)| unit),
            clock,
            lacks_time: false,
            unread: None,
        }
    }

    /// Returns once for a table a note about a time of frame `frame` that could not be read, and once about a unit that
    /// was derived from the size of a time.
    pub(super) fn take_note(&mut self, frame: u64) -> Option<RecordingNote> {
        let unread = self.unread.take();
        let unread = unread.map(|text| RecordingNote::Time { frame, text });
        unread.or_else(|| self.clock.take_note())
    }

    /// Returns the seconds from the first time to this one; None if there is no time, or a text that cannot be read.
    pub(super) fn seconds(&mut self, text: TimeText<'_>) -> Option<f64> {
        match self.time(text.time?, text.rest) {
            Ok(time) => Some(self.clock.since_first(time)),
            Err(wrong) => {
                let is_text = !matches!(self.separator.value(wrong), Field::NoCell);
                if is_text && !std::mem::replace(&mut self.lacks_time, true) {
                    self.unread = Some(shortened(&lines::text(wrong)));
                }
                None
            }
        }
    }

    /// Reads the time in a field, with the rest of its second.
    ///
    /// # Errors
    /// Returns the field that cannot be read.
    fn time<'a>(&mut self, field: &'a [u8], rest: Option<&'a [u8]>) -> Result<Time, &'a [u8]> {
        let time = match self.separator.value(field) {
            Field::Value(number) => {
                let time = self.clock.number(field, number);
                match (self.rest, rest) {
                    (Some(unit), Some(rest)) => match self.separator.value(rest) {
                        Field::Value(number) => time.plus(Time::read(rest, number, unit)),
                        _ => return Err(rest),
                    },
                    _ => time,
                }
            }
            Field::Wrong => self.clock.moment(moment::read(field).ok_or(field)?),
            Field::NoCell => return Err(field),
        };
        Ok(time)
    }
}

#[cfg(test)]
mod tests {
    use super::*;

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
}
