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

use std::io::{BufRead, Seek};

use crate::formats::recording::error::RecordingError;
use crate::formats::recording::event::{ChannelInfo, EarlyEnd, ReadOptions, RecordingEvent, Sink};
use crate::formats::recording::event::{RecordingSink, until_enough};
use crate::formats::recording::side::side;
use crate::formats::recording::table::arrangement::{
    EarlierLayout, FrameFields, LineLayout, TableLayout,
};
use crate::formats::recording::table::clock::{TableClock, TimeText};
use crate::formats::recording::table::layout::{layout, layout_with_header};
use crate::formats::recording::text::lines::{TextLines, is_blank};
use crate::formats::recording::text::number::whole;
use crate::formats::recording::text::row::{self, Field};
use crate::formats::recording::text::separator::{Separator, is_comment};
use crate::formats::recording::time::exact::Time;
use crate::formats::recording::time::frame_clock::FrameClock;
use crate::formats::recording::time::moment;
use crate::frame::{Frame, FrameSize};
use crate::parameter::number::counted;

/// Reads a recording. Its arrangement is kept in `earlier`, for the next content of a followed file.
pub(in crate::formats::recording) fn read(
    mut input: impl BufRead + Seek,
    options: ReadOptions,
    earlier: &mut EarlierLayout,
    sink: &mut Sink<'_>,
) -> Result<(), EarlyEnd> {
    let layout = match &earlier.0 {
        Some(earlier) => layout_after(&mut input, options, earlier.continued())?,
        None => layout(&mut input, options)?,
    };
    let layout = &*earlier.0.insert(layout);
    input.rewind()?;
    let info = ChannelInfo {
        size: Some(layout.size),
        unit: layout.unit.clone(),
        start: layout.start.clone(),
        ..ChannelInfo::default()
    };
    sink(RecordingEvent::Channel(&info))?;
    if let Some(note) = &layout.note {
        sink(RecordingEvent::Note(note))?;
    }
    read_arranged(input, layout, options, sink)
}

/// Reads the frames of a table whose arrangement is known.
fn read_arranged(
    input: impl BufRead,
    layout: &TableLayout,
    options: ReadOptions,
    sink: &mut Sink<'_>,
) -> Result<(), EarlyEnd> {
    let mut lines = TextLines::new(input);
    match &layout.lines {
        LineLayout::Row { parted } => {
            let frame = FrameInRows::new(layout.separator, layout.size, *parted);
            frame.read(&mut lines, options, sink)
        }
        LineLayout::Frame(fields) => frames(&mut lines, layout, fields, options, sink),
    }
}

/// Finds the arrangement of a table in a file that held another one, arranged like `earlier`, before. What cannot be
/// arranged otherwise continues the earlier table.
///
/// # Errors
/// Returns the system's error if the input cannot be read.
fn layout_after(
    input: &mut (impl BufRead + Seek),
    options: ReadOptions,
    earlier: TableLayout,
) -> Result<TableLayout, RecordingError> {
    let fitting = first_fitting(input, &earlier)?;
    input.rewind()?;
    let own = match fitting {
        Some(0) => return Ok(earlier),
        // The line above is a header, or torn.
        Some(_) => layout_with_header(input, options),
        None => layout(input, options),
    };
    match own {
        Err(error @ RecordingError::Io(_)) => Err(error),
        own => Ok(own.unwrap_or(earlier)),
    }
}

/// Returns the index of the first frame that is arranged like this, if it is one of the first two.
///
/// # Errors
/// Returns the system's error if the input cannot be read.
fn first_fitting(
    input: &mut impl BufRead,
    layout: &TableLayout,
) -> Result<Option<usize>, RecordingError> {
    let options = ReadOptions::default().leaving_out();
    let (mut wrong, mut fitting) = (0, None);
    let read = read_arranged(input, layout, options, &mut |event| {
        match event {
            RecordingEvent::Frame(_) => fitting = Some(wrong),
            RecordingEvent::Damage { .. } => wrong += 1,
            _ => {}
        }
        if fitting.is_some() || wrong == 2 {
            return Err(EarlyEnd::Enough);
        }
        Ok(())
    });
    match read {
        Err(EarlyEnd::Failed(error @ RecordingError::Io(_))) => Err(error),
        _ => Ok(fitting),
    }
}

/// Reads a text that is known to be a single frame, one line per row, up to its end or an empty line. As a recording,
/// a single row would be a frame of unknown shape, and a single column not even a table.
///
/// # Errors
/// Returns [`RecordingError::Unknown`] if the text does not begin with a number or is larger than a frame,
/// and an error if a row has another number of values than the first, or anything other than numbers.
pub fn read_rows(text: &[u8], consumer: &mut RecordingSink<'_>) -> Result<(), RecordingError> {
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
    let size = FrameSize::of_sides(columns, side(rows)).ok_or(RecordingError::Unknown)?;
    let frame = FrameInRows::new(separator, size, false);
    let options = ReadOptions::default();
    until_enough(consumer, |sink| {
        frame.read(&mut TextLines::new(text), options, sink)
    })
}

/// Reads frames of one line each.
fn frames(
    lines: &mut TextLines<impl BufRead>,
    layout: &TableLayout,
    fields: &FrameFields,
    options: ReadOptions,
    sink: &mut Sink<'_>,
) -> Result<(), EarlyEnd> {
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
                options.damage(error, line, sink)?;
                continue;
            }
        };
        frame.time = clock.seconds(time);
        if let Some(note) = clock.take_note(frame.number) {
            sink(RecordingEvent::Note(&note))?;
        }
        sink(RecordingEvent::Frame(&frame))?;
        frame.number += 1;
    }
    Ok(())
}

impl FrameFields {
    /// Fills the values and the label of a frame from a line. Returns the text of its time.
    ///
    /// Text in a field that is neither cell nor label nor time is ignored.
    ///
    /// # Errors
    /// Returns an error if the line has another number of fields, or if a cell is not a number.
    fn fill<'a>(
        &self,
        slots: &[Option<usize>],
        frame: &mut Frame,
        separator: Separator,
        (line, number): (&'a [u8], u64),
    ) -> Result<TimeText<'a>, RecordingError> {
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
                values[*slot] = cell.ok_or_else(|| row::wrong(number, found, field))?;
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
            return Err(row::count(number, found, self.count));
        }
        frame.label = label;
        Ok(time)
    }
}

/// A frame whose rows are lines, of which some may have been read.
struct FrameInRows {
    /// The separator between fields.
    separator: Separator,
    /// The frame that is being read.
    frame: Frame,
    /// The number of rows read so far.
    found: u16,
    /// Whether an empty line ends a frame.
    parted: bool,
    /// Whether the rest of a wrong frame is being left out.
    skipping: bool,
    /// The timestamp at the beginning of the first row.
    time: Option<Time>,
    /// The clock that turns timestamps into seconds since the first frame.
    clock: FrameClock,
}

impl FrameInRows {
    /// Creates an empty frame of this size.
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

    /// Reads all frames.
    ///
    /// # Errors
    /// Returns an error if a row has another number of values, or a frame another number of rows.
    fn read(
        mut self,
        lines: &mut TextLines<impl BufRead>,
        options: ReadOptions,
        sink: &mut Sink<'_>,
    ) -> Result<(), EarlyEnd> {
        loop {
            let ended = !lines.advance()?;
            let (line, number) = (lines.line(), lines.number());
            let read = if ended || is_blank(line) {
                self.end(number + u64::from(ended), sink)
            } else if self.skipping || is_comment(line) {
                continue;
            } else {
                self.row(line, number)
                    .map_err(EarlyEnd::from)
                    // Without empty lines, frames are separated by their number of rows alone.
                    .and_then(|()| if self.parted { Ok(()) } else { self.give(sink) })
            };
            match read {
                Err(EarlyEnd::Failed(error)) if self.parted => {
                    options.damage(error, line, sink)?;
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
    fn end(&mut self, number: u64, sink: &mut Sink<'_>) -> Result<(), EarlyEnd> {
        self.skipping = false;
        self.give(sink)?;
        if self.found == 0 {
            return Ok(());
        }
        let (found, rows) = (self.found, self.frame.rows());
        let found = counted(found, "row");
        let message = format!("the frame ends after {found}, expected {rows}");
        Err(RecordingError::in_line(number, message).into())
    }

    /// Reports the frame if all its rows have been read.
    fn give(&mut self, sink: &mut Sink<'_>) -> Result<(), EarlyEnd> {
        if self.found == self.frame.rows() {
            self.frame.time = self.time.map(|time| self.clock.since_first(time));
            sink(RecordingEvent::Frame(&self.frame))?;
            self.frame.number += 1;
            self.found = 0;
        }
        Ok(())
    }

    /// Reads the next row.
    fn row(&mut self, line: &[u8], number: u64) -> Result<(), RecordingError> {
        let (rows, columns) = (self.frame.rows(), usize::from(self.frame.columns()));
        if self.found == rows {
            let message = format!("another row, expected an empty line after {rows} of them");
            return Err(RecordingError::in_line(number, message));
        }
        // Each row may have its timestamp; that of the first row counts.
        let (moment, line) = match moment::leading(line) {
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
            *slot = cell.ok_or_else(|| row::wrong(number, count, field))?;
        }
        if count != columns {
            return Err(row::count(number, count, columns));
        }
        self.found += 1;
        Ok(())
    }
}
