//! Finds the descriptors that hardly depend on where and how a figure lies.
//!
//! Each of the seven figures is swept over the paper's grid of 3.6 million poses. For each descriptor, this prints the
//! coefficient of variation in percent, which is the standard deviation over the mean: a value near 0 means a
//! quasi-invariant. The two parts of the deviation follow below it: from the position at a fixed angle, and from the
//! angle.
//!
//! `cargo run --release --example invariance [-- STEP]`; STEP is the step of the angles in degrees, 1 by default.

use std::fmt::Write;

use taxel_core::prelude::*;

/// The descriptors of the shape, as opposed to its place.
const DESCRIBING: [&str; 8] = [
    "na",
    "nae",
    "ce",
    "p",
    "f",
    "roundness",
    "side_ratio",
    "filling",
];

fn main() -> Result<(), String> {
    let step = std::env::args().nth(1).unwrap_or("1".to_owned());
    print!("{}", report(&format!("0:359:{step}"))?);
    Ok(())
}

/// Returns a Markdown table over a range of angles: a row for each descriptor and each part, a column for each figure.
///
/// # Errors
/// Returns an error if `angles` is not a range.
pub(crate) fn report(angles: &str) -> Result<String, String> {
    let angle = angles
        .parse()
        .map_err(|error| format!("{angles}: {error}"))?;
    let ranges = Ranges::default().with(Axis::Angle, angle);
    let results: Vec<SweepResult> = FigureKind::ALL
        .iter()
        .copied()
        .map(|kind| sweep(kind, ranges))
        .collect();

    let names = FigureKind::names().join(" | ");
    let mut table = format!("| % of the mean | {names} |\n|---|{}\n", "---:|".repeat(7));
    for key in DESCRIBING {
        let _ = writeln!(
            table,
            "| `{key}` | {} |",
            row(&results, key, |part| part.sd)
        );
        let position = row(&results, key, |part| part.sd_position);
        let _ = writeln!(table, "| from the position | {position} |");
        let _ = writeln!(
            table,
            "| from the angle | {} |",
            row(&results, key, |part| part.sd_angle)
        );
    }
    Ok(table)
}

/// Returns the row for a feature: its deviation in percent of its mean, for each figure.
fn row(
    results: &[SweepResult],
    key: &str,
    deviation: fn(&taxel_core::atlas::Statistic) -> Option<f64>,
) -> String {
    let percent = |result: &SweepResult| {
        let statistic = result
            .statistics
            .iter()
            .find(|found| found.feature.key == key)?;
        Some(100.0 * deviation(statistic)? / statistic.mean?)
    };
    let cells = results.iter().map(|result| match percent(result) {
        Some(percent) => format!("{percent:.1}"),
        None => "–".to_owned(),
    });
    cells.collect::<Vec<_>>().join(" | ")
}

fn sweep(kind: FigureKind, ranges: Ranges) -> SweepResult {
    let sensor = Sensor::default();
    let figure = Figure::default_of(kind, &sensor).into();
    let grid =
        PoseGrid::new(figure, sensor, Anchor::Corner, ranges).expect("the paper's positions");
    Sweep::new(&grid).run()
}
