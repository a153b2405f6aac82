//! JSON objects that describe a shape: a line of `taxel batch`, a shape of a set, the source of a stored shape.

use std::fmt;
use std::num::NonZeroU32;

use serde::Deserialize;
use serde::de::value::SeqAccessDeserializer;
use serde::de::{Deserializer, Error, SeqAccess, Visitor};
use taxel_core::figure::{Figure, FigureKind};
use taxel_core::imprint::Imprint;
use taxel_core::parameter::{PARAMETERS, Parameter};
use taxel_core::picture::{PICTURE_PARAMETERS, Picture};
use taxel_core::quote::joined;
use taxel_core::sensor::Sensor;
use taxel_core::source::Source;

use crate::error::ReadError;
use crate::formats::job::FrameRows;

/// The keys of all these objects. A reader takes those that are its own, and refuses what does not belong to the rest.
#[derive(Clone, Debug, Default, Deserialize)]
#[serde(default, deny_unknown_fields)]
#[serde(expecting = "an object with a figure, a picture, an imprint or a frame")]
pub(crate) struct Record {
    pub(crate) name: Option<String>,
    pub(crate) weight: Option<NonZeroU32>,
    pub(crate) figure: Option<FigureKind>,
    pub(crate) picture: Option<ImprintOrName>,
    pub(crate) imprint: Option<Box<Imprint>>,
    pub(crate) frame: Option<FrameRows>,
    pub(crate) sensor: Option<SensorRecord>,
    radius_x: Option<f64>,
    radius_y: Option<f64>,
    length: Option<f64>,
    width: Option<f64>,
    side: Option<f64>,
    pub(crate) x0: Option<f64>,
    pub(crate) y0: Option<f64>,
    pub(crate) angle: Option<f64>,
    thickness: Option<f64>,
    zoom_x: Option<f64>,
    zoom_y: Option<f64>,
    pub(crate) at_least: Option<f64>,
    pub(crate) percent: Option<f64>,
    pub(crate) low: Option<f64>,
    pub(crate) high: Option<f64>,
    pub(crate) least: Option<NonZeroU32>,
}

impl Record {
    pub(crate) fn get(&self, parameter: Parameter) -> Option<f64> {
        match parameter {
            Parameter::RadiusX => self.radius_x,
            Parameter::RadiusY => self.radius_y,
            Parameter::Length => self.length,
            Parameter::Width => self.width,
            Parameter::Side => self.side,
            Parameter::X0 => self.x0,
            Parameter::Y0 => self.y0,
            Parameter::Angle => self.angle,
            Parameter::Thickness => self.thickness,
            Parameter::ZoomX => self.zoom_x,
            Parameter::ZoomY => self.zoom_y,
            Parameter::Columns | Parameter::Rows | Parameter::Threshold | Parameter::Pitch => None,
        }
    }

    /// Refuses the first key besides those that say what the object is, and those of its parameters.
    pub(crate) fn only(&self, thing: &str, parameters: &[Parameter]) -> Result<(), ReadError> {
        let keys = [
            ("name", self.name.is_some()),
            ("weight", self.weight.is_some()),
            ("imprint", self.imprint.is_some()),
            ("frame", self.frame.is_some()),
            ("sensor", self.sensor.is_some()),
            ("at_least", self.at_least.is_some()),
            ("percent", self.percent.is_some()),
            ("low", self.low.is_some()),
            ("high", self.high.is_some()),
            ("least", self.least.is_some()),
        ];
        let foreign = PARAMETERS.iter().map(|row| {
            let parameter = row.parameter;
            let is_foreign = self.get(parameter).is_some() && !parameters.contains(&parameter);
            (row.key, is_foreign)
        });
        let Some((key, _)) = keys.into_iter().chain(foreign).find(|(_, given)| *given) else {
            return Ok(());
        };
        let known = joined(parameters.iter().map(|known| known.row().key), "or");
        let expected = match known.as_str() {
            "" => String::new(),
            known => format!(", expected {known}"),
        };
        Err(ReadError::new(format!(
            "{key}: does not belong to {thing:?}{expected}"
        )))
    }

    /// Returns the figure or the picture. No other key may be left. Zooms are 1 if they are not given.
    pub(crate) fn source(
        &self,
        sensor: &Sensor,
        lookup: &dyn Fn(&str) -> Result<Imprint, String>,
    ) -> Result<Source, ReadError> {
        match (self.figure, &self.picture) {
            (Some(kind), None) => {
                self.only(kind.name(), kind.parameters())?;
                let figure = Figure::new(kind, sensor, |parameter| self.get(parameter))?;
                Ok(Source::Figure(figure))
            }
            (None, Some(picture)) => {
                self.only("picture", PICTURE_PARAMETERS)?;
                let imprint = match picture {
                    ImprintOrName::Imprint(imprint) => **imprint,
                    ImprintOrName::Name(name) => {
                        lookup(name).map_err(|error| ReadError::new(error).of_key("picture"))?
                    }
                };
                let picture = Picture::new(imprint, sensor, |parameter| match parameter {
                    Parameter::ZoomX | Parameter::ZoomY => self.get(parameter).or(Some(1.0)),
                    _ => self.get(parameter),
                })?;
                Ok(Source::Picture(picture))
            }
            _ => Err(ReadError::new(ONE_KEY)),
        }
    }
}

/// The message about an object that is nothing, or several things at once.
pub(crate) const ONE_KEY: &str = "expected exactly one of the keys figure, picture, imprint, frame";

/// Looks up no names, for files that are complete in themselves.
pub(crate) fn no_names(_: &str) -> Result<Imprint, String> {
    Err("expected rows of '#' and '.'".to_owned())
}

/// A sensor; what is not given is as in another one.
#[derive(Clone, Debug, Default, Deserialize)]
#[serde(default, deny_unknown_fields, expecting = "an object")]
pub(crate) struct SensorRecord {
    columns: Option<f64>,
    rows: Option<f64>,
    threshold: Option<f64>,
    pitch_mm: Option<f64>,
}

impl SensorRecord {
    pub(crate) fn sensor(&self, base: Sensor) -> Result<Sensor, ReadError> {
        let given = [
            (Parameter::Columns, self.columns),
            (Parameter::Rows, self.rows),
            (Parameter::Threshold, self.threshold),
            (Parameter::Pitch, self.pitch_mm),
        ];
        let mut sensor = base;
        for (parameter, value) in given {
            if let Some(value) = value {
                sensor = sensor.with(parameter, value)?;
            }
        }
        Ok(sensor)
    }
}

#[derive(Clone, Debug)]
pub(crate) enum ImprintOrName {
    /// An imprint, given as rows of `#` and `.`.
    Imprint(Box<Imprint>),
    /// The name of a shape.
    Name(String),
}

impl<'de> Deserialize<'de> for ImprintOrName {
    fn deserialize<D: Deserializer<'de>>(deserializer: D) -> Result<Self, D::Error> {
        deserializer.deserialize_any(ImprintOrNameVisitor)
    }
}

struct ImprintOrNameVisitor;

impl<'de> Visitor<'de> for ImprintOrNameVisitor {
    type Value = ImprintOrName;

    fn expecting(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.write_str("rows of '#' and '.', or a name")
    }

    fn visit_str<E: Error>(self, name: &str) -> Result<ImprintOrName, E> {
        Ok(ImprintOrName::Name(name.to_owned()))
    }

    fn visit_seq<A: SeqAccess<'de>>(self, rows: A) -> Result<ImprintOrName, A::Error> {
        let imprint = Box::deserialize(SeqAccessDeserializer::new(rows))?;
        Ok(ImprintOrName::Imprint(imprint))
    }
}
