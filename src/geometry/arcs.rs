//! An ellipse cut at the lines of a grid.
//!
//! The ellipse is cut at its four extreme points first. Between them it is monotone in x and in y, so it crosses each
//! grid line at most once, and a piece's cell is known from the order of its crossings; nothing is classified by a
//! midpoint, and an ellipse that merely touches a grid line is no special case. A piece counts as its chord plus the
//! segment between the two.
//!
//! Each half is gone along from top to bottom and its crossings noted; then all pieces are computed in one straight
//! loop, which a compiler makes work on several of them at once.

use super::curve::Curve;
use super::grid::{Grid, index};
use super::outline::{Ellipse, Point, Side};
use super::real::Real;

/// Draws ellipses, again and again without allocating.
#[derive(Clone, Debug, Default)]
pub struct Arcs<T> {
    /// Where the ellipse meets the horizontal lines: left, right; and the vertical ones: above, below.
    horizontal: Vec<[T; 2]>,
    vertical: Vec<[T; 2]>,
    /// The points at which a half is cut, from top to bottom.
    cuts: Vec<Cut<T>>,
    /// What the piece up to the next cut leaves in its cell: its share, at first the square of half its chord in the
    /// unit disc.
    shares: Vec<T>,
}

/// A point at which a half is cut, and the cell of the piece that ends there: its left side, entry and row.
#[derive(Clone, Copy, Debug)]
struct Cut<T> {
    at: Point<T>,
    left: T,
    entry: usize,
    row: usize,
}

/// Where a half is on its way: the last cut, and the cell after it.
struct Place<T> {
    row: usize,
    /// The horizontal line below the row.
    line: T,
    /// The column's entry: 0 left of the grid.
    entry: usize,
    left: T,
}

impl<T: Real> Arcs<T> {
    /// For grids of that size.
    pub fn new(columns: u8, rows: u8) -> Self {
        let lines = |cells: u8| vec![[T::ZERO; 2]; usize::from(cells) + 1];
        Self {
            horizontal: lines(rows),
            vertical: lines(columns),
            cuts: Vec::new(),
            shares: Vec::new(),
        }
    }

    /// Draws an ellipse on a grid of the size given at first.
    pub fn draw(&mut self, grid: &mut Grid<T>, ellipse: &Ellipse<T>, material: Side) {
        let curve = Curve::of(ellipse);
        let (top, end) = (curve.top.y.max(T::ZERO), curve.bottom.y.min(grid.bottom()));
        if top >= end {
            return;
        }
        // A crossing may lie beyond the extreme points by a rounding.
        let (low, high) = (curve.left.x - T::TIE, curve.right.x + T::TIE);
        grid.draws(Point::new(low, top), Point::new(high, end));
        between(&mut self.horizontal, top, end, |y| curve.xs_at(y));
        between(&mut self.vertical, low, high, |x| curve.ys_at(x));
        let ends = |y: T, extreme: Point<T>| {
            if y == extreme.y {
                [extreme.x; 2]
            } else {
                curve.xs_at(y)
            }
        };
        let (first, last) = (ends(top, curve.top), ends(end, curve.bottom));
        for right in [false, true] {
            let side = usize::from(right);
            let turning = if right { curve.right } else { curve.left };
            let (from, to) = (Point::new(first[side], top), Point::new(last[side], end));
            self.cut(grid, [from, turning, to], right);
            self.measure(&curve, right);
            self.leave(grid, right == (material == Side::Outside));
        }
    }

    /// Cuts a half, between two points of it on the grid and with its turning point between them or not.
    fn cut(&mut self, grid: &Grid<T>, [from, turning, to]: [Point<T>; 3], right: bool) {
        let (row, column) = (
            index(from.y.floor()),
            from.x.max(-T::ONE).min(grid.right()).floor(),
        );
        let mut place = Place {
            row,
            line: T::ONE + T::whole(from.y.floor()),
            entry: index(column + 1),
            left: T::whole(column),
        };
        self.cuts.clear();
        self.piece(grid, &place, from.x, from.y);
        let turns = turning.y.max(from.y).min(to.y);
        if from.y < turns {
            let here = if turns < to.y { turning } else { to };
            self.quarter(grid, &mut place, here, 0, right);
        }
        if turns < to.y {
            self.quarter(grid, &mut place, to, 1, !right);
        }
    }

    /// Goes on to a point, above or below the turning point, which changes the column to the right or to the left.
    fn quarter(
        &mut self,
        grid: &Grid<T>,
        place: &mut Place<T>,
        to: Point<T>,
        below: usize,
        rightwards: bool,
    ) {
        let side = usize::from(rightwards == (below == 0));
        let far = grid.bottom() + T::ONE;
        loop {
            // The vertical line that is next.
            let (line, x) = if rightwards {
                (place.entry, place.left + T::ONE)
            } else {
                (place.entry.wrapping_sub(1), place.left)
            };
            let passes = if rightwards { x < to.x } else { x > to.x };
            let y = match self.vertical.get(line) {
                Some(ys) if passes => ys[below],
                _ => far,
            };
            while place.line < to.y && place.line <= y {
                let x = self.horizontal[place.row + 1][side];
                self.piece(grid, place, x, place.line);
                (place.row, place.line) = (place.row + 1, place.line + T::ONE);
            }
            if y == far {
                break;
            }
            self.piece(grid, place, x, y.min(to.y));
            if rightwards {
                (place.entry, place.left) = (place.entry + 1, x);
            } else {
                (place.entry, place.left) = (place.entry - 1, x - T::ONE);
            }
        }
        self.piece(grid, place, to.x, to.y);
    }

    /// Notes the piece up to a point.
    #[inline]
    fn piece(&mut self, grid: &Grid<T>, place: &Place<T>, x: T, y: T) {
        self.cuts.push(Cut {
            at: Point::new(x, y),
            left: place.left,
            entry: grid.start(place.row) + place.entry,
            row: place.row,
        });
    }

    /// Computes the pieces' shares.
    fn measure(&mut self, curve: &Curve<T>, right: bool) {
        let pieces = self.cuts.len() - 1;
        self.shares.resize(pieces, T::ZERO);
        // Not the largest of them, which would have to be found one by one.
        let mut long = false;
        for (ends, share) in self.cuts.windows(2).zip(&mut self.shares) {
            let (from, to) = (ends[0].at, ends[1].at);
            *share = curve.squared_chord(Point::new(to.x - from.x, to.y - from.y));
            long |= *share * T::whole(8) > T::ONE;
        }
        let pieces = self.cuts.windows(2).zip(&mut self.shares);
        let chord = |from: Point<T>, to: &Cut<T>| {
            (to.at.y - from.y) * ((from.x + to.at.x) * T::HALF - to.left)
        };
        if long {
            for (ends, share) in pieces {
                let (from, to) = (ends[0].at, &ends[1]);
                *share = chord(from, to) + curve.segment(from, to.at, *share, right);
            }
        } else {
            for (ends, share) in pieces {
                let (from, to) = (ends[0].at, &ends[1]);
                *share = chord(from, to) + curve.short_segment(from, to.at, *share);
            }
        }
    }

    /// Adds the pieces to the grid.
    fn leave(&self, grid: &mut Grid<T>, added: bool) {
        for (ends, &share) in self.cuts.windows(2).zip(&self.shares) {
            let Cut { at, entry, row, .. } = ends[1];
            let height = at.y - ends[0].at.y;
            if added {
                grid.add(entry, row, height, share);
            } else {
                grid.add(entry, row, -height, -share);
            }
        }
    }
}

/// Computes the crossings with the lines from `low` to `high`, as far as there are such lines.
fn between<T: Real>(crossings: &mut [[T; 2]], low: T, high: T, at: impl Fn(T) -> [T; 2]) {
    let last = T::whole(i32::try_from(crossings.len()).unwrap_or(0) - 1);
    if high < T::ZERO || low > last {
        return;
    }
    let (first, last) = (
        index(low.max(T::ZERO).floor()),
        index(high.min(last).floor()),
    );
    let mut line = T::whole(low.max(T::ZERO).floor());
    for crossing in &mut crossings[first..=last] {
        *crossing = at(line);
        line = line + T::ONE;
    }
}
