//! The values of a shape's parameters: what figures and pictures have in common.

use crate::parameter::{Parameter, ParameterError};
use crate::sensor::Sensor;

/// The number of parameters of shapes. They come first among all parameters.
const COUNT: usize = Parameter::ZoomY as usize + 1;

/// A value for each parameter of shapes; None for one that a shape does not have, or that is not given.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub(crate) struct Values([Option<f64>; COUNT]);

impl Values {
    /// Creates values that are not checked.
    pub(crate) fn unchecked<const N: usize>(given: [(Parameter, f64); N]) -> Self {
        let mut values = Self::default();
        for (parameter, value) in given {
            values.put(parameter, value);
        }
        values
    }

    /// Creates the values of a picture or an outline that is neither zoomed nor turned.
    pub(crate) fn upright(x0: f64, y0: f64) -> Self {
        use Parameter::{Angle, X0, Y0, ZoomX, ZoomY};
        Self::unchecked([(X0, x0), (Y0, y0), (Angle, 0.0), (ZoomX, 1.0), (ZoomY, 1.0)])
    }

    /// Creates the values that `value` returns for the parameters `own` of a shape, each in range on the sensor. Only
    /// the thickness may be missing.
    pub(crate) fn new(
        own: &[Parameter],
        sensor: &Sensor,
        mut value: impl FnMut(Parameter) -> Option<f64>,
    ) -> Result<Self, ParameterError> {
        let mut values = Self::default();
        for &parameter in own {
            match value(parameter) {
                Some(value) => values.put(parameter, sensor.check(parameter, value)?),
                None if parameter == Parameter::Thickness => {}
                None => {
                    let range = sensor.range(parameter);
                    return Err(ParameterError::Missing { parameter, range });
                }
            }
        }
        Ok(values)
    }

    pub(crate) fn get(&self, parameter: Parameter) -> Option<f64> {
        self.0.get(parameter as usize).copied().flatten()
    }

    /// The value of a parameter that the shape has; otherwise 0.
    pub(crate) fn of(&self, parameter: Parameter) -> f64 {
        self.get(parameter).unwrap_or_default()
    }

    /// Changes a value without a check.
    pub(crate) fn put(&mut self, parameter: Parameter, value: f64) {
        if let Some(slot) = self.0.get_mut(parameter as usize) {
            *slot = Some(value);
        }
    }
}
