//! Tables of numbers. Either a line is a frame, with or without a header and other columns, or a line is a row and an
//! empty line separates frames.
//! ```text
//! frame,time,r0c0,r0c1,r1c0,r1c1          0 12  7
//! 0,0.00,1,2,3,4                          3  9 NaN
//! 1,0.05,1,,3,4
//!                                         0 11  8      or 12:00:00.25 0 11 8
//!                                         2  9  1
//! ```
//! Fields are separated by semicolons (then a comma is the decimal sign), commas, tabs or spaces; the first line
//! decides. Quotes around a field do not count. An empty field, `NaN`, `-nan`, `null`, `none`, `NA`, `N/A`, `#N/A`
//! and `<NA>` mean that there is no cell. Lines that begin with `#`, with `//`, or with `%` and a blank are skipped.
//!
//! A line below the names of cells may hold the unit of each field.
//!
//! The first lines decide how the fields are arranged, see [`layout`](super::layout); then the file is
//! read from its beginning.
//!
//! A line of commas is an empty line, as spreadsheet programs write it.
//!
//! A followed file may go on without its header, with a torn line or with a message after it was truncated. If one of
//! its first two frames is arranged as before, so is the rest; otherwise it counts as a new table.
//!
//! Errors, with line and field, are words in place of numbers, and lines or blocks of another length. Nothing is
//! padded, since a missing value in the middle would shift all later ones. If wrong frames may be left out, that is a
//! line, or all rows up to an empty line; without empty lines between frames, the next one cannot be found.

use crate::formats::recording::error::{in_line, unknown_format};
use std::io::{BufRead, Seek};

use taxel_core::frame::{Frame, FrameSize};
use taxel_core::parameter::number::counted;
use taxel_core::quote::shortened;

use crate::error::ReadError;
use crate::formats::recording::event::{
    ChannelInfo, ReadOptions, ReadState, RecordingEvent, RecordingNote, RecordingSink, Sink, Stop,
};
use crate::formats::recording::size::side;
use crate::formats::recording::table::layout::{
    EarlierLayout, FrameFields, LineLayout, TableLayout, layout,
};
use crate::formats::recording::text::{
    self, Field, Separator, TextLines, is_blank, is_comment, whole,
};
use crate::formats::recording::time::{self, FrameClock, Time, TimeUnit};

/// Reads a recording. Its arrangement is kept in `earlier`, for the next content of a followed file.
pub(in crate::formats::recording) fn read(
    mut input: impl BufRead + Seek,
    options: &ReadOptions,
    earlier: &mut EarlierLayout,
    sink: &mut Sink<'_>,
) -> Result<(), Stop> {
    let layout = layout(&mut input, options)?;
    let layout = &*earlier.0.insert(layout);
    input.rewind()?;
    let info = ChannelInfo {
        size: Some(layout.size),
        unit: layout.unit.clone(),
        start: layout.start.clone(),
        ..ChannelInfo::default()
    };
    sink.event(RecordingEvent::Channel(&info))?;
    if let Some(note) = &layout.note {
        sink.event(RecordingEvent::Note(note))?;
    }
    read_arranged(input, layout, options, sink)
}

fn read_arranged(
    input: impl BufRead,
    layout: &TableLayout,
    options: &ReadOptions,
    sink: &mut Sink<'_>,
) -> Result<(), Stop> {
    let mut lines = TextLines::new(input);
    match &layout.lines {
        LineLayout::Row { parted } => {
            let frame = FrameInRows::new(layout.separator, layout.size, *parted);
            frame.read(&mut lines, options, sink)
        }
        LineLayout::Frame(fields) => frames(&mut lines, layout, fields, options, sink),
    }
}

/// Reads a text that is known to be a single frame, one line per row, up to its end or an empty line. As a recording,
/// a single row would be a frame of unknown shape, and a single column not even a table.
///
/// # Errors
/// Returns [`unknown_format()`] if the text does not begin with a number or is larger than a frame,
/// and an error if a row has another number of values than the first, or anything other than numbers.
pub fn read_rows(text: &[u8], consumer: &mut RecordingSink<'_>) -> Result<(), ReadError> {
    let mut lines = TextLines::new(text);
    while lines.advance_to_content()? && is_comment(lines.line()) {}
    let first = lines.line();
    let separator = Separator::of(first);
    // A row that has a word among its numbers is an error with its column, but words alone are no table.
    let is_row = !is_blank(first)
        && separator
            .fields(first)
            .next()
            .is_some_and(|field| separator.is_numeric(field));
    let columns = side(separator.fields(first).count()).filter(|_| is_row);
    let mut rows = 1_usize;
    while lines.advance()? && !is_blank(lines.line()) {
        rows += usize::from(!is_comment(lines.line()));
    }
    let size = FrameSize::of_sides(columns, side(rows)).ok_or(unknown_format())?;
    let frame = FrameInRows::new(separator, size, false);
    let options = ReadOptions::default();
    let mut state = ReadState::default();
    let sink = &mut Sink::new(consumer, &mut state);
    match frame.read(&mut TextLines::new(text), &options, sink) {
        Ok(()) | Err(Stop::Enough) => Ok(()),
        Err(Stop::Failed(error)) => Err(error),
    }
}

fn frames(
    lines: &mut TextLines<impl BufRead>,
    layout: &TableLayout,
    fields: &FrameFields,
    options: &ReadOptions,
    sink: &mut Sink<'_>,
) -> Result<(), Stop> {
    // The index of the cell in each field; None if the field is not a cell.
    let mut slots = vec![None; fields.count];
    for (slot, &field) in fields.cells.iter().enumerate() {
        slots[field] = Some(slot);
    }
    let mut frame = Frame::new(layout.size);
    let mut clock = TableClock::new(layout.separator, fields.time);
    while lines.advance()? {
        let (line, number) = (lines.line(), lines.number());
        let is_header = fields.header.is_some_and(|last| number <= last);
        if is_blank(line) || is_header || is_comment(line) {
            continue;
        }
        let time = match fields.fill(&slots, &mut frame, layout.separator, (line, number)) {
            Ok(time) => time,
            Err(error) => {
                sink.damage(options, error, line)?;
                continue;
            }
        };
        frame.time = clock.seconds(time);
        if let Some(note) = clock.take_note(frame.number) {
            sink.event(RecordingEvent::Note(&note))?;
        }
        sink.event(RecordingEvent::Frame(&frame))?;
        frame.number += 1;
    }
    Ok(())
}

impl FrameFields {
    /// Fills the values and the label of a frame from a line. Returns the text of its time.
    ///
    /// Text in a field that is neither cell nor label nor time is ignored.
    fn fill<'a>(
        &self,
        slots: &[Option<usize>],
        frame: &mut Frame,
        separator: Separator,
        (line, number): (&'a [u8], u64),
    ) -> Result<TimeText<'a>, ReadError> {
        let (mut found, mut label, mut time) = (0, None, TimeText::default());
        let own = self.time.map(|time| time.field);
        let rest = self.time.and_then(|time| time.rest).map(|(rest, _)| rest);
        let values = frame.values_mut();
        for field in separator.fields_of(line, self.count) {
            let index = found;
            found += 1;
            let Some(slot) = slots.get(index) else {
                continue;
            };
            if let Some(slot) = slot {
                let cell = separator.value(field).cell();
                values[*slot] = cell.ok_or_else(|| text::wrong_field(number, found, field))?;
            } else if self.label == Some(index) {
                if let Field::Value(value) = separator.value(field) {
                    label = whole(value);
                }
            } else if own == Some(index) {
                time.time = Some(field);
            } else if rest == Some(index) {
                time.rest = Some(field);
            }
        }
        if found != self.count {
            return Err(text::wrong_count(number, found, self.count));
        }
        frame.label = label.map(Into::into);
        Ok(time)
    }
}

/// A frame whose rows are lines, of which some may have been read.
struct FrameInRows {
    separator: Separator,
    frame: Frame,
    found: u16,
    parted: bool,
    skipping: bool,
    time: Option<Time>,
    /// The clock that turns timestamps into seconds since the first frame.
    clock: FrameClock,
}

impl FrameInRows {
    fn new(separator: Separator, size: FrameSize, parted: bool) -> Self {
        Self {
            separator,
            frame: Frame::new(size),
            found: 0,
            parted,
            skipping: false,
            time: None,
            clock: FrameClock::default(),
        }
    }

    fn read(
        mut self,
        lines: &mut TextLines<impl BufRead>,
        options: &ReadOptions,
        sink: &mut Sink<'_>,
    ) -> Result<(), Stop> {
        loop {
            let ended = !lines.advance()?;
            let (line, number) = (lines.line(), lines.number());
            let read = if ended || is_blank(line) {
                self.end(number + u64::from(ended), sink)
            } else if self.skipping || is_comment(line) {
                continue;
            } else {
                self.row(line, number)
                    .map_err(Stop::from)
                    // Without empty lines, frames are separated by their number of rows alone.
                    .and_then(|()| if self.parted { Ok(()) } else { self.give(sink) })
            };
            match read {
                Err(Stop::Failed(error)) if self.parted => {
                    sink.damage(options, error, line)?;
                    self.found = 0;
                    self.skipping = !is_blank(line);
                }
                read => read?,
            }
            if ended {
                return Ok(());
            }
        }
    }

    /// Ends the frame at an empty line or at the end of the file. There may be any number of empty lines between
    /// frames.
    fn end(&mut self, number: u64, sink: &mut Sink<'_>) -> Result<(), Stop> {
        self.skipping = false;
        self.give(sink)?;
        if self.found == 0 {
            return Ok(());
        }
        let (found, rows) = (self.found, self.frame.rows());
        let found = counted(found, "row");
        let message = format!("the frame ends after {found}, expected {rows}");
        Err(in_line(number, message).into())
    }

    fn give(&mut self, sink: &mut Sink<'_>) -> Result<(), Stop> {
        if self.found == self.frame.rows() {
            self.frame.time = self.time.map(|time| self.clock.since_first(time));
            sink.event(RecordingEvent::Frame(&self.frame))?;
            self.frame.number += 1;
            self.found = 0;
        }
        Ok(())
    }

    fn row(&mut self, line: &[u8], number: u64) -> Result<(), ReadError> {
        let (rows, columns) = (self.frame.rows(), usize::from(self.frame.columns()));
        if self.found == rows {
            let message = format!("another row, expected an empty line after {rows} of them");
            return Err(in_line(number, message));
        }
        // Each row may have its timestamp; that of the first row counts.
        let (moment, line) = match time::leading(line) {
            Some((moment, row)) => (Some(moment), row),
            None => (None, line),
        };
        if self.found == 0 {
            self.time = moment.map(|moment| self.clock.moment(moment));
        }
        let start = usize::from(self.found) * columns;
        let slots = &mut self.frame.values_mut()[start..start + columns];
        let mut count = 0;
        for field in self.separator.fields_of(line, columns) {
            count += 1;
            let Some(slot) = slots.get_mut(count - 1) else {
                continue;
            };
            let cell = self.separator.value(field).cell();
            *slot = cell.ok_or_else(|| text::wrong_field(number, count, field))?;
        }
        if count != columns {
            return Err(text::wrong_count(number, count, columns));
        }
        self.found += 1;
        Ok(())
    }
}

#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) struct TimeFields {
    pub(super) field: usize,
    /// The unit; None if nothing names it.
    pub(super) unit: Option<TimeUnit>,
    pub(super) rest: Option<(usize, TimeUnit)>,
}

impl TimeFields {
    pub(super) fn new(field: usize, unit: Option<TimeUnit>) -> Self {
        Self {
            field,
            unit,
            rest: None,
        }
    }
}

#[derive(Clone, Copy, Debug, Default)]
pub(super) struct TimeText<'a> {
    pub(super) time: Option<&'a [u8]>,
    pub(super) rest: Option<&'a [u8]>,
}

#[derive(Debug)]
pub(super) struct TableClock {
    separator: Separator,
    rest: Option<TimeUnit>,
    clock: FrameClock,
    /// Whether a time could not be read.
    lacks_time: bool,
    unread: Option<String>,
}

impl TableClock {
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
                    self.unread = Some(shortened(&text::text(wrong)));
                }
                None
            }
        }
    }

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
            Field::Wrong => self.clock.moment(time::read_moment(field).ok_or(field)?),
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
