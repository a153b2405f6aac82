//! The confusion matrix: how many touches of each shape are given which name.
//!
//! Only cells above 0 are stored. Most shapes of a large set are confused with few others, so the matrix takes far less
//! memory than the square of their number.

/// A confusion matrix: how many touches of each shape are named as which shape.
#[derive(Clone, Debug, Default, PartialEq, Eq)]
pub struct ConfusionMatrix {
    /// For each shape, the names that its touches are given, in the order of the set, with the number of touches.
    rows: Vec<Vec<(usize, u128)>>,
    /// The sum of each column.
    named: Vec<u128>,
}

impl ConfusionMatrix {
    pub(super) fn new(shapes: usize) -> Self {
        Self {
            rows: vec![Vec::new(); shapes],
            named: vec![0; shapes],
        }
    }

    pub(super) fn add(&mut self, touched: usize, named: usize, touches: u128) {
        self.named[named] += touches;
        let row = &mut self.rows[touched];
        match row.binary_search_by_key(&named, |&(name, _)| name) {
            Ok(index) => row[index].1 += touches,
            Err(index) => row.insert(index, (named, touches)),
        }
    }

    /// Returns the number of shapes.
    pub fn shapes(&self) -> usize {
        self.rows.len()
    }

    /// Returns how many touches of one shape are named as another one; 0 if there is no such shape.
    pub fn get(&self, touched: usize, named: usize) -> u128 {
        let row = self.rows.get(touched).map_or(&[][..], Vec::as_slice);
        let found = row.binary_search_by_key(&named, |&(name, _)| name);
        found.map_or(0, |index| row[index].1)
    }

    /// Returns how many touches of a shape got any name; 0 if there is no such shape.
    pub fn touches_of(&self, shape: usize) -> u128 {
        let row = self.rows.get(shape).into_iter().flatten();
        row.map(|&(_, touches)| touches).sum()
    }

    /// Returns how many touches are named as a shape; 0 if there is no such shape.
    pub fn touches_named(&self, shape: usize) -> u128 {
        self.named.get(shape).into_iter().sum()
    }

    /// Iterates over the cells above 0, row by row: (touched shape, named shape, touches).
    pub fn cells(&self) -> impl DoubleEndedIterator<Item = (usize, usize, u128)> + '_ {
        let rows = self.rows.iter().enumerate();
        rows.flat_map(|(touched, row)| {
            let cells = row.iter();
            cells.map(move |&(named, touches)| (touched, named, touches))
        })
    }

    /// Iterates over the rows with all their cells: row i has the touches of shape i that are named 0, 1, 2 and so
    /// on.
    pub fn rows(&self) -> impl DoubleEndedIterator<Item = Vec<u128>> + ExactSizeIterator {
        self.rows.iter().map(|row| {
            let mut cells = vec![0; self.shapes()];
            for &(named, touches) in row {
                cells[named] = touches;
            }
            cells
        })
    }
}
