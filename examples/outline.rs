//! A user-defined outline: an angle plate with a drilled hole, touched like the built-in figures.
//!
//! Anything that can draw its boundary can touch a sensor. The boundary is drawn with numbers of any precision: once
//! in `f64`, and again with 32 digits if a taxel is so close to the threshold that rounding could decide.
//!
//! `cargo run --example outline`

use std::fmt::Write;

use taxel_core::geometry::{Ellipse, Pen, Point, Real, Side, Solid};
use taxel_core::prelude::*;

/// A plate bounded by a polygon, with a round hole; lengths in cells.
struct Plate {
    /// Clockwise as seen.
    corners: [(f64, f64); 6],
    hole: (f64, f64),
    radius: f64,
}

impl Solid for Plate {
    fn draw<T: Real>(&self, pen: &mut impl Pen<T>) {
        let point = |(x, y)| Point::new(T::decimal(x), T::decimal(y));
        pen.ring(&self.corners.map(point), Side::Inside);
        let radius = T::decimal(self.radius);
        let hole = Ellipse {
            centre: point(self.hole),
            across: Point::new(radius, T::ZERO),
            along: Point::new(T::ZERO, radius),
        };
        // The material is around the hole, outside of its edge.
        pen.ellipse(&hole, Side::Outside);
    }
}

fn main() {
    print!("{}", report());
}

/// Returns the imprint of the plate, the covered area, and what a robot would know about the plate.
pub(crate) fn report() -> String {
    let plate = Plate {
        corners: [
            (2.3, 1.6),
            (8.3, 1.6),
            (8.3, 7.6),
            (14.3, 7.6),
            (14.3, 13.6),
            (2.3, 13.6),
        ],
        hole: (5.3, 10.6),
        radius: 1.8,
    };
    let mut plane = Plane::new(Sensor::default());
    let imprint = plane.touch(&plate);
    let covered: f64 = plane.coverages().values().iter().sum();

    let mut text = format!("{imprint}\n\n");
    let regions = regions(&imprint);
    let _ = writeln!(
        text,
        "covered {covered:.4} cells, active {} taxels",
        imprint.count()
    );
    if let Some(main) = main_region(&regions) {
        let description = Description::of(&regions[main]);
        let cg = description.cg();
        let _ = writeln!(
            text,
            "pieces and holes {}, CG {:.3}, {:.3}",
            regions.len(),
            cg.x,
            cg.y
        );
    }
    text
}
