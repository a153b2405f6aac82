//! One line of `taxel batch`: a figure, a picture, an outline or a whole matrix, perhaps with its own sensor; or the values of a
//! real sensor with a threshold.

use std::num::NonZeroU32;

use serde::Deserialize;
use taxel_core::frame::{Frame, LARGEST_VALUE, Processing, Rule};
use taxel_core::imprint::Imprint;
use taxel_core::matrix::Matrix;
use taxel_core::parameter::number::counted;
use taxel_core::sensor::{MAX_SIDE, MatrixSize, Sensor};
use taxel_core::source::Source;
use taxel_core::touch::Plane;

use crate::error::ReadError;
use crate::formats::json;
use crate::formats::named_shape::ShapeLookup;
use crate::formats::record::{ONE_KEY, Record};

/// The task in a line: a figure, a picture, an outline or a whole matrix, perhaps with its own sensor; or the values of a real
/// sensor with a threshold.
#[derive(Clone, Debug, PartialEq)]
#[expect(clippy::large_enum_variant, reason = "there is one of these at a time")]
pub enum Job {
    /// Touch a source with a sensor.
    Touch(Sensor, Source),
    /// Describe a matrix as it is.
    Describe(Imprint),
}

impl Job {
    /// Reads a line, which is a JSON object with one of these keys:
    /// ```text
    /// {"figure":"hexagon","side":3,"x0":2.1,"y0":1.35,"angle":17,"thickness":1}
    /// {"picture":["##","#."],"x0":5,"y0":3,"angle":10,"zoom_x":1.5,"zoom_y":1}
    /// {"picture":"washer","x0":2,"y0":2,"angle":0}
    /// {"outline":[[[0,0],[6,0],[6,4],[0,4]],{"cx":2,"cy":2,"rx":1,"ry":1}],"x0":5,"y0":3,"angle":10}
    /// {"imprint":[".##.","#..#",".##."]}
    /// {"frame":[[0,3,8],[1,null,12]],"at_least":5}
    /// ```
    /// A figure, a picture or an outline touches the sensor; an imprint is a whole matrix, which is described as it is and has no
    /// sensor. Sizes, position and angle have no defaults ([`PARAMETERS`](taxel_core::parameter::PARAMETERS) lists
    /// keys, units and ranges); a figure without `thickness` is solid, and zooms are 1 if they are not given. A
    /// picture is given by its rows, or by a name that `lookup` finds. The sensor is `sensor` with the changes that
    /// the line makes, as in `"sensor":{"columns":32,"rows":32,"threshold":0.5}`. With `"unit":"mm"`, the sizes of a
    /// figure and the rings of an outline are divided by the `pitch_mm` of the line's sensor, or else the one given.
    ///
    /// A frame has the values of a sensor in rows, null where there is no cell, and a [`Rule`]:
    /// `at_least`, `percent`, or `low` and `high`. With `least`, pieces of fewer taxels are dropped.
    ///
    /// # Errors
    /// Returns an error if the line has no answer. It names the column, if there is one, but no line.
    pub fn read(
        line: &[u8],
        sensor: Sensor,
        pitch_mm: Option<f64>,
        lookup: &ShapeLookup<'_>,
    ) -> Result<Self, ReadError> {
        let mut record = record(line)?;
        let (imprint, frame) = (record.imprint.take(), record.frame.take());
        let touches =
            record.figure.is_some() || record.picture.is_some() || record.outline.is_some();
        match (touches, imprint, frame) {
            (false, Some(imprint), None) => {
                record.only("imprint", &[])?;
                Ok(Self::Describe(*imprint))
            }
            (false, None, Some(rows)) => {
                let rule = RuleRecord {
                    at_least: record.at_least.take(),
                    percent: record.percent.take(),
                    low: record.low.take(),
                    high: record.high.take(),
                    least: record.least.take(),
                };
                record.only("frame", &[])?;
                rule.imprint(&rows).map(Self::Describe)
            }
            (_, None, None) => {
                let own_pitch = record.sensor.as_ref().and_then(|own| own.pitch_mm);
                let sensor = match record.sensor.take() {
                    Some(own) => own.sensor(sensor).map_err(|error| error.of_key("sensor"))?,
                    None => sensor,
                };
                let source = record.source(&sensor, own_pitch.or(pitch_mm), lookup)?;
                let source = source.at_pitch(own_pitch)?;
                source.check_size(&sensor)?;
                Ok(Self::Touch(sensor, source))
            }
            _ => Err(ReadError::new(ONE_KEY)),
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

/// Only the values of a frame may be `NaN`: elsewhere, a missing value means something else than a wrong one.
fn record(line: &[u8]) -> Result<Record, ReadError> {
    json::of_line(line).or_else(|error| {
        let record: Record = json::of_line_with_nan(line)?;
        if record.frame.is_some() {
            Ok(record)
        } else {
            Err(error)
        }
    })
}

/// The values of a frame, row by row; null where there is no cell.
pub type FrameRows = Vec<Vec<Option<f64>>>;

/// The rule for active values, as the keys of a line give it.
#[derive(Clone, Debug, Default, Deserialize)]
pub struct RuleRecord {
    at_least: Option<f64>,
    /// The least active value, in percent of the largest one.
    percent: Option<f64>,
    /// The least value that is active if its taxel is joined to one of at least `high`.
    low: Option<f64>,
    /// The least value that is active in any case; given together with `low`.
    high: Option<f64>,
    /// The fewest taxels of a piece; smaller pieces are dropped.
    pub(crate) least: Option<NonZeroU32>,
}

impl RuleRecord {
    pub(crate) fn rule(&self) -> Result<Rule, ReadError> {
        let rule = match (self.at_least, self.percent, self.low, self.high) {
            (Some(threshold), None, None, None) => Rule::at_least(threshold),
            (None, Some(percent), None, None) => Rule::percent(percent),
            (None, None, Some(low), Some(high)) => Rule::hysteresis(low, high),
            (None, None, None, None) => {
                let text = "no threshold, expected at_least, percent, or low and high";
                return Err(ReadError::new(text));
            }
            _ => {
                let text = "expected one threshold: at_least, percent, or both low and high";
                return Err(ReadError::new(text));
            }
        };
        rule.map_err(|error| ReadError::new(error.to_string()))
    }

    /// Returns the imprint of a frame by this rule.
    ///
    /// # Errors
    /// Returns an error if there is no rule or several, or if the rows are not a frame of at most 64 × 64 cells.
    pub fn imprint(&self, rows: &[Vec<Option<f64>>]) -> Result<Imprint, ReadError> {
        let mut processing = Processing::default();
        processing.rule = Some(self.rule()?);
        processing.least = self.least.map_or(0, NonZeroU32::get);
        let wrong = |error: String| ReadError::new(error).of_key("frame");
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

/// Makes a matrix from its rows; NaN where there is no cell.
pub(crate) fn matrix(rows: &[Vec<Option<f64>>]) -> Result<Matrix<f64>, String> {
    let (height, width) = (rows.len(), rows.first().map_or(0, Vec::len));
    let Some(size) = MatrixSize::of_sides(width, height) else {
        let found = counted(height as u64, "row");
        return Err(format!(
            "{found} of {width}, expected 1 to {MAX_SIDE} of each"
        ));
    };
    if let Some((row, number)) = rows.iter().zip(1..).find(|(row, _)| row.len() != width) {
        let found = counted(row.len() as u64, "value");
        return Err(format!(
            "row {number} has {found}, expected {width} as in the first row"
        ));
    }
    let mut matrix = Matrix::filled(size, f64::NAN);
    for (slot, value) in matrix.values_mut().iter_mut().zip(rows.iter().flatten()) {
        *slot = value.unwrap_or(f64::NAN);
        if slot.abs() > LARGEST_VALUE {
            return Err(too_large(*slot));
        }
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
        let imprint = rule.imprint(&rows).map_err(|error| error.to_string());
        imprint.map(|imprint| imprint.to_string())
    }

    #[test]
    fn a_frame_becomes_an_imprint_by_one_rule() {
        let frame = "[[10, 9.5, null], [0, 20, 20]]";
        for (rule, expected) in [
            ("{\"at_least\":10}", "#..\n.##"),
            ("{\"percent\":100}", "...\n.##"),
            ("{\"low\":9,\"high\":20,\"least\":2}", "##.\n.##"),
        ] {
            assert_eq!(imprint(rule, frame).as_deref(), Ok(expected));
        }
        for rule in [
            "{}",
            "{\"low\":1}",
            "{\"low\":1,\"percent\":5}",
            "{\"percent\":0}",
        ] {
            assert!(imprint(rule, frame).is_err(), "{rule}");
        }
        let row_of = |length: usize| format!("[[{}]]", vec!["1"; length].join(","));
        assert!(imprint("{\"at_least\":1}", &row_of(64)).is_ok());
        for frame in ["[[1, 2], [3]]", "[[1e300, -1e301]]", "[]", &row_of(65)] {
            assert!(imprint("{\"at_least\":1}", frame).is_err(), "{frame}");
        }
    }
}
