//! Runs each program of `examples/` and compares its output with the paper and with plain geometry.

use std::f64::consts::PI;

use crate::paper::RING_IMPRINTS;

#[path = "../../examples/fits.rs"]
#[expect(dead_code, reason = "its main prints the report")]
pub(crate) mod fits;
#[path = "../../examples/invariance.rs"]
#[expect(
    dead_code,
    reason = "its main takes arguments; the report is called here"
)]
mod invariance;
#[path = "../../examples/outline.rs"]
#[expect(dead_code, reason = "its main prints the report")]
mod outline;
#[path = "../../examples/positions.rs"]
#[expect(dead_code, reason = "its main prints the report")]
mod positions;
#[path = "../../examples/touch.rs"]
#[expect(dead_code, reason = "its main prints the report")]
mod touch;

/// The numbers that the paper prints beside its Fig. 1.
#[test]
fn the_ring_of_fig_1_has_the_descriptors_that_the_paper_prints() {
    let report = touch::report();
    let (ring, hole) = report.split_once("\nhole\n").expect("a ring has a hole");
    for line in [
        "NA      36",
        "NAE     48",
        "CE      22",
        "NumX    216",
        "NumY    198",
        "CG      6, 5.5",
    ] {
        assert!(ring.contains(line), "{line:?} in\n{report}");
    }
    assert!(
        ring.contains("Rect    2..10 × 2..9") && ring.contains("Fill    64.29 %"),
        "{report}"
    );
    assert!(
        hole.contains("NA      12") && hole.contains("P       10"),
        "{report}"
    );
}

#[test]
fn the_example_counts_the_imprints_of_all_positions_in_a_cell() {
    let report = positions::report();
    let found: Vec<Vec<&str>> = report
        .lines()
        .skip(2)
        .map(|line| line.split('|').map(str::trim).collect())
        .collect();
    let cells: Vec<_> = found.iter().map(|cells| (cells[2], cells[4])).collect();
    let imprints = RING_IMPRINTS.to_string();
    assert_eq!(cells[1], ("10000", imprints.as_str()), "{report}");
    assert_eq!(cells[0], ("56", "50"), "{report}");
    // On all cells, a shift leaves the same imprint elsewhere: up to shifts, there are no more imprints than in one
    // cell.
    assert_eq!(found[1][5], found[2][5], "{report}");
}

#[test]
fn the_area_hardly_varies_and_the_sides_do() {
    let report = invariance::report("0:355:5").expect("a range");
    let row = |name: &str| -> Vec<f64> {
        let start = format!("| `{name}` | ");
        let line = report
            .lines()
            .find(|line| line.starts_with(&start))
            .expect("a row");
        let cells = line[start.len()..].trim_end_matches(" |").split(" | ");
        cells.map(|cell| cell.parse().expect("a number")).collect()
    };
    let (area, ratio) = (row("na"), row("side_ratio"));
    assert_eq!((area.len(), ratio.len()), (7, 7));
    // The triangle has 16 taxels, so a single taxel is 6 % of its area.
    assert!(
        area.iter().all(|&percent| percent > 0.0 && percent < 15.0),
        "{report}"
    );
    // A rectangle of 6 × 3 is twice as wide as high, and as wide as high when it stands on a corner.
    assert!(ratio[1] > 20.0 && area[1] < 6.0, "{report}");
    assert_eq!(
        invariance::report("0:x").expect_err("no range").get(..4),
        Some("0:x:")
    );
}

#[test]
fn a_user_defined_outline_covers_its_area() {
    let report = outline::report();
    let area = 6.0 * 12.0 + 6.0 * 6.0 - PI * 1.8 * 1.8;
    assert!(
        report.contains(&format!("covered {area:.4} cells")),
        "{report}"
    );
    assert!(report.contains("pieces and holes 2"), "{report}");
}
