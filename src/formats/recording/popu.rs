//! JSON of the `PoPu` data set: one object with the size of the matrix and its snapshots, each a list of cells.
//! ```text
//! {"volunteer_id":"4",…,"tactilus_columns":27,"tactilus_rows":64,
//!  "snapshots":{"0":{"id":"200410292003","tactilus_readings":[1,0,0,…]},"1":{…}}}
//! ```
//! Rows and columns, whose keys end in `_rows` and `_columns`, come before the snapshots. A key of a snapshot is its
//! label, if it is a number. Cells stand row by row. Snapshots are reported while the text is read: a file may have
//! thousands. Source: the data set itself (MDPI Data 2023, 8(7), 120).

use std::borrow::Cow;
use std::fmt;
use std::io::BufRead;

use serde::de::{DeserializeSeed, Deserializer, Error, IgnoredAny, MapAccess, Visitor};

use crate::formats::json;
use crate::formats::recording::error::RecordingError;
use crate::formats::recording::event::{ChannelInfo, RecordingEvent, Sink};
use crate::formats::recording::json_lines::CellsSeed;
use crate::formats::recording::side::side;
use crate::frame::{Frame, MAX_FRAME_SIDE};
use crate::parameter::number::counted;

/// Stands in an error of serde's for a sink that wants no more.
const ENOUGH: &str = "no more is wanted";

/// Reads a recording.
///
/// # Errors
/// With line and column: of what is no JSON, of a snapshot of another size, and of one before its rows and columns.
pub(super) fn read(mut input: impl BufRead, sink: &mut Sink<'_>) -> Result<(), RecordingError> {
    let mark = b"\xef\xbb\xbf";
    if input.fill_buf()?.starts_with(mark) {
        input.consume(mark.len());
    }
    let mut content = serde_json::Deserializer::from_reader(input);
    let mut state = PopuState {
        rows: None,
        columns: None,
        begun: false,
        enough: false,
        frame: Frame::new(1, 1),
        values: Vec::new(),
        sink,
    };
    let read = PopuSeed(&mut state)
        .deserialize(&mut content)
        .and_then(|()| content.end());
    match read {
        Err(error) if error.is_io() => Err(RecordingError::Io(error.into())),
        Err(_) if state.enough => Ok(()),
        Err(error) => {
            let message = json::message(&error);
            Err(RecordingError::in_field(
                error.line() as u64,
                error.column(),
                message,
            ))
        }
        Ok(()) if !state.begun => Err(RecordingError::damaged(
            "no snapshots, expected a key \"snapshots\" with frames",
        )),
        Ok(()) => Ok(()),
    }
}

/// What is known so far, and where frames go.
struct PopuState<'a, 'b> {
    /// The key that ends in `_rows`.
    rows: Option<u16>,
    /// The key that ends in `_columns`.
    columns: Option<u16>,
    /// Whether the channel was reported.
    begun: bool,
    /// Whether the sink wants no more, so that the error that stops the parser is none.
    enough: bool,
    /// The frame that is being filled.
    frame: Frame,
    /// The cells of a snapshot, in memory that is used again.
    values: Vec<f64>,
    /// Takes channel and frames.
    sink: &'a mut Sink<'b>,
}

/// The whole object.
struct PopuSeed<'s, 'a, 'b>(&'s mut PopuState<'a, 'b>);

/// All snapshots.
struct SnapshotsSeed<'s, 'a, 'b>(&'s mut PopuState<'a, 'b>);

/// One of them.
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
            } else if key.ends_with("_rows") {
                self.0.rows = Some(side(map.next_value()?)?);
            } else if key.ends_with("_columns") {
                self.0.columns = Some(side(map.next_value()?)?);
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
        let Some((rows, columns)) = self.0.rows.zip(self.0.columns) else {
            return Err(A::Error::custom("snapshots before their rows and columns"));
        };
        self.0.begun = true;
        let info = ChannelInfo {
            shape: Some((rows, columns)),
            ..ChannelInfo::default()
        };
        if (self.0.sink)(RecordingEvent::Channel(&info)).is_break() {
            self.0.enough = true;
            return Err(A::Error::custom(ENOUGH));
        }
        self.0.frame = Frame::new(columns, rows);
        while let Some(key) = map.next_key::<Cow<'de, str>>()? {
            self.0.frame.label = key.parse().ok();
            self.0.values.clear();
            map.next_value_seed(SnapshotSeed(&mut *self.0))?;
            let (found, expected) = (self.0.values.len(), self.0.frame.values().len());
            if found != expected {
                let message = format!(
                    "found {}, expected {expected}",
                    counted(found as u64, "value")
                );
                return Err(A::Error::custom(message));
            }
            self.0.frame.values_mut().copy_from_slice(&self.0.values);
            if (self.0.sink)(RecordingEvent::Frame(&self.0.frame)).is_break() {
                self.0.enough = true;
                return Err(A::Error::custom(ENOUGH));
            }
            self.0.frame.number += 1;
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
        while let Some(key) = map.next_key::<Cow<'de, str>>()? {
            if key.ends_with("_readings") && self.0.values.is_empty() {
                map.next_value_seed(CellsSeed(&mut self.0.values, None))?;
            } else {
                map.next_value::<IgnoredAny>()?;
            }
        }
        Ok(())
    }
}
