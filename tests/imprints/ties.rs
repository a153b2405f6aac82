//! Exact ties and near misses: whether a taxel is active, computed by hand in real arithmetic.
//!
//! A taxel whose coverage is exactly the threshold is active. Hardly any number here has an exact binary form, so
//! plain rounding decides about half of these cases wrongly. The near misses fall short by 1e-9 to 1e-18 of a cell.

use taxel_core::geometry::{Ellipse, Pen, Point, Real, Side, Solid};
use taxel_core::touch::Plane;

use crate::common::{Polygon, figure, picture, sensor};

/// The number of columns and of rows of the sensor, which has room for the circle of radius 13.
const SIDE: u8 = 32;

/// The x and y coordinate.
type Vertex = (f64, f64);

/// A threshold, a shape, the taxels that are active, and some that are not.
type Case<'a> = (f64, &'a str, &'a [(u8, u8)], &'a [(u8, u8)]);

fn assert_active(
    name: &str,
    threshold: f64,
    solid: &impl Solid,
    active: &[(u8, u8)],
    inactive: &[(u8, u8)],
) {
    let imprint = Plane::new(sensor(SIDE, SIDE, threshold)).touch(solid);
    for (cells, expected) in [(active, true), (inactive, false)] {
        for &(column, row) in cells {
            assert_eq!(
                imprint.get(column, row),
                expected,
                "{name}, threshold {threshold}: taxel {column}, {row}\n{imprint}"
            );
        }
    }
}

fn assert_figures(cases: &[Case]) {
    for &(threshold, text, active, inactive) in cases {
        assert_active(text, threshold, &figure(text, SIDE), active, inactive);
    }
}

#[test]
#[rustfmt::skip] // A case a line, or the table cannot be read.
fn upright_rectangles_tie() {
    assert_figures(&[
        // Half positions.
        (0.5, "rectangle length=1 width=1 x0=0.5 y0=0", &[(0, 0), (1, 0)], &[(2, 0)]),
        (0.5, "rectangle length=1 width=1 x0=0.5 y0=0.5", &[], &[(0, 0), (1, 0), (0, 1), (1, 1)]),
        (0.25, "rectangle length=1 width=1 x0=0.5 y0=0.5", &[(0, 0), (1, 0), (0, 1), (1, 1)], &[]),
        (0.5, "rectangle length=2.2 width=1 x0=-1.7 y0=3", &[(0, 3)], &[(1, 3)]),
        (0.5, "rectangle length=4 width=3 x0=2 y0=2.5 angle=270", &[(2, 2), (2, 5), (5, 3)], &[(1, 3), (6, 3)]),
        // 2.3 to 2.8 and similar: exactly a half between two numbers that have no binary form.
        (0.5, "rectangle length=0.5 width=1 x0=2.3 y0=1", &[(2, 1)], &[(1, 1), (3, 1)]),
        (0.5, "rectangle length=1 width=0.5 x0=2 y0=1.1", &[(2, 1)], &[(2, 0), (2, 2)]),
        (0.5, "rectangle length=2.9 width=1 x0=0.6 y0=0", &[(1, 0), (2, 0), (3, 0)], &[(0, 0)]),
        // Other thresholds, reached by a length, by a sum of lengths, by a product.
        (0.4, "rectangle length=0.4 width=1 x0=2.1 y0=1", &[(2, 1)], &[]),
        (0.5, "rectangle length=0.4 width=1 x0=2.1 y0=1", &[], &[(2, 1)]),
        (0.9, "rectangle length=0.9 width=1 x0=2.1 y0=1", &[(2, 1)], &[]),
        (0.3, "rectangle length=0.3 width=1 x0=0.6 y0=0", &[(0, 0)], &[]),
        (0.7, "rectangle length=0.7 width=1 x0=0.1 y0=0", &[(0, 0)], &[]),
        (0.1, "rectangle length=0.1 width=1 x0=0.85 y0=0", &[(0, 0)], &[]),
        (0.3, "rectangle length=2.6 width=1 x0=0.7 y0=0", &[(0, 0), (1, 0), (2, 0), (3, 0)], &[(4, 0)]),
        (0.35, "rectangle length=0.7 width=0.5 x0=0.1 y0=0.3", &[(0, 0)], &[]),
        (0.36, "rectangle length=0.6 width=0.6 x0=0.1 y0=0.3", &[(0, 0)], &[]),
        (0.03, "rectangle length=0.3 width=0.1 x0=0.7 y0=0.9", &[(0, 0)], &[]),
        (0.01, "rectangle length=0.2 width=0.2 x0=0.9 y0=0.9", &[(0, 0), (1, 0), (0, 1), (1, 1)], &[]),
        (1e-9, "rectangle length=1e-5 width=1e-4 x0=0.3 y0=0.3", &[(0, 0)], &[(1, 0)]),
        // Walls: a cell minus the hole in it.
        (0.75, "rectangle length=1 width=1 x0=3 y0=3 thickness=0.25", &[(3, 3)], &[]),
        (0.36, "rectangle length=1 width=1 x0=3 y0=3 thickness=0.1", &[(3, 3)], &[]),
        (0.64, "rectangle length=1 width=1 x0=3 y0=3 thickness=0.2", &[(3, 3)], &[]),
        (0.72, "rectangle length=1 width=0.8 x0=3 y0=3.1 thickness=0.3", &[(3, 3)], &[]),
        // However low the threshold is, a taxel that is not covered at all is inactive: here, inside a ring.
        (1e-21, "rectangle length=5 width=5 x0=3 y0=3 thickness=1", &[(3, 3), (5, 3)], &[(5, 5), (2, 3), (8, 3)]),
        (1e-310, "rectangle length=5 width=1e-11 x0=3 y0=3", &[(3, 3), (7, 3)], &[(2, 3), (8, 3), (3, 2)]),
        // The whole cell.
        (1.0, "rectangle length=2 width=2 x0=1 y0=1", &[(1, 1), (2, 1), (1, 2), (2, 2)], &[(0, 1), (3, 1)]),
        (1.0, "rectangle length=1.9 width=1 x0=0.1 y0=0", &[(1, 0)], &[(0, 0), (2, 0)]),
        (1.0, "rectangle length=2.7 width=1 x0=1.3 y0=0", &[(2, 0), (3, 0)], &[(1, 0), (4, 0)]),
        (1.0, "rectangle length=1.99 width=1 x0=1.01 y0=0", &[(2, 0)], &[(1, 0)]),
    ]);
}

#[test]
#[rustfmt::skip] // A case a line.
fn turned_figures_tie() {
    assert_figures(&[
        // At 30°, a long side meets the horizontal line through the centre at a distance of the width: at the centres
        // of cells.
        (0.5, "rectangle length=8 width=2 x0=2.5 y0=5.5 angle=30", &[(4, 6), (8, 6)], &[(3, 6), (9, 6)]),
        (0.5, "rectangle length=8 width=2 x0=2.5 y0=5.5 angle=60", &[(6, 4), (6, 8)], &[(6, 3), (6, 9)]),
        (0.5, "rectangle length=8 width=2 x0=2.5 y0=5.5 angle=150", &[(4, 6), (8, 6)], &[(3, 6), (9, 6)]),
        (0.5, "rectangle length=8 width=2 x0=2.5 y0=5.5 angle=240", &[(6, 4), (6, 8)], &[(6, 3), (6, 9)]),
        // The same for the hole, 4.8 − 2·1.4 = 2 wide.
        (0.5, "rectangle length=10.8 width=4.8 x0=1.1 y0=4.1 angle=30 thickness=1.4", &[(4, 6), (8, 6)], &[(6, 6)]),
        // An octagon lacks side²/4 at the corner of its bounding rectangle, if that lies in one cell.
        (0.75, "octagon side=1 x0=1 y0=1", &[(1, 1)], &[]),
        (0.75, "octagon side=1 x0=1 y0=1 angle=135", &[(1, 1)], &[]),
        (0.64, "octagon side=1.2 x0=1 y0=1", &[(1, 1)], &[]),
        (0.51, "octagon side=1.4 x0=1 y0=1 angle=45", &[(1, 1)], &[]),
        (0.55, "octagon side=1 x0=1.2 y0=1 angle=90", &[(1, 1)], &[]),
        (0.5, "octagon side=1 x0=1.25 y0=1", &[(1, 1)], &[]),
        (0.5, "octagon side=1 x0=1.25 y0=1 angle=45", &[(1, 1)], &[]),
    ]);
}

#[test]
#[rustfmt::skip] // A case a line.
fn circles_through_a_corner_of_a_cell_cover_it_fully() {
    assert_figures(&[
        // 3² + 4² = 5² about (6, 6), and 5² + 12² = 13² about (14, 14). The angle of a circle does not matter.
        (1.0, "ellipse radius_x=5 radius_y=5 x0=1 y0=1", &[(8, 9), (9, 8), (2, 3), (3, 2)], &[(9, 9), (2, 2)]),
        (1.0, "ellipse radius_x=5 radius_y=5 x0=1 y0=1 angle=33", &[(8, 9), (9, 8), (2, 3), (3, 2)], &[(9, 9), (2, 2)]),
        (1.0, "ellipse radius_x=13 radius_y=13 x0=1 y0=1 angle=77", &[(18, 25), (25, 18), (9, 2), (2, 9)], &[(19, 25)]),
        // An ellipse is a compressed circle: (6, 4) about (11, 11) is (3/5, 4/5).
        (1.0, "ellipse radius_x=10 radius_y=5 x0=1 y0=6", &[(16, 14), (5, 7)], &[(17, 14)]),
        (1.0, "ellipse radius_x=10 radius_y=5 x0=1 y0=6 angle=90", &[(14, 16), (7, 5)], &[(14, 17)]),
        // The hole of a ring, radius 5, touches the corners of cells outside of it.
        (1.0, "ellipse radius_x=8 radius_y=8 x0=1 y0=1 thickness=3", &[(12, 13), (13, 12), (4, 5)], &[(11, 13), (12, 12)]),
        // A circle that touches grid lines covers none of the cells behind them, however low the threshold is.
        (1e-12, "ellipse radius_x=2 radius_y=2 x0=3 y0=3", &[(3, 3), (6, 6)], &[(2, 4), (2, 5), (4, 2), (7, 4), (5, 7)]),
        // A radius that is shorter by 1e-9 leaves about 1e-18 of the cell uncovered.
        (1.0, "ellipse radius_x=4.999999999 radius_y=4.999999999 x0=1.000000001 y0=1.000000001", &[(6, 6)], &[(8, 9), (9, 8), (2, 3), (3, 2)]),
    ]);
}

#[test]
#[rustfmt::skip] // A case a line.
fn near_misses_are_not_ties() {
    assert_figures(&[
        (0.5, "rectangle length=0.499999999 width=1 x0=2.3 y0=1", &[], &[(2, 1)]),
        (0.5, "rectangle length=0.500000001 width=1 x0=2.3 y0=1", &[(2, 1)], &[]),
        (0.5, "rectangle length=0.499999999999 width=1 x0=2.3 y0=1", &[], &[(2, 1)]),
        (0.5, "rectangle length=0.499999999999999 width=1 x0=2.3 y0=1", &[], &[(2, 1)]),
        (0.300_000_001, "rectangle length=0.3 width=1 x0=0.6 y0=0", &[], &[(0, 0)]),
        (0.299_999_999, "rectangle length=0.3 width=1 x0=0.6 y0=0", &[(0, 0)], &[]),
        (0.300_000_000_000_001, "rectangle length=0.3 width=1 x0=0.6 y0=0", &[], &[(0, 0)]),
        (1.0, "rectangle length=1.999999999999 width=1 x0=1 y0=0", &[(1, 0)], &[(2, 0)]),
        // The tie at 30°, moved slightly to the right and to the left.
        (0.5, "rectangle length=8 width=2 x0=2.500000001 y0=5.5 angle=30", &[(8, 6)], &[(4, 6)]),
        (0.5, "rectangle length=8 width=2 x0=2.499999999 y0=5.5 angle=30", &[(4, 6)], &[(8, 6)]),
        (0.5, "rectangle length=8 width=2 x0=2.5 y0=5.5 angle=30.000000001", &[], &[(4, 6), (8, 6)]),
        (0.5, "rectangle length=8 width=2 x0=2.5 y0=5.5 angle=29.999999999", &[(4, 6), (8, 6)], &[]),
        (0.5, "octagon side=1.000000001 x0=1.25 y0=1", &[], &[(1, 1)]),
        (0.5, "octagon side=0.999999999 x0=1.25 y0=1", &[(1, 1)], &[]),
        // Short by 2.84e-11, the nearest miss that is known for figures in hundredths.
        (0.5, "rectangle length=7.24 width=5.99 x0=1.31 y0=4.01 angle=2", &[], &[(8, 8)]),
    ]);
}

/// The limit of the rule: a product of numbers with ten and eleven decimals has 21, so 1/2 − 5e-21 is taken for a
/// half.
#[test]
#[rustfmt::skip] // A case a line.
fn a_miss_beyond_twenty_decimals_is_taken_for_a_tie() {
    assert_figures(&[
        (0.5, "rectangle length=0.9999999999 width=0.50000000005 x0=0 y0=0", &[(0, 0)], &[]),
        // With nine decimals, 1/2 − 5e-19 is distinguished from a half.
        (0.5, "rectangle length=0.999999999 width=0.5000000005 x0=0 y0=0", &[], &[(0, 0)]),
    ]);
}

#[test]
fn pictures_tie_at_every_angle() {
    // Two lines that cross at right angles in a cell's centre cut the cell into four equal parts, at any angle.
    #[rustfmt::skip] // A case a line.
    let quarters = [
        (0.25, "##../##../..../...# x0=4.5 y0=4.5"),
        (0.5, "##../##../..##/..## x0=4.5 y0=4.5"),
        (0.5, "##..##/###### x0=0.25 y0=2.25 zoom_x=2 zoom_y=2"),
        (0.75, "##/#. x0=0.625 y0=0.625 zoom_x=4 zoom_y=4"),
    ];
    for (threshold, text) in quarters {
        for degrees in 0..360 {
            let text = format!("{text} angle={degrees}");
            let shape = picture(&text, SIDE);
            assert_active(&text, threshold, &shape, &[(6, 6)], &[]);
            assert_active(&text, threshold + 1e-15, &shape, &[], &[(6, 6)]);
        }
    }
    #[rustfmt::skip] // A case a line.
    let upright: [Case; 4] = [
        // Scaled positions: 4 · 0.5 = 2 to 2.5; 0.3 · 0.7 = 0.21 to 0.91; 3 · 0.1 = 0.3 to 0.4; 0.7 · 1.1 = 0.77 to
        // 1.87.
        (0.5, "# x0=4 y0=0 zoom_x=0.5", &[(2, 0)], &[(1, 0), (3, 0)]),
        (0.7, "# x0=0.3 y0=0 zoom_x=0.7", &[(0, 0)], &[]),
        (0.1, "# x0=3 y0=0 zoom_x=0.1", &[(0, 0)], &[]),
        (0.87, "# x0=0.7 y0=0 zoom_x=1.1", &[(1, 0)], &[(0, 0)]),
    ];
    for (threshold, text, active, inactive) in upright {
        assert_active(text, threshold, &picture(text, SIDE), active, inactive);
    }
}

#[test]
fn user_defined_polygons_tie() {
    #[rustfmt::skip] // A case a line.
    let cases: [(f64, &[Vertex], (u8, u8)); 8] = [
        (0.5, &[(0.0, 0.0), (1.0, 0.0), (0.0, 1.0)], (0, 0)),
        (0.32, &[(2.1, 2.1), (2.9, 2.1), (2.1, 2.9)], (2, 2)),
        // Lines through (2.5, 2.5) with slopes of 3/4, 1/2 and 7/3.
        (0.5, &[(0.1, 0.7), (4.9, 4.3), (4.9, 9.0), (0.1, 9.0)], (2, 2)),
        (0.5, &[(0.1, 1.3), (4.9, 3.7), (4.9, 0.1), (0.1, 0.2)], (2, 2)),
        (0.5, &[(1.6, 0.4), (3.4, 4.6), (7.7, 4.6), (7.7, 0.4)], (2, 2)),
        // From far beyond the sensor through (0.5, 0.5), with a slope of 3/10; in `f64` it misses by 4e-8.
        (0.5, &[(-999_999_999.5, -299_999_999.5), (1_000_000_000.5, 300_000_000.5), (0.0, 9e9)], (0, 0)),
        (0.5, &[(-999_999_999.5, -299_999_999.5), (1_000_000_000.5, 300_000_000.5), (0.0, -9e9)], (0, 0)),
        (0.5, &[(-299_999_999.5, -999_999_999.5), (300_000_000.5, 1_000_000_000.5), (9e9, 0.0)], (0, 0)),
    ];
    for (threshold, vertices, cell) in cases {
        let polygon = Polygon::new(vertices.iter().copied());
        let name = format!("{vertices:?}");
        assert_active(&name, threshold, &polygon, &[cell], &[]);
        assert_active(&name, threshold + 1e-15, &polygon, &[], &[cell]);
    }
}

/// A disc that extends from far beyond the sensor to the lower right corner of a taxel's cell.
struct Far {
    legs: (f64, f64),
    radius: f64,
}

impl Solid for Far {
    fn draw<T: Real>(&self, pen: &mut impl Pen<T>) {
        let corner = T::whole(3);
        let (x, y) = (T::decimal(self.legs.0), T::decimal(self.legs.1));
        let radius = T::decimal(self.radius);
        let disc = Ellipse {
            centre: Point::new(corner - x, corner - y),
            across: Point::new(radius, T::ZERO),
            along: Point::new(T::ZERO, radius),
        };
        pen.ellipse(&disc, Side::Inside);
    }
}

#[test]
fn large_discs_through_a_corner_of_a_cell_cover_it_fully() {
    // 3² + 4² = 5² and others, times hundreds: in `f64`, the sums are off by more than the margin in which a touch is
    // in doubt.
    for (across, down, radius) in [(3.0, 4.0, 5.0), (5.0, 12.0, 13.0), (8.0, 15.0, 17.0)] {
        for scale in [100.0, 1000.0, 2000.0] {
            let disc = |shorter: f64| Far {
                legs: (across * scale, down * scale),
                radius: radius * scale - shorter,
            };
            let name = format!("{radius} times {scale}");
            assert_active(&name, 1.0, &disc(0.0), &[(2, 2), (1, 2)], &[(3, 3), (3, 2)]);
            // A radius that is shorter by 1e-8 leaves about 1e-16 of the cell uncovered.
            assert_active(&name, 1.0, &disc(1e-8), &[(1, 1)], &[(2, 2)]);
        }
    }
}
