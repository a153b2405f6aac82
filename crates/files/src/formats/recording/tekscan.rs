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

use std::collections::HashMap;
use std::io::BufRead;

use taxel_core::frame::{Frame, FrameSize, Label};
use taxel_core::parameter::number::{counted, short, to_decimals};
use taxel_core::quote::shortened;

use crate::error::ReadError;
use crate::formats::recording::error::in_line;
use crate::formats::recording::event::{ChannelInfo, RecordingNote, Sink, Stop};
use crate::formats::recording::size::{pitch_in_mm, stated};
use crate::formats::recording::text::{
    self, Separator, TextLines, decimal, is_blank, read_number, text, unpadded,
};
use crate::formats::recording::time;
use crate::formats::seconds::{of_label, since};

/// The largest difference between two sums that is not an error.
const ROUNDING: f64 = 0.5;

/// The keys whose first value counts.
const KEYS: [&str; 6] = [
    "ROWS",
    "COLS",
    "ROW_SPACING",
    "COL_SPACING",
    "SECONDS_PER_FRAME",
    "TIME",
];

/// Reads the header, up to the line before the frames.
fn header<R: BufRead>(lines: &mut TextLines<R>) -> Result<(FrameSize, ChannelInfo), ReadError> {
    let mut first = HashMap::new();
    let mut info = ChannelInfo::default();
    // Whether the unit is above `COMMENTS`; None before these.
    let mut has_unit = None;
    loop {
        if !lines.advance()? {
            let message = "the header has no end, expected a line 'ASCII_DATA @@'";
            return Err(ReadError::new(message));
        }
        let line = text(unpadded(lines.line()));
        let rest = line.strip_prefix("ASCII_DATA");
        if rest.is_some_and(|rest| rest.trim_start().starts_with("@@")) {
            break;
        }
        // The key ends at a blank, or at a comma that a spreadsheet program put there.
        let is_end = |sign: char| sign.is_ascii_whitespace() || sign == ',';
        let (key, value) = line.split_once(is_end).unwrap_or((&line, ""));
        let value = value.trim_matches(is_end);
        match key {
            "UNITS" if has_unit != Some(true) => {
                info.unit = Some(value.to_owned()).filter(|unit| !unit.is_empty());
            }
            "COMMENTS" | "COMMENTS:" => _ = has_unit.get_or_insert(info.unit.is_some()),
            _ => {
                if let Some(known) = KEYS.into_iter().find(|&known| known == key) {
                    let value = || (value.to_owned(), lines.number);
                    first.entry(known).or_insert_with(value);
                }
            }
        }
    }
    let side = |key| {
        first
            .get(key)
            .map(|(value, line)| stated(key, ' ', value, *line))
    };
    let (columns, rows) = (side("COLS").transpose()?, side("ROWS").transpose()?);
    let size = FrameSize::of_sides(columns, rows)
        .ok_or_else(|| in_line(lines.number, "the header has no ROWS or no COLS"))?;
    info.size = Some(size);
    let value = |key| first.get(key).map(|(value, _)| &**value);
    info.start = value("TIME").map(str::to_owned);
    let step = value("SECONDS_PER_FRAME").and_then(|step| decimal(step.as_bytes()));
    info.seconds_per_frame = step.and_then(time::step);
    let pitches = value("COL_SPACING")
        .and_then(spacing)
        .zip(value("ROW_SPACING").and_then(spacing));
    info.pitch_mm = pitches.map(|(x, y)| [x, y]);
    Ok((size, info))
}

/// Reads a distance between cells with its unit, in mm: `1.27 mm`, `0.5 centimeters`, `1.27e-003 meters` or
/// `0.05 in.`; the decimal sign may be a comma. None without a unit, since it may be any, so the pitch stays unknown.
fn spacing(value: &str) -> Option<f64> {
    let end = value.rfind(|sign: char| sign.is_ascii_digit())? + 1;
    let (length, unit) = value.split_at(end);
    let length = decimal(length.as_bytes())?;
    pitch_in_mm(length, unit.trim())
}

pub(crate) fn read(input: &mut dyn BufRead, sink: &mut Sink<'_>) -> Result<(), Stop> {
    let mut lines = TextLines::new(input);
    let (size, info) = header(&mut lines)?;
    let channel = sink.channel(None, || info.clone())?;
    let unit = info.unit.as_deref();
    let is_raw = unit.is_some_and(|unit| unit.eq_ignore_ascii_case("raw"));
    let mut frame = Frame::new(size);
    let (mut first, mut start) = (None, None);
    for number in 0.. {
        if !lines.advance_to_content()? {
            let message = "ends here, expected another frame or '@@'";
            return Err(in_line(lines.number + 1, message).into());
        }
        if lines.line().trim_ascii_start().starts_with(b"@@") {
            break;
        }
        let title = title(lines.line(), lines.number)?;
        frame.label = Some(Label::Number(title.label));
        let by_label = of_label(title.label, &mut first, info.seconds_per_frame);
        // If earlier titles have no time, the first one that has counts from the first frame by its label.
        let stated = title.time.map(|time| {
            let start = *start.get_or_insert_with(|| by_label.map_or(time, |label| time - label));
            since(start, time)
        });
        frame.time = stated.or(by_label);
        values(&mut lines, &mut frame)?;
        let values = frame.values().iter().filter(|value| !value.is_nan());
        let found: f64 = values.sum();
        // The sum is that of the sensor's own numbers, whatever the unit of the export.
        let stated = title
            .sum
            .filter(|stated| is_raw && (found - stated).abs() > ROUNDING);
        if let Some(stated) = stated {
            let label = frame
                .label
                .as_ref()
                .map(|label| format!(" (label {label})"));
            let label = label.unwrap_or_default();
            // A sum of decimals has a rounding error in its last digits.
            let [stated, found] = [stated, to_decimals(found, 9)].map(short);
            sink.note(&RecordingNote::Oddity(format!(
                "frame {number}{label}: Raw Sum should be {stated}, but the values give {found}"
            )))?;
        }
        sink.frame(channel, &mut frame)?;
    }
    Ok(())
}

/// Reads the rows of a frame, which follow its title without an empty line. `B` and `b` mean that there is no cell.
fn values<R: BufRead>(lines: &mut TextLines<R>, frame: &mut Frame) -> Result<(), ReadError> {
    let (rows, columns) = (frame.rows(), frame.columns());
    for row in frame.values_mut().chunks_mut(columns.into()) {
        let is_end = !lines.advance()?;
        if is_end || is_blank(lines.line()) {
            let message = format!("the frame ends here, expected {}", counted(rows, "row"));
            return Err(in_line(lines.number + u64::from(is_end), message));
        }
        let fields = Separator::Byte(b',').split(lines.line());
        text::fill_row(row, fields, lines.number, |field| match field {
            b"B" | b"b" => Some(f64::NAN),
            field => text::read_value(field),
        })?;
    }
    Ok(())
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
    let line = text(unpadded(line));
    let mut fields = line.split(',').map(str::trim);
    let first = fields.next().unwrap_or("");
    let label = first
        .strip_prefix("Frame")
        .map(|label| label.trim().parse());
    let Some(Ok(label)) = label else {
        let found = shortened(first);
        let message = format!("found {found:?}, expected 'Frame' and its number, or '@@'");
        return Err(in_line(number, message));
    };
    let number = |field: &str| read_number(field.as_bytes());
    let time = fields.next().and_then(number);
    let mut sum = fields
        .skip_while(|field| !field.starts_with("Raw Sum"))
        .skip(1);
    let sum = sum.find(|field| !field.is_empty()).and_then(number);
    Ok(FrameTitle { label, time, sum })
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
            ("1.27e-003 meters", Some(1.27)),
            ("1.27E-3m", Some(1.27)),
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
            assert_eq!(spacing(text), expected, "{text}");
        }
    }
}
