//! The shapes of a set: one JSON object each.

use std::num::NonZeroU32;

use serde::de::{Deserialize, Deserializer, MapAccess};
use taxel_core::imprint::Imprint;
use taxel_core::picture::Picture;
use taxel_core::pose::Axis;
use taxel_core::recognition::NamedShape;
use taxel_core::sensor::Sensor;
use taxel_core::source::Source;

use crate::formats::json::message_of_line;
use crate::formats::record::{
    KeyedObject, KnownKeys, Record, RecordError, keyed_object, once, value_of,
};

/// The error for an object or a text that is not a shape of a set.
#[derive(Clone, Debug, PartialEq, thiserror::Error)]
pub enum NamedShapeError {
    /// Not JSON, or not an object with known keys.
    #[error("column {column}: {message}")]
    Json {
        /// The column of the error, from 1.
        column: usize,
        /// A description of the error.
        message: String,
    },
    /// No name.
    #[error("name: missing; every shape of a set needs one")]
    Name,
    /// A value that has no meaning.
    #[error(transparent)]
    Record(#[from] RecordError),
    /// A position, an angle or a zoom.
    #[error(
        "{key}: a shape of a set has no pose of its own; it is touched in all poses of the grid"
    )]
    Pose {
        /// The key of the parameter.
        key: &'static str,
    },
}

/// A function that finds the imprint of a stored shape.
pub type ShapeLookup<'a> = dyn Fn(&str) -> Result<Imprint, String> + 'a;

/// Reads a shape of a set from a JSON object. It has neither a pose nor a sensor: the shapes of a set are touched in
/// the poses of a grid, on one sensor.
///
/// ```text
/// {"name":"disc","figure":"ellipse","radius_x":3.09,"radius_y":3.09}
/// {"name":"washer","picture":"washer","weight":2}
/// {"name":"corner","picture":["##","#."]}
/// ```
/// The sizes of a figure have no defaults ([`PARAMETERS`](taxel_core::parameter::PARAMETERS) lists keys, units and ranges); without `thickness` it is
/// solid. A picture is given by its rows, or by the name of a stored shape, which `lookup` finds. The weight, from 1,
/// says how often the shape is expected compared with the others; by default 1.
///
/// # Errors
/// Returns an error that says in one sentence what is wrong.
///
/// ```
/// use taxel_files::formats::named_shape;
/// let line = br#"{"name":"disc","figure":"ellipse","radius_x":3.09,"radius_y":3.09}"#;
/// let disc = named_shape(line, &|name| Err(format!("no shape {name}"))).unwrap();
/// assert_eq!((disc.name.as_str(), disc.weight), ("disc", 1));
/// ```
pub fn named_shape(line: &[u8], lookup: &ShapeLookup<'_>) -> Result<NamedShape, NamedShapeError> {
    let read = serde_json::from_slice(line);
    let line: Line<'_> = read.map_err(|error| NamedShapeError::Json {
        column: error.column().max(1),
        message: message_of_line(line, &error, Line::EXPECTED),
    })?;
    let name = line.name.ok_or(NamedShapeError::Name)?;
    line.record.no_sensor("shape")?;
    let source = source(line.record, lookup)?;
    let weight = line.weight.map_or(1, NonZeroU32::get);
    Ok(NamedShape::new(name, source).weighted(weight))
}

/// Makes the shape of a record, which must have no pose, at the origin.
fn source(mut record: Record<'_>, lookup: &ShapeLookup<'_>) -> Result<Source, NamedShapeError> {
    let mut posed = Axis::ALL.map(Axis::parameter).into_iter();
    let given = posed.find(|&parameter| record.values.get(parameter).is_some());
    if let Some(parameter) = given {
        let key = parameter.row().key;
        return Err(NamedShapeError::Pose { key });
    }
    if let Record {
        figure: None,
        picture: None,
        imprint: Some(imprint),
        values,
        ..
    } = &record
    {
        values.only("imprint", &[])?;
        return Ok(Picture::at_home(*imprint).into());
    }
    for axis in Axis::ALL {
        if !axis.is_zoom() {
            record.values.set(axis.parameter(), 0.0);
        } else if record.figure.is_none() {
            record.values.set(axis.parameter(), 1.0);
        }
    }
    Ok(record.source(&Sensor::LARGEST, lookup)?)
}

#[derive(Default)]
struct Line<'a> {
    name: Option<String>,
    /// The weight: how often the shape is expected; 1 if not given.
    weight: Option<NonZeroU32>,
    record: Record<'a>,
}

const LINE_KEYS: KnownKeys = KnownKeys {
    named: &["name", "weight", "figure", "picture", "imprint"],
    others: &[],
    parameters: true,
};

impl<'de: 'a, 'a> Deserialize<'de> for Line<'a> {
    fn deserialize<D: Deserializer<'de>>(deserializer: D) -> Result<Self, D::Error> {
        keyed_object::<Line<'de>, D>(deserializer)
    }
}

impl<'de> KeyedObject<'de> for Line<'de> {
    const EXPECTED: &'static str = "an object with a name and a figure, a picture or an imprint";

    fn take_key<A: MapAccess<'de>>(&mut self, key: &str, map: &mut A) -> Result<(), A::Error> {
        match key {
            "name" => once("name", &mut self.name, value_of("name", map)?),
            "weight" => once("weight", &mut self.weight, value_of("weight", map)?),
            _ => self.record.take(key, map, &LINE_KEYS),
        }
    }
}
