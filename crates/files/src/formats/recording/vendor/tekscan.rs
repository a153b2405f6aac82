//! Tekscan's ASCII export (I-Scan, F-Scan): a header of keys, then the frames, row by row.
//!
//! `COMMENTS` may run over several lines that look like keys or frames. Keys above the comments count where they
//! first occur, so `ROWS`, `COLS` and others are taken from their first line; `UNITS` is usually below the comments, so
//! its last line counts, unless there is one above them. Frames begin only after `ASCII_DATA @@`. Spreadsheet programs
//! add a byte order mark and pad lines with commas. `B` means that the sensor has no cell there.
//! ```text
//! DATA_TYPE MOVIE
//! ROWS 28
//! COLS 28
//! ROW_SPACING 1.27 mm
//! SECONDS_PER_FRAME 0.1
//! UNITS kPa
//! ASCII_DATA @@
//! Frame 1
//! 0,0,12,B,…
//! …
//!
//! @@
//! ```
//! The title of a frame may have more fields: `Frame 2, 0.1,, date time,,,Raw Sum=,,307` gives its time in seconds,
//! which is counted from the first frame, and the sum of its raw values, which is checked if the values are raw. Other
//! keys are ignored; `NOISE_THRESHOLD` is one of them, since it says what was cut off while recording, not what counts
//! as touched. Source: exports of I-Scan and F-Scan.

use crate::formats::recording::error::in_line;
use std::io::BufRead;

use taxel_core::frame::{Frame, FrameSize};
use taxel_core::parameter::number::counted;
use taxel_core::quote::shortened;

use crate::error::ReadError;
use crate::formats::recording::event::{ChannelInfo, RecordingEvent, RecordingNote, Sink, Stop};
use crate::formats::recording::size::{LengthUnit, stated};
use crate::formats::recording::text::{
    self, Field, Separator, TextLines, decimal, is_blank, text, unpadded,
};
use crate::formats::recording::time::TimeUnit;
use crate::formats::seconds::{of_label, since};

/// The largest difference between two sums that is not an error.
const ROUNDING: f64 = 0.5;

/// The content of the header; of each key the first value counts, except that the last `UNITS` counts if none is above
/// the comments.
#[derive(Default)]
struct TekscanHeader {
    /// `ROWS`.
    rows: Option<u16>,
    /// `COLS`.
    columns: Option<u16>,
    /// `ROW_SPACING` in mm: the distance along y.
    row_spacing: Option<f64>,
    /// `COL_SPACING` in mm: the distance along x.
    column_spacing: Option<f64>,
    info: ChannelInfo,
    /// Whether the unit is above `COMMENTS`; None before these.
    has_unit: Option<bool>,
}

impl TekscanHeader {
    /// Reads a line `KEY value`. The key ends at a blank, or at a comma that a spreadsheet program put there.
    fn line(&mut self, line: &[u8], number: u64) -> Result<(), ReadError> {
        let is_end = |byte: &u8| byte.is_ascii_whitespace() || *byte == b',';
        let end = line.iter().position(is_end);
        let (key, value) = line.split_at(end.unwrap_or(line.len()));
        let value = value.trim_ascii();
        let value = value.strip_prefix(b",").unwrap_or(value).trim_ascii();
        let side = || stated(&text(key), ' ', &text(value), number);
        match key {
            b"ROWS" if self.rows.is_none() => self.rows = Some(side()?),
            b"COLS" if self.columns.is_none() => self.columns = Some(side()?),
            b"ROW_SPACING" if self.row_spacing.is_none() => self.row_spacing = spacing(value),
            b"COL_SPACING" if self.column_spacing.is_none() => {
                self.column_spacing = spacing(value);
            }
            b"SECONDS_PER_FRAME" if self.info.seconds_per_frame.is_none() => {
                if let Field::Value(seconds) = decimal(value) {
                    self.info.seconds_per_frame = TimeUnit::Seconds.step_in_seconds(seconds);
                }
            }
            b"UNITS" if self.has_unit != Some(true) => {
                self.info.unit = Some(text(value)).filter(|unit| !unit.is_empty());
            }
            b"COMMENTS" | b"COMMENTS:" => {
                self.has_unit.get_or_insert(self.info.unit.is_some());
            }
            b"TIME" if self.info.start.is_none() => self.info.start = Some(text(value)),
            _ => {}
        }
        Ok(())
    }
}

/// Reads a distance between cells with its unit, in mm: `1.27 mm`, `0.5 centimeters`, `1.27e-003 meters` or
/// `0.05 in.`; the decimal sign may be a comma. None without a unit, since it may be any, so the pitch stays unknown.
fn spacing(value: &[u8]) -> Option<f64> {
    let value = text(value);
    let value = value.trim();
    // The unit begins with the first letter that is not part of an exponent.
    let is_exponent = |at: usize| {
        value[at..].starts_with(['e', 'E'])
            && value[at + 1..].starts_with(['+', '-', '0', '1', '2', '3'])
    };
    let mut letters = value
        .char_indices()
        .filter(|(_, letter)| letter.is_alphabetic());
    let (end, _) = letters.find(|&(at, _)| !is_exponent(at))?;
    let (length, unit) = value.split_at(end);
    let Field::Value(length) = decimal(length.trim_end().as_bytes()) else {
        return None;
    };
    LengthUnit::of_name(unit)?.pitch_in_mm(length)
}

pub(in crate::formats::recording) fn read(
    input: impl BufRead,
    sink: &mut Sink<'_>,
) -> Result<(), Stop> {
    let mut lines = TextLines::new(input);
    let mut header = TekscanHeader::default();
    loop {
        if !lines.advance()? {
            let message = "the header has no end, expected a line 'ASCII_DATA @@'";
            return Err(ReadError::new(message).into());
        }
        let line = unpadded(lines.line());
        let rest = line.strip_prefix(b"ASCII_DATA");
        if rest.is_some_and(|rest| rest.trim_ascii_start().starts_with(b"@@")) {
            break;
        }
        header.line(line, lines.number())?;
    }
    let Some(size) = FrameSize::of_sides(header.columns, header.rows) else {
        let message = "the header has no ROWS or no COLS";
        return Err(in_line(lines.number(), message).into());
    };
    let mut info = header.info;
    info.size = Some(size);
    info.pitch_mm = header
        .column_spacing
        .zip(header.row_spacing)
        .map(|(x, y)| [x, y]);
    sink.event(RecordingEvent::Channel(&info))?;
    frames(&mut lines, size, &info, sink)
}

/// Reads the frames below the header, up to `@@`.
fn frames(
    lines: &mut TextLines<impl BufRead>,
    size: FrameSize,
    info: &ChannelInfo,
    sink: &mut Sink<'_>,
) -> Result<(), Stop> {
    let mut frame = Frame::new(size);
    let is_raw = |unit: &String| unit.eq_ignore_ascii_case("raw");
    let is_raw = info.unit.as_ref().is_some_and(is_raw);
    let (mut first, mut start) = (None, None);
    for number in 0.. {
        if !lines.advance_to_content()? {
            let message = "ends here, expected another frame or '@@'";
            return Err(in_line(lines.number() + 1, message).into());
        }
        if lines.line().trim_ascii_start().starts_with(b"@@") {
            break;
        }
        let title = title(lines.line(), lines.number())?;
        frame.reset(size);
        frame.number = number;
        frame.label = Some(title.label.into());
        let by_label = of_label(title.label, &mut first, info.seconds_per_frame);
        // If earlier titles have no time, the first one that has counts from the first frame by its label.
        let stated = title.time.map(|time| {
            let start = *start.get_or_insert_with(|| by_label.map_or(time, |label| time - label));
            since(start, time)
        });
        frame.time = stated.or(by_label);
        values(lines, &mut frame)?;
        let sum = title.sum.filter(|_| is_raw);
        if let Some(note) = sum.and_then(|sum| odd_sum(&frame, sum)) {
            sink.event(RecordingEvent::Note(&note))?;
        }
        sink.event(RecordingEvent::Frame(&frame))?;
    }
    Ok(())
}

/// Reads the rows of a frame, which follow its title without an empty line. `B` and `b` mean that there is no cell.
fn values(lines: &mut TextLines<impl BufRead>, frame: &mut Frame) -> Result<(), ReadError> {
    let (rows, columns) = (frame.rows(), frame.columns());
    for row in frame.values_mut().chunks_mut(columns.into()) {
        let is_end = !lines.advance()?;
        if is_end || is_blank(lines.line()) {
            let message = format!("the frame ends here, expected {}", counted(rows, "row"));
            let number = lines.number() + u64::from(is_end);
            return Err(in_line(number, message));
        }
        let (line, number) = (lines.line(), lines.number());
        let fields = Separator::Byte(b',').split(line);
        text::fill_row(row, fields, number, |field| match field {
            b"B" | b"b" => Field::NoCell,
            field => text::read_value(field),
        })?;
    }
    Ok(())
}

/// Returns a note if the title of a frame states another sum than that of its values. Only raw values can be
/// compared: the sum is that of the sensor's own numbers, whatever the unit of the export.
fn odd_sum(frame: &Frame, stated: f64) -> Option<RecordingNote> {
    let values = frame.values().iter().filter(|value| !value.is_nan());
    let found: f64 = values.sum();
    ((found - stated).abs() > ROUNDING).then_some(RecordingNote::Checksum {
        frame: frame.number,
        label: frame.label.clone(),
        what: "Raw Sum",
        stated,
        found,
    })
}

struct FrameTitle {
    /// The number after `Frame`, from 1.
    label: i64,
    /// The time in seconds, if it is given; otherwise it follows from the time step in the header.
    time: Option<f64>,
    /// `Raw Sum`: the sum of the sensor's own numbers.
    sum: Option<f64>,
}

/// Reads `Frame 2` or `Frame 2, 0.1,, date time,,,Raw Sum=,,307`.
fn title(line: &[u8], number: u64) -> Result<FrameTitle, ReadError> {
    let line = unpadded(line);
    let mut fields = line.split(|&byte| byte == b',').map(<[u8]>::trim_ascii);
    let first = fields.next().unwrap_or(b"");
    let label = first.strip_prefix(b"Frame").map(<[u8]>::trim_ascii);
    let label = label.and_then(|label| str::from_utf8(label).ok()?.parse().ok());
    let label = label.ok_or_else(|| {
        let found = shortened(&text(first));
        in_line(
            number,
            format!("found {found:?}, expected 'Frame' and its number, or '@@'"),
        )
    })?;
    let time = fields.next().and_then(text::read_number);
    let sum = fields
        .skip_while(|field| !field.starts_with(b"Raw Sum"))
        .skip(1)
        .find(|field| !field.is_empty());
    Ok(FrameTitle {
        label,
        time,
        sum: sum.and_then(text::read_number),
    })
}

#[cfg(test)]
mod tests {
    use super::spacing;

    #[test]
    fn a_spacing_has_a_unit() {
        for (text, expected) in [
            ("1.27 mm", Some(1.27)),
            ("1.27mm", Some(1.27)),
            ("0.05 in.", Some(1.27)),
            ("0.05inches", Some(1.27)),
            ("1270 um", Some(1.27)),
            ("1270 \u{b5}m", Some(1.27)),
            ("1.27e-003 meters", Some(1.27)),
            ("1.27E-3m", Some(1.27)),
            ("0.127 cm", Some(1.27)),
            ("0,5 cm", Some(5.0)),
            ("0.57 cm", Some(5.7)),
            ("1e-13 m", None),
            ("1e308 in", None),
            ("1.27", None),
            ("1.27 furlongs", None),
            ("-1 mm", None),
            ("mm", None),
            ("", None),
        ] {
            assert_eq!(spacing(text.as_bytes()), expected, "{text}");
        }
    }
}
