//! The values that files and answers contain, as serde writes them. Keys are those of the tables of parameters
//! and descriptors. None of them can be deserialized by itself: which values are in range depends on the sensor, so
//! files and lines are read as a whole.

use serde::ser::{Error, Serialize, SerializeMap, Serializer};

use crate::description::Value;
use crate::frame::{Label, Rule, SetRule};
use crate::imprint::Imprint;
use crate::parameter::Parameter;
use crate::sensor::{SENSOR_PARAMETERS, Sensor};
use crate::source::Source;

impl Serialize for Value {
    fn serialize<S: Serializer>(&self, serializer: S) -> Result<S::Ok, S::Error> {
        match *self {
            Self::None => serializer.serialize_none(),
            Self::Count(count) => serializer.serialize_u32(count),
            Self::Number(number) => serializer.serialize_f64(number),
            Self::Point(point) => [point.x, point.y].serialize(serializer),
            Self::Pair(pair) => pair.serialize(serializer),
            Self::Rect(rect) => {
                let mut map = serializer.serialize_map(Some(4))?;
                map.serialize_entry("left", &rect.left)?;
                map.serialize_entry("top", &rect.top)?;
                map.serialize_entry("right", &rect.right)?;
                map.serialize_entry("bottom", &rect.bottom)?;
                map.end()
            }
        }
    }
}

impl Serialize for Label {
    /// Writes a number or a text.
    fn serialize<S: Serializer>(&self, serializer: S) -> Result<S::Ok, S::Error> {
        match self {
            Self::Number(number) => serializer.serialize_i64(*number),
            Self::Text(text) => serializer.serialize_str(text),
        }
    }
}

/// There is no `Deserialize`: a source is read with its sensor, as a part of a stored shape or of a line of a batch.
impl Serialize for Source {
    /// Writes the object that reads back as the same source.
    fn serialize<S: Serializer>(&self, serializer: S) -> Result<S::Ok, S::Error> {
        let mut map = serializer.serialize_map(None)?;
        match self {
            Self::Figure(figure) => map.serialize_entry("figure", figure.kind().name())?,
            Self::Picture(picture) => map.serialize_entry("picture", picture.imprint())?,
        }
        for &parameter in self.parameters() {
            if let Some(value) = self.get(parameter) {
                map.serialize_entry(parameter.row().key, &value)?;
            }
        }
        map.end()
    }
}

/// The parameters of a sensor in the order of files, which is not that of forms.
const SENSOR_IN_FILES: [Parameter; SENSOR_PARAMETERS.len()] = [
    Parameter::Columns,
    Parameter::Rows,
    Parameter::Pitch,
    Parameter::Threshold,
];

/// There is no `Deserialize`: a sensor is read as a part of a stored shape or of a line of a batch.
impl Serialize for Sensor {
    fn serialize<S: Serializer>(&self, serializer: S) -> Result<S::Ok, S::Error> {
        let mut map = serializer.serialize_map(Some(SENSOR_IN_FILES.len()))?;
        for parameter in SENSOR_IN_FILES {
            let key = parameter.row().key;
            match parameter {
                // Whole numbers are written without decimals.
                Parameter::Columns => map.serialize_entry(key, &self.columns())?,
                Parameter::Rows => map.serialize_entry(key, &self.rows())?,
                _ => map.serialize_entry(key, &self.get(parameter))?,
            }
        }
        map.end()
    }
}

/// There is no `Deserialize`: a rule is read as a part of the metadata beside a recording, or of a line of a batch.
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
        /// Most rows of an imprint are empty, so their text is ready.
        const EMPTY: &str = "................................................................";
        let columns = usize::from(self.columns);
        if self.word == 0 {
            return serializer.serialize_str(&EMPTY[..columns]);
        }
        let mut row = [b'.'; EMPTY.len()];
        let row = &mut row[..columns];
        for (column, byte) in row.iter_mut().enumerate() {
            *byte = if self.word >> column & 1 == 1 {
                b'#'
            } else {
                b'.'
            };
        }
        serializer.serialize_str(str::from_utf8(row).map_err(S::Error::custom)?)
    }
}
