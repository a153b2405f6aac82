//! Recordings of one JSON object per line: `{"t": 0.1, "frame": [[0, 12], [null, 3]]}`, null or Python's `NaN` for a
//! missing cell.
//! ```text
//! {"t": 0.00, "frame": [[0, 12], [null, 3]]}
//! {"t": 0.05, "frame": [0, 13, null, 4], "label": 7}
//! {"t": 0.05, "frame": [[5, 6], [7, 8]], "channel": "left"}
//! ```
//! A frame is a list of rows, or a list of cells if rows and columns are given by the caller. `t` or `time` is in
//! seconds and counts from the first one. Without either, another key may be the time, such as `timestamp` or `t_ms`,
//! or two keys of which one has the rest of the second, such as `sec` and `nanosec`; the first line with a time decides
//! the key and its unit. `label` is a whole number or a text. `channel` is the name
//! or the number of one of several sensors; other keys are ignored. All frames of a channel have the same size.
//! These are errors, with line and column: rows of different lengths, lists within cells, infinite values, and two
//! frames, times or labels in one line. If wrong lines may be left out, so is a frame of another size, unless three
//! in succession have it.

use crate::formats::recording::error::in_line;
use crate::formats::recording::error::{in_field, unshaped};
use std::borrow::Cow;
use std::fmt;
use std::io::BufRead;

use serde::de::{
    DeserializeSeed, Deserializer, Error, IgnoredAny, MapAccess, SeqAccess, Unexpected, Visitor,
};
use serde_json::Value;
use taxel_core::frame::{Frame, FrameSize, LARGEST_VALUE, Label, MAX_FRAME_CELLS};
use taxel_core::parameter::number::counted;

use crate::error::ReadError;
use crate::formats::job::too_large;
use crate::formats::json;
use crate::formats::recording::channels::ChannelTable;
use crate::formats::recording::event::{
    ChannelInfo, LONGEST_NAME, MOST_CHANNELS, ReadOptions, RecordingEvent, Sink, Stop,
};
use crate::formats::recording::size::{StreamSize, frame_size};
use crate::formats::recording::text::TextLines;
use crate::formats::recording::time::field_role::{FieldRole, is_named_time, rest_of_second, role};
use crate::formats::recording::time::{self, FrameClock, Time, TimeUnit};

pub(in crate::formats::recording) fn read(
    input: impl BufRead,
    options: &ReadOptions,
    sink: &mut Sink<'_>,
) -> Result<(), Stop> {
    let mut lines = TextLines::new(input);
    let mut frames = JsonFrames::new(options.size);
    while lines.advance_to_content()? {
        if let Err(error) = frames.read(lines.line()) {
            sink.damage(options, error.at(lines.number()), lines.line())?;
            continue;
        }
        for info in frames.channels.take_new() {
            sink.event(RecordingEvent::Channel(info))?;
        }
        if let Some(note) = frames.clock.clock.take_note() {
            sink.event(RecordingEvent::Note(&note))?;
        }
        sink.event(RecordingEvent::Frame(frames.frame()))?;
    }
    Ok(())
}

#[derive(Debug)]
pub(in crate::formats) struct JsonFrames {
    line: FrameLine,
    pub(in crate::formats) channels: ChannelTable,
    sizes: Vec<StreamSize>,
    pub(in crate::formats) clock: JsonClock,
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
        frame.label.clone_from(&line.label);
        frame.time = line.time.map(|time| self.clock.clock.since_first(time));
        Ok(())
    }

    pub(in crate::formats) fn frame(&self) -> &Frame {
        &self.frame
    }
}

#[derive(Debug)]
struct FrameLine {
    named: Option<FrameSize>,
    /// The size of the frame; one cell before the first frame.
    size: FrameSize,
    /// The cells, row by row; NaN for null.
    values: Vec<f64>,
    time: Option<Time>,
    label: Option<Label>,
    channel: Option<String>,
}

/// The error for a line that is not a frame, or not one of its recording or stream.
#[derive(Debug)]
pub(in crate::formats) enum FrameLineError {
    Wrong {
        /// The column of the error, from 1; None if it is the line as a whole.
        column: Option<usize>,
        message: String,
    },
    /// A list of cells without rows; the number of cells.
    Shape(u64),
}

impl FrameLineError {
    fn of_line(message: String) -> Self {
        let column = None;
        Self::Wrong { column, message }
    }

    fn at(self, number: u64) -> ReadError {
        match self {
            Self::Wrong { column, message } => match column {
                Some(column) => in_field(number, column, message),
                None => in_line(number, message),
            },
            Self::Shape(values) => unshaped(values, None),
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

/// Reads the label of a frame, a whole number or a text; None for null.
struct LabelSeed;

impl<'de> DeserializeSeed<'de> for LabelSeed {
    type Value = Option<Label>;

    fn deserialize<D: Deserializer<'de>>(self, deserializer: D) -> Result<Option<Label>, D::Error> {
        deserializer.deserialize_any(self)
    }
}

impl Visitor<'_> for LabelSeed {
    type Value = Option<Label>;

    fn expecting(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.write_str("i64")
    }

    fn visit_i64<E: Error>(self, label: i64) -> Result<Option<Label>, E> {
        Ok(Some(label.into()))
    }

    fn visit_u64<E: Error>(self, label: u64) -> Result<Option<Label>, E> {
        let wrong = |_| E::invalid_value(Unexpected::Unsigned(label), &self);
        let label = i64::try_from(label).map_err(wrong)?;
        Ok(Some(label.into()))
    }

    fn visit_str<E: Error>(self, label: &str) -> Result<Option<Label>, E> {
        Ok(Some(label.into()))
    }

    fn visit_unit<E: Error>(self) -> Result<Option<Label>, E> {
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

fn once<E: Error>(given: &mut Option<&'static str>, key: &'static str) -> Result<(), E> {
    match given.replace(key) {
        None => Ok(()),
        Some(before) if before == key => Err(E::custom(format!("{key:?} is given twice"))),
        Some(before) => Err(E::custom(format!(
            "{before:?} and {key:?} are given, expected one of them"
        ))),
    }
}

/// Reads a list of rows or of cells. Lists inside it are rows only if there is a counter of rows.
struct CellsSeed<'a>(&'a mut Vec<f64>, Option<&'a mut usize>);

impl<'de> DeserializeSeed<'de> for CellsSeed<'_> {
    type Value = ();

    fn deserialize<D: Deserializer<'de>>(self, deserializer: D) -> Result<(), D::Error> {
        deserializer.deserialize_seq(self)
    }
}

impl<'de> Visitor<'de> for CellsSeed<'_> {
    type Value = ();

    fn expecting(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.write_str("a list of numbers, or of rows of them")
    }

    fn visit_seq<A: SeqAccess<'de>>(self, mut list: A) -> Result<(), A::Error> {
        let Self(values, mut rows) = self;
        let (mut width, mut cells) = (None, false);
        loop {
            let before = values.len();
            let Some(is_row) = list.next_element_seed(CellSeed(values, rows.is_some()))? else {
                return Ok(());
            };
            // Before it takes memory.
            if values.len() > MAX_FRAME_CELLS {
                return Err(A::Error::custom("more than 512 × 512 cells"));
            }
            cells |= !is_row;
            let Some(rows) = rows.as_mut().filter(|_| is_row) else {
                if width.is_some() {
                    return Err(A::Error::custom("rows and numbers in one list"));
                }
                continue;
            };
            **rows += 1;
            let found = values.len() - before;
            let expected = *width.get_or_insert(found);
            if found != expected || cells {
                let row = **rows;
                let found = counted(found as u64, "value");
                let message = format!("row {row} has {found}, expected {expected}");
                return Err(A::Error::custom(message));
            }
        }
    }
}

/// Reads a number, null, or a row of these; returns true for a row.
struct CellSeed<'a>(&'a mut Vec<f64>, bool);

impl<'de> DeserializeSeed<'de> for CellSeed<'_> {
    type Value = bool;

    fn deserialize<D: Deserializer<'de>>(self, deserializer: D) -> Result<bool, D::Error> {
        deserializer.deserialize_any(self)
    }
}

impl<'de> Visitor<'de> for CellSeed<'_> {
    type Value = bool;

    fn expecting(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.write_str("a number or null")
    }

    fn visit_f64<E: Error>(self, value: f64) -> Result<bool, E> {
        if value.abs() > LARGEST_VALUE {
            return Err(E::custom(too_large(value)));
        }
        self.0.push(value);
        Ok(false)
    }

    #[expect(clippy::cast_precision_loss, reason = "the nearest float")]
    fn visit_u64<E: Error>(self, value: u64) -> Result<bool, E> {
        self.0.push(value as f64);
        Ok(false)
    }

    #[expect(clippy::cast_precision_loss, reason = "the nearest float")]
    fn visit_i64<E: Error>(self, value: i64) -> Result<bool, E> {
        self.0.push(value as f64);
        Ok(false)
    }

    fn visit_unit<E: Error>(self) -> Result<bool, E> {
        self.0.push(f64::NAN);
        Ok(false)
    }

    fn visit_seq<A: SeqAccess<'de>>(self, list: A) -> Result<bool, A::Error> {
        if !self.1 {
            return Err(A::Error::custom(
                "a list inside a row, expected a number or null",
            ));
        }
        CellsSeed(self.0, None).visit_seq(list)?;
        Ok(true)
    }
}

/// The most keys of a line that are considered as its time.
const MOST_KEYS: usize = 16;

#[derive(Debug)]
struct TimeKey {
    name: String,
    rest: Option<(String, TimeUnit)>,
}

#[derive(Debug, Default)]
pub(in crate::formats) struct JsonClock {
    /// The key of the time; None until a line has a time.
    key: Option<TimeKey>,
    pub(in crate::formats) clock: FrameClock,
}

/// The keys of a line that may be its time, with their values.
#[derive(Debug, Default)]
struct TimeCandidates(Vec<(String, Value)>);

impl TimeCandidates {
    fn add(&mut self, name: String, value: Value) {
        self.0.push((name, value));
    }

    fn value(&self, name: &str) -> Option<&Value> {
        let mut all = self.0.iter();
        all.find(|(own, _)| own == name).map(|(_, value)| value)
    }
}

impl JsonClock {
    fn takes(&self, name: &str, others: &TimeCandidates) -> bool {
        match &self.key {
            Some(key) => {
                key.name == name || key.rest.as_ref().is_some_and(|(rest, _)| rest == name)
            }
            None => others.0.len() < MOST_KEYS && matches!(role(name), Some(FieldRole::Time(_))),
        }
    }

    /// Returns the time of a line; None if it has none.
    fn time(&mut self, line: &TimeCandidates) -> Option<Time> {
        if self.key.is_none() {
            self.key = TimeKey::of(line);
            let name = self.key.as_ref().map(|key| &*key.name);
            self.clock.set_unit(name.and_then(role_unit));
        }
        let key = self.key.as_ref()?;
        let time = match line.value(&key.name)? {
            Value::String(text) => self.clock.moment(time::read_moment(text.as_bytes())?),
            value => {
                let (text, number) = number(value)?;
                self.clock.number(text.as_bytes(), number)
            }
        };
        let Some((rest, unit)) = &key.rest else {
            return Some(time);
        };
        let (text, number) = number(line.value(rest)?)?;
        Some(time.plus(Time::read(text.as_bytes(), number, *unit)))
    }
}

impl TimeKey {
    /// Chooses the key of a first line: seconds with their rest in another key, otherwise the first key that is
    /// called a time.
    fn of(line: &TimeCandidates) -> Option<Self> {
        let are_times = line.0.iter().filter(|(_, value)| is_time(value));
        let names: Vec<&str> = are_times.map(|(name, _)| name.as_str()).collect();
        let pair = |index| rest_of_second(&names, index).map(|rest| (index, Some(rest)));
        let alone = || names.iter().position(|name| is_named_time(name));
        let pairs = (0..names.len()).find_map(pair);
        let (index, rest) = pairs.or_else(|| Some((alone()?, None)))?;
        Some(Self {
            name: names[index].to_owned(),
            rest: rest.map(|(rest, unit)| (names[rest].to_owned(), unit)),
        })
    }
}

fn role_unit(name: &str) -> Option<TimeUnit> {
    match role(name) {
        Some(FieldRole::Time(unit)) => unit,
        _ => None,
    }
}

/// Returns true if a value can be a time: a number, or a timestamp.
fn is_time(value: &Value) -> bool {
    match value {
        Value::String(text) => time::read_moment(text.as_bytes()).is_some(),
        value => number(value).is_some(),
    }
}

fn number(value: &Value) -> Option<(String, f64)> {
    let Value::Number(written) = value else {
        return None;
    };
    let number = written
        .as_f64()
        .filter(|time| time.abs() <= LARGEST_VALUE)?;
    Some((written.to_string(), number))
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::formats::recording::event::RecordingNote;

    fn cells(text: &str) -> Result<(Vec<f64>, usize), String> {
        let (mut values, mut rows) = (Vec::new(), 0);
        let mut list = serde_json::Deserializer::from_str(text);
        CellsSeed(&mut values, Some(&mut rows))
            .deserialize(&mut list)
            .map_err(|error| json::message(&error))?;
        Ok((values, rows))
    }

    #[test]
    fn a_list_has_rows_or_cells() {
        assert_eq!(cells("[1,2.5,-3]"), Ok((vec![1.0, 2.5, -3.0], 0)));
        assert_eq!(cells("[[1,2],[3,4]]"), Ok((vec![1.0, 2.0, 3.0, 4.0], 2)));
        assert!(cells("[null]").expect("a cell").0[0].is_nan());
        for (text, error) in [
            ("[[1,2],[3]]", "row 2 has 1 value, expected 2"),
            ("[[1],2]", "rows and numbers in one list"),
            ("[1,[2]]", "row 1 has 1 value, expected 1"),
            ("[[[1]]]", "a list inside a row, expected a number or null"),
            (
                "[\"1\"]",
                "invalid type: string \"1\", expected a number or null",
            ),
        ] {
            assert_eq!(cells(text), Err(error.to_owned()), "{text}");
        }
    }

    #[test]
    fn a_frame_has_at_most_512_rows_of_512_cells() {
        let list = |count: usize| format!("[{}0]", "0,".repeat(count - 1));
        assert!(cells(&list(MAX_FRAME_CELLS)).is_ok());
        let error = cells(&list(MAX_FRAME_CELLS + 1));
        assert_eq!(error, Err("more than 512 × 512 cells".to_owned()));
    }

    fn seconds(lines: &[&str]) -> (Vec<Option<f64>>, Option<RecordingNote>) {
        let mut clock = JsonClock::default();
        let of_line = |line: &&str| {
            let object: Value = serde_json::from_str(line).expect("JSON");
            let mut candidates = TimeCandidates::default();
            for (name, value) in object.as_object().expect("an object") {
                if clock.takes(name, &candidates) {
                    candidates.add(name.clone(), value.clone());
                }
            }
            let time = clock.time(&candidates)?;
            Some(clock.clock.since_first(time))
        };
        let seconds = lines.iter().map(of_line).collect();
        (seconds, clock.clock.take_note())
    }

    #[test]
    fn the_first_time_decides_the_key_and_its_unit() {
        let lines = [
            r#"{"timestamp":null,"t_ms":null}"#,
            r#"{"timestamp":0}"#,
            r#"{"t_ms":5,"timestamp":1714564800123}"#,
            r#"{"t_ms":6}"#,
        ];
        let times = vec![None, Some(0.0), Some(1_714_564_800_123.0), None];
        assert_eq!(seconds(&lines), (times, None));
    }
}
