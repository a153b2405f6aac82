//! Finds the cells of a grid that ellipses cover at least by half, from the positions of the cells' centres.
//!
//! **Method.** A cell is symmetric about its centre, so a straight line through the centre halves it. Therefore a
//! convex shape covers less than half of a cell whose centre it does not cover.
//!
//! Conversely, let `u` be the centre in the frame in which the ellipse is the unit disc, and `r` the smaller radius. If
//! `1 − |u|² ≥ 1 / (2·r²)`, the ellipse covers at least one of any two points of the cell that are opposite each other
//! about its centre, since no point of a cell is further than √½ from its centre. So it covers more than half. Half of
//! that depth is enough if the larger radius is at most `0.9·r²`: then the lens about the centre in which the ellipse
//! covers both such points is more than twice as large as the corners of the cell in which it covers neither.
//!
//! So it is enough to find where the ellipses meet the lines through the centres of the rows. The cells that this
//! leaves *open* are decided by their areas: cells whose centre lies just inside an ellipse, and cells that two
//! ellipses cross. For a circle of radius 4, fewer than 4 % of the cells that it crosses are open.
//!
//! The coverage of any other cell is not close to one half: if the centre lies on an ellipse, the ellipse's area in the
//! cell falls short of one half by a 24th of its least curvature. Ellipses that are too flat for this are left to
//! [`super::overlap`].

use std::ops::Range;

use crate::geometry::arcs::Arcs;
use crate::geometry::cell_grid::CellGrid;
use crate::geometry::ellipse_cuts::EllipseCuts;
use crate::geometry::outline::{Ellipse, Pen, Point, Side};
use crate::geometry::real::{Real, nearest};
use crate::index::from_first;

/// The largest number of rows of a grid, and of columns.
const SIDE: usize = u64::BITS as usize;
/// If coordinates or moments are beyond this, the areas of open cells are not exact to 1e-10.
const FAR: f64 = 25_000.0;
/// If the curvature is below this, the covered share of a cell that is not open may lie within 1e-10 of one half.
const FLAT: f64 = 1e-8;

/// Ellipses on a grid of at most 64 × 64 unit cells with its top left corner at the origin.
#[derive(Clone, Debug)]
pub(crate) struct CentreSampling {
    rows: i32,
    curves: Vec<Curve>,
    shape: [ShapeRow; SIDE],
    /// The rows that may contain something; all others are empty.
    drawn: Range<i32>,
    /// The grid of 1 × 1 on which the area in a single cell is computed.
    cell: CellGrid<f64>,
    arcs: Arcs<f64>,
}

/// A row of the shape, with column `i` in bit `i`.
#[derive(Clone, Copy, Debug, Default)]
struct ShapeRow {
    /// The cells whose centre is covered.
    inside: u64,
    /// The cells that an ellipse crosses.
    crossed: u64,
    /// The cells that are not decided by their centres.
    open: u64,
}

/// An ellipse that was added.
#[derive(Clone, Debug)]
struct Curve {
    ellipse: Ellipse<f64>,
    material: Side,
    cuts: EllipseCuts<f64>,
    /// The square of the smaller radius.
    radius_squared: f64,
}

impl CentreSampling {
    /// The threshold for which centres decide, as a share of a cell.
    pub(crate) const THRESHOLD: f64 = 0.5;

    /// Creates an empty grid.
    pub(crate) fn new(rows: u8) -> Self {
        Self {
            rows: rows.into(),
            curves: Vec::new(),
            shape: [ShapeRow::default(); SIDE],
            drawn: 0..0,
            cell: CellGrid::new(1, 1),
            arcs: Arcs::new(1, 1),
        }
    }

    /// Removes all ellipses.
    pub(crate) fn clear(&mut self) {
        self.curves.clear();
    }

    /// Returns true if there are no ellipses.
    pub(crate) fn is_empty(&self) -> bool {
        self.curves.is_empty()
    }

    /// Adds an ellipse.
    #[expect(
        clippy::inline_always,
        reason = "a call passes the ellipse through memory, written in halves and read in pairs: 7 ns of waiting"
    )]
    #[inline(always)]
    pub(crate) fn add(&mut self, ellipse: &Ellipse<f64>, material: Side) {
        if let Some(cuts) = EllipseCuts::of(ellipse) {
            self.curves.push(Curve {
                ellipse: *ellipse,
                material,
                cuts,
                radius_squared: cuts.smaller_radius_squared(),
            });
        }
    }

    /// Draws the ellipses with a pen.
    pub(crate) fn draw(&self, pen: &mut impl Pen<f64>) {
        for curve in &self.curves {
            pen.ellipse(&curve.ellipse, curve.material);
        }
    }

    /// Samples the ellipses. Returns the rows that may have cells covered by half; None if centres do not decide,
    /// because an ellipse is very large or flat, material overlaps, or a hole does not lie in material drawn before.
    pub(crate) fn sample(&mut self) -> Option<Range<i32>> {
        self.shape[slots(&self.drawn)].fill(ShapeRow::default());
        self.drawn = 0..0;
        let mut undecided = false;
        for curve in &self.curves {
            let rows = rows_between(curve.cuts.top.y, curve.cuts.bottom.y, self.rows);
            undecided |= !curve.is_fit() || curve.sample(&mut self.shape[slots(&rows)], rows.start);
            self.drawn = around(&self.drawn, &rows);
        }
        (!undecided).then(|| self.drawn.clone())
    }

    /// Returns the cells of a row whose centre is covered, and those that are open. Columns beyond the grid may be
    /// included.
    pub(crate) fn row(&self, row: i32) -> (u64, u64) {
        let ShapeRow { inside, open, .. } = self.shape[from_first(row)];
        (inside, open)
    }

    /// Returns the area of the ellipses in a cell.
    pub(crate) fn area(&mut self, column: u32, row: i32) -> f64 {
        let corner = Point::new(f64::from(column), f64::from(row));
        let mut area = 0.0;
        for curve in &self.curves {
            area += curve.area(corner, &mut self.cell, &mut self.arcs);
        }
        area
    }
}

impl Curve {
    /// Returns true if centres decide for an ellipse of this size and shape.
    fn is_fit(&self) -> bool {
        let (left, right) = (self.cuts.left.x.abs(), self.cuts.right.x.abs());
        let (top, bottom) = (self.cuts.top.y, self.cuts.bottom.y);
        let farthest = max(max(left, right), max(top.abs(), bottom.abs()));
        let moment = 0.5 * max(left, right) * (bottom - top);
        // The least curvature is the smaller radius over the square of the larger one. All terms here are squared.
        let (square, span) = (self.radius_squared, self.cuts.span());
        let flat = FLAT * span * span;
        farthest < FAR && moment < FAR && square * square * square > flat * flat
    }

    /// Adds the ellipse to the rows from `first` on. Returns true if it is material within material, or a hole outside
    /// of it.
    fn sample(&self, rows: &mut [ShapeRow], first: i32) -> bool {
        let cuts = &self.cuts;
        // The points that lie deep enough form an ellipse of the same centre, scaled by the square root of this.
        let deep = 1.0 - self.sure_depth();
        let chord = |y: f64| {
            let level = min(max(y, cuts.top.y), cuts.bottom.y);
            cuts.chord(level).map(columns_from)
        };
        let farthest = [cuts.left, cuts.right].map(|point| (cell(point.y), columns_from(point.x)));
        let mut line = f64::from(first);
        let mut above = chord(line);
        let mut misplaced = 0;
        for (number, row) in (first..).zip(rows) {
            let [whole, deep] = cuts.chords(line + 0.5, deep).map(centres_between);
            line += 1.0;
            let below = chord(line);
            let mut crossed = 0;
            for side in 0..2 {
                crossed |= columns_between(above[side], below[side]);
                // Between two lines, the ellipse reaches further than on the lines only at its leftmost and rightmost
                // points.
                let (level, columns) = farthest[side];
                if number == level {
                    crossed |= columns_between(above[side], columns);
                }
            }
            above = below;
            row.open |= whole & !deep & crossed | row.crossed & crossed;
            row.crossed |= crossed;
            misplaced |= match self.material {
                Side::Inside => whole & row.inside,
                Side::Outside => whole & !row.inside,
            } & !row.open;
            row.inside ^= whole;
        }
        misplaced != 0
    }

    /// Returns the value of `1 − |u|²` from which on the ellipse surely covers more than half of the cell.
    fn sure_depth(&self) -> f64 {
        let square = self.radius_squared;
        let span = self.cuts.span();
        let round = span * span <= 0.81 * square * square * square;
        (if round { 0.25 } else { 0.5 }) / square
    }

    /// Returns the ellipse's area in the cell with this corner; negative for a hole.
    fn area(&self, corner: Point<f64>, cell: &mut CellGrid<f64>, arcs: &mut Arcs<f64>) -> f64 {
        cell.clear();
        let seen = self.cuts.moved(Point::new(-corner.x, -corner.y));
        arcs.draw(cell, &seen, self.material);
        cell.first()
    }
}

/// Returns the smallest range that contains both.
fn around(one: &Range<i32>, other: &Range<i32>) -> Range<i32> {
    match (one.is_empty(), other.is_empty()) {
        (true, _) => other.clone(),
        (_, true) => one.clone(),
        _ => one.start.min(other.start)..one.end.max(other.end),
    }
}

/// Returns the rows of a grid from one height to another.
fn rows_between(top: f64, bottom: f64, rows: i32) -> Range<i32> {
    let end = cell(bottom).clamp(-1, rows - 1) + 1;
    cell(top).clamp(0, end)..end
}

/// Converts rows to indices.
fn slots(rows: &Range<i32>) -> Range<usize> {
    from_first(rows.start)..from_first(rows.end)
}

/// Returns the unit interval that contains a number. For a whole number, it may be either of the two that meet there.
fn cell(number: f64) -> i32 {
    nearest(number - 0.5)
}

/// Returns the columns from the one that contains `x` on, or from the nearest one.
fn columns_from(x: f64) -> u64 {
    u64::MAX.wrapping_shl(cell(min(max(x, 0.5), 63.5)).cast_unsigned())
}

/// Returns the columns from one position to another, in either order, each position given as [`columns_from`] returns
/// it.
fn columns_between(one: u64, other: u64) -> u64 {
    let first = |columns: u64| columns & columns.wrapping_neg();
    one ^ other | first(one) | first(other)
}

/// Returns the columns whose centre lies between two positions.
fn centres_between([left, right]: [f64; 2]) -> u64 {
    let from = |x: f64| u64::MAX.unbounded_shl(nearest(min(max(x, 0.0), 64.0)).cast_unsigned());
    from(left) & !from(right)
}

/// Returns the larger of two numbers in one instruction; `f64::max` takes six, because of NaN.
fn max(one: f64, other: f64) -> f64 {
    Real::max(one, other)
}

/// Returns the smaller of two numbers in one instruction, likewise.
fn min(one: f64, other: f64) -> f64 {
    Real::min(one, other)
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::geometry::outline::Turn;

    fn ellipse(centre: Point<f64>, radii: [f64; 2], degrees: f64) -> Ellipse<f64> {
        let turn = Turn::clockwise(degrees);
        Ellipse {
            centre,
            across: turn.of(Point::new(radii[0], 0.0)),
            along: turn.of(Point::new(0.0, radii[1])),
        }
    }

    /// Returns the ellipse as it is sampled.
    fn curve(ellipse: &Ellipse<f64>) -> Curve {
        let mut sampling = CentreSampling::new(1);
        sampling.add(ellipse, Side::Inside);
        sampling.curves.pop().expect("it has an area")
    }

    /// Returns the area in the cell at the origin.
    fn area(curve: &Curve) -> f64 {
        let origin = Point::new(0.0, 0.0);
        curve.area(origin, &mut CellGrid::new(1, 1), &mut Arcs::new(1, 1))
    }

    #[test]
    fn a_centre_that_is_deep_enough_means_more_than_half() {
        let (mut tried, mut least) = (0, 1.0_f64);
        for radii in [0.71, 0.8, 1.0, 1.12, 1.2, 1.5, 2.0, 3.0, 5.0, 9.0, 30.0] {
            for longer in [1.0, 1.02, 1.1, 1.3, 1.7, 2.5, 4.0, 9.0] {
                for step in 0..72_u32 {
                    let turned = 2.5 * f64::from(step);
                    let around = ellipse(Point::new(0.0, 0.0), [radii * longer, radii], turned);
                    let depth = curve(&around).sure_depth();
                    if depth >= 1.0 {
                        continue;
                    }
                    // The centre of the cell lies on an ellipse that is smaller by the square root of this.
                    let size = (1.0 - depth).sqrt();
                    for place in 0..40_u32 {
                        let (sin, cos) = libm::sincos((9.0 * f64::from(place)).to_radians());
                        let aside = |across: f64, along: f64| size * (across * cos + along * sin);
                        let centre = Point::new(
                            0.5 - aside(around.across.x, around.along.x),
                            0.5 - aside(around.across.y, around.along.y),
                        );
                        let area = area(&curve(&Ellipse { centre, ..around }));
                        (tried, least) = (tried + 1, least.min(area));
                    }
                }
            }
        }
        assert!(least > 0.5 && tried > 200_000, "{least} of {tried}");
    }

    #[test]
    fn few_cells_are_open() {
        let (mut open, mut crossed) = (0, 0);
        let mut sampling = CentreSampling::new(16);
        for step in 0..1000_u32 {
            let at = |factor: f64| 8.0 + (f64::from(step) * factor).fract();
            let centre = Point::new(at(0.618_034), at(0.754_878));
            sampling.clear();
            sampling.add(&ellipse(centre, [4.0, 4.0], 0.0), Side::Inside);
            let rows = sampling.sample().expect("a circle on the sensor");
            for row in &sampling.shape[slots(&rows)] {
                open += row.open.count_ones();
                crossed += row.crossed.count_ones();
            }
        }
        assert!(
            crossed > 20_000 && 25 * open < crossed,
            "{open} of {crossed}"
        );
    }

    #[test]
    fn large_flat_or_misplaced_ellipses_are_left_to_areas() {
        let circle = |x: f64, radius: f64| ellipse(Point::new(x, 8.2), [radius; 2], 0.0);
        let sampled = |drawn: &[(Ellipse<f64>, Side)]| {
            let mut sampling = CentreSampling::new(16);
            for (ellipse, material) in drawn {
                sampling.add(ellipse, *material);
            }
            sampling.sample()
        };
        let plate = (circle(8.0, 4.0), Side::Inside);
        let hole = (circle(8.0, 2.0), Side::Outside);
        let beside = (circle(10.0, 4.0), Side::Inside);
        assert_eq!(sampled(&[]), Some(0..0));
        assert_eq!(sampled(&[plate]), Some(4..13));
        assert_eq!(sampled(&[plate, hole]), Some(4..13));
        assert_eq!(sampled(&[hole, plate]), None);
        assert_eq!(sampled(&[plate, beside]), None);
        assert_eq!(sampled(&[(circle(1e5, 4.0), Side::Inside)]), None);
        assert_eq!(sampled(&[(circle(0.0, 1e3), Side::Inside)]), None);
        let blade = ellipse(Point::new(8.0, 8.0), [60.0, 1e-5], 10.0);
        assert_eq!(sampled(&[(blade, Side::Inside)]), None);
    }
}
