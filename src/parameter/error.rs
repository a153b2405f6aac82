//! Why a number was refused: one text for forms, flags and files.

use super::number::short;
use super::range::Range;
use super::table::{Parameter, Unit};

/// Why a number was refused. The message names the parameter, what was given and what was expected.
#[derive(Clone, Debug, PartialEq, thiserror::Error)]
#[non_exhaustive]
pub enum ParameterError {
    /// Not a number at all.
    #[error("{key}: \"{text}\" is not a number", key = parameter.row().key)]
    Number {
        /// What was to be set.
        parameter: Parameter,
        /// What was given.
        text: String,
    },
    /// A number outside of the allowed range.
    #[error("{key}: {value} is out of range, expected {range}{whole}", key = parameter.row().key, value = short(*value), whole = whole(*parameter))]
    Range {
        /// What was to be set.
        parameter: Parameter,
        /// What was given.
        value: f64,
        /// What is allowed.
        range: Range,
    },
    /// More decimals than a form takes.
    #[error("{key}: {value} has too many decimals, expected {}", decimals(*allowed), key = parameter.row().key, value = short(*value))]
    Decimals {
        /// What was to be set.
        parameter: Parameter,
        /// What was given.
        value: f64,
        /// How many are allowed at this value.
        allowed: usize,
    },
    /// Nothing was given where something must be.
    #[error("{}: missing, expected a number {range}", parameter.row().key)]
    Missing {
        /// What was to be set.
        parameter: Parameter,
        /// What is allowed.
        range: Range,
    },
}

impl ParameterError {
    /// What was expected, for a place that shows the field beside it.
    pub fn expected(&self) -> String {
        match self {
            Self::Number { .. } => "not a number".to_owned(),
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
