//! A frame of a real sensor as a line of JSON, with the rule for its imprint:
//! `{"frame":[[0,12],[null,30]],"at_least":10}`.

use std::fmt;

use serde::de::{Deserialize, Deserializer, Error, Unexpected, Visitor};

use crate::frame::{Frame, FrameError, LARGEST_VALUE, Processing, Rule};
use crate::imprint::Imprint;
use crate::matrix::Matrix;
use crate::parameter::number::counted;
use crate::sensor::{MAX_SIDE, MatrixSize};

/// The keys beside `frame` that say which values are active.
pub(crate) const RULE_KEYS: [&str; 5] = ["at_least", "percent", "low", "high", "least"];

/// The values of a frame, row by row; null where there is no cell.
pub type FrameRows = Vec<Vec<Option<f64>>>;

/// The rule for active values, as the keys of a line give it.
#[derive(Clone, Debug, Default, PartialEq, serde::Deserialize)]
pub struct RuleRecord {
    /// The least active value.
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
    /// Returns the number of taxels.
    pub(crate) fn get(self) -> u32 {
        self.0
    }
}

impl<'de> Deserialize<'de> for LeastTaxels {
    fn deserialize<D: Deserializer<'de>>(deserializer: D) -> Result<Self, D::Error> {
        deserializer.deserialize_u64(LeastTaxelsVisitor)
    }
}

/// The visitor of [`LeastTaxels`].
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
    /// Returns the rule that these keys give.
    ///
    /// # Errors
    /// Returns a message of one sentence if the rule is missing or out of range, or if there are several.
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

/// The number of taxels of the largest imprint.
const MOST_TAXELS: u32 = MAX_SIDE as u32 * MAX_SIDE as u32;

/// Makes a matrix from its rows; NaN where there is no cell.
///
/// # Errors
/// Returns a message of one sentence if the rows differ in length, if a side is not from 1 to [`MAX_SIDE`], or if a
/// value is beyond ±[`LARGEST_VALUE`].
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

/// Returns the message for a value beyond ±[`LARGEST_VALUE`].
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
