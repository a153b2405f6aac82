//! The errors of bitmaps.

use std::fmt;

use crate::parameter::number::counted;

/// The error for bytes that are not a bitmap, or not one of an imprint.
#[derive(Clone, Debug, PartialEq, Eq)]
pub enum PbmError {
    /// Not one of the four kinds `P1`, `P2`, `P4` and `P5`.
    Magic,
    /// A width or height that is missing, or not from 1 to 64.
    Side {
        /// The line number.
        line: usize,
        /// The byte in the line.
        column: usize,
        /// `width` or `height`.
        what: &'static str,
    },
    /// A byte other than the digits 0 and 1.
    Digit {
        /// The line number.
        line: usize,
        /// The byte in the line.
        column: usize,
        /// The byte that was found.
        byte: u8,
    },
    /// A comment in place of the one space before the bits of a raw bitmap.
    Space {
        /// The line number.
        line: usize,
        /// The byte in the line.
        column: usize,
    },
    /// Too few taxels.
    Short {
        /// The number that was found.
        found: usize,
        /// The number that was expected.
        expected: usize,
        /// The unit of the numbers.
        unit: &'static str,
    },
    /// A brightest shade that is missing, or not from 1 to 65535.
    Maximum {
        /// The line number.
        line: usize,
        /// The byte in the line.
        column: usize,
    },
    /// A shade that is missing, or above the brightest.
    Shade {
        /// The line number.
        line: usize,
        /// The byte in the line.
        column: usize,
    },
    /// A third shade.
    Third {
        /// The row, from 1.
        row: u8,
        /// The column, from 1.
        column: u8,
    },
    /// All shades are equal, and neither black nor the brightest.
    Unclear,
    /// More bytes after the image.
    Long {
        /// The number of bytes.
        found: usize,
    },
}

impl fmt::Display for PbmError {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        match self {
            Self::Magic => f.write_str("expected P1, P4, P2 or P5 at the start"),
            Self::Side { line, column, what } => write!(
                f,
                "line {line}, column {column}: expected the {what}, 1 to 64"
            ),
            Self::Digit { line, column, byte } => write!(
                f,
                "line {line}, column {column}: found byte 0x{byte:02x}, expected 0 or 1"
            ),
            Self::Space { line, column } => write!(
                f,
                "line {line}, column {column}: expected one space or line end before the bits"
            ),
            Self::Short {
                found,
                expected,
                unit,
            } => write!(f, "{unit}: found {found}, expected {expected}"),
            Self::Maximum { line, column } => write!(
                f,
                "line {line}, column {column}: expected the brightest shade, 1 to 65535"
            ),
            Self::Shade { line, column } => write!(
                f,
                "line {line}, column {column}: expected a shade, 0 to the brightest"
            ),
            Self::Third { row, column } => write!(
                f,
                "row {row}, column {column}: a third shade, expected an image with two"
            ),
            Self::Unclear => f.write_str("one shade of grey everywhere, expected two"),
            Self::Long { found } => write!(
                f,
                "found {} after the image, expected one image and no more",
                counted(*found as u64, "byte")
            ),
        }
    }
}

impl std::error::Error for PbmError {}
