//! The error for a value that is not allowed, with one message for forms, flags and files.

use std::fmt;

use crate::parameter::number::{complaint, short};
use crate::parameter::range::Range;
use crate::parameter::table::{Parameter, Unit};
use crate::quote::joined;

/// The error for a value that is not allowed. The message names the parameter, the value, and what is expected.
#[derive(Clone, Debug, PartialEq)]
pub enum ParameterError {
    /// The text is not a number.
    Number {
        /// The parameter.
        parameter: Parameter,
        /// The text, shortened.
        text: String,
    },
    /// The number is out of range.
    Range {
        /// The parameter.
        parameter: Parameter,
        /// The number.
        value: f64,
        /// The allowed range.
        range: Range,
    },
    /// The number is in range, but the parameter counts taxels and the number is not whole.
    Fraction {
        /// The parameter.
        parameter: Parameter,
        /// The number.
        value: f64,
        /// The allowed range.
        range: Range,
    },
    /// A required value is missing.
    Missing {
        /// The parameter.
        parameter: Parameter,
        /// The allowed range.
        range: Range,
    },
    /// The shape, or the sensor, does not have the parameter.
    Foreign {
        /// The parameter.
        parameter: Parameter,
        /// The name of the shape or sensor, such as "hexagon" or "picture".
        owner: &'static str,
        /// The parameters that the shape or sensor has.
        expected: &'static [Parameter],
    },
}

impl std::error::Error for ParameterError {}

impl fmt::Display for ParameterError {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.write_str(&self.about(self.parameter().row().key))
    }
}

impl ParameterError {
    /// Returns the parameter whose value is not allowed.
    pub fn parameter(&self) -> Parameter {
        match self {
            Self::Number { parameter, .. }
            | Self::Range { parameter, .. }
            | Self::Fraction { parameter, .. }
            | Self::Missing { parameter, .. }
            | Self::Foreign { parameter, .. } => *parameter,
        }
    }

    /// Returns the message with the parameter's label, for a screen that shows no key.
    pub fn labelled(&self) -> String {
        self.about(self.parameter().row().label)
    }

    fn about(&self, name: &str) -> String {
        match self {
            Self::Number { text, .. } => format!("{name}: {text:?} is {}", complaint(text)),
            Self::Range { value, .. } | Self::Fraction { value, .. } => {
                format!("{name}: {} {}", short(*value), self.complaint())
            }
            Self::Missing { range, .. } => {
                format!("{name}: missing, expected a number (allowed: {range})")
            }
            Self::Foreign {
                owner, expected, ..
            } => format!(
                "{name}: a parameter that the {owner} does not have, expected {}",
                keys(expected)
            ),
        }
    }

    /// Returns the part of the message that says what is wrong with the value, to be put after the value.
    pub fn complaint(&self) -> String {
        match self {
            Self::Number { text, .. } => format!("is {}", complaint(text)),
            Self::Range { value, range, .. } => {
                format!("{} (allowed: {range})", range.missed_by(*value))
            }
            Self::Fraction { range, .. } => format!("is not a whole number (allowed: {range})"),
            Self::Missing { .. } => "is missing".to_owned(),
            Self::Foreign { owner, .. } => format!("is a parameter that the {owner} does not have"),
        }
    }

    /// Returns the part of the message that says what is expected, for a place that shows the field beside it.
    pub fn expected(&self) -> String {
        match self {
            Self::Number { text, .. } => complaint(text),
            Self::Range {
                parameter, range, ..
            }
            | Self::Fraction {
                parameter, range, ..
            } => format!("expected {range}{}", whole(*parameter)),
            Self::Missing { range, .. } => format!("missing, expected {range}"),
            Self::Foreign { expected, .. } => format!("expected {}", keys(expected)),
        }
    }
}

fn whole(parameter: Parameter) -> &'static str {
    if parameter.row().unit == Unit::Taxels {
        ", a whole number"
    } else {
        ""
    }
}

fn keys(parameters: &[Parameter]) -> String {
    joined(parameters.iter().map(|own| own.row().key), "or")
}

#[cfg(test)]
mod tests {
    #[test]
    fn examples() {
        use crate::prelude::*;
        let error = Sensor::default().read(Parameter::ZoomX, "65").unwrap_err();
        assert_eq!(
            error.to_string(),
            "zoom_x: 65 is above 64 (allowed: above 0, up to 64)"
        );
        assert_eq!(
            error.labelled(),
            "Zoom x: 65 is above 64 (allowed: above 0, up to 64)"
        );
        let complaint = |parameter, text| {
            Sensor::default()
                .read(parameter, text)
                .unwrap_err()
                .complaint()
        };
        assert_eq!(
            complaint(Parameter::Angle, "360"),
            "is not below 360 (allowed: 0 to below 360)"
        );
        assert_eq!(
            complaint(Parameter::Rows, "2.5"),
            "is not a whole number (allowed: 1 to 64)"
        );
        assert_eq!(complaint(Parameter::X0, "left"), "is not a number");
    }
}
