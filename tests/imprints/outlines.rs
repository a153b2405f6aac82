//! Figures written as outlines leave the imprints of the figures. The rings are made here from the figures' definitions.

use std::error::Error;

use taxel_core::figure::{Figure, FigureBuilder};
use taxel_core::outline::{EllipseRing, Outline, Ring};
use taxel_core::parameter::Parameter;
use taxel_core::sensor::Sensor;
use taxel_core::source::Source;
use taxel_core::touch::Plane;

use crate::common::Random;

/// The number of poses of each figure.
const POSES: u32 = 10_000;

/// The number of poses of the same sizes.
const ALIKE: u32 = 50;

fn rectangle([left, top]: [f64; 2], [right, bottom]: [f64; 2]) -> Ring {
    Ring::Polygon(vec![
        [left, top],
        [right, top],
        [right, bottom],
        [left, bottom],
    ])
}

/// A hexagon about a centre, with one side at the bottom.
fn hexagon([x, y]: [f64; 2], side: f64) -> Ring {
    let half = side * 3.0_f64.sqrt() / 2.0;
    let points = [
        (-0.5, -half),
        (0.5, -half),
        (1.0, 0.0),
        (0.5, half),
        (-0.5, half),
        (-1.0, 0.0),
    ];
    Ring::Polygon(
        points
            .map(|(along, down)| [x + along * side, y + down])
            .into(),
    )
}

fn ellipse(centre: [f64; 2], radii: [f64; 2]) -> Ring {
    let angle = 0.0;
    Ring::Ellipse(EllipseRing {
        centre,
        radii,
        angle,
    })
}

/// Two sizes and a thickness that leaves a hole, in hundredths of a cell.
fn sizes(random: &mut Random) -> [f64; 3] {
    let [one, other] = [(); 2].map(|()| random.whole(200, 700));
    let thickness = random.whole(1, one.min(other) * 2 / 5);
    [one, other, thickness].map(|number| f64::from(number) / 100.0)
}

/// Touches both at poses in hundredths and whole degrees. Or at any poses: a hexagon's points are no decimals, so ties
/// of the figure are none of the outline.
fn same(
    seed: u64,
    is_continuous: bool,
    make: impl Fn([f64; 3]) -> (FigureBuilder, Vec<Ring>),
) -> Result<(), Box<dyn Error>> {
    let (mut random, sensor) = (Random::new(seed), Sensor::default());
    let mut plane = Plane::new(sensor);
    let mut active = 0;
    for _ in 0..POSES / ALIKE {
        let (figure, rings) = make(sizes(&mut random));
        let outline = Source::Outline(Outline::new(rings, None)?);
        for _ in 0..ALIKE {
            let mut place = |low: i32, high: i32, parts: i32| {
                let parts = if is_continuous { 1_000_000 } else { parts };
                f64::from(random.whole(low * parts, high * parts)) / f64::from(parts)
            };
            let (x0, y0, angle) = (place(-2, 12, 100), place(-2, 12, 100), place(0, 359, 1));
            let figure = figure.at(x0, y0).angle(angle).on(&sensor)?;
            let outline = outline
                .clone()
                .placed(&sensor, |parameter| match parameter {
                    Parameter::X0 => Some(x0),
                    Parameter::Y0 => Some(y0),
                    // Figures turn clockwise, outlines counter-clockwise.
                    Parameter::Angle => Some((360.0 - angle) % 360.0),
                    _ => Some(1.0),
                })?;
            let imprint = plane.touch(&figure);
            assert_eq!(plane.touch(&outline), imprint, "{figure}, {outline}");
            active += imprint.count();
        }
    }
    assert!(active > POSES, "hardly anything is touched");
    Ok(())
}

#[test]
fn a_rectangle_with_a_hole_is_two_rings() -> Result<(), Box<dyn Error>> {
    same(1, false, |[length, width, thickness]| {
        let rings = vec![
            rectangle([0.0, 0.0], [length, width]),
            rectangle([thickness; 2], [length - thickness, width - thickness]),
        ];
        (Figure::rectangle(length, width).thickness(thickness), rings)
    })
}

#[test]
fn a_hexagon_with_a_hole_is_two_rings() -> Result<(), Box<dyn Error>> {
    same(2, true, |[side, _, thickness]| {
        let centre = [side, side * 3.0_f64.sqrt() / 2.0];
        let inner = side - 2.0 * thickness / 3.0_f64.sqrt();
        let rings = vec![hexagon(centre, side), hexagon(centre, inner)];
        (Figure::hexagon(side).thickness(thickness), rings)
    })
}

#[test]
fn an_ellipse_with_a_hole_is_two_rings() -> Result<(), Box<dyn Error>> {
    same(3, false, |[x, y, thickness]| {
        let rings = vec![
            ellipse([x, y], [x, y]),
            ellipse([x, y], [x - thickness, y - thickness]),
        ];
        (Figure::ellipse(x, y).thickness(thickness), rings)
    })
}
