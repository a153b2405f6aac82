//! The sums that a boundary leaves in the cells of a grid, and the areas that follow from them.
//!
//! By Green's theorem the area of a shape in a cell is a sum over the pieces of its boundary, each cut at the grid
//! lines. A piece that climbs by `h` through a cell leaves `h` times its mean distance from the cell's right side in
//! that cell and the whole of `h` in every cell to the right of it. So each piece adds these two numbers to the entry
//! of its own cell only, and the areas come from running sums of the rows: only cells that the boundary crosses are
//! computed.
//!
//! Whatever lies left of the grid goes into a column before the first one, where only its height counts, and whatever
//! lies right of it into one behind the last. So no piece is a special case.
//!
//! Two rows are kept side by side, so that one running sum serves both: a processor adds a pair of `f64` in the time of
//! one, and a touch of a polygon spends most of its time on running sums.

use std::ops::Range;

use crate::geometry::outline::Point;
use crate::geometry::real::Real;
use crate::index::from_first;

/// A grid of `columns × rows` unit cells with its top left corner at the origin.
#[derive(Clone, Debug)]
pub(crate) struct CellGrid<T> {
    columns: i32,
    rows: i32,
    /// The entries of a pair of rows: one before the first column, one a column, one behind the last.
    stride: usize,
    entries: Vec<CellSums<T>>,
    /// The extent of everything drawn: the smallest x and y, and the largest ones.
    low: Point<T>,
    high: Point<T>,
    /// The largest moment of an ellipse that was drawn.
    moment: T,
}

/// What the pieces of boundary in a cell and in the one below it contribute there, and to each cell further right.
#[derive(Clone, Copy, Debug)]
struct CellSums<T> {
    here: [T; 2],
    beyond: [T; 2],
}

impl<T: Real> CellSums<T> {
    const EMPTY: Self = Self {
        here: [T::ZERO; 2],
        beyond: [T::ZERO; 2],
    };
}

impl<T: Real> CellGrid<T> {
    /// An empty grid.
    pub(crate) fn new(columns: u8, rows: u8) -> Self {
        let stride = usize::from(columns) + 2;
        let mut grid = Self {
            columns: columns.into(),
            rows: rows.into(),
            stride,
            entries: vec![CellSums::EMPTY; stride * usize::from(rows).div_ceil(2)],
            low: Point::new(T::ZERO, T::ZERO),
            high: Point::new(T::ZERO, T::ZERO),
            moment: T::ZERO,
        };
        grid.clear();
        grid
    }

    /// Clears the grid.
    pub(crate) fn clear(&mut self) {
        let (rows, drawn) = (self.rows(), self.entries_drawn());
        if !rows.is_empty() && !drawn.is_empty() {
            for pair in rows.start / 2..rows.end.div_ceil(2) {
                for entry in &mut self.entries[pair * self.stride..][drawn.clone()] {
                    *entry = CellSums::EMPTY;
                }
            }
        }
        self.low = Point::new(self.right(), self.bottom());
        self.high = Point::new(-T::ONE, -T::ONE);
        self.moment = T::ZERO;
    }

    /// Clears every entry, whatever the extent says: that of coordinates that are not finite is not known.
    pub(crate) fn wipe(&mut self) {
        self.entries.fill(CellSums::EMPTY);
        self.clear();
    }

    /// Its lower end.
    pub(crate) fn bottom(&self) -> T {
        T::whole(self.rows)
    }

    /// Its right end.
    pub(crate) fn right(&self) -> T {
        T::whole(self.columns)
    }

    /// Whether a rectangle lies on the grid.
    pub(crate) fn encloses(&self, low: Point<T>, high: Point<T>) -> bool {
        low.x >= T::ZERO && low.y >= T::ZERO && high.x <= self.right() && high.y <= self.bottom()
    }

    /// The rows that may hold something; all others are empty.
    pub(crate) fn rows(&self) -> Range<usize> {
        let row = |y: T| y.max(T::ZERO).min(self.bottom()).cell().0;
        let rows = from_first(self.rows);
        row(self.low.y)..(row(self.high.y) + 1).min(rows)
    }

    /// The entries of these rows that may hold something; all others are empty. [`Real::cell`] also decides where
    /// pieces lie, and it never puts a larger number into an earlier cell.
    fn entries_drawn(&self) -> Range<usize> {
        self.locate(self.low.x).0..self.locate(self.high.x).0 + 1
    }

    /// The columns that may hold something; all others are empty.
    pub(crate) fn columns(&self) -> Range<usize> {
        let entries = self.entries_drawn();
        let column = |entry: usize| entry.saturating_sub(1).min(self.stride - 2);
        column(entries.start)..column(entries.end)
    }

    /// By how much the areas of rows `2 * pair` and `2 * pair + 1` exceed a level in these columns; the areas are in
    /// [0, 1] up to a rounding error. `columns` is [`Self::columns`]. At least one of the two rows lies in
    /// [`Self::rows`]; one outside is all 0.
    pub(crate) fn pair(
        &self,
        pair: usize,
        columns: &Range<usize>,
        level: T,
    ) -> impl Iterator<Item = [T; 2]> {
        let entries = &self.entries[pair * self.stride..][columns.start..=columns.end];
        // Nothing left of these columns has a height, unless they begin with the first.
        let mut above = entries[0].beyond.map(|area| area - level);
        entries[1..].iter().map(move |entry| {
            let areas = [above[0] + entry.here[0], above[1] + entry.here[1]];
            above = [above[0] + entry.beyond[0], above[1] + entry.beyond[1]];
            areas
        })
    }

    /// The areas of one row.
    pub(crate) fn row(&self, row: usize, columns: &Range<usize>) -> impl Iterator<Item = T> {
        self.pair(row / 2, columns, T::ZERO)
            .map(move |areas| areas[row % 2])
    }

    /// The area in the top left cell, which is the only one of a grid of 1 × 1.
    pub(crate) fn first(&self) -> T {
        let (rows, columns) = (self.rows(), self.columns());
        if !rows.contains(&0) || !columns.contains(&0) {
            return T::ZERO;
        }
        let area = self.row(0, &columns).next();
        area.unwrap_or(T::ZERO)
    }

    /// The index of the entry in a row, from [`Self::start`] on, of the column that `x` lies in by [`Real::cell`], and that
    /// column's right end.
    pub(crate) fn locate(&self, x: T) -> (usize, T) {
        if x < T::ZERO {
            (0, T::ZERO)
        } else if x > self.right() {
            (self.stride - 1, self.right() + T::ONE)
        } else {
            let (column, left) = x.cell();
            (column + 1, left + T::ONE)
        }
    }

    /// Where the entries of a row begin: that of the column left of the grid.
    pub(crate) fn start(&self, row: usize) -> usize {
        row / 2 * self.stride
    }

    /// Adds to an entry, given from [`Self::start`] on, what a piece of boundary leaves in its cell and beyond.
    pub(crate) fn add(&mut self, entry: usize, row: usize, here: T, beyond: T) {
        if let Some(entry) = self.entries.get_mut(entry) {
            let lane = row % 2;
            entry.here[lane] = entry.here[lane] + here;
            entry.beyond[lane] = entry.beyond[lane] + beyond;
        }
    }

    /// An upper bound of the numbers whose sums are the areas: coordinates of edges, moments of ellipses.
    pub(crate) fn magnitude(&self) -> T {
        let ends = [self.low.x, self.low.y, self.high.x, self.high.y];
        ends.into_iter()
            .fold(self.moment, |most, end| most.max(end.abs()))
    }

    /// Remembers that an ellipse of this moment is drawn.
    pub(crate) fn weighs(&mut self, moment: T) {
        self.moment = self.moment.max(moment);
    }

    /// Remembers that something is drawn within a rectangle.
    pub(crate) fn draws(&mut self, low: Point<T>, high: Point<T>) {
        self.low = Point::new(self.low.x.min(low.x), self.low.y.min(low.y));
        self.high = Point::new(self.high.x.max(high.x), self.high.y.max(high.y));
    }
}
