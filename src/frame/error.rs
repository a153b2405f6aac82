//! The error for a frame that cannot be processed, or for settings that do not fit it.

use std::fmt;

use crate::matrix::Matrix;
use crate::parameter::number::counted;

/// The error for a frame that cannot be processed, or for settings that do not fit it.
#[derive(Clone, Debug, PartialEq)]
#[non_exhaustive]
pub enum FrameError {
    /// More cells are left than an imprint can have.
    Large {
        /// The number of columns that are left.
        columns: u16,
        /// The number of rows that are left.
        rows: u16,
    },
    /// A side of a frame that is not 1 to 512.
    Sides {
        /// The number of columns.
        columns: u16,
        /// The number of rows.
        rows: u16,
    },
    /// The number of values differs from the number of cells.
    Values {
        /// The number of the frame's columns.
        columns: u16,
        /// The number of the frame's rows.
        rows: u16,
        /// The number of values.
        found: usize,
    },
    /// The crop reaches beyond the frame.
    Crop {
        /// The number of the frame's columns.
        columns: u16,
        /// The number of the frame's rows.
        rows: u16,
    },
    /// A mask, a gain or a tare differs in size from the visible part of the frame.
    Size {
        /// "mask", "gain" or "tare".
        what: &'static str,
        /// The columns and rows of the mask, gain or tare.
        found: (u16, u16),
        /// The columns and rows of the visible part of the frame.
        expected: (u16, u16),
    },
    /// A threshold is not a number, or out of range.
    Rule {
        /// The name of the value: its key in JSON.
        what: &'static str,
        /// The value.
        found: f64,
        /// The allowed range.
        allowed: &'static str,
    },
    /// There are fewer frames than a tare needs.
    Tare {
        /// The number of frames that there are.
        frames: u64,
        /// The number of frames that the tare needs.
        wanted: u64,
    },
    /// The frames of a tare would take too much memory, by their number and size.
    TareSize {
        /// The largest possible number of frames of this size.
        most: u64,
    },
    /// The noise rule is used without a tare that measures the noise.
    NoTare,
}

impl FrameError {
    /// Returns true if a frame of another size could be processed.
    #[cfg(feature = "cli")]
    pub(crate) fn is_of_size(&self) -> bool {
        matches!(
            self,
            Self::Large { .. } | Self::Crop { .. } | Self::Size { .. }
        )
    }
}

impl fmt::Display for FrameError {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        match self {
            Self::Large { columns, rows } => write!(
                f,
                "{columns} × {rows} cells are left, expected at most 64 × 64: crop the frame"
            ),
            Self::Sides { columns, rows } => write!(
                f,
                "a frame of {columns} × {rows}, expected 1 to 512 columns and rows"
            ),
            Self::Values {
                columns,
                rows,
                found,
            } => f.write_str(&wrong_values((*columns, *rows), *found)),
            Self::Crop { columns, rows } => write!(
                f,
                "the crop reaches beyond the frame, which has {} and {}",
                counted(*columns, "column"),
                counted(*rows, "row")
            ),
            Self::Size {
                what,
                found,
                expected,
            } => write!(
                f,
                "the {what} has {} and {}, expected {} and {} as the frame has",
                counted(found.0, "column"),
                counted(found.1, "row"),
                expected.0,
                expected.1
            ),
            Self::Rule {
                what,
                found,
                allowed,
            } => write!(f, "{what}: {found} is out of range (allowed: {allowed})"),
            Self::Tare { frames, wanted } => {
                write!(f, "frames for the tare: found {frames}, expected {wanted}")
            }
            Self::TareSize { most } => {
                write!(
                    f,
                    "too many frames for a tare: expected at most {most} of this size"
                )
            }
            Self::NoTare => {
                f.write_str("a threshold from noise needs a tare of at least two frames")
            }
        }
    }
}

impl std::error::Error for FrameError {}

fn wrong_values((columns, rows): (u16, u16), found: usize) -> String {
    let found = counted(found as u64, "value");
    let expected = u32::from(columns) * u32::from(rows);
    format!("found {found}, expected {expected} for a frame of {columns} × {rows}")
}

/// Returns an error if a matrix differs in size from the values.
pub(super) fn check_size(
    what: &'static str,
    found: &Matrix<f64>,
    values: &Matrix<f64>,
) -> Result<(), FrameError> {
    let size = |of: &Matrix<f64>| (u16::from(of.columns()), u16::from(of.rows()));
    let (found, expected) = (size(found), size(values));
    if found == expected {
        Ok(())
    } else {
        Err(FrameError::Size {
            what,
            found,
            expected,
        })
    }
}
