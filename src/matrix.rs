//! A matrix with one value per taxel, row by row from the top left: for example the measurements of a sensor's cells.

use std::fmt;

use crate::parameter::number::counted;
use crate::sensor::MAX_SIDE;

/// A matrix of 1 × 1 to 64 × 64 values, row-major.
///
/// ```
/// use taxel::matrix::Matrix;
/// let mut heat = Matrix::filled(3, 2, 0.0);
/// heat.set(2, 1, 7.5);
/// assert_eq!((heat.columns(), heat.rows(), heat.get(2, 1)), (3, 2, Some(7.5)));
/// assert_eq!(heat.row(1), [0.0, 0.0, 7.5]);
/// assert_eq!(heat.get(3, 0), None);
/// ```
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct Matrix<T> {
    columns: u8,
    rows: u8,
    values: Vec<T>,
}

impl<T: Copy> Matrix<T> {
    /// Creates a matrix with the same value in every cell. Sides are clamped to 1 to 64.
    pub fn filled(columns: u8, rows: u8, value: T) -> Self {
        let mut matrix = Self {
            columns: 1,
            rows: 1,
            values: Vec::new(),
        };
        matrix.reset(columns, rows, value);
        matrix
    }

    /// Creates a matrix from the values of its cells, row by row.
    ///
    /// ```
    /// use taxel::matrix::Matrix;
    /// let gain = Matrix::from_values(3, 2, vec![1.0, 1.2, 0.9, 1.0, 1.0, 1.1])?;
    /// assert_eq!(gain.get(2, 1), Some(1.1));
    /// let error = Matrix::from_values(3, 2, vec![1.0]).unwrap_err();
    /// assert_eq!(error.to_string(), "found 1 value, expected 6 for a matrix of 3 × 2");
    /// # Ok::<(), taxel::matrix::MatrixError>(())
    /// ```
    ///
    /// # Errors
    /// Returns an error if a side is not 1 to 64, or the number of values differs from the number of cells.
    pub fn from_values(columns: u8, rows: u8, values: Vec<T>) -> Result<Self, MatrixError> {
        let sides = 1..=MAX_SIDE;
        if !sides.contains(&columns) || !sides.contains(&rows) {
            return Err(MatrixError::Sides { columns, rows });
        }
        let found = values.len();
        if found != usize::from(columns) * usize::from(rows) {
            return Err(MatrixError::Values {
                columns,
                rows,
                found,
            });
        }
        Ok(Self {
            columns,
            rows,
            values,
        })
    }

    /// Changes the size and sets every cell to `value`. Allocates only if there are more cells than ever before.
    /// Sides are clamped to 1 to 64.
    pub fn reset(&mut self, columns: u8, rows: u8, value: T) {
        self.columns = columns.clamp(1, MAX_SIDE);
        self.rows = rows.clamp(1, MAX_SIDE);
        self.values.clear();
        let cells = usize::from(self.columns) * usize::from(self.rows);
        self.values.resize(cells, value);
    }

    /// Returns the number of columns.
    pub fn columns(&self) -> u8 {
        self.columns
    }

    /// Returns the number of rows.
    pub fn rows(&self) -> u8 {
        self.rows
    }

    /// Returns all values, row by row.
    pub fn values(&self) -> &[T] {
        &self.values
    }

    /// Returns all values for writing, row by row.
    pub fn values_mut(&mut self) -> &mut [T] {
        &mut self.values
    }

    /// Returns the values of a row from the left; empty beyond the last row.
    pub fn row(&self, row: u8) -> &[T] {
        let columns = usize::from(self.columns);
        let start = usize::from(row) * columns;
        self.values.get(start..start + columns).unwrap_or(&[])
    }

    /// Returns the value of a cell; None beyond the matrix.
    pub fn get(&self, column: u8, row: u8) -> Option<T> {
        self.index(column, row).map(|index| self.values[index])
    }

    /// Changes the value of a cell; does nothing beyond the matrix.
    pub fn set(&mut self, column: u8, row: u8, value: T) {
        if let Some(index) = self.index(column, row) {
            self.values[index] = value;
        }
    }

    fn index(&self, column: u8, row: u8) -> Option<usize> {
        let inside = column < self.columns && row < self.rows;
        inside.then(|| usize::from(row) * usize::from(self.columns) + usize::from(column))
    }
}

/// The error for sides or values that do not make a matrix.
#[derive(Clone, Debug, PartialEq, Eq)]
#[non_exhaustive]
pub enum MatrixError {
    /// A side that is not 1 to 64.
    Sides {
        /// The number of columns.
        columns: u8,
        /// The number of rows.
        rows: u8,
    },
    /// The number of values differs from the number of cells.
    Values {
        /// The number of columns.
        columns: u8,
        /// The number of rows.
        rows: u8,
        /// The number of values.
        found: usize,
    },
}

impl fmt::Display for MatrixError {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        match *self {
            Self::Sides { columns, rows } => write!(
                f,
                "{columns} × {rows} cells, expected 1 to {MAX_SIDE} columns and rows"
            ),
            Self::Values {
                columns,
                rows,
                found,
            } => {
                let found = counted(found as u64, "value");
                let expected = u16::from(columns) * u16::from(rows);
                write!(
                    f,
                    "found {found}, expected {expected} for a matrix of {columns} × {rows}"
                )
            }
        }
    }
}

impl std::error::Error for MatrixError {}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_matrix_needs_valid_sides_and_one_value_per_cell() {
        for (columns, rows) in [(0, 1), (1, 65), (255, 255)] {
            let error = MatrixError::Sides { columns, rows };
            assert_eq!(Matrix::from_values(columns, rows, vec![0]), Err(error));
        }
        let full = Matrix::from_values(64, 64, vec![0; 4096]);
        assert_eq!(full, Ok(Matrix::filled(64, 64, 0)));
        assert!(Matrix::from_values(2, 2, vec![0; 5]).is_err());
    }
}
