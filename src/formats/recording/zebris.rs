//! A zebris `.apd` picture: INI sections, then the values, parted by tabs; -1 where nothing was recorded.
//!
//! `SensCountX` counts the lines and `SensCountY` the values of a line, so the file's x is down and its y to the right.
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
//! One file is one picture. Sections are not told apart: their keys differ. A value below 0 other than -1 is a value.
//! Source: pedcad import files of zebris.

use std::io::BufRead;

use crate::formats::recording::error::RecordingError;
use crate::formats::recording::event::{ChannelInfo, RecordingEvent, Sink};
use crate::formats::recording::lines::{TextLines, text};
use crate::formats::recording::number;
use crate::formats::recording::separator::Separator;
use crate::formats::recording::side::stated;
use crate::formats::recording::text_row::{self, Field};
use crate::frame::Frame;
use crate::parameter::number::counted;

/// What stands above the values.
#[derive(Default)]
struct ZebrisHeader {
    /// `SensCountX`.
    rows: Option<u16>,
    /// `SensCountY`.
    columns: Option<u16>,
    /// `LDistX`: from a line to the next.
    row_distance: Option<f64>,
    /// `LDistY`: from a value of a line to the next.
    column_distance: Option<f64>,
    /// Millimetres a unit of distance.
    factor: Option<f64>,
    /// `UnitPressure`.
    unit: Option<String>,
    /// `Date`, as it is written.
    date: Option<String>,
    /// `Time`, as it is written.
    time: Option<String>,
}

impl ZebrisHeader {
    /// Takes what a line `key=value` says; other lines say nothing.
    ///
    /// # Errors
    /// If a count is none that a frame can have.
    fn line(&mut self, line: &str, number: u64) -> Result<(), RecordingError> {
        let Some((key, value)) = line.split_once('=') else {
            return Ok(());
        };
        let value = value.trim();
        let side = || stated(key, '=', value, number);
        let positive = || number::read(value.as_bytes()).filter(|&value| value > 0.0);
        match key.trim() {
            "SensCountX" => self.rows = Some(side()?),
            "SensCountY" => self.columns = Some(side()?),
            "LDistX" => self.row_distance = positive(),
            "LDistY" => self.column_distance = positive(),
            "UnitDistance" => {
                self.factor = match value.to_ascii_lowercase().as_str() {
                    "mm" => Some(1.0),
                    "cm" => Some(10.0),
                    _ => None,
                };
            }
            "UnitPressure" => self.unit = Some(value.to_owned()),
            "Date" => self.date = Some(value.to_owned()),
            "Time" => self.time = Some(value.to_owned()),
            _ => {}
        }
        Ok(())
    }

    /// What the header says of the channel; without a unit of length there is no pitch.
    fn info(&self) -> ChannelInfo {
        let distances = self.column_distance.zip(self.row_distance);
        ChannelInfo {
            shape: self.rows.zip(self.columns),
            unit: self.unit.clone(),
            start: match (&self.date, &self.time) {
                (Some(date), Some(time)) => Some(format!("{date} {time}")),
                (date, time) => date.clone().or(time.clone()),
            },
            pitch_mm: distances
                .zip(self.factor)
                .map(|((x, y), factor)| [x * factor, y * factor]),
            ..ChannelInfo::default()
        }
    }
}

/// Reads a recording, which has one frame.
///
/// # Errors
/// If there are fewer or more lines of values than `SensCountX` says; the picture is reported before the second of
/// these.
pub(super) fn read(input: impl BufRead, sink: &mut Sink<'_>) -> Result<(), RecordingError> {
    let mut lines = TextLines::new(input);
    let mut header = ZebrisHeader::default();
    loop {
        if !lines.advance()? {
            return Err(RecordingError::damaged(
                "ends without values, expected a section [Data]",
            ));
        }
        let line = text(lines.line());
        if line.trim().eq_ignore_ascii_case("[data]") {
            break;
        }
        header.line(&line, lines.number())?;
    }
    let Some((rows, columns)) = header.rows.zip(header.columns) else {
        let message = "no SensCountX or no SensCountY before the values";
        return Err(RecordingError::in_line(lines.number(), message));
    };
    if sink(RecordingEvent::Channel(&header.info())).is_break() {
        return Ok(());
    }
    let mut frame = Frame::new(columns, rows);
    // A picture is the first of its file.
    frame.label = Some(1);
    for row in frame.values_mut().chunks_mut(columns.into()) {
        if !lines.advance_to_content()? {
            let rows = counted(rows, "line");
            let message = format!("ends inside the frame, expected {rows} of values");
            return Err(RecordingError::in_line(lines.number() + 1, message));
        }
        let (line, number) = (lines.line(), lines.number());
        let fields = Separator::Byte(b'\t').split(line);
        text_row::fill(row, fields, number, |field| match text_row::value(field) {
            Field::Value(-1.0) => Field::NoCell,
            field => field,
        })?;
    }
    let more = lines.advance_to_content()? && !lines.line().starts_with(b"[");
    let after = lines.number();
    let _ = sink(RecordingEvent::Frame(&frame));
    if more {
        let rows = counted(rows, "line");
        let message = format!("more values, expected {rows} of them as SensCountX says");
        return Err(RecordingError::in_line(after, message));
    }
    Ok(())
}
