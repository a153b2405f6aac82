//! The error for a name that is not one of the expected ones, and the macro that reads and writes types by name.

use std::fmt;

use crate::quote::shortened;

/// The error for text that is not one of the expected names.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct UnknownName {
    /// The kind of thing that was to be named, such as "figure".
    pub what: &'static str,
    /// The text, shortened.
    pub found: String,
    /// The expected names.
    pub expected: Vec<&'static str>,
}

impl UnknownName {
    /// Returns the value with a name, or the error for it.
    pub fn unless_found<T: Copy>(
        what: &'static str,
        found: &str,
        all: &[T],
        name: impl Fn(T) -> &'static str,
    ) -> Result<T, Self> {
        let one = all.iter().find(|&&one| name(one) == found);
        one.copied().ok_or_else(|| Self {
            what,
            found: shortened(found),
            expected: all.iter().map(|&one| name(one)).collect(),
        })
    }
}

impl fmt::Display for UnknownName {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        let Self {
            what,
            found,
            expected,
        } = self;
        write!(
            f,
            "{what} {found:?} is unknown, expected one of {}",
            expected.join(", ")
        )
    }
}

impl std::error::Error for UnknownName {}

/// Implements `Display` and `FromStr` for a type whose values have a `name`: both use that name.
#[macro_export]
#[doc(hidden)]
macro_rules! named {
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

    fn are_read_as_written<T>(all: &[T])
    where
        T: Copy + Display + FromStr<Err = UnknownName> + PartialEq,
    {
        for one in all {
            assert!(one.to_string().parse() == Ok(*one), "{one}");
            let wrong = format!("{one}.").parse::<T>().err();
            assert!(wrong.is_some_and(|error| error.expected.len() == all.len()));
        }
    }

    #[test]
    fn names_are_read_as_they_are_written() {
        are_read_as_written(FigureKind::ALL);
        are_read_as_written(&[RegionKind::Exterior, RegionKind::Hole]);
        let parameters = PARAMETERS.iter().map(|row| row.parameter);
        are_read_as_written(&parameters.collect::<Vec<_>>());
        assert_eq!(format!("{:>8}", FigureKind::Hexagon), " hexagon");
    }

    #[test]
    fn examples() {
        use crate::figure::FigureKind;
        let error = "hexagn".parse::<FigureKind>().unwrap_err();
        let expected = "ellipse, rectangle, triangle, pentagon, hexagon, heptagon, octagon";
        assert_eq!(
            error.to_string(),
            format!("figure \"hexagn\" is unknown, expected one of {expected}")
        );
    }
}
