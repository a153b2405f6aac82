//! One line of `taxel batch`: a figure, a picture or a whole matrix, perhaps with its own sensor; or the values of a
//! real sensor with a threshold.

use serde::de::{Deserialize, Deserializer, MapAccess};

use crate::formats::framed::{FrameRows, RULE_KEYS, RuleRecord};
use crate::formats::json::{WithoutNan, message_of_line};
use crate::formats::record::{
    KeyedObject, KnownKeys, Record, RecordError, keyed_object, once, value_of,
};
use crate::imprint::Imprint;
use crate::sensor::Sensor;
use crate::source::Source;
use crate::touch::Plane;

/// The task in a line: a figure, a picture or a whole matrix, perhaps with its own sensor; or the values of a real
/// sensor with a threshold.
#[derive(Clone, Debug, PartialEq)]
pub enum Job {
    /// Touch a source with a sensor.
    Touch(Sensor, Source),
    /// Describe a matrix as it is.
    Describe(Imprint),
}

/// The keys of a line.
const JOB_KEYS: KnownKeys = KnownKeys {
    named: &["figure", "picture", "imprint", "frame", "sensor"],
    others: &RULE_KEYS,
    parameters: true,
};

/// The error for a line without an answer.
#[derive(Clone, Debug, PartialEq, thiserror::Error)]
pub enum JobError {
    /// Not JSON, or not an object with known keys.
    #[error("column {column}: {message}")]
    Json {
        /// The column of the error, from 1.
        column: usize,
        /// A description of the error.
        message: String,
    },
    /// A value without a meaning.
    #[error(transparent)]
    Record(#[from] RecordError),
    /// A frame that gives no imprint; the message is one sentence.
    #[error("{0}")]
    Frame(String),
    /// An invalid sensor.
    #[error("sensor: {0}")]
    Sensor(RecordError),
}

impl Job {
    /// Reads a line, which is a JSON object with one of these keys:
    /// ```text
    /// {"figure":"hexagon","side":3,"x0":2.1,"y0":1.35,"angle":17,"thickness":1}
    /// {"picture":["##","#."],"x0":5,"y0":3,"angle":10,"zoom_x":1.5,"zoom_y":1}
    /// {"picture":"washer","x0":2,"y0":2,"angle":0,"zoom_x":1,"zoom_y":1}
    /// {"imprint":[".##.","#..#",".##."]}
    /// {"frame":[[0,3,8],[1,null,12]],"at_least":5}
    /// ```
    /// A figure or a picture touches the sensor; an imprint is a whole matrix, which is described as it is and has no
    /// sensor. Sizes, position, angle and zooms have no defaults ([`PARAMETERS`](crate::parameter::PARAMETERS) lists
    /// keys, units and ranges); a figure without `thickness` is solid. A picture is given by its rows, or by a name
    /// that `lookup` finds. The sensor is `sensor` with the changes that the line makes, as in
    /// `"sensor":{"columns":32,"rows":32,"threshold":0.5}`.
    ///
    /// A frame has the values of a sensor in rows, null where there is no cell, and a [`Rule`](crate::frame::Rule):
    /// `at_least`, `percent`, or `low` and `high`. With `least`, pieces of fewer taxels are dropped.
    ///
    /// # Errors
    /// Returns an error if the line has no answer; the message is one sentence.
    pub fn read(
        line: &[u8],
        sensor: Sensor,
        lookup: &dyn Fn(&str) -> Result<Imprint, String>,
    ) -> Result<Self, JobError> {
        let without_nan;
        let line: JobLine<'_> = if let Ok(line) = serde_json::from_slice(line) {
            line
        } else {
            without_nan = WithoutNan::new(line);
            let read = serde_json::from_slice(&without_nan.line);
            read.map_err(|error| JobError::Json {
                column: without_nan.column(error.column().max(1)),
                message: message_of_line(line, &error, JobLine::EXPECTED),
            })?
        };
        if let Some(frame) = &line.frame {
            return line.describe(frame).map(Self::Describe);
        }
        if line.rule != RuleRecord::default() {
            let text = "a threshold belongs to a frame, and there is none";
            return Err(JobError::Frame(text.to_owned()));
        }
        let record = line.record;
        let sensor = match &record.sensor {
            Some(own) => own.sensor(sensor).map_err(JobError::Sensor)?,
            None => sensor,
        };
        match &record {
            Record {
                figure: None,
                picture: None,
                imprint: Some(imprint),
                values,
                ..
            } => {
                values.only("imprint", &[])?;
                record.no_sensor("imprint")?;
                Ok(Self::Describe(*imprint))
            }
            _ => Ok(Self::Touch(sensor, touched(&record, &sensor, lookup)?)),
        }
    }

    /// Returns the imprint to describe. `plane` is reused if it has the right sensor.
    pub fn imprint(&self, plane: &mut Plane) -> Imprint {
        match self {
            Self::Describe(imprint) => *imprint,
            Self::Touch(sensor, source) => {
                if plane.sensor() != sensor {
                    *plane = Plane::new(*sensor);
                }
                plane.touch(source)
            }
        }
    }
}

/// Returns the figure or the picture of a line. If there is neither, the error lists all keys that a line can have.
fn touched(
    record: &Record<'_>,
    sensor: &Sensor,
    lookup: &dyn Fn(&str) -> Result<Imprint, String>,
) -> Result<Source, RecordError> {
    record.source(sensor, lookup).map_err(|error| match error {
        RecordError::Which(_) => RecordError::Which(KEYS),
        other => other,
    })
}

/// The keys of which a line has exactly one.
const KEYS: &str = "figure, picture, imprint, frame";

/// A line as it is parsed.
#[derive(Default)]
struct JobLine<'a> {
    record: Record<'a>,
    frame: Option<FrameRows>,
    rule: RuleRecord,
}

impl JobLine<'_> {
    /// Returns the imprint of a frame. Only the keys of its rule may accompany it.
    fn describe(&self, frame: &FrameRows) -> Result<Imprint, JobError> {
        let Record {
            figure: None,
            picture: None,
            imprint: None,
            values,
            ..
        } = &self.record
        else {
            return Err(RecordError::Which(KEYS).into());
        };
        values.only("frame", &[])?;
        self.record.no_sensor("frame")?;
        self.rule.imprint(frame).map_err(JobError::Frame)
    }

    /// Takes the value of a key of a frame's rule.
    fn take_rule<'de, A: MapAccess<'de>>(
        &mut self,
        key: &'static str,
        map: &mut A,
    ) -> Result<(), A::Error> {
        let rule = &mut self.rule;
        match key {
            "at_least" => once(key, &mut rule.at_least, value_of(key, map)?),
            "percent" => once(key, &mut rule.percent, value_of(key, map)?),
            "low" => once(key, &mut rule.low, value_of(key, map)?),
            "high" => once(key, &mut rule.high, value_of(key, map)?),
            _ => once(key, &mut rule.least, value_of(key, map)?),
        }
    }
}

impl<'de: 'a, 'a> Deserialize<'de> for JobLine<'a> {
    fn deserialize<D: Deserializer<'de>>(deserializer: D) -> Result<Self, D::Error> {
        keyed_object::<JobLine<'de>, D>(deserializer)
    }
}

impl<'de> KeyedObject<'de> for JobLine<'de> {
    const EXPECTED: &'static str = "an object with a figure, a picture, an imprint or a frame";

    fn take_key<A: MapAccess<'de>>(&mut self, key: &str, map: &mut A) -> Result<(), A::Error> {
        if let Some(key) = RULE_KEYS.into_iter().find(|own| *own == key) {
            return self.take_rule(key, map);
        }
        match key {
            "frame" => once("frame", &mut self.frame, value_of("frame", map)?),
            _ => self.record.take(key, map, &JOB_KEYS),
        }
    }
}
