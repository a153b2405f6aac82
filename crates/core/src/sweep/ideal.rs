//! The descriptors that a figure would have on a sensor of infinitely many, infinitely small cells.
//!
//! Only some descriptors have such a value: `na` is the figure's area, `nae` its area with the hole, and `p` the length
//! of its outer outline; `f` and `roundness` follow from these. Units are cells and cell sides. Pictures have none,
//! because their pieces and zooms do not give a single value.

use std::f64::consts::PI;

use crate::geometry::{Ellipse, Pen, Point, Side, Solid};
use crate::source::Source;

#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub(crate) struct Ideal {
    area: f64,
    filled: f64,
    outline: f64,
}

impl Ideal {
    /// Computes the ideal of a figure; None for a picture.
    pub(crate) fn of(source: &Source) -> Option<Self> {
        let Source::Figure(figure) = source else {
            return None;
        };
        let mut ideal = Self::default();
        figure.draw(&mut ideal);
        Some(ideal)
    }

    pub(crate) fn get(&self, key: &str) -> Option<f64> {
        match key {
            "na" => Some(self.area),
            "nae" => Some(self.filled),
            "p" => Some(self.outline),
            "f" => Some(self.outline * self.outline / self.filled),
            "roundness" => Some(4.0 * PI * self.filled / (self.outline * self.outline)),
            _ => None,
        }
    }

    fn add(&mut self, area: f64, outline: f64, material: Side) {
        if material == Side::Inside {
            self.area += area;
            self.filled += area;
            self.outline += outline;
        } else {
            self.area -= area;
        }
    }
}

impl Pen<f64> for Ideal {
    /// Does nothing: figures draw rings and ellipses only.
    fn edge(&mut self, _from: Point<f64>, _to: Point<f64>) {}

    fn ring(&mut self, points: &[Point<f64>], material: Side) {
        let next = points.iter().cycle().skip(1);
        let (mut doubled, mut length) = (0.0, 0.0);
        for (one, other) in points.iter().zip(next) {
            doubled += one.x * other.y - other.x * one.y;
            length += libm::hypot(other.x - one.x, other.y - one.y);
        }
        self.add(f64::abs(doubled) / 2.0, length, material);
    }

    fn ellipse(&mut self, ellipse: &Ellipse<f64>, material: Side) {
        let length = |vector: Point<f64>| libm::hypot(vector.x, vector.y);
        let (one, other) = (length(ellipse.across), length(ellipse.along));
        self.add(PI * one * other, perimeter(one, other), material);
    }
}

/// Returns the perimeter of an ellipse by the arithmetic-geometric mean (Gauss): with `c² = a² − b²` at each step,
/// `2π·(a₀² − Σ 2ⁿ⁻¹·cₙ²) / M`.
fn perimeter(one: f64, other: f64) -> f64 {
    let (mut a, mut b) = (one.max(other), one.min(other));
    let mut sum = a * a;
    let mut power = 0.5;
    while (a - b) > 1e-16 * a {
        sum -= power * (a - b) * (a + b);
        (a, b) = (f64::midpoint(a, b), (a * b).sqrt());
        power *= 2.0;
        if power > 64.0 {
            break;
        }
    }
    2.0 * PI * sum / a
}
