//! The paper's Fig. 1: an ellipse with radii of 4 and a wall of 2, touched once, and all that is said of it.
//!
//! `cargo run --example touch`

use std::fmt::Write;

use taxel::description::{DESCRIPTORS, Description, regions};
use taxel::figure::{Figure, FigureKind};
use taxel::formats::value;
use taxel::parameter::Parameter;
use taxel::sensor::Sensor;
use taxel::touch::Plane;

fn main() {
    print!("{}", report());
}

/// The imprint, then each region with its descriptors.
pub(crate) fn report() -> String {
    let sensor = Sensor::default();
    let ring = Figure::new(
        FigureKind::Ellipse,
        sensor.side(),
        |parameter| match parameter {
            Parameter::RadiusX | Parameter::RadiusY => Some(4.0),
            Parameter::X0 => Some(1.99),
            Parameter::Y0 => Some(1.47),
            Parameter::Angle => Some(0.0),
            Parameter::Thickness => Some(2.0),
            _ => None,
        },
    )
    .expect("every value is in its range");
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
