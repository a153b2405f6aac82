//! The exact area of a shape inside each cell of a grid.
//!
//! **Method.** The boundary is cut at the grid lines, and each piece adds to its own cell the sums from which areas are
//! computed ([`CellGrid`]). Straight edges are cut here, ellipses in [`Arcs`].
//!
//! **Error.** There are a few rounding errors per piece, of sums below 10^4 for every shape of the program: together
//! less than 1e-11 in `f64`, a tenth of what a touch considers doubtful. Edges that are horizontal or vertical up to a
//! rounding error are harmless: their contribution is as small as their height. To decide a threshold exactly,
//! [`crate::touch`] uses [`cell_area`].

use std::mem;
use std::ops::Range;

use crate::geometry::ellipse::{Arcs, EllipseCuts};
use crate::geometry::outline::{Ellipse, Moving, Pen, Point, Side, Solid};
use crate::geometry::real::Real;
use crate::index::from_first;

#[derive(Clone, Debug)]
pub(crate) struct Overlap<T> {
    pub(crate) grid: CellGrid<T>,
    arcs: Arcs<T>,
}

impl<T: Real> Overlap<T> {
    pub(crate) fn new(columns: u8, rows: u8) -> Self {
        Self {
            grid: CellGrid::new(columns, rows),
            arcs: Arcs::new(columns, rows),
        }
    }

    /// Draws an edge with the material on the right for a `sign` of +1, on the left for −1. `whole` says that the edge
    /// does not reach beyond the grid.
    #[expect(
        clippy::inline_always,
        reason = "called for every edge: in a large program, a call was made, which takes a twelfth of a touch"
    )]
    #[inline(always)]
    fn side(&mut self, from: Point<T>, to: Point<T>, sign: T, whole: bool) {
        let Some(edge) = SlopedEdge::between(from, to, sign) else {
            return;
        };
        if whole {
            self.inside(&edge, edge.left, edge.right);
        } else {
            self.partly(edge);
        }
    }

    /// Draws the part of an edge that lies on the grid or left of it.
    #[cold]
    fn partly(&mut self, edge: SlopedEdge<T>) {
        if let Some([from, to]) = self.clipped(&edge) {
            self.inside(&edge, from, to);
        }
    }

    #[expect(
        clippy::inline_always,
        reason = "called for every edge: a call passes the edge through memory, an eighth more instructions"
    )]
    #[inline(always)]
    fn inside(&mut self, edge: &SlopedEdge<T>, from: Point<T>, to: Point<T>) {
        let ((first, top), (last, _)) = (from.y.cell(), to.y.cell());
        let stride = self.grid.start(1);
        let (mut line, step, next_row) = if first < last {
            (top + T::ONE, T::ONE, stride)
        } else {
            (top, -T::ONE, stride.wrapping_neg())
        };
        let mut start = self.grid.start(first) + 1;
        let mut entered = from.y;
        let (mut here, mut cell) = (from.x, from.x.cell());
        for _ in 0..first.abs_diff(last) {
            // Clamped between the ends, because the slope of an edge that is horizontal up to a rounding error is
            // meaningless.
            let next = edge.x_at(line).max(from.x).min(to.x);
            let height = edge.sign * (line - entered);
            cell = self.slice(start, edge, (here, cell), next, height);
            (here, entered, line) = (next, line, line + step);
            start = start.wrapping_add(next_row);
        }
        let height = edge.sign * (to.y - entered);
        self.slice(start, edge, (here, cell), to.x, height);
    }

    /// Draws the part of an edge in one row, whose first cell has the entry `start`. The part begins in a given cell,
    /// ends at `to`, and adds `height` to the cells beyond. Returns the cell in which it ends.
    #[expect(
        clippy::inline_always,
        reason = "called for every row of every edge: a call takes a third as long as the rest"
    )]
    #[inline(always)]
    fn slice(
        &mut self,
        start: usize,
        edge: &SlopedEdge<T>,
        (from, (first, first_left)): (T, (usize, T)),
        to: T,
        height: T,
    ) -> (usize, T) {
        let (last, last_left) = to.cell();
        let mut add = |column: usize, height: T, way: T| {
            self.grid
                .add(start.wrapping_add(column), height * way, height);
        };
        let last_right = last_left + T::ONE;
        if first == last {
            add(last, height, last_right - (from + to) * T::HALF);
            return (last, last_left);
        }
        // The last cell gets the height that remains after the first cell and the whole cells in between: so a sum that
        // is too small in one cell by a rounding error is too large by it in the next one.
        let way = first_left + T::ONE - from;
        let own = way * edge.climb;
        add(first, own, way * T::HALF);
        let mut rest = height - own;
        for column in first + 1..last {
            add(column, edge.climb, T::HALF);
            rest = rest - edge.climb;
        }
        add(last, rest, last_right - (last_left + to) * T::HALF);
        (last, last_left)
    }

    /// Returns the part of an edge that lies on the grid, for an edge that reaches beyond it; draws the part left of
    /// the grid.
    fn clipped(&mut self, edge: &SlopedEdge<T>) -> Option<[Point<T>; 2]> {
        let (mut from, mut to) = (edge.left, edge.right);
        let (bottom, right) = (self.grid.bottom(), self.grid.right());
        let (low, high) = (from.y.min(to.y), from.y.max(to.y));
        let (top, end) = (low.max(T::ZERO), high.min(bottom));
        if top >= end {
            return None;
        }
        for point in [&mut from, &mut to] {
            let y = point.y.max(top).min(end);
            if y != point.y {
                *point = Point::new(edge.left.x.max(edge.x_at(y)).min(edge.right.x), y);
            }
        }
        let at = |x: T| Point::new(x, top.max(edge.y_at(x)).min(end));
        // Left of the grid only the height of an edge counts; right of it, an edge does not count.
        if from.x < T::ZERO {
            let rim = if to.x < T::ZERO { to } else { at(T::ZERO) };
            self.aside(edge, from.y, rim.y);
            from = rim;
        }
        if to.x > right {
            to = at(right);
        }
        (T::ZERO <= from.x && from.x <= to.x).then_some([from, to])
    }

    fn aside(&mut self, edge: &SlopedEdge<T>, from: T, to: T) {
        let (top, end) = (from.min(to), from.max(to));
        let sign = if from < to { edge.sign } else { -edge.sign };
        let (mut here, mut row) = (top, top.floor());
        while here < end {
            let next = T::whole(row + 1).min(end);
            let start = self.grid.start(from_first(row));
            self.grid.add(start, T::ZERO, sign * (next - here));
            (here, row) = (next, row + 1);
        }
    }
}

/// A straight edge, from left to right.
#[derive(Clone, Copy)]
struct SlopedEdge<T> {
    left: Point<T>,
    right: Point<T>,
    /// The distance to the right for each unit down.
    slope: T,
    /// The distance down for each unit to the right.
    steepness: T,
    /// −1 if the material is below, +1 if it is above: if the boundary runs upwards, the cells on its right gain.
    sign: T,
    /// The height that the edge adds to a cell that it crosses from side to side.
    climb: T,
}

impl<T: Real> SlopedEdge<T> {
    fn between(from: Point<T>, to: Point<T>, sign: T) -> Option<Self> {
        let (left, right, sign) = if from.x < to.x {
            (from, to, -sign)
        } else {
            (to, from, sign)
        };
        let (width, height) = (right.x - left.x, right.y - left.y);
        if height == T::ZERO {
            return None;
        }
        let steepness = height / width;
        Some(Self {
            left,
            right,
            slope: width / height,
            steepness,
            sign,
            climb: sign * steepness,
        })
    }

    fn x_at(&self, y: T) -> T {
        self.left.x + (y - self.left.y) * self.slope
    }

    fn y_at(&self, x: T) -> T {
        self.left.y + (x - self.left.x) * self.steepness
    }
}

impl<T: Real> Pen<T> for Overlap<T> {
    fn edge(&mut self, from: Point<T>, to: Point<T>) {
        let (low, high) = (
            Point::new(from.x.min(to.x), from.y.min(to.y)),
            Point::new(from.x.max(to.x), from.y.max(to.y)),
        );
        self.grid.include_extent(low, high);
        self.side(from, to, T::ONE, self.grid.encloses(low, high));
    }

    fn ellipse(&mut self, ellipse: &Ellipse<T>, material: Side) {
        if let Some(curve) = EllipseCuts::of(ellipse) {
            self.arcs.draw(&mut self.grid, &curve, material);
        }
    }

    fn ring(&mut self, points: &[Point<T>], material: Side) {
        let Some(&last) = points.last() else { return };
        let (mut low, mut high) = (last, last);
        for point in points {
            low = Point::new(low.x.min(point.x), low.y.min(point.y));
            high = Point::new(high.x.max(point.x), high.y.max(point.y));
        }
        self.grid.include_extent(low, high);
        let sign = match material {
            Side::Inside => T::ONE,
            Side::Outside => -T::ONE,
        };
        let whole = self.grid.encloses(low, high);
        let mut from = last;
        for &to in points {
            self.side(from, to, sign, whole);
            from = to;
        }
    }
}

/// Returns the areas of a shape inside some cells of a row, by the same method. The top left corner of the first cell is
/// (`column`, `row`).
pub(crate) fn row_areas<T: Real>(solid: &impl Solid, [column, row]: [u8; 2], cells: u8) -> Vec<T> {
    let by = Point::new(T::whole(-i32::from(column)), T::whole(-i32::from(row)));
    let mut overlap = Overlap::new(cells, 1);
    let pen = &mut overlap;
    solid.draw(&mut Moving { by, pen });
    let grid = overlap.grid;
    let mut areas = vec![T::ZERO; cells.into()];
    let Drawn { rows, columns } = grid.drawn();
    if rows.contains(&0) && !columns.is_empty() {
        for (area, found) in areas[columns.clone()].iter_mut().zip(grid.row(0, &columns)) {
            *area = found;
        }
    }
    areas
}

/// Returns the area of a shape inside the single cell whose top left corner is (`column`, `row`), by the same method.
pub fn cell_area<T: Real>(solid: &impl Solid, column: u8, row: u8) -> T {
    row_areas(solid, [column, row], 1)[0]
}

// A grid of cells that sums up the boundary drawn on it, and computes areas from the sums.
//
// By Green's theorem, the area of a shape in a cell is a sum over the pieces of its boundary, each cut at the grid
// lines. A piece that climbs by `h` through a cell adds `h` times its mean distance from the cell's right side to that
// cell, and the whole of `h` to every cell on the right of it. So each piece adds just two numbers to the entry of its
// own cell, and the areas come from running sums along the rows. Only cells that the boundary crosses are computed.
//
// A piece left of the grid belongs to a column before the first one, where only its height counts. A piece right of
// the grid belongs to a column behind the last one. So no piece is a special case.
//
// Areas are read from two rows at once, because a processor adds a pair of `f64` in the time of one.

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
