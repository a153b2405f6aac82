//! Coverages computed by hand: every expected value is written beside its shape in closed form.
//!
//! The sizes and positions are decimals as a user writes them; most have no exact binary form.

use std::f64::consts::{PI, SQRT_2};

use taxel_core::geometry::{Ellipse, Extent, Pen, Point, Real, Side, Solid};
use taxel_core::touch::{Plane, reaches_beyond};

use crate::common::{Polygon, Random, figure, picture, sensor};

/// The number of columns and of rows of the sensor.
const SIDE: u8 = 16;

/// The x and y coordinate.
type Vertex = (f64, f64);

/// Taxels by column and row, with their expected coverages.
type Cells<'a> = &'a [((u8, u8), f64)];

#[test]
fn the_last_taxel_of_a_sensor_is_covered_and_none_lies_beyond() {
    let mut plane = Plane::new(sensor(4, 3, 0.5));
    plane.touch(&figure("rectangle length=4 width=3 x0=0 y0=0", SIDE));
    let coverages = plane.coverages();
    assert_eq!(coverages.get(3, 2), Some(1.0));
    assert_eq!(
        [(4, 0), (4, 1), (0, 3)].map(|(x, y)| coverages.get(x, y)),
        [None; 3]
    );
}

#[test]
fn coverages_of_a_half_or_a_whole_cell_have_no_rounding_error() {
    let mut plane = Plane::new(sensor(SIDE, SIDE, 0.5));
    plane.touch(&figure(
        "rectangle length=2.4 width=3.3 x0=1.1 y0=2.5",
        SIDE,
    ));
    let coverages = plane.coverages();
    assert_eq!(
        [(2, 2), (2, 3)].map(|(x, y)| coverages.get(x, y)),
        [Some(0.5), Some(1.0)]
    );
}

fn assert_coverages(name: &str, solid: &impl Solid, cells: Cells) {
    let mut plane = Plane::new(sensor(SIDE, SIDE, 0.5));
    plane.touch(solid);
    let coverages = plane.coverages();
    for &((column, row), expected) in cells {
        let found = coverages.get(column, row).expect("a taxel");
        assert!(
            (found - expected).abs() < 1e-12,
            "{name}: taxel {column}, {row} is covered by {found}, expected {expected}"
        );
    }
}

#[test]
#[rustfmt::skip] // A case a line, or the table cannot be read.
fn upright_rectangles_cover_products_of_lengths() {
    let cases: &[(&str, Cells)] = &[
        ("length=2.5 width=1.5 x0=0.25 y0=0.5", &[((0, 0), 0.375), ((1, 0), 0.5), ((2, 0), 0.375), ((0, 1), 0.75),
            ((1, 1), 1.0), ((2, 1), 0.75), ((3, 0), 0.0), ((1, 2), 0.0)]),
        ("length=0.7 width=0.3 x0=5.2 y0=7.6", &[((5, 7), 0.21), ((6, 7), 0.0), ((5, 8), 0.0)]),
        // Partly off the sensor, completely off it, and as large as the sensor.
        ("length=2 width=2 x0=-0.75 y0=-0.4", &[((0, 0), 1.0), ((1, 0), 0.25), ((0, 1), 0.6), ((1, 1), 0.15)]),
        ("length=5 width=5 x0=14.3 y0=13.9", &[((14, 13), 0.07), ((15, 13), 0.1), ((14, 15), 0.7), ((15, 15), 1.0)]),
        ("length=16 width=16 x0=-16 y0=-16", &[((0, 0), 0.0), ((15, 15), 0.0)]),
        ("length=16 width=16 x0=0 y0=0", &[((0, 0), 1.0), ((15, 0), 1.0), ((0, 15), 1.0), ((15, 15), 1.0)]),
        // Right angles about (3.5, 2.5): the bar lies along x, stands upright, and lies again.
        ("length=3 width=1 x0=2 y0=2 angle=90", &[((3, 1), 1.0), ((3, 2), 1.0), ((3, 3), 1.0), ((2, 2), 0.0), ((4, 2), 0.0)]),
        ("length=3 width=1 x0=2 y0=2 angle=180", &[((2, 2), 1.0), ((3, 2), 1.0), ((4, 2), 1.0), ((3, 1), 0.0)]),
        // A frame: the hole extends from 1.75 to 4.25 and from 1.75 to 3.25.
        ("length=4 width=3 x0=1 y0=1 thickness=0.75", &[((1, 1), 0.9375), ((2, 1), 0.75), ((4, 1), 0.9375), ((1, 2), 0.75),
            ((2, 2), 0.0), ((4, 3), 0.9375), ((2, 3), 0.75)]),
        // The two walls meet, so there is no hole.
        ("length=4 width=3 x0=1 y0=1 thickness=1.5", &[((1, 1), 1.0), ((2, 2), 1.0), ((3, 2), 1.0)]),
    ];
    for &(text, cells) in cases {
        assert_coverages(text, &figure(&format!("rectangle {text}"), SIDE), cells);
    }
}

#[test]
#[rustfmt::skip] // A case a line.
fn turned_squares_and_regular_polygons_cover_hand_computed_areas() {
    let sqrt_3 = 3_f64.sqrt();
    // A hexagon of side 1 covers the first cell of its bounding rectangle except for two triangles.
    let hexagon = 1.0 - sqrt_3 / 8.0 - (1.0 - sqrt_3 / 2.0).powi(2) / (2.0 * sqrt_3);
    let lower = 0.75 * sqrt_3 - hexagon;
    let cases: &[(&str, Cells)] = &[
        // x| + |y| <= √2 about the centre of a cell, and about a crossing of grid lines.
        ("rectangle length=2 width=2 x0=1.5 y0=1.5 angle=45", &[((2, 2), 1.0), ((3, 2), SQRT_2 - 0.75), ((2, 1), SQRT_2 - 0.75),
            ((3, 3), 1.5 - SQRT_2), ((1, 1), 1.5 - SQRT_2), ((4, 2), 0.0)]),
        ("rectangle length=2 width=2 x0=2 y0=2 angle=135", &[((3, 3), 2.0 * SQRT_2 - 2.0), ((2, 3), 2.0 * SQRT_2 - 2.0),
            ((4, 3), 1.5 - SQRT_2), ((3, 1), 1.5 - SQRT_2), ((4, 4), 0.0)]),
        // The apex is at (2, 1), the sides are x = 2 ± (y − 1)/√3. A third of a turn about the centre changes nothing.
        ("triangle side=2 x0=1 y0=1", &[((1, 1), 0.5 / sqrt_3), ((2, 1), 0.5 / sqrt_3), ((1, 2), 1.0 / sqrt_3), ((2, 2), 1.0 / sqrt_3)]),
        ("triangle side=2 x0=1 y0=1 angle=120", &[((1, 1), 0.5 / sqrt_3), ((2, 1), 0.5 / sqrt_3), ((1, 2), 1.0 / sqrt_3)]),
        ("hexagon side=1 x0=1 y0=1", &[((1, 1), hexagon), ((2, 1), hexagon), ((1, 2), lower), ((2, 2), lower)]),
        ("hexagon side=1 x0=1 y0=1 angle=300", &[((1, 1), hexagon), ((2, 2), lower)]),
        // An octagon lacks triangles with legs of side/√2 at the corners of its bounding rectangle.
        ("octagon side=1 x0=1 y0=1", &[((1, 1), 0.75), ((2, 1), 1.0 - (1.0 - 0.5 * SQRT_2).powi(2) / 2.0), ((2, 2), 1.0)]),
        ("octagon side=1 x0=1 y0=1 angle=45", &[((1, 1), 0.75), ((2, 2), 1.0)]),
    ];
    for &(text, cells) in cases {
        assert_coverages(text, &figure(text, SIDE), cells);
    }
}

#[test]
#[rustfmt::skip] // A case a line.
fn ellipses_cover_hand_computed_areas() {
    let sqrt_3 = 3_f64.sqrt();
    // The parts of a unit circle about a cell's centre in the cell beside it, and in the cell diagonally across.
    let (beside, across) = (PI / 6.0 + sqrt_3 / 4.0 - 0.5, (PI / 3.0 + 1.0 - sqrt_3) / 4.0);
    // ∫ √(4 − x²) from 0 to 1.
    let under = sqrt_3 / 2.0 + PI / 3.0;
    // The segment that a line at half of the radius cuts off a circle of radius 0.5.
    let segment = 0.25 * (PI / 3.0 - sqrt_3 / 4.0);
    let cases: &[(&str, Cells)] = &[
        ("radius_x=0.5 radius_y=0.5 x0=3 y0=5", &[((3, 5), PI / 4.0), ((2, 5), 0.0), ((3, 4), 0.0), ((4, 5), 0.0)]),
        ("radius_x=0.3 radius_y=0.3 x0=7.1 y0=7.35", &[((7, 7), 0.09 * PI), ((8, 7), 0.0)]),
        ("radius_x=1 radius_y=1 x0=4 y0=6", &[((4, 6), PI / 4.0), ((5, 6), PI / 4.0), ((4, 7), PI / 4.0), ((5, 7), PI / 4.0), ((6, 6), 0.0)]),
        ("radius_x=1 radius_y=1 x0=1.5 y0=1.5 angle=33", &[((2, 2), 1.0), ((1, 2), beside), ((2, 3), beside), ((1, 1), across), ((3, 3), across)]),
        ("radius_x=0.5 radius_y=0.5 x0=1.75 y0=2", &[((1, 2), segment), ((2, 2), PI / 4.0 - segment)]),
        ("radius_x=2 radius_y=2 x0=0 y0=0", &[((1, 1), 1.0), ((0, 1), under - 1.0), ((2, 3), under - 1.0), ((3, 3), PI + 1.0 - 2.0 * under)]),
        ("radius_x=1 radius_y=1 x0=-1 y0=-1", &[((0, 0), PI / 4.0), ((1, 0), 0.0), ((0, 1), 0.0)]),
        ("radius_x=16 radius_y=16 x0=-8 y0=-8 angle=71", &[((0, 0), 1.0), ((15, 0), 1.0), ((7, 7), 1.0), ((15, 15), 1.0)]),
        // Circles that are compressed.
        ("radius_x=2 radius_y=1 x0=3 y0=3", &[((5, 3), under / 2.0), ((6, 3), (PI - under) / 2.0), ((3, 4), (PI - under) / 2.0)]),
        ("radius_x=2 radius_y=1 x0=3 y0=3 angle=90", &[((4, 4), under / 2.0), ((4, 2), (PI - under) / 2.0), ((5, 5), (PI - under) / 2.0)]),
        ("radius_x=0.5 radius_y=0.25 x0=3 y0=3.25 angle=37", &[((3, 3), PI / 8.0)]),
        // Rings; the last one has no room for a hole.
        ("radius_x=1 radius_y=1 x0=4 y0=6 thickness=0.5", &[((4, 6), 3.0 * PI / 16.0), ((5, 7), 3.0 * PI / 16.0)]),
        ("radius_x=2 radius_y=2 x0=0 y0=0 thickness=1", &[((1, 1), 1.0 - PI / 4.0), ((0, 1), under - 1.0), ((2, 3), under - 1.0)]),
        ("radius_x=0.5 radius_y=0.4 x0=3 y0=5 thickness=0.3", &[((3, 5), PI * (0.2 - 0.02))]),
        ("radius_x=0.5 radius_y=0.4 x0=3 y0=5 thickness=0.4", &[((3, 5), PI * 0.2)]),
    ];
    for &(text, cells) in cases {
        assert_coverages(text, &figure(&format!("ellipse {text}"), SIDE), cells);
    }
}

#[test]
#[rustfmt::skip] // A case a line.
fn user_defined_polygons_cover_hand_computed_areas() {
    let wedge: Vec<_> = (0..8_u8).map(|k| ((k, 0), 1.0 - f64::from(2 * k + 1) / 16.0)).collect();
    let cases: &[(&str, &[Vertex], Cells)] = &[
        // A square of side 5 whose sides have slopes of 3/4 and 4/3.
        ("3-4-5", &[(3.0, 0.0), (7.0, 3.0), (4.0, 7.0), (0.0, 4.0)], &[((0, 3), 0.625), ((0, 4), 0.375), ((1, 2), 5.0 / 6.0),
            ((2, 0), 0.375), ((3, 0), 0.625), ((1, 1), 1.0 / 6.0), ((2, 1), 23.0 / 24.0), ((3, 3), 1.0)]),
        ("a wedge that climbs by one cell over eight", &[(0.0, 0.0), (8.0, 1.0), (0.0, 1.0)], &wedge),
        // The left arm ends at x = 2 − (y − 2)/2.
        ("dented", &[(1.0, 1.0), (4.0, 1.0), (4.0, 2.0), (2.0, 2.0), (1.0, 4.0)], &[((1, 1), 1.0), ((3, 1), 1.0), ((2, 2), 0.0),
            ((1, 2), 0.75), ((1, 3), 0.25)]),
        ("a line", &[(1.0, 1.0), (4.0, 5.0)], &[((1, 1), 0.0), ((2, 2), 0.0), ((3, 4), 0.0)]),
        ("no vertex", &[], &[((0, 0), 0.0)]),
    ];
    for &(name, vertices, cells) in cases {
        assert_coverages(name, &Polygon::new(vertices.iter().copied()), cells);
    }
}

#[test]
#[rustfmt::skip] // A case a line.
fn pictures_cover_the_sum_of_their_squares() {
    let cases: &[(&str, Cells)] = &[
        // The position of the corner is scaled, too: from 2.5 to 5 and from 1.5 to 3.
        ("# x0=1 y0=1 zoom_x=2.5 zoom_y=1.5", &[((2, 1), 0.25), ((3, 1), 0.5), ((4, 1), 0.5), ((2, 2), 0.5), ((3, 2), 1.0), ((5, 2), 0.0)]),
        ("##/#. x0=0.5 y0=0.25", &[((0, 0), 0.375), ((1, 0), 0.75), ((2, 0), 0.375), ((0, 1), 0.5), ((1, 1), 0.625),
            ((2, 1), 0.125), ((0, 2), 0.125), ((1, 2), 0.125), ((2, 2), 0.0)]),
        ("# x0=0.75 y0=0.75 angle=45 zoom_x=2 zoom_y=2", &[((2, 2), 1.0), ((3, 2), SQRT_2 - 0.75), ((3, 3), 1.5 - SQRT_2)]),
        // Counter-clockwise: the taxel below the left end of the row comes to be below its right end.
        ("##/#. x0=3 y0=3 angle=90", &[((3, 3), 1.0), ((3, 4), 1.0), ((4, 4), 1.0), ((4, 3), 0.0)]),
        ("#.# x0=2 y0=2 zoom_x=0.5 zoom_y=0.5", &[((1, 1), 0.25), ((2, 1), 0.25)]),
        // From 0.6 to 1.5 with a hole from 0.9 to 1.2, in both directions.
        ("###/#.#/### x0=2 y0=2 zoom_x=0.3 zoom_y=0.3", &[((0, 0), 0.15), ((1, 0), 0.18), ((0, 1), 0.18), ((1, 1), 0.21)]),
        ("#.#/### x0=-1 y0=-1", &[((0, 0), 1.0), ((1, 0), 1.0), ((2, 0), 0.0)]),
        // The empty rim of the stored matrix is not part of the picture.
        ("..../..#./..../.... x0=5 y0=6", &[((5, 6), 1.0), ((7, 7), 0.0)]),
        (".../... x0=5 y0=6 zoom_x=3", &[((5, 6), 0.0)]),
    ];
    for &(text, cells) in cases {
        assert_coverages(text, &picture(text, SIDE), cells);
    }
}

#[test]
fn coverages_add_up_to_the_area_of_the_figure() {
    let regular = |corners: f64, side: f64| corners / 4.0 * side * side / (PI / corners).tan();
    // The hole is the same polygon with an inradius that is smaller by the wall.
    let walled = |corners: f64, side: f64, wall: f64| {
        let inradius = side / (2.0 * (PI / corners).tan());
        regular(corners, side) * (1.0 - ((inradius - wall) / inradius).powi(2))
    };
    #[rustfmt::skip] // One case per line.
    let cases = [
        ("triangle side=7.5 x0=3.1 y0=4.2 angle=11", regular(3.0, 7.5)),
        ("pentagon side=3.33 x0=4.4 y0=5.5 angle=23", regular(5.0, 3.33)),
        ("hexagon side=3 x0=2.1 y0=3.35 angle=17", regular(6.0, 3.0)),
        ("heptagon side=2.5 x0=3.3 y0=3.3 angle=200", regular(7.0, 2.5)),
        ("octagon side=4.44 x0=2.02 y0=2.5 angle=300", regular(8.0, 4.44)),
        ("triangle side=7.5 x0=3.1 y0=4.2 angle=60 thickness=1", walled(3.0, 7.5, 1.0)),
        ("pentagon side=3.33 x0=4.4 y0=5.5 angle=90 thickness=0.5", walled(5.0, 3.33, 0.5)),
        ("hexagon side=3 x0=2.1 y0=3.35 angle=17 thickness=1", walled(6.0, 3.0, 1.0)),
        ("heptagon side=2.5 x0=3.3 y0=3.3 angle=1 thickness=2.5", walled(7.0, 2.5, 2.5)),
        ("octagon side=4.44 x0=2.02 y0=2.5 angle=45 thickness=0.01", walled(8.0, 4.44, 0.01)),
        // The inradius of a triangle of side 3 is 0.866, so there is no room for a hole.
        ("triangle side=3 x0=4 y0=4 angle=200 thickness=0.87", regular(3.0, 3.0)),
        ("ellipse radius_x=4 radius_y=2.5 x0=4 y0=4 angle=49", 10.0 * PI),
        ("ellipse radius_x=4 radius_y=2.5 x0=4 y0=4 angle=49 thickness=1.25", PI * (10.0 - 2.75 * 1.25)),
        ("rectangle length=6.5 width=3.2 x0=4 y0=4 angle=77", 20.8),
        ("rectangle length=6.5 width=3.2 x0=4 y0=4 angle=77 thickness=0.6", 20.8 - 5.3 * 2.0),
    ];
    for (text, area) in cases {
        let mut plane = Plane::new(sensor(SIDE, SIDE, 0.5));
        plane.touch(&figure(text, SIDE));
        let sum: f64 = plane.coverages().values().iter().sum();
        assert!(
            (sum - area).abs() < 1e-11,
            "{text}: covers {sum}, expected {area}"
        );
    }
}

/// Ellipses, each with the side on which its material is.
struct Rings(Vec<(Ellipse<f64>, Side)>);

impl Solid for Rings {
    fn draw<T: Real>(&self, pen: &mut impl Pen<T>) {
        let point = |point: Point<f64>| Point::new(T::decimal(point.x), T::decimal(point.y));
        for (ellipse, material) in &self.0 {
            let ellipse = Ellipse {
                centre: point(ellipse.centre),
                across: point(ellipse.across),
                along: point(ellipse.along),
            };
            pen.ellipse(&ellipse, *material);
        }
    }
}

/// A ring through four points, drawn as a whole or edge by edge.
struct Quadrangle([f64; 8], bool);

impl Solid for Quadrangle {
    fn draw<T: Real>(&self, pen: &mut impl Pen<T>) {
        let corner = |i: usize| Point::new(T::decimal(self.0[i]), T::decimal(self.0[i + 1]));
        let ring = [0, 2, 4, 6].map(corner);
        if self.1 {
            return pen.ring(&ring, Side::Inside);
        }
        for (index, &from) in ring.iter().enumerate() {
            pen.edge(from, ring[(index + 1) % 4]);
        }
    }
}

/// A mistake in a user-defined shape must not change the imprints of later shapes.
#[test]
fn a_shape_that_is_not_finite_does_not_affect_the_next_one() {
    let mut plane = Plane::new(sensor(SIDE, SIDE, 0.5));
    let square = Polygon::new([(0.0, 0.0), (2.0, 0.0), (2.0, 2.0), (0.0, 2.0)]);
    let mut check = |odd: f64, solid: &dyn Fn(&mut Plane) -> u32| {
        assert_eq!(solid(&mut plane), 0, "{odd}");
        assert!(
            plane.coverages().values().iter().all(|&own| own == 0.0),
            "{odd}"
        );
        assert_eq!(plane.touch(&square).count(), 4, "{odd}");
        assert_eq!(plane.coverages().values().iter().sum::<f64>(), 4.0, "{odd}");
    };
    for odd in [f64::NAN, f64::INFINITY, f64::NEG_INFINITY] {
        for index in 0..8 {
            let mut corners = [1.0, 1.0, 9.0, 1.5, 9.5, 9.0, 1.3, 9.3];
            corners[index] = odd;
            for whole in [false, true] {
                check(odd, &|plane| {
                    plane.touch(&Quadrangle(corners, whole)).count()
                });
            }
        }
    }
    for odd in [f64::NAN, f64::INFINITY, f64::MAX, -1e200, 1e70] {
        for index in 0..6 {
            let mut numbers = [4.0, 5.0, 3.0, 0.5, -0.5, 2.0];
            numbers[index] = odd;
            let [centre, across, along] = [0, 2, 4].map(|i| Point::new(numbers[i], numbers[i + 1]));
            let ellipse = Ellipse {
                centre,
                across,
                along,
            };
            check(odd, &|plane| {
                plane.touch(&Rings(vec![(ellipse, Side::Inside)])).count()
            });
        }
    }
}

/// At a threshold of one half, ellipses are decided by centres, while coverages are computed from areas.
#[test]
fn ellipses_are_active_where_they_cover_half() {
    let mut random = Random::new(7);
    let mut plane = Plane::new(sensor(24, 20, 0.5));
    let (mut active, mut near) = (0, 0);
    for _ in 0..40_000 {
        let mut between =
            |low: f64, high: f64| low + (high - low) * f64::from(random.whole(0, 1_000_000)) / 1e6;
        let centre = Point::new(between(-3.0, 27.0), between(-3.0, 23.0));
        let (longer, turn) = (between(0.1, 11.0), between(0.0, 2.0 * PI));
        let shorter = longer * between(0.02, 1.0);
        let (sin, cos) = turn.sin_cos();
        let shear = between(-0.5, 0.5);
        let mut ellipse = Ellipse {
            centre,
            across: Point::new(longer * cos, longer * sin),
            along: Point::new(shear - shorter * sin, shorter * cos),
        };
        let mut rings = vec![(ellipse, Side::Inside)];
        for material in [Side::Outside, Side::Inside] {
            // From very thin walls to no hole.
            let scale = between(0.0, 1.3).min(0.9999);
            let smaller = |axis: Point<f64>| Point::new(axis.x * scale, axis.y * scale);
            ellipse.across = smaller(ellipse.across);
            ellipse.along = smaller(ellipse.along);
            rings.push((ellipse, material));
        }
        let imprint = plane.touch(&Rings(rings));
        for (index, &coverage) in plane.coverages().values().iter().enumerate() {
            let (column, row) = (index % 24, index / 24);
            let found = imprint.words()[row] >> column & 1 == 1;
            if (coverage - 0.5).abs() > 1e-9 {
                assert_eq!(found, coverage > 0.5, "{ellipse:?}: {column}, {row}");
            }
            active += u32::from(found);
            near += u32::from((coverage - 0.5).abs() < 0.01);
        }
    }
    assert!(active > 1_000_000 && near > 10_000, "{active}, {near}");
}

#[test]
fn a_figure_that_ends_at_the_rim_does_not_reach_beyond_it() {
    let sensor = sensor(SIDE, SIDE, 0.5);
    let mut beyond_but_for_rounding = 0;
    for hundredths in 100..400 {
        // A rotation that maps the figure onto itself, so it ends where the upright one does.
        for (kind, step) in [
            ("triangle", 120),
            ("pentagon", 72),
            ("hexagon", 60),
            ("octagon", 45),
        ] {
            for angle in (step..360).step_by(step) {
                let side = f64::from(hundredths) / 100.0;
                let text = format!("{kind} side={side} x0=0 y0=0 angle={angle}");
                let figure = figure(&text, SIDE);
                let extent = Extent::of(&figure).expect("it has edges");
                beyond_but_for_rounding += u32::from(extent.left.min(extent.top) < 0.0);
                assert!(!reaches_beyond(&figure, &sensor), "{text}: {extent:?}");
            }
        }
    }
    assert!(beyond_but_for_rounding > 0);
    let rim = f64::from(SIDE);
    for (by, expected) in [(1e-12, false), (1e-8, true)] {
        for ends in [
            [-by, 1.0, 4.0, 4.0],
            [1.0, -by, 4.0, 4.0],
            [1.0, 1.0, rim + by, 4.0],
            [1.0, 1.0, 4.0, rim + by],
        ] {
            let [left, top, right, bottom] = ends;
            let corners = [(left, top), (right, top), (right, bottom), (left, bottom)];
            let found = reaches_beyond(&Polygon::new(corners), &sensor);
            assert_eq!(found, expected, "{ends:?}");
        }
    }
    let beyond = figure("ellipse radius_x=1 radius_y=1 x0=14.01 y0=3", SIDE);
    assert!(reaches_beyond(&beyond, &sensor));
}
