use std::fmt;

use crate::frame::size::{FrameSize, FrameSizeError};
use crate::matrix::Matrix;
use crate::parameter::number::{counted, short};
use crate::sensor::MatrixSize;

/// The error for a frame that cannot be processed, or for settings that do not fit it.
#[derive(Clone, Debug, PartialEq)]
pub enum FrameError {
    /// More cells are left than an imprint can have.
    Large {
        /// The size of the visible part.
        size: FrameSize,
    },
    /// A side of a frame is not from 1 to 512.
    Sides(FrameSizeError),
    /// The number of values differs from the number of cells.
    Values {
        /// The frame's size.
        size: FrameSize,
        /// The number of values.
        found: usize,
    },
    /// The crop reaches beyond the frame.
    Crop {
        /// The frame's size.
        size: FrameSize,
    },
    /// A mask, a gain or a tare differs in size from the visible part of the frame.
    Size {
        /// "mask", "gain" or "tare".
        what: &'static str,
        /// The size of the mask, gain or tare.
        found: MatrixSize,
        /// The size of the visible part of the frame.
        expected: MatrixSize,
    },
    /// A threshold or a part of a tare is not a number, or out of range.
    Rule {
        /// The name of the value: its key in JSON.
        what: &'static str,
        /// The value.
        found: f64,
        /// The allowed range.
        allowed: &'static str,
    },
    /// The lower of two thresholds is above the higher one.
    Order {
        /// The lower threshold.
        low: f64,
        /// The higher threshold.
        high: f64,
    },
    /// A value times the gain of its cell is beyond ±[`LARGEST_VALUE`](crate::frame::LARGEST_VALUE).
    Product {
        /// The value, after the tare.
        value: f64,
        /// The gain of its cell.
        gain: f64,
    },
    /// There are fewer frames than a tare needs.
    Tare {
        /// The number of frames so far.
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
    pub fn is_of_size(&self) -> bool {
        matches!(
            self,
            Self::Large { .. } | Self::Crop { .. } | Self::Size { .. }
        )
    }
}

impl fmt::Display for FrameError {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        match self {
            Self::Large { size } => write!(
                f,
                "{size} cells are left, expected at most 64 × 64: crop the frame"
            ),
            Self::Sides(error) => error.fmt(f),
            Self::Values { size, found } => {
                let (found, expected) = (counted(*found as u64, "value"), size.cells());
                write!(
                    f,
                    "found {found}, expected {expected} for a frame of {size}"
                )
            }
            Self::Crop { size } => write!(
                f,
                "the crop reaches beyond the frame, which has {} and {}",
                counted(size.columns(), "column"),
                counted(size.rows(), "row")
            ),
            Self::Size {
                what,
                found,
                expected,
            } => write!(
                f,
                "the {what} has {} and {}, expected {} and {} as the frame has",
                counted(found.columns(), "column"),
                counted(found.rows(), "row"),
                expected.columns(),
                expected.rows()
            ),
            Self::Rule {
                what,
                found,
                allowed,
            } => {
                let found = short(*found);
                write!(f, "{what}: {found} is out of range (allowed: {allowed})")
            }
            Self::Order { low, high } => {
                write!(f, "low {} is above high {}", short(*low), short(*high))
            }
            Self::Product { value, gain } => write!(
                f,
                "the value {value:e} times its gain {gain:e} is too large, expected at most 1e300"
            ),
            Self::Tare { frames, wanted } => f.write_str(&too_few(*frames, *wanted)),
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

fn too_few(frames: u64, wanted: u64) -> String {
    let wanted = counted(wanted, "frame");
    let verb = if frames == 1 { "is" } else { "are" };
    format!("the tare needs {wanted}, but there {verb} only {frames}")
}

impl std::error::Error for FrameError {}

impl From<FrameSizeError> for FrameError {
    fn from(error: FrameSizeError) -> Self {
        Self::Sides(error)
    }
}

pub(super) fn check_size(
    what: &'static str,
    found: &Matrix<f64>,
    values: &Matrix<f64>,
) -> Result<(), FrameError> {
    let (found, expected) = (found.size(), values.size());
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
