//! Numbers in and out: range checks, reading, showing, stepping.

use super::error::ParameterError;
use super::number;
use super::range::Range;
use super::table::{Decimals, LENGTH, PARAMETERS, Parameter, Row, Unit};
use crate::quote::shortened;

impl Parameter {
    /// Its row of the table.
    pub fn row(self) -> &'static Row {
        const { &PARAMETERS }
            .iter()
            .find(|row| row.parameter == self)
            .unwrap_or(&LENGTH)
    }

    /// What files and flags may set, on a sensor whose larger side is `side`.
    pub fn range(self, side: u8) -> Range {
        let row = self.row();
        Range {
            low: row.low,
            high: row.high,
            side: f64::from(side),
        }
    }

    /// What forms may set.
    pub fn form_range(self, side: u8) -> Range {
        let row = self.row();
        let (low, high) = row.form.unwrap_or((row.low, row.high));
        Range {
            low,
            high,
            ..self.range(side)
        }
    }

    /// Where a new form starts: the default, or what is nearest to it on a small sensor.
    pub fn default(self, side: u8) -> f64 {
        let default = self.row().default;
        if self.range(side).contains(default) {
            default
        } else {
            f64::from(side)
        }
    }

    /// `value`, if files and flags may set it.
    ///
    /// # Errors
    /// [`ParameterError::Range`], for a number that is not finite too.
    pub fn check(self, value: f64, side: u8) -> Result<f64, ParameterError> {
        let range = self.range(side);
        let whole = !matches!(self.row().unit, Unit::Taxels) || value.fract() == 0.0;
        if range.contains(value) && whole {
            Ok(value)
        } else {
            Err(ParameterError::Range {
                parameter: self,
                value,
                range,
            })
        }
    }

    /// The number in the text of a flag.
    ///
    /// # Errors
    /// [`ParameterError::Number`] or [`ParameterError::Range`].
    pub fn read(self, text: &str, side: u8) -> Result<f64, ParameterError> {
        self.check(self.number(text)?, side)
    }

    fn number(self, text: &str) -> Result<f64, ParameterError> {
        number::read(text).ok_or_else(|| ParameterError::Number {
            parameter: self,
            text: shortened(text),
        })
    }

    /// The number in the text of a form's field.
    ///
    /// # Errors
    /// Any [`ParameterError`]: forms hold to the paper's decimals.
    pub fn read_form(self, text: &str, side: u8) -> Result<f64, ParameterError> {
        let text = text.trim();
        let plain = text
            .bytes()
            .all(|byte| byte.is_ascii_digit() || matches!(byte, b'.' | b'-'));
        if !plain {
            return Err(ParameterError::Number {
                parameter: self,
                text: shortened(text),
            });
        }
        let value = self.number(text)?;
        let range = self.form_range(side);
        if !range.contains(value) {
            return Err(ParameterError::Range {
                parameter: self,
                value,
                range,
            });
        }
        let given = text
            .split_once('.')
            .map_or(0, |(_, fraction)| fraction.trim_end_matches('0').len());
        let allowed = self.decimals_at(value);
        if given > allowed {
            return Err(ParameterError::Decimals {
                parameter: self,
                value,
                allowed,
            });
        }
        Ok(value)
    }

    /// How many decimals a form shows and takes at a value.
    fn decimals_at(self, value: f64) -> usize {
        match self.row().decimals {
            Decimals::Paper if value.abs() < 10.0 => 2,
            Decimals::Paper => 1,
            Decimals::Fixed(count) => usize::from(count),
        }
    }

    /// The number as a form shows it: with the form's decimals, or as [`number::short`] does where it has more.
    pub fn format(self, value: f64) -> String {
        let usual = format!("{value:.*}", self.decimals_at(value));
        let exact = usual.parse::<f64>().is_ok_and(|read| read == value);
        if exact { usual } else { number::short(value) }
    }

    /// The next number that a form takes, `direction` last decimals further; angles go round, others stop at the ends.
    pub fn step(self, value: f64, direction: i32, side: u8) -> f64 {
        let direction = f64::from(direction.signum());
        // From ten up the steps are tenths, from ten down hundredths.
        let decimals = self.decimals_at(value + direction.min(0.0) * 0.01);
        let scale = 10_f64.powi(i32::try_from(decimals).unwrap_or(0));
        let stepped = ((value * scale).round() + direction) / scale;
        if self == Self::Angle {
            return stepped.rem_euclid(360.0);
        }
        self.form_range(side).nearest(stepped, 1.0 / scale)
    }
}
