//! A grid of cells that sums up the boundary drawn on it, and computes areas from the sums.
//!
//! By Green's theorem, the area of a shape in a cell is a sum over the pieces of its boundary, each cut at the grid
//! lines. A piece that climbs by `h` through a cell adds `h` times its mean distance from the cell's right side to that
//! cell, and the whole of `h` to every cell on the right of it. So each piece adds just two numbers to the entry of its
//! own cell, and the areas come from running sums along the rows. Only cells that the boundary crosses are computed.
//!
//! A piece left of the grid belongs to a column before the first one, where only its height counts. A piece right of
//! the grid belongs to a column behind the last one. So no piece is a special case.
//!
//! Areas are read from two rows at once, because a processor adds a pair of `f64` in the time of one.

use std::mem;
use std::ops::Range;

use crate::geometry::outline::Point;
use crate::geometry::real::Real;
use crate::index::from_first;

#[derive(Clone, Debug)]
pub(crate) struct CellGrid<T> {
    columns: i32,
    rows: i32,
    /// The number of entries of a row: one before the first column, one per column, one behind the last.
    stride: usize,
    /// The entries of all rows, and of one more below them. That row is the second of a pair if the last row is the
    /// first, and it takes the rounding errors of edges that end at the lower end of the grid.
    entries: Vec<CellSums<T>>,
    /// The extent of everything drawn: the smallest x and y, and the largest ones.
    low: Point<T>,
    high: Point<T>,
    moment: T,
}

/// The cells of a grid that may contain something; all others are empty.
#[derive(Clone, Debug, Default)]
pub(crate) struct Drawn {
    pub(crate) rows: Range<usize>,
    pub(crate) columns: Range<usize>,
}

impl Drawn {
    pub(crate) fn is_empty(&self) -> bool {
        self.rows.is_empty() || self.columns.is_empty()
    }
}

/// The sums of the pieces of boundary in a cell: what they add to its area, and to that of each cell further right.
#[derive(Clone, Copy, Debug)]
struct CellSums<T> {
    here: T,
    beyond: T,
}

impl<T: Real> CellSums<T> {
    const EMPTY: Self = Self {
        here: T::ZERO,
        beyond: T::ZERO,
    };
}

impl<T: Real> CellGrid<T> {
    pub(crate) fn new(columns: u8, rows: u8) -> Self {
        let stride = usize::from(columns) + 2;
        let mut grid = Self {
            columns: columns.into(),
            rows: rows.into(),
            stride,
            entries: vec![CellSums::EMPTY; stride * (usize::from(rows) + 1)],
            low: Point::new(T::ZERO, T::ZERO),
            high: Point::new(T::ZERO, T::ZERO),
            moment: T::ZERO,
        };
        grid.clear();
        grid
    }

    pub(crate) fn clear(&mut self) {
        let (rows, drawn) = (self.rows_drawn(), self.entries_drawn());
        if !drawn.is_empty() {
            for row in rows {
                self.entries[row * self.stride..][drawn.clone()].fill(CellSums::EMPTY);
            }
        }
        self.forget();
    }

    /// Prepares a grid whose entries are empty for the next drawing.
    pub(crate) fn forget(&mut self) {
        self.low = Point::new(self.right(), self.bottom());
        self.high = Point::new(-T::ONE, -T::ONE);
        self.moment = T::ZERO;
    }

    /// Clears every entry, for a grid on which coordinates that are not finite were drawn: its extent is not known.
    pub(crate) fn wipe(&mut self) {
        self.entries.fill(CellSums::EMPTY);
        self.clear();
    }

    pub(crate) fn bottom(&self) -> T {
        T::whole(self.rows)
    }

    pub(crate) fn right(&self) -> T {
        T::whole(self.columns)
    }

    pub(crate) fn encloses(&self, low: Point<T>, high: Point<T>) -> bool {
        low.x >= T::ZERO && low.y >= T::ZERO && high.x <= self.right() && high.y <= self.bottom()
    }

    /// Returns the cells that may contain something; all others are empty.
    pub(crate) fn drawn(&self) -> Drawn {
        let entries = self.entries_drawn();
        let column = |entry: usize| entry.saturating_sub(1).min(self.stride - 2);
        Drawn {
            rows: self.rows_drawn(),
            columns: column(entries.start)..column(entries.end),
        }
    }

    fn rows_drawn(&self) -> Range<usize> {
        let row = |y: T| y.max(T::ZERO).min(self.bottom()).cell().0;
        let rows = from_first(self.rows);
        row(self.low.y)..(row(self.high.y) + 1).min(rows)
    }

    /// Returns the entries of these rows that may contain something; all others are empty. [`Real::cell`] also decides
    /// which cell a piece belongs to, and it never puts a larger number into an earlier cell.
    fn entries_drawn(&self) -> Range<usize> {
        self.locate(self.low.x).0..self.locate(self.high.x).0 + 1
    }

    /// Takes the areas of the cells that [`Self::drawn`] returns, in pairs of rows from the first one on, and leaves
    /// the grid empty. The areas are in [0, 1] up to a rounding error. The second row of the last pair may lie below
    /// the others; then its areas are 0, up to a rounding error.
    pub(crate) fn take_pairs(
        &mut self,
        drawn: &Drawn,
    ) -> impl Iterator<Item = impl Iterator<Item = [T; 2]>> {
        let Drawn { rows, columns } = drawn;
        let stride = self.stride;
        let take = |entry: &mut CellSums<T>| mem::replace(entry, CellSums::EMPTY);
        // Not `chunks_exact_mut`: its division takes as long as three cells.
        let mut rest = &mut self.entries[rows.start * stride..];
        let pairs =
            (0..rows.len().div_ceil(2)).map_while(move |_| rest.split_off_mut(..2 * stride));
        pairs.map(move |pair| {
            let (upper, lower) = pair.split_at_mut(stride);
            // What lies behind the last column counts nowhere.
            upper[stride - 1] = CellSums::EMPTY;
            lower[stride - 1] = CellSums::EMPTY;
            let upper = &mut upper[columns.start..=columns.end];
            let lower = &mut lower[columns.start..=columns.end];
            // No entry left of these columns has a height, unless they begin with the first column.
            let mut above = [take(&mut upper[0]).beyond, take(&mut lower[0]).beyond];
            let pairs = upper[1..].iter_mut().zip(&mut lower[1..]);
            pairs.map(move |(upper, lower)| {
                let (upper, lower) = (take(upper), take(lower));
                let areas = [above[0] + upper.here, above[1] + lower.here];
                above = [above[0] + upper.beyond, above[1] + lower.beyond];
                areas
            })
        })
    }

    /// Returns the areas of a row in these columns, of the cells that [`Self::drawn`] returns.
    pub(crate) fn row(&self, row: usize, columns: &Range<usize>) -> impl Iterator<Item = T> {
        let entries = &self.entries[row * self.stride..][columns.start..=columns.end];
        let mut above = entries[0].beyond;
        entries[1..].iter().map(move |entry| {
            let area = above + entry.here;
            above = above + entry.beyond;
            area
        })
    }

    pub(crate) fn first(&self) -> T {
        let Drawn { rows, columns } = self.drawn();
        if !rows.contains(&0) || !columns.contains(&0) {
            return T::ZERO;
        }
        let area = self.row(0, &columns).next();
        area.unwrap_or(T::ZERO)
    }

    /// Returns the entry, counted from [`Self::start`], of the column in which `x` lies by [`Real::cell`], and the
    /// right end of that column.
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

    /// Returns the index of the first entry of a row: that of the column left of the grid.
    pub(crate) fn start(&self, row: usize) -> usize {
        row * self.stride
    }

    /// Adds what a piece of boundary contributes to its own cell (`here`) and to each cell further right (`beyond`).
    /// `entry` is the index of the cell's entry among those of all rows.
    pub(crate) fn add(&mut self, entry: usize, here: T, beyond: T) {
        if let Some(entry) = self.entries.get_mut(entry) {
            entry.here = entry.here + here;
            entry.beyond = entry.beyond + beyond;
        }
    }

    /// Returns an upper bound of the numbers that the areas are sums of: coordinates of edges, moments of ellipses.
    pub(crate) fn magnitude(&self) -> T {
        let ends = [self.low.x, self.low.y, self.high.x, self.high.y];
        ends.into_iter()
            .fold(self.moment, |most, end| most.max(end.abs()))
    }

    pub(crate) fn include_moment(&mut self, moment: T) {
        self.moment = self.moment.max(moment);
    }

    pub(crate) fn include_extent(&mut self, low: Point<T>, high: Point<T>) {
        self.low = Point::new(self.low.x.min(low.x), self.low.y.min(low.y));
        self.high = Point::new(self.high.x.max(high.x), self.high.y.max(high.y));
    }
}
