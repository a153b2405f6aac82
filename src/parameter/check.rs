//! Numbers in and out: range checks, reading, showing, stepping.

use crate::parameter::error::ParameterError;
use crate::parameter::number;
use crate::parameter::range::Range;
use crate::parameter::table::{Decimals, LENGTH, PARAMETERS, Parameter, ParameterRow, Unit};
use crate::quote::shortened;

impl Parameter {
    /// Its row of the table.
    pub fn row(self) -> &'static ParameterRow {
        PARAMETERS
            .iter()
            .find(|row| row.parameter == self)
            .unwrap_or(&LENGTH)
    }

    /// What files and flags may set, on a sensor whose larger side is `side`, 1 to 64.
    pub fn range(self, side: u8) -> Range {
        let row = self.row();
        Range {
            low: row.low,
            high: row.high,
            // Or nothing would be in the range of a length.
            side: f64::from(side.max(1)),
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
            f64::from(side.max(1))
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
    /// [`ParameterError::Number`], [`ParameterError::Range`] or [`ParameterError::Decimals`]: forms hold to the paper's
    /// decimals.
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
        // From ten up the steps are tenths, from ten down hundredths.
        let decimals = self.decimals_at(if direction < 0 { value - 0.01 } else { value });
        let scale = 10_f64.powi(i32::try_from(decimals).unwrap_or(0));
        // A number with more decimals lies between two that a form takes; one that it takes may be a rounding beside
        // itself when it is counted in its last decimals.
        let places = value * scale;
        let stepped = match direction {
            1.. => (places + 1e-6).floor() + 1.0,
            0 => places.round(),
            _ => (places - 1e-6).ceil() - 1.0,
        } / scale;
        if self == Self::Angle {
            return stepped.rem_euclid(360.0);
        }
        self.form_range(side).nearest(stepped, 1.0 / scale)
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn steps_lead_to_the_next_number_that_a_form_takes() {
        for (parameter, value, up, down) in [
            (Parameter::X0, 1.236, 1.24, 1.23),
            (Parameter::X0, 1.234, 1.24, 1.23),
            (Parameter::X0, 1.24, 1.25, 1.23),
            (Parameter::X0, 0.29, 0.3, 0.28),
            (Parameter::X0, 9.995, 10.0, 9.99),
            (Parameter::X0, 10.0, 10.1, 9.99),
            (Parameter::X0, 10.05, 10.1, 10.0),
            (Parameter::X0, 16.0, 16.0, 15.9),
            (Parameter::Side, 0.004, 0.01, 0.01),
            (Parameter::Angle, 17.5, 18.0, 17.0),
            (Parameter::Angle, 359.5, 0.0, 359.0),
            (Parameter::Angle, 0.0, 1.0, 359.0),
        ] {
            assert_eq!(parameter.step(value, 1, 16), up, "{parameter:?} {value}");
            assert_eq!(parameter.step(value, -1, 16), down, "{parameter:?} {value}");
        }
        assert_eq!(Parameter::X0.step(1.236, 0, 16), 1.24);
    }
}
