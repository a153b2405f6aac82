//! novel's emed `.lst` export: pages with a header, the printed window of the matrix with its indices, and sums of
//! forces.
//!
//! The printed window is the frame; the numbers of its first row and column are reported with it. A picture that is
//! too wide or too high for a page is printed on several, which are joined by the numbers of their rows and columns.
//! Pages without a `Pict-No.`, which summarise (MVP, MPP), are skipped.
//! ```text
//! (fields are separated by tabs, or end where those of the heading end and are empty for 0)
//!     Page 1
//!
//!     File: …\2.dat     Matrix: 64x95
//!     Sensor area: 0.25 cm²    Time/picture:10.0 ms
//!     Sensor size: 0.500x0.500 cm
//!     Pict-No.: 1  Force[N]=sum*sensor_area in row/column
//!
//!     26    27    28    …    Force
//! 30    0.00    0.00    15.00    …    0.38
//! …
//! Force    0.00    0.00    0.38    …
//! ```
//! `Matrix` counts columns × rows of the whole sensor, of which only the loaded part is printed. Values are in kPa; the
//! forces of rows, of columns and of all cells are in N, and are checked. The time counts from the first picture: the
//! difference of their numbers times `Time/picture`. Source: exports of novel's emed software.

use std::io::BufRead;

use crate::formats::recording::error::RecordingError;
use crate::formats::recording::event::{
    ChannelInfo, EarlyEnd, RecordingEvent, RecordingNote, Sink,
};
use crate::formats::recording::length::{LengthUnit, pitches_in_mm};
use crate::formats::recording::side::{frame_size, side};
use crate::formats::recording::text::lines::{TextLines, text};
use crate::formats::recording::text::number;
use crate::formats::recording::text::row::{self, Field};
use crate::formats::recording::text::separator::Separator;
use crate::formats::recording::time::field_role::time_unit;
use crate::formats::recording::time::unit::TimeUnit;
use crate::formats::seconds::of_label;
use crate::frame::{FirstCell, Frame, MAX_FRAME_SIDE};

/// The force in N of a pressure of 1 kPa on 1 cm².
const NEWTON: f64 = 0.1;
/// The rounding error of values and forces, which have two decimals.
const ROUNDING: f64 = 0.005;

/// The most pages of a picture.
const MOST_PAGES: usize = 16;

/// The content of the headers so far; a value holds until another page changes it.
#[derive(Default)]
struct EmedState {
    /// The columns and rows of the whole sensor.
    sensor: Option<[f64; 2]>,
    /// The number of the first frame whose window reaches beyond the sensor.
    first_beyond: Option<u64>,
    /// The area of a cell, by which pressures become forces.
    area_cm2: Option<f64>,
    /// The size of a cell along x and along y.
    pitch_mm: Option<[f64; 2]>,
    /// The time from one picture to the next.
    seconds: Option<f64>,
    /// Whether a page has begun but not yet its values.
    in_header: bool,
    /// The `Pict-No.` of the picture whose window comes next; None on other pages.
    label: Option<i64>,
    /// Whether the line of the `Pict-No.` says that windows end in a line of forces.
    has_forces: bool,
    /// The pages so far of the last picture; another page may follow.
    picture: Vec<EmedWindow>,
    /// Whether pictures so far have forces of rows, which their last page prints.
    has_row_forces: bool,
    /// The number of pictures that have been reported.
    frames: u64,
    /// The `Pict-No.` of the first of them.
    first_label: Option<i64>,
}

/// Reads a recording.
///
/// # Errors
/// Returns an error if a page has a header but no window, or if the pages of a picture leave out cells, and the
/// errors of the window.
pub(in crate::formats::recording) fn read(
    input: impl BufRead,
    sink: &mut Sink<'_>,
) -> Result<(), EarlyEnd> {
    let mut lines = TextLines::new(input);
    let mut state = EmedState::default();
    let ended = match state.pages(&mut lines, sink) {
        Err(EarlyEnd::Enough) => return Err(EarlyEnd::Enough),
        Ok(()) if state.lacks_pages() => {
            let message = "ends before the last page of a picture";
            Err(RecordingError::in_line(lines.number() + 1, message).into())
        }
        ended => ended,
    };
    if !state.lacks_pages() {
        state.give(sink)?;
    }
    ended
}

/// The heading of a window: the numbers of its columns, and `Force` if each row ends in its force.
/// ```text
///          21      22      23     Force
/// 45     0.00   12.50    7.50      2.00
/// Force  0.00    1.25    0.75      2.00
/// ```
struct EmedHeading {
    /// The first column of the window, counted on the whole sensor.
    first_column: u32,
    /// The number of columns in the window.
    columns: u16,
    /// Whether each row has a force, and a line of forces follows the rows.
    has_force: bool,
    /// The positions where fields end; empty if tabs separate them.
    ends: Vec<usize>,
}

/// Returns the words of a line, each with the position of its end.
fn words(line: &[u8]) -> impl Iterator<Item = (&[u8], usize)> {
    let mut end = 0;
    let fields = line.split(u8::is_ascii_whitespace);
    let words = fields.map(move |word| {
        let own = end + word.len();
        end = own + 1;
        (word, own)
    });
    words.filter(|(word, _)| !word.is_empty())
}

impl EmedHeading {
    /// Reads the heading in line `number`.
    ///
    /// # Errors
    /// Returns an error if its numbers are not consecutive, or if there are more than a frame has columns.
    fn of(line: &[u8], number: u64) -> Result<Self, RecordingError> {
        let (names, ends): (Vec<&[u8]>, Vec<usize>) = words(line).unzip();
        let has_force = names.last().is_some_and(|last| *last == b"Force");
        let numbers = &names[..names.len() - usize::from(has_force)];
        let column = |name: &[u8]| str::from_utf8(name).ok()?.parse::<u32>().ok();
        let first = numbers.first().and_then(|first| column(first));
        let first = first.filter(|&first| {
            let mut expected = (first..).zip(numbers);
            expected.all(|(number, name)| column(name) == Some(number))
        });
        let Some((first_column, columns)) = first.zip(side(numbers.len())) else {
            let message = "expected the numbers of columns, one after the other";
            return Err(RecordingError::in_line(number, message));
        };
        Ok(Self {
            first_column,
            columns,
            has_force,
            ends: if line.contains(&b'\t') {
                Vec::new()
            } else {
                ends
            },
        })
    }

    /// Splits a line below the heading into its fields: the number of the row, its values, and its force if rows have
    /// one.
    fn fields<'a>(&self, line: &'a [u8]) -> Vec<&'a [u8]> {
        if self.ends.is_empty() {
            return Separator::Byte(b'\t').split(line).collect();
        }
        let mut fields = vec![&b"0"[..]; 1 + self.ends.len()];
        for (index, (word, end)) in words(line).enumerate() {
            let column = self.ends.iter().position(|own| *own == end);
            match column.filter(|_| index > 0) {
                Some(column) => fields[column + 1] = word,
                None if index == 0 => fields[0] = word,
                // Words that are not in columns: no field is left out.
                None => return words(line).map(|(word, _)| word).collect(),
            }
        }
        fields
    }

    /// Reads the numbers of a line into `values`. `name` replaces the first field, if that is not a number.
    fn fill(
        &self,
        values: &mut [f64],
        (line, number): (&[u8], u64),
        name: Option<&[u8]>,
    ) -> Result<(), RecordingError> {
        let fields = self.fields(line).into_iter().enumerate();
        let fields = fields.map(|(index, field)| name.filter(|_| index == 0).unwrap_or(field));
        row::fill(values, fields, number, |field| match row::value(field) {
            Field::NoCell => Field::Wrong,
            field => field,
        })
    }
}

/// The window on a page, or several joined into that of a picture.
struct EmedWindow {
    /// The `Pict-No.` of the page.
    label: i64,
    /// The first row of the window, counted on the whole sensor.
    first_row: u32,
    /// The first column of the window, counted on the whole sensor.
    first_column: u32,
    /// The number of rows in the window.
    rows: u16,
    /// The number of columns in the window.
    columns: u16,
    /// The values, row by row.
    values: Vec<f64>,
    /// The force of each row, if it is printed.
    row_forces: Vec<f64>,
    /// The force of each column, and after these that of all cells, if they are printed.
    column_forces: Vec<f64>,
}

impl EmedWindow {
    /// Reads the rows of the window below its heading, and the line after them.
    ///
    /// # Errors
    /// Returns an error if rows are not numbered consecutively, or if the window ends before the line of forces.
    fn read(
        heading: &EmedHeading,
        lines: &mut TextLines<impl BufRead>,
        label: i64,
        has_forces: bool,
    ) -> Result<Self, RecordingError> {
        let columns = usize::from(heading.columns);
        let mut fields = vec![0.0; columns + 1 + usize::from(heading.has_force)];
        let mut window = Self {
            label,
            first_row: 0,
            first_column: heading.first_column,
            rows: 0,
            columns: heading.columns,
            values: Vec::new(),
            row_forces: Vec::new(),
            column_forces: Vec::new(),
        };
        while window.has_next_row(lines, has_forces)? {
            let (line, number) = (lines.line(), lines.number());
            heading.fill(&mut fields, (line, number), None)?;
            if window.rows == 0 {
                #[expect(
                    clippy::cast_possible_truncation,
                    clippy::cast_sign_loss,
                    reason = "saturates; the next row would not follow it"
                )]
                let first = fields[0] as u32;
                window.first_row = first;
            }
            let expected = f64::from(window.first_row) + f64::from(window.rows);
            if fields[0] != expected {
                let message = format!("found row {}, expected row {expected}", fields[0]);
                return Err(RecordingError::in_field(number, 1, message));
            }
            if window.rows == MAX_FRAME_SIDE {
                let message = format!("more than {MAX_FRAME_SIDE} rows");
                return Err(RecordingError::in_line(number, message));
            }
            window.rows += 1;
            window.values.extend_from_slice(&fields[1..=columns]);
            window.row_forces.extend(fields.get(columns + 1).copied());
        }
        Ok(window)
    }

    /// Moves to the next row of the window; returns false at its end, which is the line of forces, or an empty line
    /// if there are none.
    ///
    /// # Errors
    /// Returns an error if the window ends before its first row, or without its line of forces.
    fn has_next_row(
        &self,
        lines: &mut TextLines<impl BufRead>,
        has_forces: bool,
    ) -> Result<bool, RecordingError> {
        let content = lines.advance()? && !lines.line().trim_ascii().is_empty();
        if content && !is_forces(lines.line()) {
            return Ok(true);
        }
        if has_forces && !content || self.rows == 0 {
            let message = "the picture ends here, expected more rows, then their Force";
            return Err(RecordingError::in_line(lines.number(), message));
        }
        Ok(false)
    }

    /// Returns the ranges of rows and columns on the whole sensor, each from the first to the one after the last.
    fn ranges(&self) -> [(u32, u32); 2] {
        let behind = |first: u32, count: u16| (first, first.saturating_add(count.into()));
        [
            behind(self.first_row, self.rows),
            behind(self.first_column, self.columns),
        ]
    }

    /// Returns true if both windows include some cell of the sensor.
    fn overlaps(&self, other: &Self) -> bool {
        let mut pairs = self.ranges().into_iter().zip(other.ranges());
        pairs.all(|(own, other)| own.0 < other.1 && other.0 < own.1)
    }
}

/// Returns true if a line holds the forces of columns.
fn is_forces(line: &[u8]) -> bool {
    line.trim_ascii_start().starts_with(b"Force")
}

/// Returns the number that follows a word, and the rest of the line after it: 10 and ` ms` for the word
/// `Time/picture:` in `Time/picture:10.0 ms`.
fn after<'a>(line: &'a str, word: &str) -> Option<(f64, &'a str)> {
    let rest = line.split_once(word)?.1.trim_start();
    let end = rest.find(|character: char| !character.is_ascii_digit() && character != '.');
    let (number, rest) = rest.split_at(end.unwrap_or(rest.len()));
    Some((number::read(number.as_bytes())?, rest))
}

/// Returns the unit of length at the beginning of a text; centimetres if it names none.
fn length_unit(text: &str) -> LengthUnit {
    let mut words = text.trim_start().split(|end: char| !end.is_alphabetic());
    let named = words.next().and_then(LengthUnit::of_name);
    named.unwrap_or(LengthUnit::Centimetres)
}

impl EmedState {
    /// Reads all pages.
    fn pages(
        &mut self,
        lines: &mut TextLines<impl BufRead>,
        sink: &mut Sink<'_>,
    ) -> Result<(), EarlyEnd> {
        while lines.advance_to_content()? {
            let line = text(lines.line());
            if line.contains("Page") {
                (self.label, self.in_header) = (None, true);
            }
            self.line(&line);
            let is_window = line.starts_with(['\t', ' '])
                && line
                    .split_whitespace()
                    .next()
                    .is_some_and(|word| word.parse::<u32>().is_ok());
            // A page that summarises need not have a window.
            let is_summary = line.contains("MVP") || line.contains("MPP");
            self.in_header &= !is_window && !is_summary;
            let Some(label) = self.label.filter(|_| is_window) else {
                continue;
            };
            self.window(lines, label, sink)?;
        }
        if self.in_header || self.label.is_some() {
            let message = "ends before the values of a picture";
            return Err(RecordingError::in_line(lines.number() + 1, message).into());
        }
        Ok(())
    }

    /// Reads a line of the header, which may hold several values.
    fn line(&mut self, line: &str) {
        if let Some((columns, rest)) = after(line, "Matrix:")
            && let Some((rows, _)) = after(rest, "x")
        {
            self.sensor = Some([columns, rows]);
        }
        if let Some((area, _)) = after(line, "Sensor area:") {
            self.area_cm2 = Some(area);
        }
        if let Some((time, unit)) = after(line, "Time/picture:") {
            let unit = time_unit(unit).unwrap_or(TimeUnit::Seconds);
            self.seconds = unit.step_in_seconds(time);
        }
        if let Some((x, rest)) = after(line, "Sensor size:")
            && let Some((y, unit)) = after(rest, "x")
        {
            self.pitch_mm = pitches_in_mm([Some(x), Some(y)], length_unit(unit));
        }
        if let Some((label, _)) = after(line, "Pict-No.:") {
            #[expect(clippy::cast_possible_truncation, reason = "the number of a picture")]
            let label = label as i64;
            self.label = Some(label);
            self.has_forces = line.contains("Force");
        }
    }

    /// Reads the window below the line of column numbers, and reports the picture before it.
    ///
    /// # Errors
    /// Returns an error if columns or rows are not numbered consecutively, or if the window ends before the line of
    /// forces.
    fn window(
        &mut self,
        lines: &mut TextLines<impl BufRead>,
        label: i64,
        sink: &mut Sink<'_>,
    ) -> Result<(), EarlyEnd> {
        let heading = EmedHeading::of(lines.line(), lines.number())?;
        let has_forces = self.has_forces || heading.has_force;
        let mut window = EmedWindow::read(&heading, lines, label, has_forces)?;
        let mut forces = Ok(());
        if is_forces(lines.line()) {
            let line = (lines.line(), lines.number());
            let mut fields =
                vec![0.0; 1 + usize::from(heading.columns) + usize::from(heading.has_force)];
            forces = heading.fill(&mut fields, line, Some(b"0"));
            if forces.is_ok() {
                window.column_forces = fields.split_off(1);
            }
        }
        // The values are complete even if the line of forces is not.
        self.label = None;
        let joins = |own: &EmedWindow| own.label == label && !own.overlaps(&window);
        if !self.picture.iter().all(joins) {
            self.give(sink)?;
        }
        if self.picture.len() == MOST_PAGES {
            let message = format!("picture {label} has more than {MOST_PAGES} pages");
            return Err(RecordingError::in_line(lines.number(), message).into());
        }
        self.picture.push(window);
        Ok(forces?)
    }

    /// Returns true if the last picture lacks a page where the file ends or is damaged: the damaged page itself, or
    /// the last one, which has the forces of rows if earlier pictures have them.
    fn lacks_pages(&self) -> bool {
        let label = self.picture.first().map(|window| window.label);
        let has_row_forces = self
            .picture
            .iter()
            .any(|window| !window.row_forces.is_empty());
        label.is_some() && (self.label == label || self.has_row_forces && !has_row_forces)
    }

    /// Reports the last picture, if there is one.
    ///
    /// # Errors
    /// Returns an error if its pages leave out cells, or are larger than a frame.
    fn give(&mut self, sink: &mut Sink<'_>) -> Result<(), EarlyEnd> {
        let pages = std::mem::take(&mut self.picture);
        let Some(first) = pages.first() else {
            return Ok(());
        };
        let mut frame = joined(first, &pages)?;
        self.has_row_forces |= pages.iter().any(|page| !page.row_forces.is_empty());
        frame.number = self.frames;
        frame.label = Some(first.label);
        if self.frames == 0 {
            let info = ChannelInfo {
                size: Some(frame.size()),
                unit: Some("kPa".to_owned()),
                seconds_per_frame: self.seconds,
                pitch_mm: self.pitch_mm,
                ..ChannelInfo::default()
            };
            sink(RecordingEvent::Channel(&info))?;
        }
        frame.time = of_label(first.label, &mut self.first_label, self.seconds);
        self.frames += 1;
        if self.first_beyond.is_none()
            && let Some(note) = self.window_beyond(&frame)
        {
            self.first_beyond = Some(frame.number);
            sink(RecordingEvent::Note(&note))?;
        }
        for note in self.odd_sums(&frame, &pages) {
            sink(RecordingEvent::Note(&note))?;
        }
        sink(RecordingEvent::Frame(&frame))
    }

    /// Returns a note if the window of a picture reaches beyond the sensor: then one of the two is wrong.
    fn window_beyond(&self, frame: &Frame) -> Option<RecordingNote> {
        let ([columns, rows], corner) = self.sensor.zip(frame.first)?;
        // Rows and columns are counted from 1.
        let row = corner.row.saturating_add(u32::from(frame.rows()) - 1);
        let column = corner.column.saturating_add(u32::from(frame.columns()) - 1);
        let label = frame.label?;
        let is_beyond = f64::from(row) > rows || f64::from(column) > columns;
        is_beyond.then(|| RecordingNote::Window {
            complaint: format!(
                "frame {} (label {label}): its window ends in row {row} and column {column}, but the sensor has {rows} \
                 rows and {columns} columns",
                frame.number
            ),
        })
    }

    /// Returns notes about the forces of rows, of columns and of all cells that differ from those of the values. The
    /// force of a row on several pages is printed on the last one only; if several pages print one, it is unclear
    /// what is summed, so it is not checked.
    ///
    /// A force has two decimals, as has each value that it sums: the difference may be half of the last digit for
    /// each. The force of all cells may be the sum of those of the rows or of the columns.
    fn odd_sums(&self, frame: &Frame, pages: &[EmedWindow]) -> Vec<RecordingNote> {
        let (Some(area), Some(corner)) = (self.area_cm2, frame.first) else {
            return Vec::new();
        };
        let columns = usize::from(frame.columns());
        let mut notes = Vec::new();
        let mut check = |what, stated: f64, cells: &mut dyn Iterator<Item = f64>, sums: u16| {
            let (mut found, mut count) = (0.0, 0.0);
            cells.for_each(|cell| (found, count) = (found + cell, count + 1.0));
            found *= area * NEWTON;
            let rounding =
                ROUNDING * (f64::from(sums) + count * area * NEWTON) + 1e-9 * found.abs();
            if (found - stated).abs() > rounding {
                notes.push(RecordingNote::Checksum {
                    frame: frame.number,
                    label: frame.label,
                    what,
                    stated,
                    found,
                });
            }
        };
        let values = frame.values();
        for row in 0..frame.rows() {
            let number = corner.row + u32::from(row);
            let stated = pages.iter().filter_map(|page| {
                let index = number.checked_sub(page.first_row)?;
                page.row_forces.get(usize::try_from(index).ok()?)
            });
            if let [stated] = stated.collect::<Vec<_>>()[..] {
                let start = usize::from(row) * columns;
                let mut cells = values[start..start + columns].iter().copied();
                check("the force of a row", *stated, &mut cells, 1);
            }
        }
        for column in 0..frame.columns() {
            let number = corner.column + u32::from(column);
            let stated = pages.iter().filter_map(|page| {
                let index = usize::try_from(number.checked_sub(page.first_column)?).ok()?;
                let own = page.column_forces.get(..page.columns.into())?;
                own.get(index)
            });
            if let [stated] = stated.collect::<Vec<_>>()[..] {
                let cells = values[usize::from(column)..].iter().step_by(columns);
                check("the force of a column", *stated, &mut cells.copied(), 1);
            }
        }
        let stated = pages
            .iter()
            .filter_map(|page| page.column_forces.get(usize::from(page.columns)));
        if let [stated] = stated.collect::<Vec<_>>()[..] {
            let sums = 1 + frame.rows().max(frame.columns());
            let mut cells = values.iter().copied();
            check("the force of all cells", *stated, &mut cells, sums);
        }
        notes
    }
}

/// Joins the pages of a picture into a frame; no cell is on two pages.
///
/// # Errors
/// Returns an error if the pages leave out cells, or are larger than a frame.
fn joined(first: &EmedWindow, pages: &[EmedWindow]) -> Result<Frame, RecordingError> {
    let range = |axis: usize| {
        let ranges = pages.iter().map(|page| page.ranges()[axis]);
        let bounds = |(low, high): (u32, u32), own: (u32, u32)| (low.min(own.0), high.max(own.1));
        ranges.fold(first.ranges()[axis], bounds)
    };
    let ((top, bottom), (left, right)) = (range(0), range(1));
    let label = first.label;
    let Some(size) = frame_size(right - left, bottom - top) else {
        let message = format!("picture {label} has more than {MAX_FRAME_SIDE} rows or columns");
        return Err(RecordingError::damaged(message));
    };
    let mut frame = Frame::new(size);
    let cells: usize = pages.iter().map(|page| page.values.len()).sum();
    if cells != frame.values().len() {
        let message = format!("the pages of picture {label} do not make up a rectangle");
        return Err(RecordingError::damaged(message));
    }
    for page in pages {
        // The page lies within the bounds of all pages, which are those of the frame.
        let (above, before) = (top..page.first_row, left..page.first_column);
        let columns = usize::from(size.columns());
        let start = above.count() * columns + before.count();
        let width = usize::from(page.columns);
        let starts = (start..).step_by(columns);
        for (start, row) in starts.zip(page.values.chunks(width)) {
            frame.values_mut()[start..start + width].copy_from_slice(row);
        }
    }
    frame.first = Some(FirstCell {
        column: left,
        row: top,
    });
    Ok(frame)
}
