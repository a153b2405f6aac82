//! The sums that a boundary leaves in the cells of a grid, and the areas that follow from them.
//!
//! By Green's theorem the area of a shape in a cell is a sum over the pieces of its boundary, each cut at the grid
//! lines. A piece that climbs by `h` through a cell leaves `h` times its mean distance from the cell's right side in
//! that cell and the whole of `h` in every cell to the right of it. So each piece adds to the entry of its own cell
//! only, and the areas come from running sums of the rows: only cells that the boundary crosses are computed.
//!
//! What lies left of the grid is put into a column before the first one, where its height is all that counts, and
//! what lies right of it into one behind the last: no piece is a special case.
//!
//! Two rows are kept side by side, so that one running sum serves both: a processor adds a pair of `f64` in the time
//! of one, and the running sums are what a touch of a polygon spends most of its time on.

use std::ops::Range;

use super::outline::Point;
use super::real::Real;

/// A grid of `columns × rows` unit cells with its top left corner at the origin.
#[derive(Clone, Debug)]
pub struct Grid<T> {
    columns: i32,
    rows: i32,
    /// The entries of a pair of rows: one before the first column, one a column, one behind the last.
    stride: usize,
    entries: Vec<Entry<T>>,
    /// How far anything drawn reaches: the least x and y, and the largest ones.
    low: Point<T>,
    high: Point<T>,
}

/// Of a cell and the one below it: the sums of their pieces' heights, and of what lies between the pieces and the
/// cell's left side.
///
/// The second belongs to the cells on the right, but is kept here: a piece then writes to one place only.
#[derive(Clone, Copy, Debug)]
struct Entry<T> {
    heights: [T; 2],
    shares: [T; 2],
}

impl<T: Real> Entry<T> {
    const EMPTY: Self = Self {
        heights: [T::ZERO; 2],
        shares: [T::ZERO; 2],
    };
}

impl<T: Real> Grid<T> {
    /// An empty grid.
    pub fn new(columns: u8, rows: u8) -> Self {
        let stride = usize::from(columns) + 2;
        let mut grid = Self {
            columns: columns.into(),
            rows: rows.into(),
            stride,
            entries: vec![Entry::EMPTY; stride * usize::from(rows).div_ceil(2)],
            low: Point::new(T::ZERO, T::ZERO),
            high: Point::new(T::ZERO, T::ZERO),
        };
        grid.clear();
        grid
    }

    /// Wipes the grid.
    pub fn clear(&mut self) {
        let (rows, drawn) = (self.rows(), self.entries_drawn());
        if !rows.is_empty() {
            for pair in rows.start / 2..rows.end.div_ceil(2) {
                // A piece on a line may have gone to the column on its left.
                let drawn = drawn.start.saturating_sub(1)..drawn.end;
                for entry in &mut self.entries[pair * self.stride..][drawn] {
                    (entry.heights, entry.shares) = ([T::ZERO; 2], [T::ZERO; 2]);
                }
            }
        }
        self.low = Point::new(self.right(), self.bottom());
        self.high = Point::new(-T::ONE, -T::ONE);
    }

    /// Its lower end.
    pub fn bottom(&self) -> T {
        T::whole(self.rows)
    }

    /// Its right end.
    pub fn right(&self) -> T {
        T::whole(self.columns)
    }

    /// The rows whose cells are not all empty for certain.
    pub fn rows(&self) -> Range<usize> {
        let (top, bottom) = (self.low.y.floor(), self.high.y.floor());
        index(top.min(self.rows))..index(bottom.saturating_add(1).min(self.rows))
    }

    /// The entries of these rows that are not all zero for certain.
    fn entries_drawn(&self) -> Range<usize> {
        let entry = |x: T| index(x.floor().max(-1).min(self.columns) + 1);
        entry(self.low.x)..entry(self.high.x) + 1
    }

    /// The columns whose cells are not all empty for certain.
    pub fn columns(&self) -> Range<usize> {
        let entries = self.entries_drawn();
        let column = |entry: usize| entry.saturating_sub(1).min(self.stride - 2);
        column(entries.start)..column(entries.end)
    }

    /// The areas of rows `2 * pair` and `2 * pair + 1` in these columns, each in [0, 1] up to a rounding. `columns` is
    /// [`Self::columns`], one of the rows at least lies in [`Self::rows`]; the other one may lie outside, all 0.
    pub fn pair(&self, pair: usize, columns: &Range<usize>) -> impl Iterator<Item = [T; 2]> {
        let entries = &self.entries[pair * self.stride..][columns.start..=columns.end];
        // Nothing left of these columns has a height, unless they begin with the first.
        let mut heights = entries[0].heights;
        entries[1..].iter().map(move |entry| {
            let [upper, lower] = entry.heights;
            let areas = [
                heights[0] + (upper - entry.shares[0]),
                heights[1] + (lower - entry.shares[1]),
            ];
            heights = [heights[0] + upper, heights[1] + lower];
            areas
        })
    }

    /// The areas of one row.
    pub fn row(&self, row: usize, columns: &Range<usize>) -> impl Iterator<Item = T> {
        self.pair(row / 2, columns).map(move |areas| areas[row % 2])
    }

    /// Whether a piece of boundary that is not horizontal runs through a cell. Neighbours in a row through which none
    /// runs have the same area.
    pub fn crosses(&self, row: usize, column: usize) -> bool {
        let Entry { heights, shares } = self.entries[row / 2 * self.stride + column + 1];
        (heights[row % 2], shares[row % 2]) != (T::ZERO, T::ZERO)
    }

    /// Where the entries of a row begin: that of the column left of the grid.
    pub fn start(&self, row: usize) -> usize {
        row / 2 * self.stride
    }

    /// Adds a piece of boundary to an entry, given from [`Self::start`] on.
    pub fn add(&mut self, entry: usize, row: usize, height: T, share: T) {
        if let Some(Entry { heights, shares }) = self.entries.get_mut(entry) {
            let lane = row % 2;
            (heights[lane], shares[lane]) = (heights[lane] + height, shares[lane] + share);
        }
    }

    /// Remembers that something is drawn within a rectangle.
    pub fn draws(&mut self, low: Point<T>, high: Point<T>) {
        self.low = Point::new(self.low.x.min(low.x), self.low.y.min(low.y));
        self.high = Point::new(self.high.x.max(high.x), self.high.y.max(high.y));
    }
}

/// A number that is not negative, as an index.
pub fn index(value: i32) -> usize {
    usize::try_from(value).unwrap_or(0)
}
