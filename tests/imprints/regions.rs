//! Regions and descriptors of grids that are drawn in the source, computed by hand.
//!
//! The steps around a region are counted by following it with a finger: `straight` to a taxel beside, above or below,
//! `diagonal` across a corner.

use std::collections::HashSet;
use std::f64::consts::SQRT_2;

use taxel_core::description::{DESCRIPTORS, Description, RegionKind, Value, main_region, regions};
use taxel_core::imprint::Imprint;
use taxel_core::touch::Plane;

use crate::common::{figure, grid, sensor};
use crate::paper::RING_IMPRINTS;
use RegionKind::{Exterior, Hole};

/// The kind of region; NA, NAE, CE; the sums of x and of y; straight and diagonal steps; left, top, right, bottom.
type Row = (RegionKind, [u32; 3], [f64; 2], [u32; 2], [u8; 4]);

fn assert_regions(name: &str, imprint: &Imprint, expected: &[Row]) {
    let found: Vec<Row> = regions(imprint)
        .iter()
        .map(|region| {
            let d = Description::of(region);
            let rect = [d.rect.left, d.rect.top, d.rect.right, d.rect.bottom];
            let steps = [d.steps.straight, d.steps.diagonal];
            (d.kind, [d.na, d.nae, d.ce], [d.num_x, d.num_y], steps, rect)
        })
        .collect();
    assert_eq!(found, expected, "{name}\n{imprint}");
}

#[test]
#[rustfmt::skip] // A region a line, or the table cannot be read.
fn regions_of_drawn_grids_equal_those_counted_by_hand() {
    let cases: &[(&str, &str, &[Row])] = &[
        ("nothing", ".../...", &[]),
        ("one taxel", ".../.#./...", &[(Exterior, [1, 1, 1], [1.5, 1.5], [0, 0], [1, 1, 2, 2])]),
        ("two taxels, out and back", "##", &[(Exterior, [2, 2, 2], [2.0, 1.0], [2, 0], [0, 0, 2, 1])]),
        ("a square", "##/##", &[(Exterior, [4, 4, 4], [4.0, 4.0], [4, 0], [0, 0, 2, 2])]),
        ("an L", "#./##", &[(Exterior, [3, 3, 3], [2.5, 3.5], [2, 1], [0, 0, 2, 2])]),
        ("a diagonal pair is one piece", "#./.#", &[(Exterior, [2, 2, 2], [2.0, 2.0], [0, 2], [0, 0, 2, 2])]),
        ("a cross", ".#./###/.#.", &[(Exterior, [5, 5, 4], [7.5, 7.5], [0, 4], [0, 0, 3, 3])]),
        ("a slanting cross", "#.#/.#./#.#", &[(Exterior, [5, 5, 5], [7.5, 7.5], [0, 8], [0, 0, 3, 3])]),
        ("a block", "###/###/###", &[(Exterior, [9, 9, 8], [13.5, 13.5], [8, 0], [0, 0, 3, 3])]),
        ("a spur counts out and back", "##../####/##..", &[(Exterior, [8, 8, 7], [12.0, 12.0], [6, 2], [0, 0, 4, 3])]),
        ("a ring", "###/#.#/###", &[(Exterior, [8, 9, 8], [12.0, 12.0], [8, 0], [0, 0, 3, 3]),
            (Hole, [1, 1, 1], [1.5, 1.5], [0, 0], [1, 1, 2, 2])]),
        ("a diagonal ring encloses, too", ".#./#.#/.#.", &[(Exterior, [4, 5, 4], [6.0, 6.0], [0, 4], [0, 0, 3, 3]),
            (Hole, [1, 1, 1], [1.5, 1.5], [0, 0], [1, 1, 2, 2])]),
        ("an island in the hole of a ring", "#####/#...#/#.#.#/#...#/#####", &[
            (Exterior, [16, 25, 16], [40.0, 40.0], [16, 0], [0, 0, 5, 5]),
            (Exterior, [1, 1, 1], [2.5, 2.5], [0, 0], [2, 2, 3, 3]),
            (Hole, [8, 9, 8], [20.0, 20.0], [8, 0], [1, 1, 4, 4])]),
        ("holes that meet in a corner are two", "####/#.##/##.#/####", &[
            (Exterior, [14, 16, 12], [28.0, 28.0], [12, 0], [0, 0, 4, 4]),
            (Hole, [1, 1, 1], [1.5, 1.5], [0, 0], [1, 1, 2, 2]), (Hole, [1, 1, 1], [2.5, 2.5], [0, 0], [2, 2, 3, 3])]),
        ("a gap on the rim is no hole", "###/#.#", &[(Exterior, [5, 5, 5], [7.5, 4.5], [4, 2], [0, 0, 3, 2])]),
        ("a C", "###/#../###", &[(Exterior, [7, 7, 7], [9.5, 10.5], [8, 2], [0, 0, 3, 3])]),
        ("a C that the rim does not close", "####/#..#/#.##/#...", &[(Exterior, [10, 10, 10], [19.0, 16.0], [12, 3], [0, 0, 4, 4])]),
        ("two pieces in reading order, not by size", "..#/##./##./...", &[(Exterior, [5, 5, 5], [6.5, 8.5], [4, 2], [0, 0, 3, 3])]),
        ("pieces apart", "#.../..##/#...", &[(Exterior, [1, 1, 1], [0.5, 0.5], [0, 0], [0, 0, 1, 1]),
            (Exterior, [2, 2, 2], [6.0, 3.0], [2, 0], [2, 1, 4, 2]), (Exterior, [1, 1, 1], [0.5, 2.5], [0, 0], [0, 2, 1, 3])]),
    ];
    for &(name, text, expected) in cases {
        assert_regions(name, &grid(text), expected);
    }
}

#[test]
#[rustfmt::skip] // A region a line.
fn matrices_of_the_largest_sizes_have_the_expected_regions() {
    let full = |columns: usize, rows: usize| grid(&vec!["#".repeat(columns); rows].join("/"));
    assert_regions("1 x 1", &full(1, 1), &[(Exterior, [1, 1, 1], [0.5, 0.5], [0, 0], [0, 0, 1, 1])]);
    // A line, there and back again: 2 · 63 steps.
    assert_regions("64 x 1", &full(64, 1), &[(Exterior, [64, 64, 64], [2048.0, 32.0], [126, 0], [0, 0, 64, 1])]);
    assert_regions("1 x 64", &full(1, 64), &[(Exterior, [64, 64, 64], [32.0, 2048.0], [126, 0], [0, 0, 1, 64])]);
    assert_regions("64 x 64", &full(64, 64), &[(Exterior, [4096, 4096, 252], [131_072.0, 131_072.0], [252, 0], [0, 0, 64, 64])]);
    // All taxels except the middle one of the last column: it is on the rim, so it is no hole.
    let mut dented = full(64, 64);
    dented.set(63, 32, false);
    assert_regions("dented", &dented, &[(Exterior, [4095, 4095, 252], [131_008.5, 131_039.5], [250, 2], [0, 0, 64, 64])]);
    // The complete rim of the largest matrix.
    let mut rim = full(64, 64);
    (1..63).for_each(|row| (1..63).for_each(|column| rim.set(column, row, false)));
    assert_regions("rim", &rim, &[(Exterior, [252, 4096, 252], [8064.0, 8064.0], [252, 0], [0, 0, 64, 64]),
        (Hole, [3844, 3844, 244], [123_008.0, 123_008.0], [244, 0], [1, 1, 63, 63])]);
}

#[test]
fn the_main_region_is_the_first_with_the_largest_filled_area() {
    let cases = [
        ("...", None),
        ("#.#", Some(0)),
        ("#.##", Some(1)),
        // Eight taxels around a hole enclose a larger area than eight in two rows.
        ("####.###/####.#.#/.....###", Some(1)),
        // A hole is never the main region, however large.
        (".###./#...#/#...#/#...#/.###.", Some(0)),
    ];
    for (text, expected) in cases {
        assert_eq!(main_region(&regions(&grid(text))), expected, "{text}");
    }
}

fn measure(imprint: &Imprint, key: &str) -> Value {
    let region = &regions(imprint)[0];
    let row = DESCRIPTORS.iter().find(|descriptor| descriptor.key == key);
    (row.expect("a key of the table").measure)(&Description::of(region))
}

#[test]
fn directions_are_counter_clockwise_as_seen() {
    // The direction from the centre of gravity to the centre of the rectangle.
    let cases = [
        ("#./##", 45.0),
        (".#/##", 135.0),
        ("##/.#", -135.0),
        ("##/#.", -45.0),
        ("##../####/##..", 0.0),
        (".#./.#./###/###", 90.0),
        ("..##/####/..##", 180.0),
        ("###/###/.#./.#.", -90.0),
    ];
    for (text, degrees) in cases {
        let Value::Number(found) = measure(&grid(text), "cg_cd_direction") else {
            panic!("{text} has no direction");
        };
        assert!(
            (found - degrees).abs() < 1e-9,
            "{text}: {found}, expected {degrees}"
        );
    }
    assert_eq!(measure(&grid("###/###"), "cg_cd_direction"), Value::None);
    let flat = (1.0_f64 / 3.0).atan().to_degrees();
    let diagonals = Value::Pair([flat, 180.0 - flat]);
    assert_eq!(measure(&grid("###"), "diagonals"), diagonals);
    assert_eq!(
        measure(&grid("##/##"), "diagonals"),
        Value::Pair([45.0, 135.0])
    );
}

#[test]
fn one_taxel_has_an_outline_without_length() {
    let one = grid(".../.#./...");
    for (key, expected) in [
        ("p", Value::Number(0.0)),
        ("f", Value::Number(0.0)),
        ("roundness", Value::None),
        ("area", Value::Count(1)),
        ("side_ratio", Value::Number(1.0)),
        ("filling", Value::Number(1.0)),
        ("cg_cd", Value::Number(0.0)),
        ("cg_cd_direction", Value::None),
    ] {
        assert_eq!(measure(&one, key), expected, "{key}");
    }
}

#[test]
fn the_ring_of_fig_1_has_the_papers_values() {
    // The ring of Fig. 1 in Purcaru and Niculescu's paper.
    let ring = figure(
        "ellipse radius_x=4 radius_y=4 x0=1.99 y0=1.47 thickness=2",
        16,
    );
    let imprint = Plane::new(sensor(16, 16, 0.5)).touch(&ring);
    #[rustfmt::skip] // One region per line.
    assert_regions("the paper's ring", &imprint, &[
        (Exterior, [36, 48, 22], [216.0, 198.0], [18, 4], [2, 2, 10, 9]),
        (Hole, [12, 12, 10], [72.0, 66.0], [10, 0], [4, 4, 8, 7]),
    ]);
    let p = 18.0 + 4.0 * SQRT_2;
    for (key, expected) in [
        ("p", p),
        ("f", p * p / 48.0),
        ("filling", 36.0 / 56.0),
        ("cg_cd", 0.0),
        ("side_ratio", 8.0 / 7.0),
    ] {
        let Value::Number(found) = measure(&imprint, key) else {
            panic!("{key} is no number");
        };
        assert!(
            (found - expected).abs() < 1e-12,
            "{key}: {found}, expected {expected}"
        );
    }
    assert_eq!(measure(&imprint, "area"), Value::Count(56));
}

#[test]
fn the_papers_ring_leaves_393_imprints_over_all_positions_in_a_cell() {
    // The paper's range of positions, in steps of 0.01.
    let mut plane = Plane::new(sensor(16, 16, 0.5));
    let mut seen = HashSet::new();
    for x0 in 100..200 {
        for y0 in 100..200 {
            let place = format!("x0={} y0={}", f64::from(x0) / 100.0, f64::from(y0) / 100.0);
            let ring = format!("ellipse radius_x=4 radius_y=4 {place} thickness=2");
            seen.insert(plane.touch(&figure(&ring, 16)));
        }
    }
    assert_eq!(seen.len(), RING_IMPRINTS);
}
