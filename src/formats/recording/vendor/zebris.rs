//! The zebris `.apd` format: INI sections, then one or more pictures with fields separated by tabs; -1 where nothing
//! was recorded.
//!
//! `SensCountX` counts the lines and `SensCountY` the values of a line, so the file's x points down and its y to the
//! right.
//! ```text
//! [General]
//! Date=25/04/2017
//! UnitDistance=mm
//! UnitPressure=N/cm2
//! [Technical]
//! SensCountX=32
//! SensCountY=15
//! LDistX=8.46591
//! LDistY=8.46591
//! [Data]
//! -1    -1    1.0    3.0    …
//! ```
//! The pictures of a step are numbered (`[Data12]`, `[Data13]`, …) and lie `TimeDiff` apart, in `UnitTime`. `[Data]`
//! is then their maximum, which is not a frame and is left out; a file with `[Data]` alone is a single picture. The
//! names of other sections do not matter, since all keys differ. A value below 0 other than -1 is a value. Source:
//! pedcad import files of zebris.

use std::io::BufRead;

use crate::formats::recording::error::RecordingError;
use crate::formats::recording::event::{
    ChannelInfo, EarlyEnd, RecordingEvent, RecordingNote, Sink,
};
use crate::formats::recording::length::{LengthUnit, pitches_in_mm};
use crate::formats::recording::side::stated;
use crate::formats::recording::text::lines::{TextLines, text};
use crate::formats::recording::text::number;
use crate::formats::recording::text::row::{self, Field};
use crate::formats::recording::text::separator::Separator;
use crate::formats::recording::time::field_role::time_unit;
use crate::formats::recording::time::unit::TimeUnit;
use crate::formats::seconds::of_label;
use crate::frame::{Frame, FrameSize};
use crate::parameter::number::counted;

/// The header above the values.
#[derive(Default)]
struct ZebrisHeader {
    /// `SensCountX`.
    rows: Option<u16>,
    /// `SensCountY`.
    columns: Option<u16>,
    /// `LDistX`: the distance between lines.
    row_distance: Option<f64>,
    /// `LDistY`: the distance between the values of a line.
    column_distance: Option<f64>,
    /// `UnitDistance`.
    distance_unit: Option<LengthUnit>,
    /// `UnitPressure`.
    unit: Option<String>,
    /// `Date`, as it is written.
    date: Option<String>,
    /// `Time`, as it is written.
    time: Option<String>,
    /// `TimeDiff`: the time from one picture to the next.
    time_difference: Option<f64>,
    /// `UnitTime`.
    time_unit: Option<TimeUnit>,
    /// `MinIdx`: the number of the first picture.
    first: Option<i64>,
    /// `MaxIdx`: the number of the last picture.
    last: Option<i64>,
}

impl ZebrisHeader {
    /// Reads the lines up to the first section of values; returns that, too.
    ///
    /// # Errors
    /// Returns an error if there is no such section, or if a key in the header has a wrong value.
    fn read(lines: &mut TextLines<impl BufRead>) -> Result<(Self, ZebrisSection), RecordingError> {
        let mut header = Self::default();
        while lines.advance()? {
            let line = text(lines.line());
            if let Some(section) = ZebrisSection::of(&line) {
                return Ok((header, section));
            }
            header.line(&line, lines.number())?;
        }
        let message = "ends without values, expected a section [Data]";
        Err(RecordingError::damaged(message))
    }

    /// Reads a line `key=value`; other lines are ignored.
    ///
    /// # Errors
    /// Returns an error if a frame cannot have this number of rows or columns.
    fn line(&mut self, line: &str, number: u64) -> Result<(), RecordingError> {
        let Some((key, value)) = line.split_once('=') else {
            return Ok(());
        };
        let value = value.trim();
        let side = || stated(key, '=', value, number);
        let read = || number::read(value.as_bytes());
        match key.trim() {
            "SensCountX" => self.rows = Some(side()?),
            "SensCountY" => self.columns = Some(side()?),
            "LDistX" => self.row_distance = read(),
            "LDistY" => self.column_distance = read(),
            "UnitDistance" => self.distance_unit = LengthUnit::of_name(value),
            "UnitPressure" => self.unit = Some(value.to_owned()),
            "Date" => self.date = Some(value.to_owned()),
            "Time" => self.time = Some(value.to_owned()),
            "TimeDiff" => self.time_difference = read(),
            "UnitTime" => self.time_unit = time_unit(&value.to_lowercase()),
            "MinIdx" => self.first = value.parse().ok(),
            "MaxIdx" => self.last = value.parse().ok(),
            _ => {}
        }
        Ok(())
    }

    /// Returns the channel that the header describes; without a unit of length it has no pitch.
    fn info(&self) -> ChannelInfo {
        ChannelInfo {
            size: FrameSize::of_sides(self.columns, self.rows),
            unit: self.unit.clone(),
            start: match (&self.date, &self.time) {
                (Some(date), Some(time)) => Some(format!("{date} {time}")),
                (date, time) => date.clone().or(time.clone()),
            },
            seconds_per_frame: self
                .time_difference
                .zip(self.time_unit)
                .and_then(|(step, unit)| unit.step_in_seconds(step)),
            pitch_mm: self
                .distance_unit
                .and_then(|unit| pitches_in_mm([self.column_distance, self.row_distance], unit)),
            ..ChannelInfo::default()
        }
    }

    /// Returns a note if there are fewer pictures than `MinIdx` and `MaxIdx` count.
    fn cut(&self, frames: u64) -> Option<RecordingNote> {
        let counted = self.last?.checked_sub(self.first?)?.checked_add(1)?;
        let counted = u64::try_from(counted).ok()?;
        let records = frames;
        (records < counted).then_some(RecordingNote::Cut { records, counted })
    }
}

/// A section of values.
#[derive(Clone, Copy)]
enum ZebrisSection {
    /// `[Data]`: the only picture, or the maximum of the numbered ones.
    Data,
    /// `[Data12]`: the picture of that number.
    Picture(i64),
}

impl ZebrisSection {
    /// Returns the section that a line begins; None for any other line.
    fn of(line: &str) -> Option<Self> {
        let name = line.trim().strip_prefix('[')?.strip_suffix(']')?;
        match name.to_ascii_lowercase().strip_prefix("data")? {
            "" => Some(Self::Data),
            number => number.parse().ok().map(Self::Picture),
        }
    }
}

/// Reads a recording.
///
/// # Errors
/// Returns an error if a picture has fewer or more lines of values than `SensCountX` says, or if there are two sections
/// `[Data]`; then the picture above is reported before the error.
pub(in crate::formats::recording) fn read(
    input: impl BufRead,
    sink: &mut Sink<'_>,
) -> Result<(), EarlyEnd> {
    let mut lines = TextLines::new(input);
    let (header, mut section) = ZebrisHeader::read(&mut lines)?;
    let info = header.info();
    let Some(size) = info.size else {
        let message = "no SensCountX or no SensCountY before the values";
        return Err(RecordingError::in_line(lines.number(), message).into());
    };
    sink(RecordingEvent::Channel(&info))?;
    let mut frame = Frame::new(size);
    let (mut first, mut has_maximum) = (None, false);
    loop {
        values(&mut lines, &mut frame)?;
        let is_data = matches!(section, ZebrisSection::Data);
        let next = match next_section(&mut lines, size.rows()) {
            Ok(Some(ZebrisSection::Data)) if is_data || has_maximum => {
                let message = "a second section [Data], expected a numbered one such as [Data12]";
                Err(RecordingError::in_line(lines.number(), message))
            }
            next => next,
        };
        let is_only = frame.number == 0 && !matches!(next, Ok(Some(_)));
        if is_data && !is_only {
            has_maximum = true;
            sink(RecordingEvent::Note(&RecordingNote::Maximum))?;
        } else {
            frame.label = Some(1);
            if let ZebrisSection::Picture(label) = section {
                frame.label = Some(label);
                frame.time = of_label(label, &mut first, info.seconds_per_frame);
            }
            sink(RecordingEvent::Frame(&frame))?;
            frame.number += 1;
        }
        match next? {
            Some(next) => section = next,
            None => break,
        }
    }
    if let Some(note) = header.cut(frame.number).filter(|_| first.is_some()) {
        sink(RecordingEvent::Note(&note))?;
    }
    Ok(())
}

/// Reads the values of a picture.
///
/// # Errors
/// Returns an error if there are fewer lines than the frame has rows, or if a line has another number of values.
fn values(lines: &mut TextLines<impl BufRead>, frame: &mut Frame) -> Result<(), RecordingError> {
    let (rows, columns) = (frame.rows(), frame.columns());
    for row in frame.values_mut().chunks_mut(columns.into()) {
        if !lines.advance_to_content()? {
            let rows = counted(rows, "line");
            let message = format!("ends inside the frame, expected {rows} of values");
            return Err(RecordingError::in_line(lines.number() + 1, message));
        }
        let fields = Separator::Byte(b'\t').split(lines.line());
        row::fill(row, fields, lines.number(), |field| {
            match row::value(field) {
                Field::Value(-1.0) => Field::NoCell,
                field => field,
            }
        })?;
    }
    Ok(())
}

/// Moves to the next section of values; None at the end of the file.
///
/// # Errors
/// Returns an error if there are more lines of values in the current section.
fn next_section(
    lines: &mut TextLines<impl BufRead>,
    rows: u16,
) -> Result<Option<ZebrisSection>, RecordingError> {
    let mut is_first = true;
    while lines.advance_to_content()? {
        let found = ZebrisSection::of(&text(lines.line()));
        if found.is_some() {
            return Ok(found);
        }
        if std::mem::take(&mut is_first) && !lines.line().starts_with(b"[") {
            let rows = counted(rows, "line");
            let message = format!("more values, expected {rows} of them as SensCountX says");
            return Err(RecordingError::in_line(lines.number(), message));
        }
    }
    Ok(None)
}
