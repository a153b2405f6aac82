//! The tactile matrix sensor: its columns and rows of square cells, its threshold, its pitch, and the values that it
//! allows.
//!
//! The ranges of a figure's lengths and positions scale with the larger side of the sensor. So the sensor checks,
//! parses and steps values: `sensor.check(Parameter::X0, 1.99)`.

use std::fmt;

use crate::parameter::{Parameter, ParameterError, Range, Unit, number};
use crate::quote::shortened;

/// The largest number of columns, and of rows.
pub const MAX_SIDE: u8 = 64;

/// The columns and rows of a sensor, its imprints and its matrices of values: each from 1 to [`MAX_SIDE`].
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash, serde::Serialize)]
pub struct MatrixSize {
    columns: u8,
    rows: u8,
}

impl MatrixSize {
    /// The smallest size: one cell.
    pub const SMALLEST: Self = Self::unchecked(1, 1);

    /// The largest size: [`MAX_SIDE`] columns and rows.
    pub const LARGEST: Self = Self::unchecked(MAX_SIDE, MAX_SIDE);

    const fn unchecked(columns: u8, rows: u8) -> Self {
        Self { columns, rows }
    }

    /// Creates the size of a matrix from its columns and rows.
    ///
    /// # Errors
    /// Returns an error if a number is not from 1 to [`MAX_SIDE`].
    pub fn new(columns: u8, rows: u8) -> Result<Self, ParameterError> {
        let largest = Sensor::LARGEST;
        largest.check(Parameter::Columns, columns.into())?;
        largest.check(Parameter::Rows, rows.into())?;
        Ok(Self { columns, rows })
    }

    /// Returns the size of a matrix from sides of any integer type; None if one is not from 1 to [`MAX_SIDE`].
    pub fn of_sides(columns: impl TryInto<u8>, rows: impl TryInto<u8>) -> Option<Self> {
        Self::new(columns.try_into().ok()?, rows.try_into().ok()?).ok()
    }

    /// Returns the number of columns.
    pub fn columns(self) -> u8 {
        self.columns
    }

    /// Returns the number of rows.
    pub fn rows(self) -> u8 {
        self.rows
    }

    /// Returns the number of cells.
    pub fn cells(self) -> usize {
        usize::from(self.columns) * usize::from(self.rows)
    }

    /// Returns the smallest size that contains both sizes.
    #[must_use]
    pub fn union(self, other: Self) -> Self {
        Self::unchecked(self.columns.max(other.columns), self.rows.max(other.rows))
    }

    #[cfg(test)]
    pub(crate) fn of(columns: u8, rows: u8) -> Self {
        Self::new(columns, rows).expect("1 to 64")
    }
}

impl fmt::Display for MatrixSize {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        write!(f, "{} × {}", self.columns, self.rows)
    }
}

/// The parameters of a sensor, in the order in which forms show them.
pub const SENSOR_PARAMETERS: &[Parameter] = &[
    Parameter::Columns,
    Parameter::Rows,
    Parameter::Threshold,
    Parameter::Pitch,
];

/// A sensor whose values are always in range: 1 to 64 columns and rows, a threshold above 0 and up to 1, a pitch
/// above 0 and up to 1000 mm.
#[derive(Clone, Copy, Debug, PartialEq, serde::Serialize)]
pub struct Sensor {
    #[serde(flatten)]
    size: MatrixSize,
    pitch_mm: f64,
    threshold: f64,
}

impl Default for Sensor {
    fn default() -> Self {
        Self::of_size(MatrixSize::unchecked(16, 16))
    }
}

impl Sensor {
    /// The largest sensor, 64 × 64. It allows every value that any sensor allows.
    pub const LARGEST: Self = Self::of_size(MatrixSize::LARGEST);

    /// Creates a sensor of `columns × rows` taxels, with the default threshold and pitch.
    ///
    /// # Errors
    /// Returns an error if a number is not from 1 to [`MAX_SIDE`].
    pub fn new(columns: u8, rows: u8) -> Result<Self, ParameterError> {
        MatrixSize::new(columns, rows).map(Self::of_size)
    }

    /// Creates a sensor of this size, with the default threshold and pitch. It cannot fail, so every imprint can be the
    /// whole matrix of a sensor.
    pub const fn of_size(size: MatrixSize) -> Self {
        Self {
            size,
            threshold: 0.5,
            pitch_mm: 1.0,
        }
    }

    /// Returns the same sensor with one of [`SENSOR_PARAMETERS`] changed to `value`, in the parameter's unit.
    ///
    /// # Errors
    /// Returns an error if the value is out of range, or the parameter is not one of a sensor.
    #[expect(
        clippy::cast_possible_truncation,
        clippy::cast_sign_loss,
        reason = "checked: a whole number, 1 to 64"
    )]
    pub fn with(mut self, parameter: Parameter, value: f64) -> Result<Self, ParameterError> {
        let value = self.check_own("sensor", SENSOR_PARAMETERS, parameter, value)?;
        match parameter {
            Parameter::Columns => self.size.columns = value as u8,
            Parameter::Rows => self.size.rows = value as u8,
            Parameter::Threshold => self.threshold = value,
            _ => self.pitch_mm = value,
        }
        Ok(self)
    }

    /// Returns the same sensor with another threshold: the share of a cell that must be covered to activate its taxel.
    ///
    /// # Errors
    /// Returns an error if the threshold is not above 0 and at most 1.
    pub fn with_threshold(self, threshold: f64) -> Result<Self, ParameterError> {
        self.with(Parameter::Threshold, threshold)
    }

    /// Returns the value of a parameter; None if a sensor does not have the parameter.
    pub fn get(&self, parameter: Parameter) -> Option<f64> {
        match parameter {
            Parameter::Columns => Some(f64::from(self.size.columns)),
            Parameter::Rows => Some(f64::from(self.size.rows)),
            Parameter::Threshold => Some(self.threshold),
            Parameter::Pitch => Some(self.pitch_mm),
            _ => None,
        }
    }

    /// Returns the number of columns and rows.
    pub fn size(&self) -> MatrixSize {
        self.size
    }

    /// Returns the number of columns.
    pub fn columns(&self) -> u8 {
        self.size.columns
    }

    /// Returns the number of rows.
    pub fn rows(&self) -> u8 {
        self.size.rows
    }

    /// Returns the number of columns or rows, whichever is larger. It bounds the lengths and positions of figures.
    pub fn side(&self) -> u8 {
        self.size.columns.max(self.size.rows)
    }

    /// Returns the threshold: the share of a cell that must be covered to activate its taxel.
    pub fn threshold(&self) -> f64 {
        self.threshold
    }

    /// Returns the side of a cell in mm.
    pub fn pitch_mm(&self) -> f64 {
        self.pitch_mm
    }
}

impl Sensor {
    /// Returns the range of a parameter on this sensor. It is the same in forms, flags, files and commands.
    pub fn range(&self, parameter: Parameter) -> Range {
        parameter.row().range(self.side())
    }

    /// Returns the value of a parameter in a new form: its default, or the larger side of the sensor if the default
    /// is out of range.
    pub fn default_value(&self, parameter: Parameter) -> f64 {
        let default = parameter.row().default;
        let is_allowed = self.range(parameter).contains(default);
        if is_allowed {
            default
        } else {
            self.side().into()
        }
    }

    /// Returns `value` if it is allowed for the parameter; a negative zero becomes 0.
    ///
    /// # Errors
    /// Returns [`ParameterError::Range`] if the value is out of range, NaN or infinite, or should be whole and is not.
    pub fn check(&self, parameter: Parameter, value: f64) -> Result<f64, ParameterError> {
        let range = self.range(parameter);
        let is_whole = parameter.row().unit != Unit::Taxels || value.fract() == 0.0;
        if !range.contains(value) || !is_whole {
            return Err(ParameterError::Range {
                parameter,
                value,
                range,
            });
        }
        Ok(value + 0.0)
    }

    /// Returns `value` as [`Self::check`] does, if the parameter is one of those that its owner has.
    pub(crate) fn check_own(
        &self,
        owner: &'static str,
        expected: &'static [Parameter],
        parameter: Parameter,
        value: f64,
    ) -> Result<f64, ParameterError> {
        if expected.contains(&parameter) {
            return self.check(parameter, value);
        }
        Err(ParameterError::Foreign {
            parameter,
            owner,
            expected,
        })
    }

    /// Parses a value from the text of a flag, a command or a form's field.
    ///
    /// # Errors
    /// Returns [`ParameterError::Number`] if the text is not a number, and the errors of [`Self::check`].
    pub fn read(&self, parameter: Parameter, text: &str) -> Result<f64, ParameterError> {
        let value = number::read(text).ok_or_else(|| ParameterError::Number {
            parameter,
            text: shortened(text),
        })?;
        self.check(parameter, value)
    }

    /// Returns the next value up or down, by the sign of `direction`; 0 only rounds to the nearest one. A step is one of
    /// the last decimal that a form shows. For lengths, positions and zooms that is the paper's: hundredths below ten,
    /// tenths from ten on. Angles are in whole degrees, columns and rows whole numbers, threshold and pitch in
    /// thousandths. Angles wrap around; other parameters stop at the ends of their range. The value must be a number,
    /// not NaN.
    pub fn step(&self, parameter: Parameter, value: f64, direction: i32) -> f64 {
        // Upwards from ten the steps are tenths, downwards from ten hundredths. Below zero it is the other way round.
        let towards = match direction {
            1.. if value < 0.0 => value + 0.01,
            ..=-1 if value > 0.0 => value - 0.01,
            _ => value,
        };
        let scale = 10_f64.powi(parameter.decimals_at(towards).into());
        // A value between two steps goes to the next one. The tolerance of 1e-6 is for a value on a step, which
        // rounding may have moved off it.
        let places = value * scale;
        let stepped = match direction {
            1.. => (places + 1e-6).floor() + 1.0,
            0 => places.round(),
            _ => (places - 1e-6).ceil() - 1.0,
        } / scale;
        if parameter == Parameter::Angle {
            return stepped.rem_euclid(360.0);
        }
        self.range(parameter).nearest(stepped, 1.0 / scale)
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn steps_go_to_the_next_value_with_the_papers_decimals() {
        let sensor = Sensor::default();
        for (parameter, value, up, down) in [
            (Parameter::X0, 1.236, 1.24, 1.23),
            (Parameter::X0, 1.234, 1.24, 1.23),
            (Parameter::X0, 1.24, 1.25, 1.23),
            (Parameter::X0, 0.29, 0.3, 0.28),
            (Parameter::X0, 9.995, 10.0, 9.99),
            (Parameter::X0, 10.0, 10.1, 9.99),
            (Parameter::X0, 10.05, 10.1, 10.0),
            (Parameter::X0, 16.0, 16.0, 15.9),
            (Parameter::X0, 0.0, 0.01, -0.01),
            (Parameter::X0, -1.99, -1.98, -2.0),
            (Parameter::X0, -9.99, -9.98, -10.0),
            (Parameter::X0, -10.0, -9.99, -10.1),
            (Parameter::X0, -16.0, -15.9, -16.0),
            (Parameter::Side, 0.004, 0.01, 0.01),
            (Parameter::Angle, 17.5, 18.0, 17.0),
            (Parameter::Angle, 359.5, 0.0, 359.0),
            (Parameter::Angle, 0.0, 1.0, 359.0),
            (Parameter::Columns, 16.0, 17.0, 15.0),
            (Parameter::Threshold, 0.5, 0.501, 0.499),
            (Parameter::Pitch, 20.0, 20.001, 19.999),
        ] {
            let stepped = [1, -1].map(|direction| sensor.step(parameter, value, direction));
            assert_eq!(stepped, [up, down], "{parameter:?} {value}");
        }
        assert_eq!(sensor.step(Parameter::X0, 1.236, 0), 1.24);
    }

    #[test]
    fn a_fraction_is_not_reported_as_out_of_range() {
        let sensor = Sensor::default();
        let refused = |value| sensor.check(Parameter::Rows, value).expect_err("refused");
        let whole = "is not a whole number (allowed: 1 to 64)";
        assert_eq!(refused(2.5).complaint(), whole);
        for value in [0.5, 64.5, f64::NAN, f64::INFINITY] {
            assert_ne!(refused(value).complaint(), whole);
        }
    }

    #[test]
    fn a_negative_zero_is_read_as_zero() {
        let read = Sensor::default().read(Parameter::X0, "-0.0");
        assert!(read.is_ok_and(f64::is_sign_positive));
    }

    #[test]
    fn a_sensor_refuses_a_parameter_that_it_does_not_have() {
        let error = Sensor::default()
            .with(Parameter::X0, 1.0)
            .expect_err("x0 is not a sensor parameter");
        assert_eq!(
            error.to_string(),
            "x0: a parameter that the sensor does not have, \
             expected columns, rows, threshold or pitch_mm"
        );
    }

    #[test]
    fn a_sensor_has_its_threshold_and_its_pitch() {
        let sensor = Sensor::new(10, 8).and_then(|sensor| sensor.with_threshold(0.3));
        let sensor = sensor.and_then(|sensor| sensor.with(Parameter::Pitch, 1.27));
        let sensor = sensor.expect("in range");
        assert_eq!((sensor.threshold(), sensor.pitch_mm()), (0.3, 1.27));
        assert!(sensor.with_threshold(0.0).is_err() && MatrixSize::new(65, 8).is_err());
    }
}
