//! Areas of an ellipse in the cells of a grid: the ellipse is cut at the grid lines.
//!
//! Each half of the ellipse is followed from top to bottom, row by row. Within a row, it runs in one direction to the
//! column of its end; in the row of the leftmost or rightmost point, it runs first to the column of that point and then
//! back. So the columns determine the vertical lines at which a piece ends, each point is reached once, and nothing
//! depends on how two rounding errors compare. An ellipse that merely touches a grid line is not a special case.
//!
//! A piece adds to its cell the difference of two running sums ([`Sums`]), so each line is computed once for the cells
//! on its two sides. All lines are computed before the descent begins, so that a processor can work on several of them
//! at once.

use crate::geometry::cell_grid::CellGrid;
use crate::geometry::ellipse_cuts::{EllipseCuts, Sums};
use crate::geometry::outline::{Point, Side};
use crate::geometry::real::Real;
use crate::index::from_first;

/// Draws ellipses on a grid. Drawing another ellipse does not allocate.
#[derive(Clone, Debug, Default)]
pub(crate) struct Arcs<T> {
    /// The sums where the ellipse meets each vertical line: above, below.
    vertical: Vec<[Sums<T>; 2]>,
    /// The states where the ellipse begins, meets each horizontal line, and ends: left, right.
    horizontal: Vec<[Way<T>; 2]>,
}

/// The state of a descent along a half of an ellipse.
#[derive(Clone, Copy, Debug)]
struct Way<T> {
    sums: Sums<T>,
    /// The index of the column's entry in a row of the grid, which is also the number of the line on its right.
    slot: usize,
    right: T,
}

struct RowPass<T> {
    start: usize,
    /// +1 or −1: whether the descent adds or subtracts.
    sign: T,
    quarter: T,
}

impl<T: Real> Arcs<T> {
    pub(crate) fn new(columns: u8, rows: u8) -> Self {
        let sums = Sums {
            height: T::ZERO,
            moment: T::ZERO,
        };
        let way = Way {
            sums,
            slot: 0,
            right: T::ZERO,
        };
        Self {
            vertical: vec![[sums; 2]; usize::from(columns) + 1],
            horizontal: vec![[way; 2]; usize::from(rows) + 1],
        }
    }

    pub(crate) fn draw(&mut self, grid: &mut CellGrid<T>, curve: &EllipseCuts<T>, material: Side) {
        let (top, end) = (curve.top.y.max(T::ZERO), curve.bottom.y.min(grid.bottom()));
        if top >= end {
            return;
        }
        grid.include_extent(
            Point::new(curve.left.x, curve.top.y),
            Point::new(curve.right.x, curve.bottom.y),
        );
        let farthest = curve.left.x.abs().max(curve.right.x.abs());
        grid.include_moment(farthest * (curve.bottom.y - curve.top.y) * T::HALF);
        let (leftmost, mut line) = grid.locate(curve.left.x);
        let (rightmost, _) = grid.locate(curve.right.x);
        for vertical in &mut self.vertical[leftmost..rightmost] {
            *vertical = curve.along(line);
            line = line + T::ONE;
        }
        let first = top.floor();
        let rows = self.cross(grid, curve, top, end);
        let quarter = curve.quarter();
        for side in 0..2 {
            let (turn, far, sign) = if side == 0 {
                (curve.left.y.floor(), leftmost, T::ONE)
            } else {
                (curve.right.y.floor(), rightmost, -T::ONE)
            };
            let sign = if material == Side::Inside {
                sign
            } else {
                -sign
            };
            for (number, ends) in (first..).zip(self.horizontal[..=rows].windows(2)) {
                let (mut way, goal) = (ends[0][side], ends[1][side]);
                let row = RowPass {
                    start: grid.start(from_first(number)),
                    sign,
                    quarter,
                };
                // A half moves away from the middle above its turning point, and back below it.
                if number < turn {
                    self.go(grid, &row, &mut way, goal.slot, 0);
                } else {
                    if number == turn {
                        self.go(grid, &row, &mut way, far, 0);
                    }
                    self.go(grid, &row, &mut way, goal.slot, 1);
                }
                row.add(grid, &way, goal.sums);
            }
        }
    }

    /// Computes the ends of each row's pieces, from `top` to `end`. Returns the number of rows.
    fn cross(&mut self, grid: &CellGrid<T>, curve: &EllipseCuts<T>, top: T, end: T) -> usize {
        let meet = |y: T| {
            curve.across(y).map(|(x, sums)| {
                let x = x.max(curve.left.x).min(curve.right.x);
                let (slot, right) = grid.locate(x);
                Way { sums, slot, right }
            })
        };
        let mut line = T::whole(top.floor());
        let mut rows = 0;
        self.horizontal[0] = meet(top);
        for ends in &mut self.horizontal[1..] {
            rows += 1;
            line = line + T::ONE;
            *ends = meet(line.min(end));
            if line >= end {
                break;
            }
        }
        rows
    }

    /// Follows a half to a column within a row, above or below the turning point.
    fn go(
        &self,
        grid: &mut CellGrid<T>,
        row: &RowPass<T>,
        way: &mut Way<T>,
        slot: usize,
        below: usize,
    ) {
        while way.slot < slot {
            let mut sums = self.vertical[way.slot][below];
            sums.moment = sums.moment - row.quarter;
            row.add(grid, way, sums);
            *way = Way {
                sums,
                slot: way.slot + 1,
                right: way.right + T::ONE,
            };
        }
        while way.slot > slot {
            let mut sums = self.vertical[way.slot - 1][below];
            sums.moment = sums.moment + row.quarter;
            row.add(grid, way, sums);
            *way = Way {
                sums,
                slot: way.slot - 1,
                right: way.right - T::ONE,
            };
        }
    }
}

impl<T: Real> RowPass<T> {
    fn add(&self, grid: &mut CellGrid<T>, from: &Way<T>, to: Sums<T>) {
        let height = self.sign * (to.height - from.sums.height);
        let moment = self.sign * (to.moment - from.sums.moment);
        let here = from.right * height - moment;
        grid.add(self.start + from.slot, here, height);
    }
}
