//! Checks regions and descriptors against a simple implementation: flood fill with a queue, and border following.
//!
//! The walk around the filled region is Moore's neighbour tracing. A part one taxel wide is passed twice, and the
//! first taxel may be passed before the walk ends, so the walk ends by Jacob Eliosoff's criterion: at the first taxel,
//! about to leave it in the first direction again.

use std::f64::consts::{PI, SQRT_2};

use taxel_core::description::{DESCRIPTORS, Description, RegionKind, Value, main_region, regions};
use taxel_core::imprint::Imprint;

use crate::common::{Random, size};

/// Rows of taxels.
type Mask = Vec<Vec<bool>>;

/// The neighbours of a taxel as column and row, clockwise as seen, from the left one. Odd ones are diagonal.
const AROUND: [(isize, isize); 8] = [
    (-1, 0),
    (-1, -1),
    (0, -1),
    (1, -1),
    (1, 0),
    (1, 1),
    (0, 1),
    (-1, 1),
];

fn at(mask: &Mask, column: isize, row: isize) -> bool {
    let row = usize::try_from(row).ok().and_then(|row| mask.get(row));
    let column = usize::try_from(column).ok();
    column.is_some_and(|column| row.is_some_and(|row| row.get(column) == Some(&true)))
}

fn blank(mask: &Mask) -> Mask {
    vec![vec![false; mask[0].len()]; mask.len()]
}

fn taxels(mask: &Mask) -> Vec<(usize, usize)> {
    let row = |(j, row): (usize, &Vec<bool>)| {
        let active = row.iter().enumerate().filter(|&(_, &active)| active);
        active.map(move |(i, _)| (i, j)).collect::<Vec<_>>()
    };
    mask.iter().enumerate().flat_map(row).collect()
}

/// Removes the component that contains a taxel from `mask` and returns its taxels. Every `stride`-th neighbour counts:
/// 1 means all eight, 2 the four that share a side.
fn take_component(mask: &mut Mask, start: (usize, usize), stride: usize) -> Vec<(usize, usize)> {
    let mut found = vec![start];
    mask[start.1][start.0] = false;
    let mut visited = 0;
    while let Some(&(column, row)) = found.get(visited) {
        visited += 1;
        for (dx, dy) in AROUND.iter().step_by(stride) {
            let (x, y) = (
                column.wrapping_add_signed(*dx),
                row.wrapping_add_signed(*dy),
            );
            if x < mask[0].len() && y < mask.len() && mask[y][x] {
                mask[y][x] = false;
                found.push((x, y));
            }
        }
    }
    found
}

/// Returns the components of a mask in reading order of their first taxels, the taxels of each in reading order.
fn components(mask: &Mask, stride: usize) -> Vec<Vec<(usize, usize)>> {
    let (mut rest, mut found) = (mask.clone(), Vec::new());
    for (column, row) in taxels(mask) {
        if rest[row][column] {
            let mut piece = take_component(&mut rest, (column, row), stride);
            piece.sort_unstable_by_key(|&(column, row)| (row, column));
            found.push(piece);
        }
    }
    found
}

/// Returns the inactive taxels that are cut off from the outside: the mask gets a rim, which is flooded.
fn enclosed(mask: &Mask) -> Mask {
    let mut open = vec![vec![true; mask[0].len() + 2]; mask.len() + 2];
    for (column, row) in taxels(mask) {
        open[row + 1][column + 1] = false;
    }
    take_component(&mut open, (0, 0), 2);
    // The taxels that the flood did not reach.
    let inner = |row: usize, column: usize| open[row + 1][column + 1];
    (0..mask.len())
        .map(|row| {
            (0..mask[0].len())
                .map(|column| inner(row, column))
                .collect()
        })
        .collect()
}

/// Returns the straight and diagonal steps of the walk around a filled region.
fn walk(filled: &Mask) -> (u32, u32) {
    let signed = |value: usize| isize::try_from(value).expect("a small number");
    let start = taxels(filled)[0];
    let start = (signed(start.0), signed(start.1));
    // Nothing is active to the left of the first taxel in reading order, so the search begins there.
    let next = |(column, row): (isize, isize), from: usize| {
        (0..8).map(|turn| (from + turn) % 8).find(|&direction| {
            let (dx, dy) = AROUND[direction];
            at(filled, column + dx, row + dy)
        })
    };
    let Some(first) = next(start, 0) else {
        return (0, 0);
    };
    let (mut here, mut direction) = (start, first);
    let (mut straight, mut diagonal) = (0, 0);
    loop {
        let (dx, dy) = AROUND[direction];
        here = (here.0 + dx, here.1 + dy);
        if direction % 2 == 0 {
            straight += 1;
        } else {
            diagonal += 1;
        }
        // Turns back to the last inactive taxel that was examined, as seen from the new place.
        let from = (direction + if direction % 2 == 0 { 6 } else { 5 }) % 8;
        direction = next(here, from).expect("at least the way back");
        if here == start && direction == first {
            return (straight, diagonal);
        }
    }
}

/// A region as the simple implementation describes it.
struct Plain {
    kind: RegionKind,
    taxels: Vec<(usize, usize)>,
    filled: Vec<(usize, usize)>,
    nae: u32,
    values: Vec<(&'static str, Value)>,
}

fn count(value: usize) -> u32 {
    u32::try_from(value).expect("at most 4096")
}

fn plain_region(kind: RegionKind, own: &[(usize, usize)]) -> Plain {
    let number = |value: usize| f64::from(count(value));
    let sum =
        |of: fn(&(usize, usize)) -> usize| own.iter().map(|t| number(of(t)) + 0.5).sum::<f64>();
    let least = |of: fn(&(usize, usize)) -> usize| own.iter().map(of).min().expect("not empty");
    let most = |of: fn(&(usize, usize)) -> usize| own.iter().map(of).max().expect("not empty") + 1;
    let (left, top, right, bottom) = (least(|t| t.0), least(|t| t.1), most(|t| t.0), most(|t| t.1));
    // The region is filled within its own bounds: in a mask of the whole matrix, a small region would take too much
    // time.
    let mut filled = vec![vec![false; right - left]; bottom - top];
    for (column, row) in own {
        filled[row - top][column - left] = true;
    }
    for (column, row) in taxels(&enclosed(&filled)) {
        filled[row][column] = true;
    }
    let all = taxels(&filled);
    let (width, height) = (number(right - left), number(bottom - top));
    let open = |&&(column, row): &&(usize, usize)| {
        let (x, y) = (column.cast_signed(), row.cast_signed());
        AROUND
            .iter()
            .step_by(2)
            .any(|(dx, dy)| !at(&filled, x + dx, y + dy))
    };
    let (straight, diagonal) = walk(&filled);
    let p = f64::from(straight) + f64::from(diagonal) * SQRT_2;
    let (na, nae) = (number(own.len()), number(all.len()));
    let (num_x, num_y) = (sum(|t| t.0), sum(|t| t.1));
    let cg = glam::DVec2::new(num_x / na, num_y / na);
    let cd = glam::DVec2::new(number(left + right) / 2.0, number(top + bottom) / 2.0);
    let way = cd - cg;
    let distance = (way.x * way.x + way.y * way.y).sqrt();
    // The sign is changed by a rule, not by negating y, so that a horizontal direction is 0 or 180, never -0 or -180.
    let steep = if way.y == 0.0 { 0.0 } else { -way.y };
    let flat = (height / width).atan() * 180.0 / PI;
    let existing = |exists: bool, value: f64| {
        if exists {
            Value::Number(value)
        } else {
            Value::None
        }
    };
    let side = |value: usize| u8::try_from(value).expect("at most 64");
    let rect = taxel_core::imprint::Bounds {
        left: side(left),
        top: side(top),
        right: side(right),
        bottom: side(bottom),
    };
    let values = vec![
        ("na", Value::Count(count(own.len()))),
        ("nae", Value::Count(count(all.len()))),
        ("ce", Value::Count(count(all.iter().filter(open).count()))),
        ("num_x", Value::Number(num_x)),
        ("num_y", Value::Number(num_y)),
        ("cg", Value::Point(cg)),
        ("p", Value::Number(p)),
        ("f", Value::Number(p * p / nae)),
        ("roundness", existing(p > 0.0, 4.0 * PI * nae / (p * p))),
        ("rect", Value::Rect(rect)),
        ("cd", Value::Point(cd)),
        ("area", Value::Count(count((right - left) * (bottom - top)))),
        ("diagonals", Value::Pair([flat, 180.0 - flat])),
        (
            "side_ratio",
            Value::Number(width.max(height) / width.min(height)),
        ),
        ("filling", Value::Number(na / (width * height))),
        ("cg_cd", Value::Number(distance)),
        (
            "cg_cd_direction",
            existing(distance >= 1e-9, steep.atan2(way.x) * 180.0 / PI),
        ),
    ];
    Plain {
        kind,
        nae: count(all.len()),
        taxels: own.to_vec(),
        filled: all
            .iter()
            .map(|(column, row)| (column + left, row + top))
            .collect(),
        values,
    }
}

fn alike(found: Value, expected: Value) -> bool {
    let near = |a: f64, b: f64| (a - b).abs() < 1e-9;
    match (found, expected) {
        (Value::Number(a), Value::Number(b)) => near(a, b),
        (Value::Point(a), Value::Point(b)) => near(a.x, b.x) && near(a.y, b.y),
        (Value::Pair(a), Value::Pair(b)) => near(a[0], b[0]) && near(a[1], b[1]),
        (a, b) => a == b,
    }
}

fn mask(imprint: &Imprint) -> Mask {
    let row = |j: u8| (0..imprint.columns()).map(|i| imprint.get(i, j)).collect();
    (0..imprint.rows()).map(row).collect()
}

/// Returns the rows of an imprint as words. There can be a thousand regions, and a mask of each would take most of the
/// time.
fn words(taxels: &[(usize, usize)], rows: usize) -> Vec<u64> {
    let mut words = vec![0; rows];
    for &(column, row) in taxels {
        words[row] |= 1 << column;
    }
    words
}

/// Compares all values of an imprint, and returns the number of regions.
fn compare(imprint: &Imprint) -> usize {
    let active_mask = mask(imprint);
    let holes = enclosed(&active_mask);
    let pieces = components(&active_mask, 1);
    let exteriors = pieces
        .iter()
        .map(|piece| plain_region(RegionKind::Exterior, piece));
    let expected: Vec<Plain> = exteriors
        .chain(
            components(&holes, 2)
                .iter()
                .map(|hole| plain_region(RegionKind::Hole, hole)),
        )
        .collect();

    let found = regions(imprint);
    assert_eq!(found.len(), expected.len(), "{imprint}");
    let (mut active, mut inactive) = (0, 0);
    for (region, plain) in found.iter().zip(&expected) {
        assert_eq!(region.kind(), plain.kind, "{imprint}");
        let words = |taxels: &[(usize, usize)]| words(taxels, usize::from(imprint.rows()));
        let (own, filled) = (words(&plain.taxels), words(&plain.filled));
        assert_eq!(region.taxels().words(), own, "{region:?}\n{imprint}");
        assert_eq!(region.filled().words(), filled, "{region:?}\n{imprint}");
        let description = Description::of(region);
        for descriptor in DESCRIPTORS {
            let expected = plain.values.iter().find(|(key, _)| *key == descriptor.key);
            let (key, expected) = *expected.expect("a descriptor that this test knows");
            let value = (descriptor.measure)(&description);
            assert!(
                alike(value, expected),
                "{key}: {value:?}, expected {expected:?}\n{region:?}\n{imprint}"
            );
        }
        match plain.kind {
            RegionKind::Exterior => active += region.taxels().count(),
            RegionKind::Hole => inactive += region.taxels().count(),
        }
    }
    // Every taxel is in exactly one exterior, in exactly one hole, or outside.
    let outside = taxels(&enclosed_or(&active_mask, &holes)).len();
    assert_eq!(active, imprint.count(), "{imprint}");
    assert_eq!(
        active + inactive + count(outside),
        u32::from(imprint.columns()) * u32::from(imprint.rows()),
        "{imprint}"
    );
    let most = expected
        .iter()
        .filter(|plain| plain.kind == RegionKind::Exterior)
        .map(|plain| plain.nae)
        .max();
    let main = expected
        .iter()
        .position(|plain| plain.kind == RegionKind::Exterior && Some(plain.nae) == most);
    assert_eq!(main_region(&found), main, "{imprint}");
    found.len()
}

/// Returns the taxels that are neither active nor in a hole.
fn enclosed_or(mask: &Mask, holes: &Mask) -> Mask {
    let mut outside = blank(mask);
    for (row, line) in outside.iter_mut().enumerate() {
        for (column, open) in line.iter_mut().enumerate() {
            *open = !mask[row][column] && !holes[row][column];
        }
    }
    outside
}

fn drawn_size(random: &mut Random) -> Imprint {
    match random.whole(0, 999) {
        0..=19 => Imprint::empty(size(1, 1)),
        20..=39 => Imprint::empty(size(1, 64)),
        40..=59 => Imprint::empty(size(64, 1)),
        60..=64 => Imprint::empty(size(64, 64)),
        65..=79 => Imprint::empty(size(random.side(1, 64), random.side(1, 64))),
        _ => Imprint::empty(size(random.side(1, 14), random.side(1, 14))),
    }
}

#[test]
fn random_noise_agrees() {
    let mut random = Random::new(11);
    let mut found = 0;
    for _ in 0..70_000 {
        let mut imprint = drawn_size(&mut random);
        let density = u64::from(random.side(1, 49)) * 20;
        for row in 0..imprint.rows() {
            for column in 0..imprint.columns() {
                imprint.set(column, row, random.chance(density));
            }
        }
        found += compare(&imprint);
    }
    println!("{found} regions");
    assert!(found > 400_000, "too few regions to compare");
}

#[test]
fn random_blobs_agree() {
    let mut random = Random::new(12);
    for _ in 0..40_000 {
        let mut imprint = drawn_size(&mut random);
        let (columns, rows) = (imprint.columns(), imprint.rows());
        // Draws and removes rectangles, then draws a walk that may be one taxel wide.
        for _ in 0..random.whole(0, 4) {
            let (left, top) = (random.side(0, columns - 1), random.side(0, rows - 1));
            let (right, bottom) = (random.side(left, columns - 1), random.side(top, rows - 1));
            let active = random.chance(700);
            (top..=bottom).for_each(|j| (left..=right).for_each(|i| imprint.set(i, j, active)));
        }
        let (mut column, mut row) = (random.side(0, columns - 1), random.side(0, rows - 1));
        for _ in 0..random.whole(0, 60) {
            imprint.set(column, row, true);
            let step = |value: u8, side: u8, random: &mut Random| {
                (value + random.side(0, 2)).saturating_sub(1).min(side - 1)
            };
            (column, row) = (
                step(column, columns, &mut random),
                step(row, rows, &mut random),
            );
        }
        compare(&imprint);
    }
}

#[test]
fn matrices_of_all_sizes_agree() {
    let mut random = Random::new(13);
    for columns in 1..=64 {
        for rows in 1..=64 {
            let mut imprint = Imprint::empty(size(columns, rows));
            let density = u64::from(random.side(1, 49)) * 20;
            for row in 0..rows {
                for column in 0..columns {
                    imprint.set(column, row, random.chance(density));
                }
            }
            // A broken frame around the noise makes regions within regions.
            for column in 0..columns {
                imprint.set(column, 0, random.chance(900));
                imprint.set(column, rows - 1, random.chance(900));
            }
            for row in 0..rows {
                imprint.set(0, row, random.chance(900));
                imprint.set(columns - 1, row, random.chance(900));
            }
            compare(&imprint);
        }
    }
}

#[test]
fn spirals_checkerboards_and_combs_agree() {
    for side in 1..=64_u8 {
        let checkerboard = |i: u8, j: u8| (i + j).is_multiple_of(2);
        let comb = |i: u8, j: u8| i.is_multiple_of(2) || j == 0;
        let ring = |i: u8, j: u8| i.min(j).min(side - 1 - i).min(side - 1 - j);
        let rings = |i: u8, j: u8| ring(i, j).is_multiple_of(2);
        // The rings joined into one arm: each ring except the last opens where the next one begins.
        let spiral = |i: u8, j: u8| {
            let ring = ring(i, j);
            let gap = i == ring && j == ring + 1 && rings(i, j);
            let bridge = ring % 2 == 1 && j == ring + 1 && i == ring;
            (rings(i, j) && !gap) || bridge
        };
        let grate = |i: u8, j: u8| i % 3 != 1 || j % 3 != 1;
        let patterns: [&dyn Fn(u8, u8) -> bool; 5] =
            [&checkerboard, &comb, &rings, &spiral, &grate];
        for pattern in patterns {
            for turned in [false, true] {
                let mut imprint = Imprint::empty(size(side, side));
                for row in 0..side {
                    for column in 0..side {
                        let (i, j) = if turned {
                            (side - 1 - row, column)
                        } else {
                            (column, row)
                        };
                        imprint.set(column, row, pattern(i, j));
                    }
                }
                compare(&imprint);
            }
        }
    }
}
