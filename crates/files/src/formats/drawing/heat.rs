//! A heat map in greys: the shade of each cell, and the edge of the active taxels.
//!
//! The grey of a cell shows its value as a share of the largest one, from white at 0 and below to black; where there
//! is no cell, the page stays white. Active taxels are edged instead of filled, which would hide their values.

use crate::formats::drawing::scene::{Position, Segment};
use crate::formats::shade::shade;
use crate::formats::value::fitting;
use crate::imprint::Imprint;
use crate::matrix::Matrix;

/// The number of shades from white to black.
const SHADES: u8 = 16;

/// Returns the largest value; None if no value is above 0.
fn largest(values: &Matrix<f64>) -> Option<f64> {
    let largest = values.values().iter().copied().fold(0.0, f64::max);
    (largest > 0.0).then_some(largest)
}

/// Returns each grey except white with its cells, given by their top left corners.
pub(super) fn shades(values: &Matrix<f64>) -> Vec<(u8, Vec<Position>)> {
    let Some(largest) = largest(values) else {
        return Vec::new();
    };
    let mut shades = vec![Vec::new(); usize::from(SHADES)];
    for row in 0..values.rows() {
        for (column, &value) in (0..values.columns()).zip(values.row(row)) {
            let shade = shade(value / largest, shades.len());
            if shade > 0 {
                shades[shade].push((f64::from(column), f64::from(row)));
            }
        }
    }
    let grey = |shade: u8| 255 - shade * (255 / (SHADES - 1));
    let all = (0..SHADES).map(grey).zip(shades);
    all.filter(|(_, cells)| !cells.is_empty()).collect()
}

/// Returns the lines between active and inactive taxels, in cell sides.
pub(super) fn edges(imprint: &Imprint) -> Vec<Segment> {
    let mut edges = Vec::new();
    let mut line = |from: (u8, u8), to: (u8, u8)| {
        let place = |(x, y): (u8, u8)| (f64::from(x), f64::from(y));
        edges.extend([Segment::Move(place(from)), Segment::Line(place(to))]);
    };
    for (x, y) in imprint.active() {
        if y == 0 || !imprint.get(x, y - 1) {
            line((x, y), (x + 1, y));
        }
        if x == 0 || !imprint.get(x - 1, y) {
            line((x, y), (x, y + 1));
        }
        if !imprint.get(x, y + 1) {
            line((x, y + 1), (x + 1, y + 1));
        }
        if !imprint.get(x + 1, y) {
            line((x + 1, y), (x + 1, y + 1));
        }
    }
    edges
}

/// Returns the legend of the shades.
pub(super) fn legend(values: &Matrix<f64>) -> String {
    match largest(values) {
        Some(largest) => format!("values from 0 (white) to {} (black)", fitting(largest, 9)),
        None => "no value above 0".to_owned(),
    }
}
