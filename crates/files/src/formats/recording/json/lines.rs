//! Recordings of one JSON object per line: `{"t": 0.1, "frame": [[0, 12], [null, 3]]}`, null or Python's `NaN` for a
//! missing cell.
//! ```text
//! {"t": 0.00, "frame": [[0, 12], [null, 3]]}
//! {"t": 0.05, "frame": [0, 13, null, 4], "label": 7}
//! {"t": 0.05, "frame": [[5, 6], [7, 8]], "channel": "left"}
//! ```
//! A frame is a list of rows, or a list of cells if rows and columns are given by the caller. `t` or `time` is in
//! seconds and counts from the first one; without either, another key may give the time, see
//! [`clock`](super::clock). `label` is a whole number; text, as for the name of a class, is ignored. `channel` is the
//! name or the number of one of several sensors; other keys are ignored. All frames of a channel have the same size.
//! These are errors, with line and column: rows of different lengths, lists within cells, infinite values, and two
//! frames, times or labels in one line. If wrong lines may be left out, so is a frame of another size, unless three
//! in succession have it.

use std::borrow::Cow;
use std::fmt;
use std::io::BufRead;

use serde_json::Value;

use serde::de::{DeserializeSeed, Deserializer, Error, IgnoredAny, MapAccess, Unexpected, Visitor};

use crate::formats::json;
use crate::formats::recording::channel_table::ChannelTable;
use crate::formats::recording::error::RecordingError;
use crate::formats::recording::event::{
    ChannelInfo, EarlyEnd, LONGEST_NAME, MOST_CHANNELS, ReadOptions, RecordingEvent, Sink,
};
use crate::formats::recording::json::cells::CellsSeed;
use crate::formats::recording::json::clock::{JsonClock, TimeCandidates};
use crate::formats::recording::side::frame_size;
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
    let mut frames = JsonFrames::new(options.size);
    while lines.advance_to_content()? {
        if let Err(error) = frames.read(lines.line()) {
            options.damage(error.in_line(lines.number()), lines.line(), sink)?;
            continue;
        }
        for info in frames.channels.take_new() {
            sink(RecordingEvent::Channel(info))?;
        }
        if let Some(note) = frames.clock.clock.take_note() {
            sink(RecordingEvent::Note(&note))?;
        }
        sink(RecordingEvent::Frame(frames.frame()))?;
    }
    Ok(())
}

/// The frames of JSON lines, in a recording or in a stream.
#[derive(Debug)]
pub(in crate::formats) struct JsonFrames {
    /// The line that was read last.
    line: FrameLine,
    /// The channels so far.
    pub(in crate::formats) channels: ChannelTable,
    /// The rows and columns of the frames of each channel.
    sizes: Vec<StreamSize>,
    /// The clock that reads the times of lines.
    pub(in crate::formats) clock: JsonClock,
    /// The frame made of the line.
    frame: Frame,
}

impl JsonFrames {
    /// Prepares for lines; `named` is the size of a frame, if it was given.
    pub(in crate::formats) fn new(named: Option<FrameSize>) -> Self {
        Self {
            line: FrameLine::new(named),
            channels: ChannelTable::new(MOST_CHANNELS, "channels"),
            sizes: Vec::new(),
            clock: JsonClock::default(),
            frame: Frame::default(),
        }
    }

    /// Reads a line, after which [`Self::frame`] is its frame.
    ///
    /// # Errors
    /// Returns an error if the line is not a frame, has other rows and columns than those of its channel before it,
    /// or is of one channel too many.
    pub(in crate::formats) fn read(&mut self, line: &[u8]) -> Result<(), FrameLineError> {
        if let Err(error) = self.line.read(line, &mut self.clock) {
            self.sizes.iter_mut().for_each(StreamSize::pass_torn);
            return Err(error);
        }
        let line = &self.line;
        let info = || ChannelInfo {
            size: Some(line.size),
            ..ChannelInfo::default()
        };
        let channel = self.channels.index_of(line.channel.as_deref(), info);
        let channel = channel.map_err(FrameLineError::of_line)?;
        if channel == self.sizes.len() {
            self.sizes.push(StreamSize::new(line.named));
        }
        let admitted = self.sizes[channel].admit(line.size);
        admitted.map_err(FrameLineError::of_line)?;
        let frame = &mut self.frame;
        frame.reset(line.size);
        frame.values_mut().copy_from_slice(&line.values);
        self.channels.number(channel, frame);
        frame.label = line.label;
        frame.time = line.time.map(|time| self.clock.clock.since_first(time));
        Ok(())
    }

    /// Returns the frame of the last line.
    pub(in crate::formats) fn frame(&self) -> &Frame {
        &self.frame
    }

    /// Forgets the rows and columns of the channels: after a gap, the sensors may have been reconfigured.
    pub(in crate::formats) fn forget_sizes(&mut self) {
        self.sizes.fill(StreamSize::new(self.line.named));
    }
}

/// The content of a line, in memory that is reused.
#[derive(Debug)]
struct FrameLine {
    /// The size of a frame, for lists of cells without rows, if it was given.
    named: Option<FrameSize>,
    /// The size of the frame; one cell before the first frame.
    size: FrameSize,
    /// The cells, row by row; NaN for null.
    values: Vec<f64>,
    /// The time.
    time: Option<Time>,
    /// The frame's label in the recording.
    label: Option<i64>,
    /// The name of the sensor, if there are several.
    channel: Option<String>,
}

/// The error for a line that is not a frame, or not one of its recording or stream.
#[derive(Debug)]
pub(in crate::formats) enum FrameLineError {
    /// A wrong line.
    Wrong {
        /// The column of the error, from 1; None if it is the line as a whole.
        column: Option<usize>,
        /// The message, which says what was found and what was expected.
        message: String,
    },
    /// A list of cells without rows; the number of cells.
    Shape(u64),
}

impl FrameLineError {
    /// Returns the error for a line as a whole.
    fn of_line(message: String) -> Self {
        let column = None;
        Self::Wrong { column, message }
    }

    /// Returns the error for that line of a recording.
    fn in_line(self, number: u64) -> RecordingError {
        match self {
            Self::Wrong { column, message } => match column {
                Some(column) => RecordingError::in_field(number, column, message),
                None => RecordingError::in_line(number, message),
            },
            Self::Shape(values) => RecordingError::Shape { values },
        }
    }
}

impl FrameLine {
    /// Creates a line without a frame. `named` is the size of a frame, if it was given.
    fn new(named: Option<FrameSize>) -> Self {
        Self {
            named,
            size: FrameSize::SMALLEST,
            values: Vec::new(),
            time: None,
            label: None,
            channel: None,
        }
    }

    /// Reads a line. `clock` reads the times of all lines.
    fn read(&mut self, line: &[u8], clock: &mut JsonClock) -> Result<(), FrameLineError> {
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
            FrameLineError::Wrong {
                column: Some(column),
                message: complaint(line, column, &error),
            }
        })?;
        let values = self.values.len();
        let wrong = |message: String| {
            let column = Some(1);
            Err(FrameLineError::Wrong { column, message })
        };
        if let Some(columns) = values.checked_div(rows) {
            let Some(size) = frame_size(columns, rows) else {
                let rows = counted(rows as u64, "row");
                return wrong(format!("{rows} of {columns}, expected 1 to 512 of each"));
            };
            if let Some(named) = self.named.filter(|named| *named != size) {
                return wrong(format!(
                    "{}, and {} of {} were named",
                    size.in_words(),
                    named.rows(),
                    named.columns()
                ));
            }
            self.size = size;
            return Ok(());
        }
        if values == 0 {
            return wrong("\"frame\" is empty, expected rows of values".to_owned());
        }
        let Some(size) = self.named else {
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
                    line.label = map.next_value_seed(LabelSeed)?;
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

/// Reads the label of a frame, a whole number; None for null, and for text, which is the name of a class in data sets.
struct LabelSeed;

impl<'de> DeserializeSeed<'de> for LabelSeed {
    type Value = Option<i64>;

    fn deserialize<D: Deserializer<'de>>(self, deserializer: D) -> Result<Option<i64>, D::Error> {
        deserializer.deserialize_any(self)
    }
}

impl Visitor<'_> for LabelSeed {
    type Value = Option<i64>;

    fn expecting(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.write_str("i64")
    }

    fn visit_i64<E: Error>(self, label: i64) -> Result<Option<i64>, E> {
        Ok(Some(label))
    }

    fn visit_u64<E: Error>(self, label: u64) -> Result<Option<i64>, E> {
        let wrong = |_| E::invalid_value(Unexpected::Unsigned(label), &self);
        i64::try_from(label).map(Some).map_err(wrong)
    }

    fn visit_str<E: Error>(self, _: &str) -> Result<Option<i64>, E> {
        Ok(None)
    }

    fn visit_unit<E: Error>(self) -> Result<Option<i64>, E> {
        Ok(None)
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
