//! JSON objects that describe a shape: a line of `taxel batch`, a shape of a set, the source of a stored shape.

use std::fmt;
use std::num::NonZeroU32;

use serde::Deserialize;
use serde::de::value::SeqAccessDeserializer;
use serde::de::{Deserializer, Error, SeqAccess, Visitor};
use taxel_core::figure::{Figure, FigureKind};
use taxel_core::imprint::Imprint;
use taxel_core::outline::{Outline, Ring};
use taxel_core::parameter::number::to_decimals;
use taxel_core::parameter::{PARAMETERS, Parameter};
use taxel_core::picture::{PICTURE_PARAMETERS, Picture};
use taxel_core::quote::joined;
use taxel_core::sensor::Sensor;
use taxel_core::source::Source;

use crate::error::ReadError;
use crate::formats::job::FrameRows;
use crate::formats::named_shape::ShapeLookup;

/// The keys of all these objects. A reader takes those that are its own, and refuses what does not belong to the rest.
#[derive(Clone, Debug, Default, Deserialize)]
#[serde(default, deny_unknown_fields)]
#[serde(expecting = "an object with a figure, a picture, an outline, an imprint or a frame")]
pub(crate) struct Record {
    pub(crate) name: Option<String>,
    pub(crate) weight: Option<NonZeroU32>,
    pub(crate) figure: Option<FigureKind>,
    pub(crate) picture: Option<ImprintOrName>,
    pub(crate) outline: Option<Vec<Ring>>,
    unit: Option<Unit>,
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
            (
                "unit",
                self.unit.is_some() && self.figure.is_none() && self.outline.is_none(),
            ),
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

    /// Returns the figure, picture or outline. No other key may be left. Zooms are 1 if they are not given. Lengths in mm
    /// are divided by the pitch.
    pub(crate) fn source(
        &self,
        sensor: &Sensor,
        pitch_mm: Option<f64>,
        lookup: &ShapeLookup<'_>,
    ) -> Result<Source, ReadError> {
        let source = match (self.figure, &self.picture, &self.outline) {
            (Some(kind), None, None) => {
                self.only(kind.name(), kind.parameters())?;
                let Some(pitch) = self.pitch_of_lengths(pitch_mm)? else {
                    return Ok(Figure::new(kind, sensor, |own| self.get(own))?.into());
                };
                let is_length = |own| kind.sizes().contains(&own) || own == Parameter::Thickness;
                let figure = Figure::new(kind, sensor, |own| match self.get(own)? {
                    // Rounded as by `model separate`: 0.3 mm at 0.1 mm are 3 cells.
                    length if is_length(own) => Some(to_decimals(length / pitch, 9)),
                    value => Some(value),
                });
                let divided = |error| format!("{error}; the pitch is {pitch} mm");
                let figure = figure.map_err(|error| ReadError::new(divided(error)))?;
                return Ok(figure.into());
            }
            (None, Some(picture), None) => {
                self.only("picture", PICTURE_PARAMETERS)?;
                match picture {
                    ImprintOrName::Imprint(imprint) => Picture::at_home(**imprint).into(),
                    ImprintOrName::Name(name) => {
                        lookup(name).map_err(|error| ReadError::new(error).of_key("picture"))?
                    }
                }
            }
            (None, None, Some(rings)) => {
                self.only("outline", PICTURE_PARAMETERS)?;
                let outline = Outline::new(rings.clone(), self.pitch_of_lengths(pitch_mm)?);
                outline?.into()
            }
            _ => return Err(ReadError::new(ONE_KEY)),
        };
        Ok(source.placed(sensor, |parameter| match parameter {
            Parameter::ZoomX | Parameter::ZoomY => self.get(parameter).or(Some(1.0)),
            _ => self.get(parameter),
        })?)
    }

    /// Returns the pitch by which lengths are divided; None if they are in cells.
    fn pitch_of_lengths(&self, pitch_mm: Option<f64>) -> Result<Option<f64>, ReadError> {
        match (self.unit, pitch_mm) {
            (None | Some(Unit::Cells), _) => Ok(None),
            (Some(Unit::Mm), Some(pitch)) => Ok(Some(pitch)),
            (Some(Unit::Mm), None) => {
                let text = "unit: mm need the pitch, from --pitch or as pitch_mm of the sensor";
                Err(ReadError::new(text))
            }
        }
    }
}

/// The unit of the lengths of a figure or an outline.
#[derive(Clone, Copy, Debug, Deserialize)]
#[serde(rename_all = "lowercase")]
enum Unit {
    Mm,
    Cells,
}

/// The message about an object that is nothing, or several things at once.
pub(crate) const ONE_KEY: &str =
    "expected exactly one of the keys figure, picture, outline, imprint, frame";

/// Looks up no names, for files that are complete in themselves.
pub(crate) fn no_names(_: &str) -> Result<Source, String> {
    Err("expected rows of '#' and '.'".to_owned())
}

/// A sensor; what is not given is as in another one.
#[derive(Clone, Debug, Default, Deserialize)]
#[serde(default, deny_unknown_fields, expecting = "an object")]
pub(crate) struct SensorRecord {
    columns: Option<f64>,
    rows: Option<f64>,
    threshold: Option<f64>,
    pub(crate) pitch_mm: Option<f64>,
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

#[cfg(test)]
mod tests {
    use super::*;
    use crate::formats::job::Job;
    use crate::formats::{Name, StoredShape, named_shape};

    const PLATE: &str =
        r#""outline":[[[0,0],[15,0],[15,10],[0,10]],{"cx":5,"cy":5,"rx":2.5,"ry":2.5}]"#;

    fn job(line: &str, pitch: Option<f64>) -> Result<Source, String> {
        let stored = Outline::new(
            vec![Ring::Polygon(vec![[0.0, 0.0], [5.0, 0.0], [0.0, 5.0]])],
            Some(2.5),
        );
        let lookup = |name: &str| match (name, &stored) {
            ("wedge", Ok(wedge)) => Ok(wedge.clone().into()),
            _ => Err("no such shape".to_owned()),
        };
        match Job::read(line.as_bytes(), Sensor::default(), pitch, &lookup) {
            Ok(Job::Touch(_, source)) => Ok(source),
            Ok(Job::Describe(_)) => Err("no touch".to_owned()),
            Err(error) => Err(error.to_string()),
        }
    }

    fn size(source: Source) -> [f64; 2] {
        match source {
            Source::Outline(outline) => outline.size(),
            _ => [0.0; 2],
        }
    }

    #[test]
    fn lengths_in_mm_are_divided_by_the_pitch() -> Result<(), String> {
        let figure = r#""figure":"hexagon","x0":2,"y0":1,"angle":0"#;
        let in_mm = job(
            &format!(r#"{{{figure},"side":7.5,"thickness":2.5,"unit":"mm"}}"#),
            Some(2.5),
        )?;
        let in_cells = job(
            &format!(r#"{{{figure},"side":3,"thickness":1,"unit":"cells"}}"#),
            Some(2.5),
        )?;
        assert_eq!(in_mm, in_cells);
        let tenths = job(
            &format!(r#"{{{figure},"side":0.3,"unit":"mm"}}"#),
            Some(0.1),
        )?;
        assert_eq!(tenths.get(Parameter::Side), Some(3.0));
        let placed = r#""unit":"mm","x0":2,"y0":1,"angle":0"#;
        let plate = job(&format!("{{{PLATE},{placed}}}"), Some(2.5))?;
        assert_eq!(size(plate.clone()), [6.0, 4.0]);
        assert_eq!(plate.get(Parameter::X0), Some(2.0));
        // The line's own sensor goes before the pitch that is given.
        let own = r#""sensor":{"pitch_mm":5}"#;
        assert_eq!(
            size(job(&format!("{{{PLATE},{placed},{own}}}"), Some(2.5))?),
            [3.0, 2.0]
        );
        let named = r#"{"picture":"wedge","x0":2,"y0":1,"angle":0}"#;
        assert_eq!(size(job(named, None)?), [2.0, 2.0]);
        let finer = r#"{"picture":"wedge","x0":2,"y0":1,"angle":0,"sensor":{"pitch_mm":1.25}}"#;
        assert_eq!(size(job(finer, Some(2.5))?), [4.0, 4.0]);
        Ok(())
    }

    #[test]
    fn wrong_outlines_and_lengths_are_refused() {
        let crossing = "[[0,0],[4,0],[4,4],[0,4]],[[2,2],[6,2],[6,6],[2,6]]";
        let long = "[[0,0],[60,0],[60,24]]";
        let cases = [
            (
                format!(r#""outline":[{crossing}]"#),
                "outline: rings 1 and 2 cross",
            ),
            (
                r#""outline":[[[0,0],[4,0]]]"#.to_owned(),
                "outline: ring 1: 2 points, expected at least 3",
            ),
            (r#""outline":[]"#.to_owned(), "outline: no rings"),
            (
                format!(r#""outline":[{long}],"unit":"mm","sensor":{{"pitch_mm":2.5}}"#),
                "outline: 24 cells (60 mm) long, 8 cells (20 mm) longer than the sensor",
            ),
            (
                format!(r#""outline":[{long}]"#),
                "outline: 60 cells long, 44 cells longer than the sensor",
            ),
            (
                format!(r#""outline":[{long}],"unit":"mm""#),
                "unit: mm need the pitch, from --pitch or as pitch_mm of the sensor",
            ),
            (
                r###""picture":["##"],"unit":"mm""###.to_owned(),
                "unit: does not belong to \"picture\", expected x0, y0, angle, zoom_x or zoom_y",
            ),
            (
                format!(r#""outline":[{long}],"side":3"#),
                "side: does not belong to \"outline\", expected x0, y0, angle, zoom_x or zoom_y",
            ),
            (format!(r#""outline":[{long}],"figure":"ellipse""#), ONE_KEY),
            (
                r#""figure":"triangle","side":50,"unit":"mm","sensor":{"pitch_mm":2.5}"#.to_owned(),
                "side: 20 is above 16 (allowed: above 0, up to 16); the pitch is 2.5 mm",
            ),
        ];
        for (keys, expected) in cases {
            let line = format!(r#"{{{keys},"x0":0,"y0":0,"angle":0}}"#);
            assert_eq!(job(&line, None), Err(expected.to_owned()), "{line}");
        }
    }

    #[test]
    fn a_stored_shape_keeps_its_rings_and_their_unit() -> Result<(), Box<dyn std::error::Error>> {
        let sensor = Sensor::default().with(Parameter::Pitch, 2.5)?;
        let line = format!(r#"{{"name":"plate",{PLATE},"unit":"mm"}}"#);
        let plate = named_shape(line.as_bytes(), Some(2.5), &no_names)?.source;
        let plate = plate.with(Parameter::ZoomX, 1.5, &sensor)?;
        let imprint = Imprint::empty(sensor.size());
        let shape = StoredShape::new(Name::new("plate")?, sensor, imprint, Some(plate.clone()))?;
        let text = shape.write();
        assert_eq!(StoredShape::read(text.as_bytes())?, shape);
        assert_eq!(shape.touched_again(), plate);
        assert_eq!(shape.of_set().source.get(Parameter::ZoomX), Some(1.0));
        let without = text.replace("\"pitch_mm\": 2.5,", "");
        let refused = StoredShape::read(without.as_bytes()).map_err(|error| error.message);
        let expected = "source: unit: mm need the pitch, from --pitch or as pitch_mm of the sensor";
        assert_eq!(refused, Err(expected.to_owned()));
        Ok(())
    }
}
