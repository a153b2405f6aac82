//! Shapes drawn at random, in hundredths of a cell side.

use proptest::prelude::*;
use taxel_core::figure::{Figure, FigureKind};
use taxel_core::imprint::Imprint;
use taxel_core::parameter::Parameter;
use taxel_core::sensor::{MAX_SIDE, Sensor};

use crate::common::{Polygon, size};

pub(crate) fn hundredths(value: i32) -> f64 {
    f64::from(value) / 100.0
}

/// Returns a whole number of degrees; every other one is a multiple of 15.
pub(crate) fn angle() -> impl Strategy<Value = i32> {
    prop_oneof![0..360, (0..24).prop_map(|step| step * 15)]
}

pub(crate) fn kind() -> impl Strategy<Value = FigureKind> {
    proptest::sample::select(FigureKind::ALL.to_vec())
}

/// A figure in hundredths: kind, two sizes, x0 and y0, angle, wall.
pub(crate) type Drawn = (FigureKind, (i32, i32), (i32, i32), i32, Option<i32>);

pub(crate) fn drawn(place: std::ops::Range<i32>) -> impl Strategy<Value = Drawn> {
    let sizes = (1..500, 1..500);
    let wall = proptest::option::of(1..200);
    (kind(), sizes, (place.clone(), place), angle(), wall)
}

pub(crate) fn figure(&(kind, sizes, place, angle, wall): &Drawn, side: u8) -> Figure {
    let sensor = Sensor::new(side, side).expect("1 to 64");
    Figure::new(kind, &sensor, |parameter| match parameter {
        Parameter::X0 => Some(hundredths(place.0)),
        Parameter::Y0 => Some(hundredths(place.1)),
        Parameter::Angle => Some(f64::from(angle)),
        Parameter::Thickness => wall.map(hundredths),
        Parameter::RadiusY | Parameter::Width => Some(hundredths(sizes.1)),
        _ => Some(hundredths(sizes.0)),
    })
    .expect("drawn within the ranges")
}

pub(crate) fn imprints(
    columns: std::ops::RangeInclusive<u8>,
    rows: std::ops::RangeInclusive<u8>,
) -> impl Strategy<Value = Imprint> {
    let words = proptest::collection::vec(any::<u64>(), usize::from(MAX_SIDE));
    (columns, rows, words).prop_map(|(columns, rows, words)| {
        let mut imprint = Imprint::empty(size(columns, rows));
        for (row, word) in words.into_iter().enumerate() {
            imprint.set_word(row, word);
        }
        imprint
    })
}

/// Returns the imprint with every active taxel moved by `to`; taxels that leave the matrix are dropped.
pub(crate) fn moved(imprint: &Imprint, to: impl Fn(i32, i32) -> (i32, i32)) -> Imprint {
    let mut result = Imprint::empty(imprint.size());
    for (column, row) in imprint.active() {
        let (column, row) = to(i32::from(column), i32::from(row));
        if let (Ok(column), Ok(row)) = (u8::try_from(column), u8::try_from(row)) {
            result.set(column, row, true);
        }
    }
    result
}

/// Returns the vertices of a polygon in hundredths. It is star-shaped about (8, 8), with vertices in order of their
/// angle, which keeps the polygon simple. Any polygon would do, because a shape is only compared with itself
/// elsewhere.
pub(crate) fn star() -> impl Strategy<Value = Vec<(i32, i32)>> {
    proptest::collection::vec((1..240_i32, 50..780_i32), 5..12).prop_map(|steps| {
        let total: i32 = steps.iter().map(|step| step.0).sum();
        let mut so_far = 0;
        let vertex = |(step, radius): (i32, i32)| {
            so_far += step;
            let turn = std::f64::consts::TAU * f64::from(so_far) / f64::from(total);
            let on_grid = |value: f64| {
                format!("{value:.0}")
                    .parse::<i32>()
                    .expect("a whole number")
            };
            let radius = f64::from(radius);
            (
                800 + on_grid(radius * turn.cos()),
                800 + on_grid(radius * turn.sin()),
            )
        };
        steps.into_iter().map(vertex).collect()
    })
}

pub(crate) fn polygon(vertices: impl IntoIterator<Item = (i32, i32)>) -> Polygon {
    Polygon::new(
        vertices
            .into_iter()
            .map(|(x, y)| (hundredths(x), hundredths(y))),
    )
}

/// Returns the area in closed form.
pub(crate) fn area(figure: &Figure) -> f64 {
    let get = |parameter| figure.get(parameter).expect("a parameter of this kind");
    let wall = figure.get(Parameter::Thickness).unwrap_or(f64::MAX);
    let less_hole = |outer: f64, inner: (f64, f64), share: f64| {
        if inner.0 > 0.0 && inner.1 > 0.0 {
            outer - inner.0 * inner.1 * share
        } else {
            outer
        }
    };
    let pi = std::f64::consts::PI;
    let corners = match figure.kind() {
        FigureKind::Ellipse => {
            let (rx, ry) = (get(Parameter::RadiusX), get(Parameter::RadiusY));
            return less_hole(pi * rx * ry, (rx - wall, ry - wall), pi);
        }
        FigureKind::Rectangle => {
            let (length, width) = (get(Parameter::Length), get(Parameter::Width));
            return less_hole(
                length * width,
                (length - 2.0 * wall, width - 2.0 * wall),
                1.0,
            );
        }
        FigureKind::Triangle => 3.0,
        FigureKind::Pentagon => 5.0,
        FigureKind::Hexagon => 6.0,
        FigureKind::Heptagon => 7.0,
        FigureKind::Octagon => 8.0,
    };
    // n r² tan(π/n), with the inradius r.
    let factor = corners * (pi / corners).tan();
    let inradius = get(Parameter::Side) / 2.0 / (pi / corners).tan();
    less_hole(
        factor * inradius * inradius,
        (inradius - wall, inradius - wall),
        factor,
    )
}
