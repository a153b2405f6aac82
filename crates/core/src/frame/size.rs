use std::fmt;
use std::ops::RangeInclusive;

use crate::parameter::number::counted;
use crate::sensor::MatrixSize;

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
    pub fn new(columns: u16, rows: u16) -> Result<Self, FrameSizeError> {
        if Self::SIDES.contains(&columns) && Self::SIDES.contains(&rows) {
            Ok(Self { columns, rows })
        } else {
            Err(FrameSizeError { columns, rows })
        }
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

/// The error for a size that no frame can have.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct FrameSizeError {
    /// The number of columns.
    pub columns: u16,
    /// The number of rows.
    pub rows: u16,
}

impl fmt::Display for FrameSizeError {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        let Self { columns, rows } = self;
        write!(
            f,
            "a frame of {columns} × {rows}, expected 1 to {MAX_FRAME_SIDE} columns and rows"
        )
    }
}

impl std::error::Error for FrameSizeError {}

#[cfg(test)]
mod tests {
    #[test]
    fn examples() -> Result<(), Box<dyn std::error::Error>> {
        use crate::frame::FrameSize;
        let size = FrameSize::new(28, 64)?;
        assert_eq!((size.columns(), size.rows(), size.cells()), (28, 64, 1792));
        assert_eq!(size.to_string(), "28 × 64");
        assert_eq!(
            FrameSize::new(28, 0).unwrap_err().to_string(),
            "a frame of 28 × 0, expected 1 to 512 columns and rows"
        );
        Ok(())
    }
}
