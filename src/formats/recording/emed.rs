//! novel's emed `.lst` export: pages with a header, the printed window of the matrix with its indices, and sums of
//! forces.
//!
//! The printed window is the frame; the numbers of its first row and column are reported with it. Pages without a
//! `Pict-No.`, which summarise (MVP, MPP), are passed over.
//! ```text
//! (fields are parted by tabs)
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
//! `Matrix` counts columns × rows of the whole sensor, of which only the loaded part is printed. Values are kPa; each
//! row ends in its force in N, which is checked. Time is the number of the picture times `Time/picture`. Source:
//! exports of novel's emed software.

use std::io::BufRead;

use crate::formats::recording::error::RecordingError;
use crate::formats::recording::event::{ChannelInfo, RecordingEvent, RecordingNote, Sink};
use crate::formats::recording::lines::{TextLines, text};
use crate::formats::recording::number;
use crate::formats::recording::separator::Separator;
use crate::formats::recording::side::side;
use crate::formats::recording::text_row::{self, Field};
use crate::formats::seconds::to_nanoseconds;
use crate::frame::{Frame, MAX_FRAME_SIDE};

/// A pressure of 1 kPa on 1 cm² is a force of 0.1 N.
const NEWTON: f64 = 0.1;
/// Values and forces have two decimals.
const ROUNDING: f64 = 0.005;

/// What the headers so far say; a value holds until another page says another.
#[derive(Default)]
struct EmedState {
    /// The area of a cell, which makes forces of pressures.
    area_cm2: Option<f64>,
    /// The size of a cell along x and along y.
    pitch_mm: Option<[f64; 2]>,
    /// From a picture to the next.
    seconds: Option<f64>,
    /// `Pict-No.` of the picture whose window comes next; None on other pages.
    label: Option<i64>,
    /// Pictures so far.
    frames: u64,
}

/// Reads a recording.
///
/// # Errors
/// If a picture has a header but no window; those of the window.
pub(super) fn read(input: impl BufRead, sink: &mut Sink<'_>) -> Result<(), RecordingError> {
    let mut lines = TextLines::new(input);
    let mut state = EmedState::default();
    let mut frame = Frame::new(1, 1);
    while lines.advance_to_content()? {
        let line = text(lines.line());
        if line.contains("Page") {
            state.label = None;
        }
        state.line(&line);
        let is_window = line.starts_with(['\t', ' '])
            && line
                .split_whitespace()
                .next()
                .is_some_and(|word| word.parse::<u32>().is_ok());
        if state.label.is_some() && is_window {
            let notes = state.window(&mut lines, &mut frame)?;
            if state.give(&mut frame, notes, sink) {
                break;
            }
        }
    }
    if state.label.is_some() {
        let message = "ends before the values of a picture";
        return Err(RecordingError::in_line(lines.number() + 1, message));
    }
    Ok(())
}

/// The line above a window: the numbers of its columns, and `Force` if each row ends in its sum.
/// ```text
///          21      22      23     Force
/// 45     0.00   12.50    7.50      2.00
/// Force  0.00    1.25    0.75      2.00
/// ```
struct EmedHeading {
    /// The column of the whole sensor that the window begins at.
    first_column: u32,
    /// Columns of the window.
    columns: u16,
    /// Whether rows have a sum, and a line of sums follows them.
    has_force: bool,
}

impl EmedHeading {
    /// Reads the heading in line `number`.
    ///
    /// # Errors
    /// If its numbers do not follow one another, or are more than a frame has columns.
    fn of(line: &str, number: u64) -> Result<Self, RecordingError> {
        let words: Vec<&str> = line.split_whitespace().collect();
        let has_force = words.last() == Some(&"Force");
        let numbers = &words[..words.len() - usize::from(has_force)];
        let first = numbers.first().and_then(|first| first.parse::<u32>().ok());
        let first = first.filter(|&first| {
            let mut expected = (u64::from(first)..).zip(numbers);
            expected.all(|(number, word)| word.parse() == Ok(number))
        });
        let Some((first_column, columns)) = first.zip(side(numbers.len())) else {
            let message = "expected the numbers of columns, one after the other";
            return Err(RecordingError::in_line(number, message));
        };
        Ok(Self {
            first_column,
            columns,
            has_force,
        })
    }

    /// Goes to the next row of the window; false at its end: the line of forces, or without them an empty line.
    ///
    /// # Errors
    /// If the window ends before its first row, or without its line of forces.
    fn next_row(
        &self,
        lines: &mut TextLines<impl BufRead>,
        rows: u16,
    ) -> Result<bool, RecordingError> {
        let content = lines.advance()? && !lines.line().trim_ascii().is_empty();
        if content && !lines.line().starts_with(b"Force") {
            return Ok(true);
        }
        if self.has_force && !content || rows == 0 {
            let message = "the picture ends here, expected more rows, then their Force";
            return Err(RecordingError::in_line(lines.number(), message));
        }
        Ok(false)
    }
}

/// The number that follows a word.
/// `Time/picture:10.0 ms` has 10 behind `Time/picture:`; the number ends at the first character that is not a digit or
/// point.
fn after(line: &str, word: &str) -> Option<f64> {
    let rest = line.split_once(word)?.1.trim_start();
    let end = rest.find(|character: char| !character.is_ascii_digit() && character != '.');
    number::read(&rest.as_bytes()[..end.unwrap_or(rest.len())])
}

impl EmedState {
    /// Takes from a header line what it says; there may be several things in one line.
    fn line(&mut self, line: &str) {
        if let Some(area) = after(line, "Sensor area:") {
            self.area_cm2 = Some(area);
        }
        if let Some(time) = after(line, "Time/picture:") {
            let factor = if line.contains("ms") { 1e-3 } else { 1.0 };
            self.seconds = Some(time * factor).filter(|&seconds| seconds > 0.0);
        }
        if let (Some(x), Some((_, rest))) = (
            after(line, "Sensor size:"),
            line.split_once("Sensor size:")
                .and_then(|(_, rest)| rest.split_once('x')),
        ) {
            let factor = if rest.contains("mm") { 1.0 } else { 10.0 };
            let y = after(&format!(":{rest}"), ":");
            self.pitch_mm = y.map(|y| [x * factor, y * factor]);
        }
        if let Some(label) = after(line, "Pict-No.:") {
            #[expect(clippy::cast_possible_truncation, reason = "the number of a picture")]
            let label = label as i64;
            self.label = Some(label);
        }
    }

    /// Reads the window below the line of column numbers. Returns sums that do not hold.
    ///
    /// # Errors
    /// If columns or rows are not numbered one after the other, or the window ends before the line of forces.
    fn window(
        &self,
        lines: &mut TextLines<impl BufRead>,
        frame: &mut Frame,
    ) -> Result<Vec<RecordingNote>, RecordingError> {
        let heading = EmedHeading::of(&text(lines.line()), lines.number())?;
        let columns = usize::from(heading.columns);
        let mut fields = vec![0.0; columns + 1 + usize::from(heading.has_force)];
        let (mut values, mut forces, mut first_row) = (Vec::new(), Vec::new(), 0);
        let mut rows = 0_u16;
        while heading.next_row(lines, rows)? {
            let (line, number) = (lines.line(), lines.number());
            text_row::fill(
                &mut fields,
                Separator::Byte(b'\t').split(line),
                number,
                |field| match text_row::value(field) {
                    Field::NoCell => Field::Wrong,
                    field => field,
                },
            )?;
            if rows == 0 {
                #[expect(
                    clippy::cast_possible_truncation,
                    clippy::cast_sign_loss,
                    reason = "saturates; the next row would not follow it"
                )]
                let first = fields[0] as u32;
                first_row = first;
            }
            let (found, expected) = (fields[0], f64::from(first_row) + f64::from(rows));
            if found != expected {
                let message = format!("found row {found}, expected row {expected}");
                return Err(RecordingError::in_field(number, 1, message));
            }
            if rows == MAX_FRAME_SIDE {
                let message = format!("more than {MAX_FRAME_SIDE} rows");
                return Err(RecordingError::in_line(number, message));
            }
            rows += 1;
            values.extend_from_slice(&fields[1..=columns]);
            forces.extend(fields.get(columns + 1).copied());
        }
        frame.reset(heading.columns, rows);
        frame.values_mut().copy_from_slice(&values);
        frame.first = Some((first_row, heading.first_column));
        frame.number = self.frames;
        frame.label = self.label;
        Ok(self.sums(frame, &forces))
    }

    /// The forces of rows that are not those of the values.
    /// A force has two decimals, and so has each value it is the sum of: the difference may be half of the last digit
    /// for each.
    fn sums(&self, frame: &Frame, stated: &[f64]) -> Vec<RecordingNote> {
        let Some(area) = self.area_cm2 else {
            return Vec::new();
        };
        let rows = frame.values().chunks(frame.columns().into());
        let note = |(row, &stated): (&[f64], &f64)| {
            let found = row.iter().sum::<f64>() * area * NEWTON;
            let rounding =
                ROUNDING * (1.0 + f64::from(frame.columns()) * area * NEWTON) + 1e-9 * found.abs();
            ((found - stated).abs() > rounding).then_some(RecordingNote::Checksum {
                frame: frame.number,
                label: frame.label,
                what: "the force of a row",
                stated,
                found,
            })
        };
        rows.zip(stated).filter_map(note).collect()
    }

    /// Gives the frame; true if no more is wanted.
    fn give(&mut self, frame: &mut Frame, notes: Vec<RecordingNote>, sink: &mut Sink<'_>) -> bool {
        if self.frames == 0 {
            let info = ChannelInfo {
                shape: Some((frame.rows(), frame.columns())),
                unit: Some("kPa".to_owned()),
                seconds_per_frame: self.seconds,
                pitch_mm: self.pitch_mm,
                ..ChannelInfo::default()
            };
            if sink(RecordingEvent::Channel(&info)).is_break() {
                return true;
            }
        }
        #[expect(clippy::cast_precision_loss, reason = "fewer than 2^52 pictures")]
        let number = self.frames as f64;
        frame.time = self.seconds.map(|seconds| to_nanoseconds(seconds * number));
        self.frames += 1;
        self.label = None;
        for note in notes {
            if sink(RecordingEvent::Note(&note)).is_break() {
                return true;
            }
        }
        sink(RecordingEvent::Frame(frame)).is_break()
    }
}
