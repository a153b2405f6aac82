//! A stored shape: one JSON file with a name, a sensor, an imprint and, where it was not drawn by hand, its source.

use serde::{Deserialize, Serialize};
use taxel_core::imprint::Imprint;
use taxel_core::picture::Picture;
use taxel_core::recognition::NamedShape;
use taxel_core::sensor::Sensor;
use taxel_core::source::Source;

use crate::error::ReadError;
use crate::formats::file::without_mark;
use crate::formats::json;
use crate::formats::name::Name;
use crate::formats::record::{Record, SensorRecord, no_names};

/// The size limit of a shape file in bytes; a larger file is not read.
pub const MAX_BYTES: usize = 1 << 20;

/// A stored shape; made by [`StoredShape::new`] or [`StoredShape::read`].
#[derive(Clone, Debug, PartialEq, Serialize)]
#[serde(tag = "format", rename = "taxel-shape/1")]
pub struct StoredShape {
    /// The name.
    pub name: Name,
    /// The sensor that the shape was made on.
    pub sensor: Sensor,
    /// The taxels; as many columns and rows as the sensor has.
    pub imprint: Imprint,
    /// The figure, picture or outline that left the imprint; None if it was drawn by hand.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub source: Option<Source>,
}

/// The format of a file. Another one, perhaps newer, is refused.
#[derive(Deserialize)]
enum Format {
    #[serde(rename = "taxel-shape/1")]
    First,
}

#[derive(Deserialize)]
#[serde(deny_unknown_fields, expecting = "a stored shape")]
struct ShapeFile {
    #[serde(rename = "format")]
    _format: Format,
    name: Name,
    sensor: SensorRecord,
    imprint: Imprint,
    source: Option<Record>,
}

impl StoredShape {
    /// Makes a stored shape of these parts.
    ///
    /// # Errors
    /// Returns an error if the imprint has another number of columns or rows than the sensor.
    pub fn new(
        name: Name,
        sensor: Sensor,
        imprint: Imprint,
        source: Option<Source>,
    ) -> Result<Self, ReadError> {
        let (found, expected) = (imprint.size(), sensor.size());
        if found != expected {
            return Err(ReadError::new(format!(
                "imprint: {found} taxels, expected {expected} as the sensor has"
            )));
        }
        Ok(Self {
            name,
            sensor,
            imprint,
            source,
        })
    }

    /// The shape as it is touched again: its outline as it was placed, otherwise the picture of its imprint.
    pub fn touched_again(&self) -> Source {
        let source = match &self.source {
            Some(source @ Source::Outline(_)) => source.clone(),
            _ => Picture::at_home(self.imprint).into(),
        };
        source.named(self.name.as_str())
    }

    /// The shape as one of a set, where neither its place, its angle nor its zoom counts.
    pub fn of_set(&self) -> NamedShape {
        NamedShape::new(self.name.to_string(), self.touched_again().at_home())
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
    pub fn read(text: &[u8]) -> Result<Self, ReadError> {
        if text.len() > MAX_BYTES {
            return Err(ReadError::new("larger than 1 MiB, the limit for a shape"));
        }
        let file: ShapeFile = json::object(without_mark(text))?;
        let pitch = file.sensor.pitch_mm;
        let sensor = file.sensor.sensor(Sensor::default());
        let sensor = sensor.map_err(|error| error.of_key("sensor"))?;
        let source = file.source;
        let source = source.map(|own| own.source(&sensor, pitch, &no_names));
        let source = source.transpose().map_err(|error| error.of_key("source"))?;
        Self::new(file.name, sensor, file.imprint, source)
    }

    /// Returns the content of the file, with a line per row of the imprint.
    pub fn write(&self) -> String {
        let Some(source @ Source::Outline(_)) = &self.source else {
            return json::pretty(self) + "\n";
        };
        // A line for each number of thousands of points would exceed the size limit.
        let source = json::text(source);
        let head = json::pretty(&Self {
            source: None,
            ..self.clone()
        });
        let head = head.trim_end_matches("\n}");
        format!("{head},\n  \"source\": {source}\n}}\n")
    }
}
