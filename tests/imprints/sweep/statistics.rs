//! The statistics of a sweep, compared with a plain loop over all its poses; ideal values; classes of imprints.

use std::collections::HashMap;

use taxel_core::atlas::{feature_values, features};
use taxel_core::description::{Description, main_region, regions};
use taxel_core::figure::FigureKind;
use taxel_core::imprint::Imprint;
use taxel_core::touch::Plane;

use super::cases::{figure, picture};
use super::{small, sweep};

/// Returns the sum of squares about the mean, divided by the number of values.
fn variance(values: &[f64]) -> f64 {
    let count = values.len() as f64;
    let mean = values.iter().sum::<f64>() / count;
    values
        .iter()
        .map(|value| (value - mean).powi(2))
        .sum::<f64>()
        / count
}

/// Returns the length of the mean unit vector, and its direction in degrees.
fn resultant(degrees: &[f64]) -> (f64, f64) {
    let mean = |part: fn(f64) -> f64| {
        degrees
            .iter()
            .map(|angle| part(angle.to_radians()))
            .sum::<f64>()
            / degrees.len() as f64
    };
    let (x, y) = (mean(f64::cos), mean(f64::sin));
    (x.hypot(y), y.atan2(x).to_degrees())
}

fn deviation(length: f64) -> f64 {
    (-2.0 * length.ln()).sqrt().to_degrees()
}

#[test]
fn statistics_equal_those_of_a_plain_loop() {
    for source in [
        figure(FigureKind::Triangle, 5.3, 0.0, 0.9),
        figure(FigureKind::Rectangle, 1.3, 0.6, 0.0),
        picture("##.# .### ##.. #..#"),
    ] {
        let grid = small(source, "4:5.4:0.07", "3:351:29");
        let result = sweep(&grid);
        let mut plane = Plane::new(*grid.sensor());
        let mut orientations: Vec<Vec<Vec<f64>>> = Vec::new();
        let poses = grid.row_length() * grid.rows_per_orientation();
        for number in 0..grid.poses() {
            if number % poses == 0 {
                orientations.push(vec![Vec::new(); features().len()]);
            }
            let regions = regions(&plane.touch(&grid.placed(number)));
            let Some(main) = main_region(&regions) else {
                continue;
            };
            let description = Description::of(&regions[main]);
            let lists = orientations.last_mut().expect("an orientation");
            feature_values(&description, |index, value| lists[index].push(value));
        }
        for (index, statistic) in result.statistics.iter().enumerate() {
            let key = &statistic.feature.key;
            let by_orientation: Vec<&[f64]> =
                orientations.iter().map(|lists| &lists[index][..]).collect();
            let all = by_orientation.concat();
            assert_eq!(statistic.poses, all.len() as u64, "{key}");
            if all.is_empty() {
                assert!(statistic.mean.is_none() && statistic.sd_angle.is_none());
                continue;
            }
            let near = |found: Option<f64>, expected: f64, what: &str| {
                let found = found.unwrap_or(f64::NAN);
                let error = (found - expected).abs();
                assert!(
                    error < 1e-9 * expected.abs().max(1.0),
                    "{key} {what}: {found}, {expected}"
                );
            };
            let weighted = |of: &dyn Fn(&[f64]) -> f64| {
                let sum = by_orientation
                    .iter()
                    .filter(|orientation| !orientation.is_empty());
                sum.map(|orientation| of(orientation) * orientation.len() as f64)
                    .sum::<f64>()
                    / all.len() as f64
            };
            if statistic.feature.circular {
                let (length, direction) = resultant(&all);
                let within = weighted(&|poses| resultant(poses).0);
                near(statistic.mean, direction, "mean");
                near(statistic.sd, deviation(length), "sd");
                near(statistic.sd_position, deviation(within), "position");
                near(statistic.sd_angle, deviation(length / within), "angle");
                continue;
            }
            let mean = all.iter().sum::<f64>() / all.len() as f64;
            near(
                statistic.min,
                all.iter().copied().fold(f64::INFINITY, f64::min),
                "min",
            );
            near(
                statistic.max,
                all.iter().copied().fold(0.0, f64::max),
                "max",
            );
            near(statistic.mean, mean, "mean");
            near(statistic.sd, variance(&all).sqrt(), "sd");
            if mean == 0.0 {
                assert_eq!(statistic.cv, None, "{key}");
            } else {
                near(statistic.cv, variance(&all).sqrt() / mean, "cv");
            }
            near(
                statistic.sd_position,
                weighted(&variance).sqrt(),
                "position",
            );
            let of_orientation = |orientation: &[f64]| {
                (orientation.iter().sum::<f64>() / orientation.len() as f64 - mean).powi(2)
            };
            near(
                statistic.sd_angle,
                weighted(&of_orientation).sqrt(),
                "angle",
            );
        }
    }
}

#[test]
fn ideal_values_are_those_of_the_continuous_figure() {
    let ideal = |source, key: &str| {
        let result = sweep(&small(source, "4", "0"));
        let found = result
            .statistics
            .iter()
            .find(|statistic| statistic.feature.key == key);
        found.expect("a feature").ideal
    };
    let near = |found: Option<f64>, expected: f64| {
        assert!(
            (found.expect("an ideal value") - expected).abs() < 1e-9,
            "{found:?}, {expected}"
        );
    };
    let frame = || figure(FigureKind::Rectangle, 6.0, 3.0, 1.0);
    near(ideal(frame(), "na"), 14.0);
    near(ideal(frame(), "nae"), 18.0);
    near(ideal(frame(), "p"), 18.0);
    near(ideal(frame(), "f"), 18.0);
    near(
        ideal(figure(FigureKind::Hexagon, 2.0, 0.0, 0.0), "na"),
        6.0 * 3_f64.sqrt(),
    );
    near(
        ideal(figure(FigureKind::Ellipse, 4.0, 4.0, 2.0), "na"),
        12.0 * std::f64::consts::PI,
    );
    near(
        ideal(figure(FigureKind::Ellipse, 4.0, 4.0, 2.0), "roundness"),
        1.0,
    );
    // The complete elliptic integral of the second kind, from tables: 4·5·E(1 − 9/25).
    near(
        ideal(figure(FigureKind::Ellipse, 5.0, 3.0, 0.0), "p"),
        25.526_998_863_398_1,
    );
    assert_eq!(ideal(frame(), "ce"), None);
    assert_eq!(ideal(picture("##"), "na"), None);
}

type Map = fn((i32, i32)) -> (i32, i32);

/// Returns the eight symmetric images of a set of taxels, each moved to the top left corner.
fn images(imprint: &Imprint) -> [Vec<(i32, i32)>; 8] {
    let taxels: Vec<(i32, i32)> = imprint
        .active()
        .map(|(x, y)| (i32::from(x), i32::from(y)))
        .collect();
    let maps: [Map; 8] = [
        |(x, y)| (x, y),
        |(x, y)| (-x, y),
        |(x, y)| (x, -y),
        |(x, y)| (-x, -y),
        |(x, y)| (y, x),
        |(x, y)| (-y, x),
        |(x, y)| (y, -x),
        |(x, y)| (-y, -x),
    ];
    maps.map(|map| {
        let mut image: Vec<_> = taxels.iter().copied().map(map).collect();
        let left = image.iter().map(|taxel| taxel.0).min().unwrap_or(0);
        let top = image.iter().map(|taxel| taxel.1).min().unwrap_or(0);
        for taxel in &mut image {
            *taxel = (taxel.0 - left, taxel.1 - top);
        }
        image.sort_unstable();
        image
    })
}

#[test]
fn classes_equal_those_from_comparing_all_images() {
    for (source, place) in [
        (figure(FigureKind::Rectangle, 3.0, 2.0, 0.0), "3:7.9:0.31"),
        (picture("##.# .###"), "-3:15:0.9"),
    ] {
        let result = sweep(&small(source, place, "0:359:7"));
        let mut shifted = HashMap::new();
        let mut symmetric = HashMap::new();
        for entry in result.atlas.entries() {
            let images = images(&entry.imprint);
            *shifted.entry(images[0].clone()).or_insert(0) += 1;
            *symmetric.entry(images.into_iter().min()).or_insert(0) += 1;
            assert_eq!(result.atlas.find(&entry.imprint), Some(entry.id));
        }
        let classes = result.atlas.distinct_classes();
        assert_eq!(classes.up_to_shifts, shifted.len());
        assert_eq!(classes.up_to_symmetry, symmetric.len());
        assert!(symmetric.len() < shifted.len() && shifted.len() < result.atlas.len());
    }
}
