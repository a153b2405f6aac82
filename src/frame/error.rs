//! Why a frame, or the way to process it, is refused.

use std::fmt;

use crate::matrix::Matrix;
use crate::parameter::number::counted;

/// What is wrong with a frame or with the way to process it.
#[derive(Clone, Debug, PartialEq)]
#[non_exhaustive]
pub enum FrameError {
    /// More cells are left than an imprint can have.
    Large {
        /// Columns that are left.
        columns: u16,
        /// Rows that are left.
        rows: u16,
    },
    /// A side of a frame that is not 1 to 512.
    Sides {
        /// Its columns.
        columns: u16,
        /// Its rows.
        rows: u16,
    },
    /// Another number of values than a frame has cells.
    Values {
        /// The frame's columns.
        columns: u16,
        /// The frame's rows.
        rows: u16,
        /// Number of values.
        found: usize,
    },
    /// The crop reaches beyond the frame.
    Crop {
        /// The frame's columns.
        columns: u16,
        /// The frame's rows.
        rows: u16,
    },
    /// A mask, a gain or a tare whose size differs from that of the visible part of the frame.
    Size {
        /// Which of these.
        what: &'static str,
        /// Its columns and rows.
        found: (u16, u16),
        /// Those of the frame.
        expected: (u16, u16),
    },
    /// A threshold that is not a number, or out of range.
    Rule {
        /// Which value: its key in JSON.
        what: &'static str,
        /// The number.
        found: f64,
        /// What is allowed.
        allowed: &'static str,
    },
    /// A tare of more frames than there are.
    Tare {
        /// How many there are.
        frames: u64,
        /// How many are needed.
        wanted: u64,
    },
    /// A tare whose frames, by their number and size, take too much memory.
    TareSize {
        /// How many frames are possible.
        most: u64,
    },
    /// The noise rule without a tare that measures the noise.
    NoTare,
}

impl FrameError {
    /// Whether a frame of another size would be processed.
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

/// Refuses a matrix whose size differs from that of the values.
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
