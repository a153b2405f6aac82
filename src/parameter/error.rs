//! Why a number was refused: one text for forms, flags and files.

use std::fmt;

use crate::parameter::number::{complaint, short};
use crate::parameter::range::Range;
use crate::parameter::table::{Parameter, Unit};

/// Why a number was refused. The message names the parameter, what was given and what was expected.
#[derive(Clone, Debug, PartialEq)]
#[non_exhaustive]
pub enum ParameterError {
    /// Not a number at all.
    Number {
        /// What was to be set.
        parameter: Parameter,
        /// What was given, or its beginning.
        text: String,
    },
    /// A number outside of the allowed range.
    Range {
        /// What was to be set.
        parameter: Parameter,
        /// What was given.
        value: f64,
        /// What is allowed.
        range: Range,
    },
    /// More decimals than a form takes.
    Decimals {
        /// What was to be set.
        parameter: Parameter,
        /// What was given.
        value: f64,
        /// How many are allowed at this value.
        allowed: usize,
    },
    /// Nothing was given where something must be.
    Missing {
        /// What was to be set.
        parameter: Parameter,
        /// What is allowed.
        range: Range,
    },
}

impl std::error::Error for ParameterError {}

impl fmt::Display for ParameterError {
    /// By the parameter's key, as in files and flags.
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.write_str(&self.about(self.parameter().row().key))
    }
}

impl ParameterError {
    /// What was to be set.
    pub fn parameter(&self) -> Parameter {
        match self {
            Self::Number { parameter, .. }
            | Self::Range { parameter, .. }
            | Self::Decimals { parameter, .. }
            | Self::Missing { parameter, .. } => *parameter,
        }
    }

    /// The message by the parameter's label, for a screen that shows no key.
    ///
    /// ```
    /// use taxel::parameter::Parameter;
    /// let error = Parameter::ZoomX.read("65", 16).unwrap_err();
    /// assert_eq!(error.to_string(), "zoom_x: 65 is out of range, expected above 0, up to 64");
    /// assert_eq!(error.labelled(), "Zoom x: 65 is out of range, expected above 0, up to 64");
    /// ```
    pub fn labelled(&self) -> String {
        self.about(self.parameter().row().label)
    }

    fn about(&self, name: &str) -> String {
        match self {
            Self::Number { text, .. } => format!("{name}: {text:?} is {}", complaint(text)),
            Self::Range {
                parameter,
                value,
                range,
            } => {
                let (value, whole) = (short(*value), whole(*parameter));
                format!("{name}: {value} is out of range, expected {range}{whole}")
            }
            Self::Decimals { value, allowed, .. } => {
                let (value, decimals) = (short(*value), decimals(*allowed));
                format!("{name}: {value} has too many decimals, expected {decimals}")
            }
            Self::Missing { range, .. } => format!("{name}: missing, expected a number {range}"),
        }
    }

    /// What was expected, for a place that shows the field beside it.
    pub fn expected(&self) -> String {
        match self {
            Self::Number { text, .. } => complaint(text),
            Self::Range {
                parameter, range, ..
            } => format!("expected {range}{}", whole(*parameter)),
            Self::Missing { range, .. } => format!("missing, expected {range}"),
            Self::Decimals { allowed, .. } => format!("expected {}", decimals(*allowed)),
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

fn decimals(allowed: usize) -> String {
    match allowed {
        0 => "a whole number".to_owned(),
        1 => "one decimal from 10 on".to_owned(),
        count => format!("at most {count} decimals"),
    }
}
