//! The values that files and answers contain, as serde writes them. Keys are those of the tables of parameters
//! and descriptors. Imprints, rings and the kinds of figures are read, too. Sources, sensors and rules cannot be read by
//! themselves: which values are in range depends on the sensor, so files and lines are read as a whole.

use std::borrow::Cow;
use std::fmt;

use serde::de::value::{MapAccessDeserializer, SeqAccessDeserializer};
use serde::de::{self, Deserializer, MapAccess, SeqAccess, Visitor};
use serde::ser::{Error, SerializeMap, Serializer};
use serde::{Deserialize, Serialize};

use crate::figure::FigureKind;
use crate::frame::{Rule, SetRule};
use crate::imprint::Imprint;
use crate::outline::{EllipseRing, Ring};
use crate::sensor::MAX_SIDE;
use crate::source::Source;

impl Serialize for Source {
    /// Writes the object that reads back as the same source.
    fn serialize<S: Serializer>(&self, serializer: S) -> Result<S::Ok, S::Error> {
        let mut map = serializer.serialize_map(None)?;
        match self {
            Self::Figure(figure) => map.serialize_entry("figure", figure.kind().name())?,
            Self::Picture(picture) => map.serialize_entry("picture", picture.imprint())?,
            Self::Outline(outline) => {
                map.serialize_entry("outline", outline.rings())?;
                if outline.pitch_mm().is_some() {
                    map.serialize_entry("unit", "mm")?;
                }
            }
        }
        for &parameter in self.parameters() {
            if let Some(value) = self.get(parameter) {
                map.serialize_entry(parameter.row().key, &value)?;
            }
        }
        map.end()
    }
}

/// A polygon is a list of its points, an ellipse an object.
impl Serialize for Ring {
    fn serialize<S: Serializer>(&self, serializer: S) -> Result<S::Ok, S::Error> {
        match self {
            Self::Polygon(points) => points.serialize(serializer),
            Self::Ellipse(EllipseRing {
                centre: [cx, cy],
                radii: [rx, ry],
                angle,
            }) => {
                let mut map = serializer.serialize_map(None)?;
                for (key, value) in [("cx", cx), ("cy", cy), ("rx", rx), ("ry", ry)] {
                    map.serialize_entry(key, value)?;
                }
                if *angle != 0.0 {
                    map.serialize_entry("angle", angle)?;
                }
                map.end()
            }
        }
    }
}

impl<'de> Deserialize<'de> for Ring {
    fn deserialize<D: Deserializer<'de>>(deserializer: D) -> Result<Self, D::Error> {
        deserializer.deserialize_any(RingVisitor)
    }
}

struct RingVisitor;

impl<'de> Visitor<'de> for RingVisitor {
    type Value = Ring;

    fn expecting(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.write_str("a ring: a list of points, or an object with cx, cy, rx and ry")
    }

    fn visit_seq<A: SeqAccess<'de>>(self, points: A) -> Result<Ring, A::Error> {
        let points: Vec<Vec<f64>> = Vec::deserialize(SeqAccessDeserializer::new(points))?;
        let point = |own: Vec<f64>| {
            let wrong =
                |own: Vec<f64>| format!("a point of {} numbers, expected x and y", own.len());
            <[f64; 2]>::try_from(own).map_err(|own| de::Error::custom(wrong(own)))
        };
        let points: Result<_, _> = points.into_iter().map(point).collect();
        points.map(Ring::Polygon)
    }

    fn visit_map<A: MapAccess<'de>>(self, keys: A) -> Result<Ring, A::Error> {
        let own = EllipseKeys::deserialize(MapAccessDeserializer::new(keys))?;
        Ok(Ring::Ellipse(EllipseRing {
            centre: [own.cx, own.cy],
            radii: [own.rx, own.ry],
            angle: own.angle,
        }))
    }
}

#[derive(Deserialize)]
#[serde(deny_unknown_fields)]
struct EllipseKeys {
    cx: f64,
    cy: f64,
    rx: f64,
    ry: f64,
    #[serde(default)]
    angle: f64,
}

impl Serialize for SetRule {
    fn serialize<S: Serializer>(&self, serializer: S) -> Result<S::Ok, S::Error> {
        let mut map = serializer.serialize_map(None)?;
        match self.rule {
            Rule::AtLeast(threshold) => map.serialize_entry("at_least", &Shortest(threshold))?,
            Rule::Percent(percent) => map.serialize_entry("percent", &Shortest(percent))?,
            Rule::Hysteresis { low, high } => {
                map.serialize_entry("low", &Shortest(low))?;
                map.serialize_entry("high", &Shortest(high))?;
            }
            Rule::Noise(deviations) => map.serialize_entry("noise", &Shortest(deviations))?,
        }
        if self.least > 1 {
            map.serialize_entry("least", &self.least)?;
        }
        map.serialize_entry("from", self.from.name())?;
        map.end()
    }
}

/// A finite number, written without a fraction if it is whole.
#[derive(Clone, Copy, Debug)]
pub struct Shortest(pub f64);

impl Serialize for Shortest {
    fn serialize<S: Serializer>(&self, serializer: S) -> Result<S::Ok, S::Error> {
        #[expect(clippy::cast_possible_truncation, reason = "checked")]
        if self.0.fract() == 0.0 && self.0.abs() < 9e15 {
            serializer.serialize_i64(self.0 as i64)
        } else {
            serializer.serialize_f64(self.0)
        }
    }
}

/// An imprint is a list of its rows.
impl Serialize for Imprint {
    fn serialize<S: Serializer>(&self, serializer: S) -> Result<S::Ok, S::Error> {
        let columns = self.columns();
        let words = self.words().iter();
        serializer.collect_seq(words.map(|&word| ImprintRow { word, columns }))
    }
}

/// A row of an imprint as a text.
struct ImprintRow {
    word: u64,
    columns: u8,
}

impl Serialize for ImprintRow {
    fn serialize<S: Serializer>(&self, serializer: S) -> Result<S::Ok, S::Error> {
        let taxel = |column: usize| b".#"[usize::from(self.word >> column & 1 == 1)];
        let row: [u8; MAX_SIDE as usize] = std::array::from_fn(taxel);
        let row = &row[..usize::from(self.columns)];
        serializer.serialize_str(str::from_utf8(row).map_err(S::Error::custom)?)
    }
}

/// A text, which is borrowed unless it has escapes.
#[derive(Deserialize)]
struct Text<'a>(#[serde(borrow)] Cow<'a, str>);

/// An imprint is read from a list of its rows.
impl<'de> Deserialize<'de> for Imprint {
    fn deserialize<D: Deserializer<'de>>(deserializer: D) -> Result<Self, D::Error> {
        let rows = Vec::<Text<'_>>::deserialize(deserializer)?;
        Self::from_rows(rows.iter().map(|Text(row)| &**row)).map_err(de::Error::custom)
    }
}

/// A kind of figure is read from its name.
impl<'de> Deserialize<'de> for FigureKind {
    fn deserialize<D: Deserializer<'de>>(deserializer: D) -> Result<Self, D::Error> {
        let Text(name) = Text::deserialize(deserializer)?;
        name.parse().map_err(de::Error::custom)
    }
}
