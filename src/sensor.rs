//! The tactile matrix sensor: so many columns and rows of square cells, a threshold, a pitch.

use crate::parameter::{Parameter, ParameterError};

/// The largest number of columns, and of rows.
pub const MAX_SIDE: u8 = 64;

/// The parameters of a sensor, in the order of forms.
pub const SENSOR_PARAMETERS: [Parameter; 4] = [
    Parameter::Columns,
    Parameter::Rows,
    Parameter::Threshold,
    Parameter::Pitch,
];

/// A sensor. Its values are always in range: columns and rows 1 to 64, threshold in (0, 1],
/// pitch above 0, up to 1000 mm.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Sensor {
    columns: u8,
    rows: u8,
    threshold: f64,
    pitch_mm: f64,
}

impl Default for Sensor {
    /// The paper's: 16 × 16 taxels, active from one half on; cells of 1 mm.
    fn default() -> Self {
        Self {
            columns: 16,
            rows: 16,
            threshold: 0.5,
            pitch_mm: 1.0,
        }
    }
}

impl Sensor {
    /// A sensor of `columns × rows` taxels, otherwise as the default one.
    ///
    /// # Errors
    /// Where a number is not from 1 to [`MAX_SIDE`].
    pub fn new(columns: u8, rows: u8) -> Result<Self, ParameterError> {
        Self::default()
            .with(Parameter::Columns, columns.into())?
            .with(Parameter::Rows, rows.into())
    }

    /// The same sensor with one of [`SENSOR_PARAMETERS`] set; `value` in the parameter's unit. Unchanged by any other,
    /// whose value is checked all the same.
    ///
    /// # Errors
    /// Where the value is out of the parameter's range.
    #[expect(
        clippy::cast_possible_truncation,
        clippy::cast_sign_loss,
        reason = "checked: a whole number, 1 to 64"
    )]
    pub fn with(mut self, parameter: Parameter, value: f64) -> Result<Self, ParameterError> {
        let value = parameter.check(value, MAX_SIDE)?;
        match parameter {
            Parameter::Columns => self.columns = value as u8,
            Parameter::Rows => self.rows = value as u8,
            Parameter::Threshold => self.threshold = value,
            Parameter::Pitch => self.pitch_mm = value,
            _ => {}
        }
        Ok(self)
    }

    /// One of its values; none of a parameter that it does not have.
    pub fn get(&self, parameter: Parameter) -> Option<f64> {
        match parameter {
            Parameter::Columns => Some(f64::from(self.columns)),
            Parameter::Rows => Some(f64::from(self.rows)),
            Parameter::Threshold => Some(self.threshold),
            Parameter::Pitch => Some(self.pitch_mm),
            _ => None,
        }
    }

    /// Number of columns.
    pub fn columns(&self) -> u8 {
        self.columns
    }

    /// Number of rows.
    pub fn rows(&self) -> u8 {
        self.rows
    }

    /// The larger of the two, which bounds the parameters of figures.
    pub fn side(&self) -> u8 {
        self.columns.max(self.rows)
    }

    /// The share of a cell that makes its taxel active.
    pub fn threshold(&self) -> f64 {
        self.threshold
    }

    /// The side of a cell, in mm.
    pub fn pitch_mm(&self) -> f64 {
        self.pitch_mm
    }
}
