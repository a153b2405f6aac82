//! A stored shape: one JSON file with a name, a sensor, an imprint and, where it was not drawn by hand, its source.

use std::fmt;

use serde::de::{Deserialize, Deserializer, Error, MapAccess, Visitor};
use serde::ser::{Serialize, SerializeMap, Serializer};
use taxel_core::imprint::Imprint;
use taxel_core::quote::shortened;
use taxel_core::sensor::{MatrixSize, Sensor};
use taxel_core::source::Source;

use crate::formats::file::without_mark;
use crate::formats::json::{self, message};
use crate::formats::name::Name;
use crate::formats::record::{
    ImprintRecord, KeyedObject, KnownKeys, Record, RecordError, Text, Values, keyed_object,
    no_names, once, value_of,
};

/// The required value of a file's first key.
pub const FORMAT: &str = "taxel-shape/1";

/// The size limit of a shape file in bytes; a larger file is not read.
pub const MAX_BYTES: usize = 1 << 20;

/// A stored shape; made by [`StoredShape::new`] or [`StoredShape::read`].
#[derive(Clone, Debug, PartialEq)]
pub struct StoredShape {
    /// The name.
    pub name: Name,
    /// The sensor that the shape was made on.
    pub sensor: Sensor,
    /// The taxels; as many columns and rows as the sensor has.
    pub imprint: Imprint,
    /// The figure or picture that left the imprint; None if it was drawn by hand.
    pub source: Option<Source>,
}

/// The error for text that is not a stored shape.
#[derive(Clone, Debug, PartialEq, thiserror::Error)]
pub enum ShapeError {
    /// More than [`MAX_BYTES`] bytes.
    #[error("larger than 1 MiB, the limit for a shape")]
    Large,
    /// Not JSON, not an object with the keys of a shape, or of another format, perhaps a newer one.
    #[error("line {line}, column {column}: {message}")]
    Json {
        /// The line number, from 1.
        line: usize,
        /// The column number, from 1.
        column: usize,
        /// A description of the error.
        message: String,
    },
    /// A required key that is missing.
    #[error("{0}: missing")]
    Missing(&'static str),
    /// An invalid source.
    #[error("source: {0}")]
    Source(RecordError),
    /// An imprint of another size than the sensor's.
    #[error("imprint: {found} taxels, expected {expected} as the sensor has")]
    Size {
        /// The size of the imprint.
        found: MatrixSize,
        /// The size of the sensor.
        expected: MatrixSize,
    },
}

impl StoredShape {
    /// Makes a stored shape of these parts.
    ///
    /// # Errors
    /// Returns [`ShapeError::Size`] if the imprint has another number of columns or rows than the sensor.
    pub fn new(
        name: Name,
        sensor: Sensor,
        imprint: Imprint,
        source: Option<Source>,
    ) -> Result<Self, ShapeError> {
        let (found, expected) = (imprint.size(), sensor.size());
        if found != expected {
            return Err(ShapeError::Size { found, expected });
        }
        Ok(Self {
            name,
            sensor,
            imprint,
            source,
        })
    }

    /// Returns the same shape under another name.
    #[must_use]
    pub fn renamed(self, name: Name) -> Self {
        Self { name, ..self }
    }

    /// Reads a file's content; a byte order mark before it is skipped.
    ///
    /// # Errors
    /// Returns an error that says what is wrong, where, and what was expected.
    pub fn read(text: &[u8]) -> Result<Self, ShapeError> {
        if text.len() > MAX_BYTES {
            return Err(ShapeError::Large);
        }
        let text = without_mark(text);
        let file: ShapeFile<'_> =
            serde_json::from_slice(text).map_err(|error| ShapeError::Json {
                line: error.line(),
                column: error.column().max(1),
                message: message(&error),
            })?;
        let FormatRecord = file.format.ok_or(ShapeError::Missing("format"))?;
        let NameRecord(name) = file.name.ok_or(ShapeError::Missing("name"))?;
        let SensorRecord(sensor) = file.sensor.ok_or(ShapeError::Missing("sensor"))?;
        let ImprintRecord(imprint) = file.imprint.ok_or(ShapeError::Missing("imprint"))?;
        let source = file
            .source
            .map(|source| {
                source.no_sensor("source")?;
                source.source(&sensor, &no_names)
            })
            .transpose();
        Self::new(name, sensor, imprint, source.map_err(ShapeError::Source)?)
    }

    /// Returns the content of the file, with a line per row of the imprint.
    pub fn write(&self) -> String {
        let mut text = json::pretty(self);
        text.push('\n');
        text
    }
}

/// There is no `Deserialize`: [`StoredShape::read`] reads a shape.
impl Serialize for StoredShape {
    fn serialize<S: Serializer>(&self, serializer: S) -> Result<S::Ok, S::Error> {
        let mut map = serializer.serialize_map(None)?;
        map.serialize_entry("format", FORMAT)?;
        map.serialize_entry("name", self.name.as_str())?;
        map.serialize_entry("sensor", &self.sensor)?;
        map.serialize_entry("imprint", &self.imprint)?;
        if let Some(source) = &self.source {
            map.serialize_entry("source", source)?;
        }
        map.end()
    }
}

/// The format of a file, which is [`FORMAT`]; another one is refused at its place in the file.
struct FormatRecord;

impl<'de> Deserialize<'de> for FormatRecord {
    fn deserialize<D: Deserializer<'de>>(deserializer: D) -> Result<Self, D::Error> {
        let Text(format) = Text::deserialize(deserializer)?;
        if format == FORMAT {
            Ok(Self)
        } else {
            Err(D::Error::custom(format_args!(
                "{:?} is unknown to this version, which reads {FORMAT:?}",
                shortened(&format)
            )))
        }
    }
}

/// The name in a file; an invalid one is refused at its place in the file.
struct NameRecord(Name);

impl<'de> Deserialize<'de> for NameRecord {
    fn deserialize<D: Deserializer<'de>>(deserializer: D) -> Result<Self, D::Error> {
        struct NameVisitor;
        impl Visitor<'_> for NameVisitor {
            type Value = NameRecord;
            fn expecting(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
                f.write_str("a string")
            }
            fn visit_str<E: Error>(self, text: &str) -> Result<Self::Value, E> {
                Name::new(text).map(NameRecord).map_err(E::custom)
            }
        }
        deserializer.deserialize_str(NameVisitor)
    }
}

struct SensorRecord(Sensor);

impl<'de> Deserialize<'de> for SensorRecord {
    fn deserialize<D: Deserializer<'de>>(deserializer: D) -> Result<Self, D::Error> {
        let sensor = Values::deserialize(deserializer)?.sensor(Sensor::default());
        sensor.map(SensorRecord).map_err(D::Error::custom)
    }
}

#[derive(Default)]
struct ShapeFile<'a> {
    format: Option<FormatRecord>,
    name: Option<NameRecord>,
    sensor: Option<SensorRecord>,
    imprint: Option<ImprintRecord>,
    /// The figure or picture that left the imprint, if it is known.
    source: Option<Record<'a>>,
}

impl<'de: 'a, 'a> Deserialize<'de> for ShapeFile<'a> {
    fn deserialize<D: Deserializer<'de>>(deserializer: D) -> Result<Self, D::Error> {
        keyed_object::<ShapeFile<'de>, D>(deserializer)
    }
}

const SHAPE_KEYS: KnownKeys = KnownKeys {
    named: &["format", "name", "sensor", "imprint", "source"],
    others: &[],
    parameters: false,
};

impl<'de> KeyedObject<'de> for ShapeFile<'de> {
    const EXPECTED: &'static str = "a stored shape";

    fn take_key<A: MapAccess<'de>>(&mut self, key: &str, map: &mut A) -> Result<(), A::Error> {
        match key {
            // Another format has other keys, so its name is reported before its keys are refused.
            "format" => once("format", &mut self.format, value_of("format", map)?),
            "name" => once("name", &mut self.name, value_of("name", map)?),
            "sensor" => once("sensor", &mut self.sensor, value_of("sensor", map)?),
            "imprint" => once("imprint", &mut self.imprint, value_of("imprint", map)?),
            "source" => once("source", &mut self.source, value_of("source", map)?),
            _ => Err(A::Error::custom(SHAPE_KEYS.unknown(key))),
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn an_unknown_key_is_answered_with_the_key_that_was_probably_meant() {
        let error = StoredShape::read(b"{\"fromat\":\"taxel-shape/1\"}").expect_err("unknown");
        let message = error.to_string();
        assert!(
            message.contains("unknown key \"fromat\", expected format, name,"),
            "{message}"
        );
        assert!(message.contains("did you mean"), "{message}");
    }

    #[test]
    fn a_key_given_twice_is_refused() {
        let keys = [
            "\"format\":\"taxel-shape/1\"",
            "\"name\":\"cup\"",
            "\"sensor\":{}",
            "\"imprint\":[\"#\"]",
            "\"source\":{\"picture\":[\"#\"]}",
        ];
        for key in keys {
            let text = format!("{{{key},{key}}}");
            let error = StoredShape::read(text.as_bytes()).expect_err("twice");
            let name = key.split('"').nth(1).expect("a name");
            let message = format!(": {name}: given twice");
            assert!(error.to_string().ends_with(&message), "{error}");
        }
    }
}
