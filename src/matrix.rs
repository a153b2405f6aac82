//! A matrix of values, one per taxel, row by row from the top left: what a sensor measures in each of its cells.

use crate::sensor::MAX_SIDE;

/// Values of 1 × 1 to 64 × 64 cells, row-major.
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

    /// Changes the size, with the same value in every cell. It allocates only if there are more cells than ever before.
    pub fn reset(&mut self, columns: u8, rows: u8, value: T) {
        self.columns = columns.clamp(1, MAX_SIDE);
        self.rows = rows.clamp(1, MAX_SIDE);
        self.values.clear();
        let cells = usize::from(self.columns) * usize::from(self.rows);
        self.values.resize(cells, value);
    }

    /// Number of columns.
    pub fn columns(&self) -> u8 {
        self.columns
    }

    /// Number of rows.
    pub fn rows(&self) -> u8 {
        self.rows
    }

    /// All values, row by row.
    pub fn values(&self) -> &[T] {
        &self.values
    }

    /// The same, mutable.
    pub fn values_mut(&mut self) -> &mut [T] {
        &mut self.values
    }

    /// The values of a row from the left; empty beyond the last row.
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
