//! The paper's experiment with positions: how many different imprints does one ring leave?
//!
//! The paper reports 8 imprints of the ring of its Fig. 1 among 56 positions, which it does not list. Here the same
//! ring is placed at a lattice of 56 positions over one cell, at all 10,000 positions in it whose coordinates have two
//! decimals, and at the same positions in all cells of the sensor where it fits.
//!
//! `cargo run --release --example positions`

use std::fmt::Write;

use taxel_core::prelude::*;

/// The name of each experiment, its ranges of x0 and y0, and what the paper says about it.
const EXPERIMENTS: [(&str, &str, &str, &str); 3] = [
    (
        "7 × 8 positions in a cell",
        "1:1.98:0.16",
        "1:1.98:0.14",
        "8 of 56",
    ),
    ("all positions in a cell", "1:1.99:0.01", "1:1.99:0.01", "–"),
    ("all positions on the sensor", "0:8:0.01", "0:8:0.01", "–"),
];

fn main() {
    print!("{}", report());
}

/// Returns a Markdown table of the experiments: the positions, the paper's claim, and the numbers found.
pub(crate) fn report() -> String {
    let mut table = String::from(
        "| positions | poses | the paper | distinct | up to shifts | up to symmetry |\n|---|---|---|---|---|---|\n",
    );
    for (name, x0, y0, claimed) in EXPERIMENTS {
        let result = sweep(x0, y0);
        let classes = result.atlas.distinct_classes();
        let _ = writeln!(
            table,
            "| {name} | {} | {claimed} | {} | {} | {} |",
            result.poses,
            result.atlas.len(),
            classes.up_to_shifts,
            classes.up_to_symmetry,
        );
    }
    table
}

fn sweep(x0: &str, y0: &str) -> SweepResult {
    let sensor = Sensor::default();
    let ring = Figure::ellipse(4.0, 4.0)
        .thickness(2.0)
        .on(&sensor)
        .expect("in range");
    let range = |text: &str| -> DecimalRange { text.parse().expect("a range") };
    let ranges = Ranges::default()
        .with(Axis::X0, range(x0))
        .with(Axis::Y0, range(y0))
        .with(Axis::Angle, range("0"));
    let grid = PoseGrid::new(Source::Figure(ring), sensor, Anchor::Corner, ranges)
        .expect("ranges of figures on the sensor");
    Sweep::new(&grid).run()
}
