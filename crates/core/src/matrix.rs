//! A matrix with one value per taxel, row by row from the top left: for example the measurements of a sensor's cells.

use crate::imprint::Imprint;
use crate::sensor::MatrixSize;

/// A matrix of 1 × 1 to 64 × 64 values, row-major.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct Matrix<T> {
    size: MatrixSize,
    values: Vec<T>,
}

impl<T: Copy + Default> Default for Matrix<T> {
    /// Creates a matrix of one cell, whose memory a [`View`](crate::frame::View) can reuse.
    fn default() -> Self {
        Self::filled(MatrixSize::SMALLEST, T::default())
    }
}

impl<T: Copy> Matrix<T> {
    /// Creates a matrix with the same value in every cell.
    pub fn filled(size: MatrixSize, value: T) -> Self {
        Self {
            size,
            values: vec![value; size.cells()],
        }
    }

    /// Creates a matrix from the values of its cells, row by row; None if there are not as many values as cells.
    pub fn from_values(size: MatrixSize, values: Vec<T>) -> Option<Self> {
        (values.len() == size.cells()).then_some(Self { size, values })
    }

    /// Changes the size and sets every cell to `value`. Allocates only if there are more cells than ever before.
    pub fn reset(&mut self, size: MatrixSize, value: T) {
        self.size = size;
        self.values.clear();
        self.values.resize(size.cells(), value);
    }

    /// Returns the number of columns and rows.
    pub fn size(&self) -> MatrixSize {
        self.size
    }

    /// Returns the number of columns.
    pub fn columns(&self) -> u8 {
        self.size.columns()
    }

    /// Returns the number of rows.
    pub fn rows(&self) -> u8 {
        self.size.rows()
    }

    /// Returns all values, row by row.
    pub fn values(&self) -> &[T] {
        &self.values
    }

    /// Returns all values for writing, row by row.
    pub fn values_mut(&mut self) -> &mut [T] {
        &mut self.values
    }

    /// Returns the cells that satisfy a condition on their index, row by row, and their value.
    pub fn cells_where(&self, holds: impl Fn(usize, T) -> bool) -> Imprint {
        let columns = usize::from(self.columns());
        let mut cells = Imprint::empty(self.size);
        for (row, line) in self.values.chunks(columns).enumerate() {
            let mut word = 0;
            for (column, &value) in line.iter().enumerate() {
                word |= u64::from(holds(row * columns + column, value)) << column;
            }
            cells.set_word(row, word);
        }
        cells
    }

    /// Returns the values of a row from the left; empty beyond the last row.
    pub fn row(&self, row: u8) -> &[T] {
        let columns = usize::from(self.columns());
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
        let inside = column < self.columns() && row < self.rows();
        inside.then(|| usize::from(row) * usize::from(self.columns()) + usize::from(column))
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_matrix_needs_valid_sides_and_one_value_per_cell() {
        let full = Matrix::from_values(MatrixSize::LARGEST, vec![0; 4096]);
        assert_eq!(full, Some(Matrix::filled(MatrixSize::LARGEST, 0)));
        assert_eq!(Matrix::from_values(MatrixSize::of(2, 2), vec![0; 5]), None);
    }
}
