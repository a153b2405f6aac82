//! Ellipses that are cut at the lines of a grid, and their areas in its cells.

use crate::geometry::outline::{Ellipse, Point, Side};
use crate::geometry::overlap::CellGrid;
use crate::geometry::real::Real;
use crate::index::from_first;

// An ellipse prepared for being cut at the lines of a grid.
//
// Let `a`, `b` be the images of the disc's axes and `c` the centre. The reach in y is `R = √(a.y² + b.y²)`. The line
// `y = c.y + R·sin η` meets the ellipse at `x = c.x + shear·R·sin η ± extent·cos η`, with
// `shear = (a.x·a.y + b.x·b.y) / R²` and `extent = |det| / R`; likewise for vertical lines.
//
// **Moments.** Along an arc whose angle in the disc is `φ`, Green's theorem gives `∫ X dY = (X·Y + det·φ) / 2` about
// the centre. A horizontal line needs only one angle `η` for the two points at which it meets the ellipse, since both
// are equally far from the topmost point; so does a vertical line.

#[derive(Clone, Copy, Debug)]
pub(crate) struct EllipseCuts<T> {
    centre: Point<T>,
    reach: Point<T>,
    inverse: Point<T>,
    shear: Point<T>,
    extent: Point<T>,
    /// Half of the area of the parallelogram that the axes span; positive.
    half_area: T,
    /// The angle by which the rightmost point lies below the middle between the topmost and the bottommost one.
    tilt: T,
    pub(crate) left: Point<T>,
    pub(crate) top: Point<T>,
    pub(crate) right: Point<T>,
    pub(crate) bottom: Point<T>,
}

/// The running sums of a descent along a half of an ellipse, at one of its points. A piece between two points
/// contributes the difference of their sums.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Sums<T> {
    /// `∫ dy`: the height below the centre.
    pub height: T,
    /// `∫ x dy`, starting at the leftmost or rightmost point.
    pub moment: T,
}

pub(crate) type Crossing<T> = (T, Sums<T>);

impl<T: Real> EllipseCuts<T> {
    /// Prepares an ellipse; None if it is thinner than any tie.
    pub(crate) fn of(ellipse: &Ellipse<T>) -> Option<Self> {
        let (centre, reach, area) = (ellipse.centre, ellipse.reach(), ellipse.span());
        if area <= T::TIE * T::TIE {
            return None;
        }
        let inverse = Point::new(T::ONE / reach.x, T::ONE / reach.y);
        let extent = Point::new(area * inverse.y, area * inverse.x);
        // The distances by which the extreme points lie to the side of the centre.
        let mixed = ellipse.skew();
        let skew = Point::new(mixed * inverse.y, mixed * inverse.x);
        Some(Self {
            centre,
            reach,
            inverse,
            shear: Point::new(skew.x * inverse.y, skew.y * inverse.x),
            extent,
            half_area: area * T::HALF,
            // Circles and upright ellipses are not tilted.
            tilt: if mixed == T::ZERO {
                T::ZERO
            } else {
                T::angle(skew.y * inverse.y, extent.y * inverse.y)
            },
            left: Point::new(centre.x - reach.x, centre.y - skew.y),
            top: Point::new(centre.x - skew.x, centre.y - reach.y),
            right: Point::new(centre.x + reach.x, centre.y + skew.y),
            bottom: Point::new(centre.x + skew.x, centre.y + reach.y),
        })
    }

    /// Returns where the horizontal line at `y` meets the ellipse: left, right. If it passes by, returns the nearest
    /// extreme point twice.
    pub(crate) fn across(&self, y: T) -> [Crossing<T>; 2] {
        let height = y - self.centre.y;
        let (angle, half) = if height.abs() < self.reach.y {
            let sin = height * self.inverse.y;
            let cos = ((T::ONE - sin) * (T::ONE + sin)).sqrt();
            (T::angle(sin, cos), self.extent.x * cos)
        } else if height < T::ZERO {
            (-T::QUARTER_TURN, T::ZERO)
        } else {
            (T::QUARTER_TURN, T::ZERO)
        };
        let middle = self.centre.x + self.shear.x * height;
        let at = |x: T, angle: T| {
            let moment = height * T::HALF * (x + self.centre.x) + self.half_area * angle;
            (x, Sums { height, moment })
        };
        [
            at(middle - half, -(angle + self.tilt)),
            at(middle + half, angle - self.tilt),
        ]
    }

    /// Returns where the vertical line at `x`, which must meet the ellipse, does so: above, below. The moments are off
    /// by a quarter turn, see [`Self::quarter`].
    pub(crate) fn along(&self, x: T) -> [Sums<T>; 2] {
        let aside = x - self.centre.x;
        let sin = aside * self.inverse.x;
        let cos = ((T::ONE - sin) * (T::ONE + sin)).sqrt();
        let sector = self.half_area * T::angle(sin, cos);
        let middle = self.shear.y * aside;
        let half = self.extent.y * cos;
        let mean = (x + self.centre.x) * T::HALF;
        let at = |height: T, sector: T| Sums {
            height,
            moment: height * mean + sector,
        };
        [at(middle - half, sector), at(middle + half, -sector)]
    }

    /// Returns a quarter turn's share of a moment. It is subtracted from the result of [`Self::along`] on a descent to
    /// the right, and added on a descent to the left.
    pub(crate) fn quarter(&self) -> T {
        self.half_area * T::QUARTER_TURN
    }
}

// Areas of an ellipse in the cells of a grid: the ellipse is cut at the grid lines.
//
// Each half of the ellipse is followed from top to bottom, row by row. Within a row, it runs in one direction to the
// column of its end; in the row of the leftmost or rightmost point, it runs first to the column of that point and then
// back. So the columns determine the vertical lines at which a piece ends, each point is reached once, and nothing
// depends on how two rounding errors compare. An ellipse that merely touches a grid line is not a special case.
//
// A piece adds to its cell the difference of two running sums ([`Sums`]), so each line is computed once for the cells
// on its two sides. All lines are computed before the descent begins, so that a processor can work on several of them
// at once.

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
