use std::fmt;
use std::ops::RangeInclusive;

use crate::parameter::number::{counted, short};
use crate::sensor::MatrixSize;

/// The largest value that a cell may have; the smallest is its negative. So the sum of a frame is always finite.
pub const LARGEST_VALUE: f64 = 1e300;

pub(super) const VALUES: RangeInclusive<f64> = -LARGEST_VALUE..=LARGEST_VALUE;

/// The label that a recording gives a frame: its number there, or the name of what was touched.
#[derive(Clone, Debug, PartialEq, Eq, PartialOrd, Ord, serde::Serialize)]
#[serde(untagged)]
pub enum Label {
    /// A whole number.
    Number(i64),
    /// A text that is no whole number.
    Text(String),
}

impl Label {
    /// The number; None of a text.
    pub fn number(&self) -> Option<i64> {
        match *self {
            Self::Number(number) => Some(number),
            Self::Text(_) => None,
        }
    }
}

impl From<i64> for Label {
    fn from(number: i64) -> Self {
        Self::Number(number)
    }
}

/// A text that is a whole number is the same label as that number, so `7` finds both.
impl From<&str> for Label {
    fn from(text: &str) -> Self {
        text.parse()
            .map_or_else(|_| Self::Text(text.to_owned()), Self::Number)
    }
}

impl fmt::Display for Label {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        match self {
            Self::Number(number) => number.fmt(f),
            Self::Text(text) => text.fmt(f),
        }
    }
}

/// The values of a sensor's cells at one moment, in the sensor's unit.
///
/// Readers and decoders reuse one frame, so nothing is allocated per frame, except for labels that are texts.
#[derive(Clone, Debug)]
pub struct Frame {
    /// The number of the frame in its channel, from 0.
    pub number: u64,
    /// The number of the channel, from 0; each of several sensors has one.
    pub channel: usize,
    /// The label that the recording gives the frame, if any.
    pub label: Option<Label>,
    /// The time in seconds since the start of the recording, if known. Times may repeat and go back.
    pub time: Option<f64>,
    size: FrameSize,
    values: Vec<f64>,
}

impl Default for Frame {
    fn default() -> Self {
        Self::new(FrameSize::SMALLEST)
    }
}

impl Frame {
    /// Creates a frame of cells without values.
    pub fn new(size: FrameSize) -> Self {
        Self {
            number: 0,
            channel: 0,
            label: None,
            time: None,
            size,
            values: vec![f64::NAN; size.cells()],
        }
    }

    /// Creates a frame from the values of its cells, row by row; NaN stands for no cell. A value that is infinite or
    /// beyond ±[`LARGEST_VALUE`] counts as no value.
    ///
    /// # Errors
    /// Returns an error if the number of values is not the number of cells.
    pub fn from_values(size: FrameSize, values: &[f64]) -> Result<Self, FrameError> {
        let mut frame = Self::new(size);
        frame.set_values(values)?;
        Ok(frame)
    }

    /// Sets the values of all cells, row by row; everything else stays. Does not allocate.
    ///
    /// # Errors
    /// Returns an error if the number of values differs from the number of cells; then nothing is changed.
    pub fn set_values(&mut self, values: &[f64]) -> Result<(), FrameError> {
        if values.len() != self.values.len() {
            let (found, size) = (counted(values.len() as u64, "value"), self.size);
            return Err(FrameError::Invalid(format!(
                "found {found}, expected {} for a frame of {size}",
                size.cells()
            )));
        }
        self.values.copy_from_slice(values);
        Ok(())
    }

    /// Changes the size and removes all values; everything else stays. Allocates only if there are more cells than ever
    /// before.
    pub fn reset(&mut self, size: FrameSize) {
        self.size = size;
        self.values.clear();
        self.values.resize(size.cells(), f64::NAN);
    }

    /// Returns the number of columns and rows.
    pub fn size(&self) -> FrameSize {
        self.size
    }

    /// Returns the number of columns.
    pub fn columns(&self) -> u16 {
        self.size.columns()
    }

    /// Returns the number of rows.
    pub fn rows(&self) -> u16 {
        self.size.rows()
    }

    /// Returns the values row by row; NaN where the sensor has no cell.
    pub fn values(&self) -> &[f64] {
        &self.values
    }

    /// Returns the values for writing. A value that is infinite or beyond ±[`LARGEST_VALUE`] counts as no value.
    pub fn values_mut(&mut self) -> &mut [f64] {
        &mut self.values
    }
}

/// The largest number of columns, and of rows, of a frame before it is cropped.
pub const MAX_FRAME_SIDE: u16 = 512;

/// The largest number of cells of a frame.
pub const MAX_FRAME_CELLS: usize = MAX_FRAME_SIDE as usize * MAX_FRAME_SIDE as usize;

/// The columns and rows of a frame before it is cropped: each from 1 to [`MAX_FRAME_SIDE`].
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash)]
pub struct FrameSize {
    columns: u16,
    rows: u16,
}

impl FrameSize {
    /// The allowed numbers of columns, and of rows.
    pub const SIDES: RangeInclusive<u16> = 1..=MAX_FRAME_SIDE;

    /// One cell.
    pub const SMALLEST: Self = Self {
        columns: 1,
        rows: 1,
    };

    /// Creates the size of a frame from its columns and rows.
    ///
    /// # Errors
    /// Returns an error if a number is not from 1 to [`MAX_FRAME_SIDE`].
    pub fn new(columns: u16, rows: u16) -> Result<Self, FrameError> {
        let size = Self { columns, rows };
        if Self::SIDES.contains(&columns) && Self::SIDES.contains(&rows) {
            return Ok(size);
        }
        Err(FrameError::Invalid(format!(
            "a frame of {size}, expected 1 to {MAX_FRAME_SIDE} columns and rows"
        )))
    }

    /// Returns the size of a frame; None if a side is unknown or not allowed.
    pub fn of_sides(columns: Option<u16>, rows: Option<u16>) -> Option<Self> {
        Self::new(columns?, rows?).ok()
    }

    /// Returns the number of columns.
    pub fn columns(self) -> u16 {
        self.columns
    }

    /// Returns the number of rows.
    pub fn rows(self) -> u16 {
        self.rows
    }

    /// Returns the number of cells.
    pub fn cells(self) -> usize {
        usize::from(self.columns) * usize::from(self.rows)
    }

    /// Returns the size in words: `4 rows of 5`.
    pub fn in_words(self) -> String {
        format!("{} of {}", counted(self.rows, "row"), self.columns)
    }

    #[cfg(test)]
    pub(crate) fn of(columns: u16, rows: u16) -> Self {
        Self::new(columns, rows).expect("1 to 512")
    }
}

impl From<MatrixSize> for FrameSize {
    fn from(size: MatrixSize) -> Self {
        Self {
            columns: size.columns().into(),
            rows: size.rows().into(),
        }
    }
}

impl fmt::Display for FrameSize {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        write!(f, "{} × {}", self.columns, self.rows)
    }
}

/// The error for a frame that cannot be processed, or for settings that do not fit it.
#[derive(Clone, Debug, PartialEq, thiserror::Error)]
pub enum FrameError {
    /// A crop, mask, gain or tare does not fit the size of the frame, or too many cells are left. A frame of another
    /// size may fit.
    #[error("{0}")]
    Size(String),
    /// A threshold or a part of a tare is not a number, or out of range.
    #[error("{what}: {} is out of range (allowed: {allowed})", short(*found))]
    Rule {
        /// The name of the value: its key in JSON.
        what: &'static str,
        /// The value.
        found: f64,
        /// The allowed range.
        allowed: &'static str,
    },
    /// The lower of two thresholds is above the higher one.
    #[error("low {} is above high {}", short(*low), short(*high))]
    Order {
        /// The lower threshold.
        low: f64,
        /// The higher threshold.
        high: f64,
    },
    /// There are fewer frames than a tare needs.
    #[error(
        "the tare needs {}, but there {} only {frames}",
        counted(*wanted, "frame"), if *frames == 1 { "is" } else { "are" }
    )]
    Tare {
        /// The number of frames so far.
        frames: u64,
        /// The number of frames that the tare needs.
        wanted: u64,
    },
    /// The noise rule is used without a tare that measures the noise.
    #[error("a threshold from noise needs a tare of at least two frames")]
    NoTare,
    /// Anything else, described by the text.
    #[error("{0}")]
    Invalid(String),
}

impl FrameError {
    /// Returns true if a frame of another size could be processed.
    pub fn is_of_size(&self) -> bool {
        matches!(self, Self::Size(_))
    }
}

/// Returns a threshold or a part of a tare if it is in its range.
pub(super) fn in_range(
    what: &'static str,
    found: f64,
    range: RangeInclusive<f64>,
    allowed: &'static str,
) -> Result<f64, FrameError> {
    let wrong = FrameError::Rule {
        what,
        found,
        allowed,
    };
    range.contains(&found).then_some(found).ok_or(wrong)
}

/// Checks that a mask, a gain or a tare has the size of what is seen of a frame.
pub(super) fn check_size(
    what: &str,
    found: MatrixSize,
    expected: MatrixSize,
) -> Result<(), FrameError> {
    if found == expected {
        return Ok(());
    }
    let columns = counted(found.columns(), "column");
    let rows = counted(found.rows(), "row");
    let (right, down) = (expected.columns(), expected.rows());
    Err(FrameError::Size(format!(
        "the {what} has {columns} and {rows}, expected {right} and {down} as the frame has"
    )))
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_frame_takes_as_many_values_as_it_has_cells() -> Result<(), Box<dyn std::error::Error>> {
        let size = FrameSize::new(3, 2)?;
        let mut frame = Frame::from_values(size, &[0.0, 12.0, f64::NAN, 3.0, 10.0, 0.0])?;
        assert_eq!((frame.columns(), frame.rows()), (3, 2));
        // The next frame, in the same memory.
        frame.set_values(&[0.0, 11.0, f64::NAN, 4.0, 10.0, 0.0])?;
        assert_eq!(
            frame.set_values(&[0.0]).expect_err("refused").to_string(),
            "found 1 value, expected 6 for a frame of 3 × 2"
        );
        Ok(())
    }
}
