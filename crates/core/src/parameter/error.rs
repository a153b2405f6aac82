//! The error for a value that is not allowed, with one message for forms, flags and files.

use crate::parameter::number::{complaint, short};
use crate::parameter::table::{Parameter, Range, Unit};
use crate::quote::{joined, other_figure, unknown_name};

/// The error for a value that is not allowed. The message names the parameter, the value, and what is expected.
#[derive(Clone, Debug, PartialEq, thiserror::Error)]
#[error("{}", self.about(self.parameter().row().key))]
pub enum ParameterError {
    /// The text is not a number.
    Number {
        /// The parameter.
        parameter: Parameter,
        /// The text, shortened.
        text: String,
    },
    /// The number is out of range, or in range but not whole, although the parameter counts taxels.
    Range {
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

impl ParameterError {
    /// Returns the parameter whose value is not allowed.
    pub fn parameter(&self) -> Parameter {
        match self {
            Self::Number { parameter, .. }
            | Self::Range { parameter, .. }
            | Self::Missing { parameter, .. }
            | Self::Foreign { parameter, .. } => *parameter,
        }
    }

    /// Returns the message with the parameter's label, for a screen that shows no key.
    pub fn labelled(&self) -> String {
        self.about(self.parameter().row().label)
    }

    fn about(&self, name: &str) -> String {
        let complaint = self.complaint();
        match self {
            Self::Number { text, .. } => format!("{name}: {text:?} {complaint}"),
            Self::Range { value, .. } => format!("{name}: {} {complaint}", short(*value)),
            Self::Missing { .. } | Self::Foreign { .. } => format!("{name}: {complaint}"),
        }
    }

    /// Returns the part of the message that says what is wrong with the value, to be put after the value.
    pub fn complaint(&self) -> String {
        match self {
            Self::Number { text, .. } => format!("is {}", complaint(text)),
            Self::Range { value, range, .. } if range.contains(*value) => {
                format!("is not a whole number (allowed: {range})")
            }
            Self::Range { value, range, .. } => {
                format!("{} (allowed: {range})", range.missed_by(*value))
            }
            Self::Missing { range, .. } => {
                format!("missing, expected a number (allowed: {range})")
            }
            Self::Foreign {
                owner, expected, ..
            } => {
                let keys = joined(expected.iter().map(|own| own.row().key), "or");
                format!("a parameter that the {owner} does not have, expected {keys}")
            }
        }
    }

    /// Returns the part of the message that says what is expected, for a place that shows the field beside it.
    pub fn expected(&self) -> String {
        match self {
            Self::Number { text, .. } => complaint(text),
            Self::Range {
                parameter, range, ..
            } if parameter.row().unit == Unit::Taxels => {
                format!("expected {range}, a whole number")
            }
            Self::Range { range, .. } => format!("expected {range}"),
            Self::Missing { range, .. } => format!("missing, expected {range}"),
            Self::Foreign { .. } => self.complaint(),
        }
    }
}

/// The error for text that is not one of the expected names: which they are, and which one was probably meant.
#[derive(Clone, Debug, PartialEq, Eq, thiserror::Error)]
#[error("{0}")]
pub struct UnknownName(String);

impl UnknownName {
    /// Returns the value with a name. `what` is the kind of thing that is named, such as "figure".
    ///
    /// # Errors
    /// Returns an error if no value has this name.
    pub fn unless_found<T: Copy>(
        what: &str,
        found: &str,
        all: &[T],
        name: impl Fn(T) -> &'static str,
    ) -> Result<T, Self> {
        let one = all.iter().find(|&&one| name(one) == found);
        one.copied().ok_or_else(|| {
            let names: Vec<_> = all.iter().map(|&one| name(one)).collect();
            let other = other_figure(found).map(|known| format!("; {known}"));
            let unknown = unknown_name(found, &names);
            Self(format!("{what} {unknown}{}", other.unwrap_or_default()))
        })
    }
}

/// Implements `Display` and `FromStr` for a type whose values have a `name`: both use that name.
#[macro_export]
#[doc(hidden)]
macro_rules! named {
    ($type:ident, $what:literal, [$($variant:ident $name:literal),+ $(,)?]) => {
        impl $type {
            /// All of them, in order.
            pub const ALL: &'static [Self] = &[$(Self::$variant),+];

            /// Returns the name used on the command line, in JSON and on the screen.
            pub const fn name(self) -> &'static str {
                match self {
                    $(Self::$variant => $name),+
                }
            }
        }

        $crate::parameter::named!($type, $what, $type::ALL);
    };
    ($type:ident, $what:literal, $all:expr) => {
        impl std::fmt::Display for $type {
            fn fmt(&self, f: &mut std::fmt::Formatter<'_>) -> std::fmt::Result {
                f.pad(self.name())
            }
        }

        impl std::str::FromStr for $type {
            type Err = $crate::parameter::UnknownName;

            fn from_str(name: &str) -> Result<Self, Self::Err> {
                Self::Err::unless_found($what, name, $all, Self::name)
            }
        }
    };
}
pub use named;

#[cfg(test)]
mod tests {
    use std::fmt::Display;
    use std::str::FromStr;

    use super::UnknownName;
    use crate::description::RegionKind;
    use crate::figure::FigureKind;
    use crate::parameter::PARAMETERS;

    #[test]
    fn a_message_names_parameter_value_and_range() {
        use crate::prelude::*;
        let error = Sensor::default()
            .read(Parameter::ZoomX, "65")
            .expect_err("refused");
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
                .expect_err("refused")
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

    fn are_read_as_written<T>(all: &[T])
    where
        T: Copy + Display + FromStr<Err = UnknownName> + PartialEq,
    {
        for one in all {
            assert!(one.to_string().parse() == Ok(*one), "{one}");
            assert!(format!("{one}.").parse::<T>().is_err(), "{one}");
        }
    }

    #[test]
    fn names_are_read_as_they_are_written() {
        are_read_as_written(FigureKind::ALL);
        are_read_as_written(&[RegionKind::Exterior, RegionKind::Hole]);
        let parameters = PARAMETERS.iter().map(|row| row.parameter);
        are_read_as_written(&parameters.collect::<Vec<_>>());
        assert_eq!(format!("{:>8}", FigureKind::Hexagon), " hexagon");
        let meant = |word: &str| {
            let error = word.parse::<FigureKind>().expect_err("no figure");
            error.to_string().rsplit("; ").next().map(str::to_owned)
        };
        assert_eq!(
            meant("hexagn"),
            Some("did you mean \"hexagon\"?".to_owned())
        );
        assert_eq!(
            meant("square"),
            Some("a square is a rectangle with equal sides".to_owned())
        );
    }
}
