//! The JSON of the `PoPu` data set: one object with the size of the matrix and its snapshots, each a list of cells.
//! ```text
//! {"volunteer_id":"4",…,"tactilus_columns":27,"tactilus_rows":64,
//!  "snapshots":{"0":{"id":"200410292003","tactilus_readings":[1,0,0,…]},"1":{…}}}
//! ```
//! The keys of rows and columns, which end in `_rows` and `_columns`, come before the snapshots. The start of such a
//! key names the sheet; a file may have two (`tactilus`, `sensomatt`), and each is a channel. The key of a snapshot
//! is its label, if it is a number. Cells are listed row by row. Snapshots are reported while the text is read: a
//! file may have thousands. Source: the data set itself (MDPI Data 2023, 8(7), 120).

use std::borrow::Cow;
use std::fmt;
use std::io::{self, BufRead};

use serde::de::{DeserializeSeed, Deserializer, Error, IgnoredAny, MapAccess, Visitor};

use crate::formats::byte_order_mark::BYTE_ORDER_MARK;
use crate::formats::json;
use crate::formats::recording::error::RecordingError;
use crate::formats::recording::event::{ChannelInfo, EarlyEnd, RecordingEvent, Sink};
use crate::formats::recording::json::cells::CellsSeed;
use crate::formats::recording::side::side;
use crate::frame::{Frame, FrameSize, MAX_FRAME_SIDE};
use crate::parameter::number::counted;

/// Reads a recording.
///
/// # Errors
/// Returns an error with line and column for text that is not JSON, for a snapshot of another size, and for a
/// snapshot before its rows and columns.
pub(in crate::formats::recording) fn read(
    mut input: impl BufRead,
    sink: &mut Sink<'_>,
) -> Result<(), EarlyEnd> {
    if input.fill_buf()?.starts_with(BYTE_ORDER_MARK) {
        input.consume(BYTE_ORDER_MARK.len());
    }
    let mut content = serde_json::Deserializer::from_reader(input);
    let mut state = PopuState {
        sheets: Vec::new(),
        begun: false,
        ended: None,
        label: None,
        values: Vec::new(),
        sink,
    };
    let read = PopuSeed(&mut state)
        .deserialize(&mut content)
        .and_then(|()| content.end());
    if let Some(end) = state.ended {
        return Err(end);
    }
    read.map_err(|error| {
        if error.is_io() {
            return io::Error::from(error).into();
        }
        RecordingError::in_field(error.line() as u64, error.column(), json::message(&error))
    })?;
    if !state.begun {
        let message = "no snapshots, expected a key \"snapshots\" with frames";
        return Err(RecordingError::damaged(message).into());
    }
    Ok(())
}

/// The most sheets in a file.
const MOST_SHEETS: usize = 16;

/// A sheet of cells.
struct PopuSheet {
    /// The name, with which its keys begin.
    name: String,
    /// The value of the key that ends in `_rows`.
    rows: Option<u16>,
    /// The value of the key that ends in `_columns`.
    columns: Option<u16>,
    /// The frame that is being filled.
    frame: Frame,
}

/// The state of the reader.
struct PopuState<'a, 'b> {
    /// The sheets in the order in which they occur; each is a channel.
    sheets: Vec<PopuSheet>,
    /// Whether the channels have been reported.
    begun: bool,
    /// The reason why the sink ended the reading, which the parser's own error cannot hold.
    ended: Option<EarlyEnd>,
    /// The key of a snapshot, if it is a number.
    label: Option<i64>,
    /// The cells of a snapshot, in memory that is reused.
    values: Vec<f64>,
    /// The receiver of channels and frames.
    sink: &'a mut Sink<'b>,
}

impl PopuState<'_, '_> {
    /// Returns the sheet of that name, adding it if it is new.
    fn sheet<E: Error>(&mut self, name: &str) -> Result<&mut PopuSheet, E> {
        let known = self.sheets.iter().position(|own| own.name == name);
        if known.is_none() {
            if self.sheets.len() == MOST_SHEETS {
                return Err(E::custom(format!("more than {MOST_SHEETS} sheets")));
            }
            self.sheets.push(PopuSheet {
                name: name.to_owned(),
                rows: None,
                columns: None,
                frame: Frame::default(),
            });
        }
        let index = known.unwrap_or(self.sheets.len() - 1);
        Ok(&mut self.sheets[index])
    }

    /// Reports an event; returns an error if the sink ends the reading.
    fn report<E: Error>(&mut self, event: RecordingEvent<'_>) -> Result<(), E> {
        (self.sink)(event).map_err(|end| {
            self.ended = Some(end);
            E::custom("the sink ended the reading")
        })
    }

    /// Reports the sheets as channels.
    fn begin<E: Error>(&mut self) -> Result<(), E> {
        self.begun = true;
        let is_only = self.sheets.len() == 1;
        let mut sheets = std::mem::take(&mut self.sheets);
        for (channel, sheet) in sheets.iter_mut().enumerate() {
            let Some(size) = FrameSize::of_sides(sheet.columns, sheet.rows) else {
                return Err(E::custom("snapshots before their rows and columns"));
            };
            sheet.frame = Frame::new(size);
            sheet.frame.channel = channel;
            let info = ChannelInfo {
                name: (!is_only).then(|| sheet.name.clone()),
                size: Some(size),
                ..ChannelInfo::default()
            };
            self.report(RecordingEvent::Channel(&info))?;
        }
        if sheets.is_empty() {
            return Err(E::custom("snapshots before their rows and columns"));
        }
        self.sheets = sheets;
        Ok(())
    }

    /// Reports the values as a frame of the sheet with that index.
    fn give<E: Error>(&mut self, sheet: usize) -> Result<(), E> {
        let mut frame = std::mem::take(&mut self.sheets[sheet].frame);
        let (found, expected) = (self.values.len(), frame.values().len());
        if found != expected {
            let found = counted(found as u64, "value");
            return Err(E::custom(format!("found {found}, expected {expected}")));
        }
        frame.values_mut().copy_from_slice(&self.values);
        frame.label = self.label;
        self.report(RecordingEvent::Frame(&frame))?;
        frame.number += 1;
        self.sheets[sheet].frame = frame;
        Ok(())
    }
}

/// Reads the whole object.
struct PopuSeed<'s, 'a, 'b>(&'s mut PopuState<'a, 'b>);

/// Reads all snapshots.
struct SnapshotsSeed<'s, 'a, 'b>(&'s mut PopuState<'a, 'b>);

/// Reads a single snapshot.
struct SnapshotSeed<'s, 'a, 'b>(&'s mut PopuState<'a, 'b>);

macro_rules! map_seed {
    ($seed:ident) => {
        impl<'de> DeserializeSeed<'de> for $seed<'_, '_, '_> {
            type Value = ();

            fn deserialize<D: Deserializer<'de>>(self, deserializer: D) -> Result<(), D::Error> {
                deserializer.deserialize_map(self)
            }
        }
    };
}

map_seed!(PopuSeed);
map_seed!(SnapshotsSeed);
map_seed!(SnapshotSeed);

impl<'de> Visitor<'de> for PopuSeed<'_, '_, '_> {
    type Value = ();

    fn expecting(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.write_str("an object with rows, columns and snapshots")
    }

    fn visit_map<A: MapAccess<'de>>(self, mut map: A) -> Result<(), A::Error> {
        while let Some(key) = map.next_key::<Cow<'de, str>>()? {
            let side = |length: u16| {
                let message = || format!("{length}: expected 1 to {MAX_FRAME_SIDE}");
                side(length).ok_or_else(|| A::Error::custom(message()))
            };
            if key == "snapshots" {
                map.next_value_seed(SnapshotsSeed(&mut *self.0))?;
            } else if let Some(name) = key.strip_suffix("_rows") {
                self.0.sheet(name)?.rows = Some(side(map.next_value()?)?);
            } else if let Some(name) = key.strip_suffix("_columns") {
                self.0.sheet(name)?.columns = Some(side(map.next_value()?)?);
            } else {
                map.next_value::<IgnoredAny>()?;
            }
        }
        Ok(())
    }
}

impl<'de> Visitor<'de> for SnapshotsSeed<'_, '_, '_> {
    type Value = ();

    fn expecting(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.write_str("an object of snapshots")
    }

    fn visit_map<A: MapAccess<'de>>(self, mut map: A) -> Result<(), A::Error> {
        self.0.begin()?;
        while let Some(key) = map.next_key::<Cow<'de, str>>()? {
            self.0.label = key.parse().ok();
            map.next_value_seed(SnapshotSeed(&mut *self.0))?;
        }
        Ok(())
    }
}

impl<'de> Visitor<'de> for SnapshotSeed<'_, '_, '_> {
    type Value = ();

    fn expecting(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.write_str("a snapshot with its readings")
    }

    fn visit_map<A: MapAccess<'de>>(self, mut map: A) -> Result<(), A::Error> {
        let mut given = vec![false; self.0.sheets.len()];
        while let Some(key) = map.next_key::<Cow<'de, str>>()? {
            let name = key.strip_suffix("_readings");
            let sheet = self
                .0
                .sheets
                .iter()
                .position(|sheet| name == Some(&sheet.name));
            match sheet.filter(|&sheet| !given[sheet]) {
                Some(sheet) => {
                    self.0.values.clear();
                    map.next_value_seed(CellsSeed(&mut self.0.values, None))?;
                    self.0.give(sheet)?;
                    given[sheet] = true;
                }
                None => drop(map.next_value::<IgnoredAny>()?),
            }
        }
        if given.contains(&true) {
            return Ok(());
        }
        let names = self.0.sheets.iter().map(|sheet| &sheet.name);
        let keys: Vec<String> = names.map(|name| format!("{name}_readings")).collect();
        let message = format!("a snapshot without {}", keys.join(" or "));
        Err(A::Error::custom(message))
    }
}
