//! The paper's Fig. 1: an ellipse with radii of 4 and a wall of 2, touched once, with all its descriptors.
//!
//! `cargo run --example touch`

use std::fmt::Write;

use taxel_core::prelude::*;
use taxel_files::formats::value;

fn main() {
    print!("{}", report());
}

/// Returns the imprint, then each region with its descriptors.
pub(crate) fn report() -> String {
    let sensor = Sensor::default();
    let ring = Figure::ellipse(4.0, 4.0)
        .at(1.99, 1.47)
        .thickness(2.0)
        .on(&sensor)
        .expect("in range");
    let imprint = Plane::new(sensor).touch(&ring);

    let mut text = format!("{imprint}\n");
    for region in regions(&imprint) {
        let description = Description::of(&region);
        let _ = writeln!(text, "\n{}", region.kind().name());
        for descriptor in DESCRIPTORS {
            let value = (descriptor.measure)(&description);
            let value = value::text(value, descriptor.dimension);
            let value = value.as_deref().unwrap_or("–");
            let _ = writeln!(text, "{:<7} {value}", descriptor.symbol);
        }
    }
    text
}
