//! Recordings of one JSON object per line: `{"t": 0.1, "frame": [[0, 12], [null, 3]]}`, null or Python's `NaN` for a
//! missing cell.
//! ```text
//! {"t": 0.00, "frame": [[0, 12], [null, 3]]}
//! {"t": 0.05, "frame": [0, 13, null, 4], "label": 7}
//! {"t": 0.05, "frame": [[5, 6], [7, 8]], "channel": "left"}
//! ```
//! A frame is a list of rows, or a list of cells if rows and columns are given by the caller. `t` or `time` is in
//! seconds and counts from the first one; without either, another key may give the time, see
//! [`clock`](super::clock). `label` is a whole number; `channel` is the name or the number of one of several
//! sensors; other keys are ignored. All frames of a channel have the same size.
//! These are errors, with line and column: rows of different lengths, lists within cells, infinite values, and two
//! frames, times or labels in one line. If wrong lines may be left out, so is a frame of another size, unless three
//! in succession have it.

use std::borrow::Cow;
use std::fmt;
use std::io::BufRead;

use serde_json::Value;

use serde::de::{DeserializeSeed, Deserializer, Error, IgnoredAny, MapAccess, Visitor};

use crate::formats::json;
use crate::formats::recording::error::RecordingError;
use crate::formats::recording::event::{
    ChannelInfo, EarlyEnd, LONGEST_NAME, MOST_CHANNELS, ReadOptions, RecordingEvent, Sink,
};
use crate::formats::recording::json::cells::CellsSeed;
use crate::formats::recording::json::clock::{JsonClock, TimeCandidates};
use crate::formats::recording::side::{changed, frame_size};
use crate::formats::recording::stream_size::StreamSize;
use crate::formats::recording::text::lines::TextLines;
use crate::formats::recording::time::exact::Time;
use crate::frame::{Frame, FrameSize, LARGEST_VALUE};
use crate::parameter::number::counted;

/// Reads a recording.
pub(in crate::formats::recording) fn read(
    input: impl BufRead,
    options: ReadOptions,
    sink: &mut Sink<'_>,
) -> Result<(), EarlyEnd> {
    let mut lines = TextLines::new(input);
    let mut line = FrameLine::new(options.size);
    let mut clock = JsonClock::default();
    // The name of each channel, the size of its frames, and their number so far.
    let mut channels: Vec<(Option<String>, StreamSize, u64)> = Vec::new();
    let mut frame = Frame::default();
    while lines.advance_to_content()? {
        let number = lines.number();
        if let Err(error) = line.read(lines.line(), &mut clock) {
            options.damage(error.in_line(number), lines.line(), sink)?;
            let sizes = channels.iter_mut().map(|(_, size, _)| size);
            sizes.for_each(StreamSize::pass_torn);
            continue;
        }
        let known = channels.iter().position(|(name, ..)| *name == line.channel);
        if known.is_none() {
            if channels.len() == MOST_CHANNELS {
                let message = format!("more than {MOST_CHANNELS} channels");
                let error = RecordingError::in_line(number, message);
                options.damage(error, lines.line(), sink)?;
                continue;
            }
            channels.push((line.channel.clone(), StreamSize::new(options.size), 0));
            sink(RecordingEvent::Channel(&line.channel_info()))?;
        }
        frame.channel = known.unwrap_or(channels.len() - 1);
        let (_, size, count) = &mut channels[frame.channel];
        let before = size.present().unwrap_or(line.size);
        if !size.admits(line.size) {
            let error = RecordingError::in_line(number, changed(line.size, before));
            options.damage(error, lines.line(), sink)?;
            continue;
        }
        frame.number = *count;
        *count += 1;
        frame.reset(line.size);
        frame.values_mut().copy_from_slice(&line.values);
        frame.time = line.time.map(|time| clock.clock.since_first(time));
        frame.label = line.label;
        if let Some(note) = clock.clock.take_note() {
            sink(RecordingEvent::Note(&note))?;
        }
        sink(RecordingEvent::Frame(&frame))?;
    }
    Ok(())
}

/// The content of a line, in memory that is reused.
#[derive(Debug)]
pub(in crate::formats) struct FrameLine {
    /// The size of a frame, for lists of cells without rows, if it is known beforehand.
    asked: Option<FrameSize>,
    /// The size of the frame; one cell before the first frame.
    pub(in crate::formats) size: FrameSize,
    /// The cells, row by row; NaN for null.
    pub(in crate::formats) values: Vec<f64>,
    /// The time.
    pub(in crate::formats) time: Option<Time>,
    /// The frame's label in the recording.
    pub(in crate::formats) label: Option<i64>,
    /// The name of the sensor, if there are several.
    pub(in crate::formats) channel: Option<String>,
}

/// The error for a line that is not a frame.
#[derive(Debug)]
pub(in crate::formats) enum FrameLineError {
    /// The column of the error, from 1, and what is wrong.
    Json(usize, String),
    /// A list of cells without rows; the number of cells.
    Shape(u64),
}

impl FrameLineError {
    /// Returns the error for that line of a recording.
    fn in_line(self, number: u64) -> RecordingError {
        match self {
            Self::Json(column, message) => RecordingError::in_field(number, column, message),
            Self::Shape(values) => RecordingError::Shape { values },
        }
    }

    /// Returns the number of values in the frame, if only its rows and columns are missing.
    pub(in crate::formats) fn unshaped(&self) -> Option<u64> {
        match self {
            Self::Shape(values) => Some(*values),
            Self::Json(..) => None,
        }
    }

    /// Returns what is wrong, unless only rows and columns are missing.
    pub(in crate::formats) fn reason(self) -> Option<String> {
        match self {
            Self::Shape(_) => None,
            Self::Json(_, message) => Some(message),
        }
    }
}

impl FrameLine {
    /// Creates a line without a frame. `asked` is the size of a frame, if it is known beforehand.
    pub(in crate::formats) fn new(asked: Option<FrameSize>) -> Self {
        Self {
            asked,
            size: FrameSize::SMALLEST,
            values: Vec::new(),
            time: None,
            label: None,
            channel: None,
        }
    }

    /// Returns the channel of the line, to be reported before its first frame.
    pub(in crate::formats) fn channel_info(&self) -> ChannelInfo {
        ChannelInfo {
            name: self.channel.clone(),
            size: Some(self.size),
            ..ChannelInfo::default()
        }
    }

    /// Reads a line. `clock` reads the times of all lines.
    pub(in crate::formats) fn read(
        &mut self,
        line: &[u8],
        clock: &mut JsonClock,
    ) -> Result<(), FrameLineError> {
        self.values.clear();
        (self.time, self.label, self.channel) = (None, None, None);
        let mut rows = 0;
        let without_nan = json::WithoutNan::new(line);
        let mut content = serde_json::Deserializer::from_slice(&without_nan.line);
        let object = ObjectSeed {
            line: self,
            rows: &mut rows,
            clock,
        };
        let read = object
            .deserialize(&mut content)
            .and_then(|()| content.end());
        read.map_err(|error| {
            let column = without_nan.column(error.column().max(1));
            FrameLineError::Json(column, complaint(line, column, &error))
        })?;
        let values = self.values.len();
        let wrong = |message: String| Err(FrameLineError::Json(1, message));
        if let Some(columns) = values.checked_div(rows) {
            let Some(size) = frame_size(columns, rows) else {
                let rows = counted(rows as u64, "row");
                return wrong(format!("{rows} of {columns}, expected 1 to 512 of each"));
            };
            if let Some(asked) = self.asked.filter(|asked| *asked != size) {
                return wrong(format!(
                    "{}, and {} of {} were named",
                    size.in_words(),
                    asked.rows(),
                    asked.columns()
                ));
            }
            self.size = size;
            return Ok(());
        }
        if values == 0 {
            return wrong("\"frame\" is empty, expected rows of values".to_owned());
        }
        let Some(size) = self.asked else {
            return Err(FrameLineError::Shape(values as u64));
        };
        if values != size.cells() {
            return wrong(format!(
                "found {}, expected {}",
                counted(values as u64, "value"),
                size.cells()
            ));
        }
        self.size = size;
        Ok(())
    }
}

/// Returns what is wrong with a line from that column on.
fn complaint(line: &[u8], column: usize, error: &serde_json::Error) -> String {
    let rest = line.get(column - 1..).unwrap_or(&[]);
    let begins_list = line.trim_ascii_start().strip_prefix(b"[");
    match begins_list.map(<[u8]>::trim_ascii_start) {
        Some([] | [b'{', ..]) => {
            "found a list of objects, expected one object a line, as `jq -c '.[]'` writes them"
                .to_owned()
        }
        // Some programs write infinity, but it is not a value.
        _ if rest.starts_with(b"Infinity") || rest.starts_with(b"-Infinity") => {
            "found Infinity, expected a number, or null where there is no cell".to_owned()
        }
        _ => json::message(error),
    }
}

/// The object of a line.
struct ObjectSeed<'a> {
    line: &'a mut FrameLine,
    /// The number of rows, which is set; it stays 0 for cells without rows.
    rows: &'a mut usize,
    clock: &'a mut JsonClock,
}

impl<'de> DeserializeSeed<'de> for ObjectSeed<'_> {
    type Value = ();

    fn deserialize<D: Deserializer<'de>>(self, deserializer: D) -> Result<(), D::Error> {
        deserializer.deserialize_map(self)
    }
}

impl<'de> Visitor<'de> for ObjectSeed<'_> {
    type Value = ();

    fn expecting(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.write_str("an object with a key \"frame\"")
    }

    fn visit_map<A: MapAccess<'de>>(self, mut map: A) -> Result<(), A::Error> {
        let (mut frame, mut time, mut label, mut channel) = (None, None, None, None);
        let mut other_times = TimeCandidates::default();
        let Self { line, rows, clock } = self;
        while let Some(key) = map.next_key::<Cow<'de, str>>()? {
            match &*key {
                "frame" => {
                    once(&mut frame, "frame")?;
                    map.next_value_seed(CellsSeed(&mut line.values, Some(&mut *rows)))?;
                }
                key @ ("t" | "time") => {
                    once(&mut time, if key == "t" { "t" } else { "time" })?;
                    let time: Option<f64> = map.next_value()?;
                    let time = time.filter(|time| time.abs() <= LARGEST_VALUE);
                    line.time = time.map(Time::Seconds);
                }
                "label" => {
                    once(&mut label, "label")?;
                    line.label = map.next_value()?;
                }
                "channel" => {
                    once(&mut channel, "channel")?;
                    line.channel = channel_name(&map.next_value()?)?;
                }
                other if clock.takes(other, &other_times) => {
                    other_times.add(other.to_owned(), map.next_value()?);
                }
                _ => drop(map.next_value::<IgnoredAny>()?),
            }
        }
        if time.is_none() {
            line.time = clock.time(&other_times);
        }
        if frame.is_none() {
            return Err(A::Error::custom("no key \"frame\" with rows of values"));
        }
        Ok(())
    }
}

/// Reads the name of a channel: a number is a name, too, and null means no name.
fn channel_name<E: Error>(value: &Value) -> Result<Option<String>, E> {
    let name = match value {
        Value::Null => return Ok(None),
        Value::String(name) => name.clone(),
        Value::Number(number) if !number.is_f64() => number.to_string(),
        _ => {
            return Err(E::custom(
                "\"channel\" is neither a name nor a whole number",
            ));
        }
    };
    if name.is_empty() || name.len() > LONGEST_NAME {
        let length = name.len();
        return Err(E::custom(format!(
            "\"channel\" is a name of {length} bytes, expected 1 to {LONGEST_NAME}"
        )));
    }
    Ok(Some(name))
}

/// Notes that a key gave a value.
///
/// # Errors
/// Returns an error if a key gave the value before.
fn once<E: Error>(given: &mut Option<&'static str>, key: &'static str) -> Result<(), E> {
    match given.replace(key) {
        None => Ok(()),
        Some(before) if before == key => Err(E::custom(format!("{key:?} is given twice"))),
        Some(before) => Err(E::custom(format!(
            "{before:?} and {key:?} are given, expected one of them"
        ))),
    }
}
