//! One line of `taxel batch`: a figure, a picture or a whole matrix, perhaps with its own sensor; or the values of a
//! real sensor with a threshold.

use std::fmt;

use serde::de::{Deserialize, Deserializer, Error, MapAccess, Unexpected, Visitor};
use taxel_core::frame::{Frame, FrameError, LARGEST_VALUE, Processing, Rule};
use taxel_core::imprint::Imprint;
use taxel_core::matrix::Matrix;
use taxel_core::parameter::number::counted;
use taxel_core::sensor::{MAX_SIDE, MatrixSize, Sensor};
use taxel_core::source::Source;
use taxel_core::touch::Plane;

use crate::formats::json::{WithoutNan, message_of_line};
use crate::formats::record::{
    KeyedObject, KnownKeys, Record, RecordError, keyed_object, once, value_of,
};

/// The task in a line: a figure, a picture or a whole matrix, perhaps with its own sensor; or the values of a real
/// sensor with a threshold.
#[derive(Clone, Debug, PartialEq)]
pub enum Job {
    /// Touch a source with a sensor.
    Touch(Sensor, Source),
    /// Describe a matrix as it is.
    Describe(Imprint),
}

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
    /// sensor. Sizes, position, angle and zooms have no defaults ([`PARAMETERS`](taxel_core::parameter::PARAMETERS) lists
    /// keys, units and ranges); a figure without `thickness` is solid. A picture is given by its rows, or by a name
    /// that `lookup` finds. The sensor is `sensor` with the changes that the line makes, as in
    /// `"sensor":{"columns":32,"rows":32,"threshold":0.5}`.
    ///
    /// A frame has the values of a sensor in rows, null where there is no cell, and a [`Rule`]:
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

const KEYS: &str = "figure, picture, imprint, frame";

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

/// The keys beside `frame` that say which values are active.
pub(crate) const RULE_KEYS: [&str; 5] = ["at_least", "percent", "low", "high", "least"];

/// The values of a frame, row by row; null where there is no cell.
pub type FrameRows = Vec<Vec<Option<f64>>>;

/// The rule for active values, as the keys of a line give it.
#[derive(Clone, Debug, Default, PartialEq, serde::Deserialize)]
pub struct RuleRecord {
    pub(crate) at_least: Option<f64>,
    /// The least active value, in percent of the largest one.
    pub(crate) percent: Option<f64>,
    /// The least value that is active if its taxel is joined to one of at least `high`.
    pub(crate) low: Option<f64>,
    /// The least value that is active in any case; given together with `low`.
    pub(crate) high: Option<f64>,
    /// The fewest taxels of a piece; smaller pieces are dropped.
    pub(crate) least: Option<LeastTaxels>,
}

/// The fewest taxels of a piece, 1 to the number of taxels of the largest imprint.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(crate) struct LeastTaxels(u32);

impl LeastTaxels {
    pub(crate) fn get(self) -> u32 {
        self.0
    }
}

impl<'de> Deserialize<'de> for LeastTaxels {
    fn deserialize<D: Deserializer<'de>>(deserializer: D) -> Result<Self, D::Error> {
        deserializer.deserialize_u64(LeastTaxelsVisitor)
    }
}

struct LeastTaxelsVisitor;

impl Visitor<'_> for LeastTaxelsVisitor {
    type Value = LeastTaxels;

    fn expecting(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        write!(f, "a whole number from 1 to {MOST_TAXELS}")
    }

    fn visit_u64<E: Error>(self, taxels: u64) -> Result<LeastTaxels, E> {
        let fitting = u32::try_from(taxels).ok();
        fitting
            .filter(|taxels| (1..=MOST_TAXELS).contains(taxels))
            .map(LeastTaxels)
            .ok_or_else(|| E::invalid_value(Unexpected::Unsigned(taxels), &self))
    }
}

impl RuleRecord {
    pub(crate) fn rule(&self) -> Result<Rule, String> {
        let made = |rule: Result<Rule, FrameError>| rule.map_err(|error| error.to_string());
        match (self.at_least, self.percent, self.low, self.high) {
            (Some(threshold), None, None, None) => made(Rule::at_least(threshold)),
            (None, Some(percent), None, None) => made(Rule::percent(percent)),
            (None, None, Some(low), Some(high)) => made(Rule::hysteresis(low, high)),
            (None, None, None, None) => {
                Err("no threshold, expected at_least, percent, or low and high".to_owned())
            }
            (None, None, Some(_), None) => Err("low without high, expected both".to_owned()),
            (None, None, None, Some(_)) => Err("high without low, expected both".to_owned()),
            _ => Err(
                "several thresholds, expected one: at_least, percent, or low and high".to_owned(),
            ),
        }
    }

    /// Returns the imprint of a frame by this rule.
    ///
    /// # Errors
    /// Returns a message of one sentence if there is no rule or several, or if the rows are not a frame of at most 64
    /// × 64 cells.
    pub fn imprint(&self, rows: &[Vec<Option<f64>>]) -> Result<Imprint, String> {
        let mut processing = Processing::default();
        processing.rule = Some(self.rule()?);
        processing.least = self.least.map_or(0, LeastTaxels::get);
        let wrong = |error: String| format!("frame: {error}");
        let values = matrix(rows).map_err(wrong)?;
        let mut frame = Frame::new(values.size().into());
        frame.values_mut().copy_from_slice(values.values());
        let processed = processing
            .run(&frame)
            .map_err(|error| wrong(error.to_string()))?;
        processed
            .imprint
            .ok_or_else(|| wrong("no threshold".to_owned()))
    }
}

const MOST_TAXELS: u32 = MAX_SIDE as u32 * MAX_SIDE as u32;

/// Makes a matrix from its rows; NaN where there is no cell.
pub(crate) fn matrix(rows: &[Vec<Option<f64>>]) -> Result<Matrix<f64>, String> {
    let (height, width) = (rows.len(), rows.first().map_or(0, Vec::len));
    let Some(size) = MatrixSize::of_sides(width, height) else {
        return Err(format!(
            "{} of {width}, expected 1 to {MAX_SIDE} of each",
            counted(height as u64, "row")
        ));
    };
    if let Some((row, number)) = rows.iter().zip(1..).find(|(row, _)| row.len() != width) {
        let found = counted(row.len() as u64, "value");
        return Err(format!(
            "row {number} has {found}, expected {width} as in the first row"
        ));
    }
    let mut values = rows.iter().flatten().flatten();
    if let Some(&value) = values.find(|value| value.abs() > LARGEST_VALUE) {
        return Err(too_large(value));
    }
    let mut matrix = Matrix::filled(size, f64::NAN);
    for (slot, value) in matrix.values_mut().iter_mut().zip(rows.iter().flatten()) {
        *slot = value.unwrap_or(f64::NAN);
    }
    Ok(matrix)
}

pub(crate) fn too_large(value: f64) -> String {
    if value.is_infinite() {
        return "infinite, expected a number".to_owned();
    }
    format!("{value:e} is too large, expected at most {LARGEST_VALUE:e}")
}

#[cfg(test)]
mod tests {
    use super::*;

    fn imprint(rule: &str, frame: &str) -> Result<String, String> {
        let rule: RuleRecord = serde_json::from_str(rule).expect("a rule");
        let rows: FrameRows = serde_json::from_str(frame).expect("a frame");
        rule.imprint(&rows).map(|imprint| imprint.to_string())
    }

    #[test]
    fn a_frame_becomes_an_imprint_by_one_rule() {
        let frame = "[[10, 9.5, null], [0, 20, 20]]";
        assert_eq!(
            imprint("{\"at_least\":10}", frame).as_deref(),
            Ok("#..\n.##")
        );
        assert_eq!(
            imprint("{\"percent\":100}", frame).as_deref(),
            Ok("...\n.##")
        );
        let both = "{\"low\":9,\"high\":20,\"least\":2}";
        assert_eq!(imprint(both, frame).as_deref(), Ok("##.\n.##"));
        let wrong = |rule: &str, frame: &str| imprint(rule, frame).expect_err("it is refused");
        assert!(wrong("{}", frame).starts_with("no threshold, expected at_least"));
        assert_eq!(
            wrong("{\"low\":1}", frame),
            "low without high, expected both"
        );
        assert!(wrong("{\"low\":1,\"percent\":5}", frame).starts_with("several thresholds"));
        assert!(wrong("{\"percent\":0}", frame).contains("above 0"));
        assert_eq!(
            wrong("{\"at_least\":1}", "[[1, 2], [3]]"),
            "frame: row 2 has 1 value, expected 2 as in the first row"
        );
        let large = "frame: -1e301 is too large, expected at most 1e300";
        assert_eq!(wrong("{\"at_least\":1}", "[[1e300, -1e301]]"), large);
        assert_eq!(
            wrong("{\"at_least\":1}", "[]"),
            "frame: 0 rows of 0, expected 1 to 64 of each"
        );
        let row_of = |length: usize| format!("[[{}]]", vec!["1"; length].join(","));
        assert!(imprint("{\"at_least\":1}", &row_of(64)).is_ok());
        assert_eq!(
            wrong("{\"at_least\":1}", &row_of(65)),
            "frame: 1 row of 65, expected 1 to 64 of each"
        );
    }
}
