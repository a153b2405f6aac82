//! Sweeps: identical to touching pose by pose, whatever the threads and the shards, and summed up as they should be.

#![expect(clippy::cast_precision_loss, reason = "numbers of poses in a test")]

mod cases;

use std::collections::HashMap;
use std::sync::atomic::{AtomicU64, Ordering};

use cases::{cases, differences, figure, picture};
use taxel::description::descriptor::Description;
use taxel::description::region::{main_region, regions};
use taxel::figure::Kind;
use taxel::imprint::Imprint;
use taxel::sensor::Sensor;
use taxel::source::Source;
use taxel::sweep::grid::{Anchor, Grid, Ranges};
use taxel::sweep::plan::Shard;
use taxel::sweep::quantity::{quantities, values};
use taxel::sweep::range::{DecimalRange, MAX_VALUES};
use taxel::sweep::survey::{MergeError, Survey, Watch};
use taxel::touch::Plane;

fn sweep(grid: &Grid) -> Survey {
    Survey::of(grid, Shard::WHOLE, Watch::nothing())
}

fn small(source: Source, place: &str, angles: &str) -> Grid {
    let read = |text: &str| text.parse().expect("a range");
    let ranges = Ranges {
        x0: read(place),
        y0: read(place),
        angle: read(angles),
        ..Ranges::default()
    };
    Grid::new(source, Sensor::default(), Anchor::Corner, ranges).expect("a grid")
}

#[test]
fn sweeps_equal_touches_at_all_sorts_of_angles() {
    for case in cases() {
        let grid = case.grid("0:359:15", 5);
        assert_eq!(differences(&grid), Ok(0), "{}", case.name);
        let grid = case.grid("1.37:359:61.03", 9);
        assert_eq!(differences(&grid), Ok(0), "{}", case.name);
    }
}

#[test]
fn sweeps_equal_touches_at_every_step_of_a_cell() {
    for case in cases().iter().step_by(4) {
        assert_eq!(
            differences(&case.grid("0:90:30", 1)),
            Ok(0),
            "{}",
            case.name
        );
    }
}

#[test]
fn nearly_upright_edges_do_no_harm() {
    for source in [
        figure(Kind::Rectangle, 6.0, 3.0, 0.5),
        figure(Kind::Ellipse, 5.0, 3.0, 1.0),
    ] {
        for angles in [
            "0.000000001",
            "0.00001:0.00003:0.00001",
            "89.9999",
            "90.001:90.003:0.001",
        ] {
            let grid = small(source.clone(), "5:5.99:0.05", angles);
            assert_eq!(differences(&grid), Ok(0), "{angles}");
        }
    }
}

#[test]
fn steps_may_be_finer_than_the_crossings_are_sharp() {
    let grid = small(
        figure(Kind::Hexagon, 3.0, 0.0, 1.0),
        "5.49999:5.50001:0.0000005",
        "0:30:30",
    );
    assert_eq!(differences(&grid), Ok(0));
    let grid = small(
        figure(Kind::Rectangle, 3.0, 2.0, 0.0),
        "5.4999999999:5.5:0.000000000005",
        "0",
    );
    assert_eq!(differences(&grid), Ok(0));
}

/// All that can be said of a survey, in one text.
fn told(survey: &Survey) -> String {
    let entries: Vec<_> = survey.atlas.entries().collect();
    let Survey {
        poses,
        partly_off,
        statistics,
        ..
    } = survey;
    format!(
        "{poses} {partly_off} {:?} {entries:?} {statistics:?}",
        survey.atlas.distinct_classes()
    )
}

#[test]
fn threads_and_shards_do_not_matter() {
    let zoomed = cases().into_iter().find(|case| case.zoom.contains(':'));
    let grids = [
        small(
            figure(Kind::Hexagon, 3.0, 0.0, 1.0),
            "5:5.99:0.03",
            "0:359:5",
        ),
        small(
            figure(Kind::Ellipse, 5.0, 3.0, 1.0),
            "5:5.99:0.05",
            "0:200:10",
        ),
        small(figure(Kind::Ellipse, 4.0, 4.0, 2.0), "-3:14:0.25", "0:3:1"),
        zoomed.expect("a case with zooms").grid("0:359:40", 5),
    ];
    for grid in grids {
        let threads = |count| {
            let pool = rayon::ThreadPoolBuilder::new().num_threads(count).build();
            pool.expect("a pool").install(|| sweep(&grid))
        };
        let whole = told(&threads(1));
        assert_eq!(told(&threads(2)), whole);
        assert_eq!(told(&threads(5)), whole);
        for of in [1, 2, 3, 7, 40] {
            let shards = (1..=of).map(|number| {
                let shard = Shard::new(number, of).expect("a shard");
                Survey::of(&grid, shard, Watch::nothing())
            });
            let merged = Survey::merge(shards.collect::<Vec<_>>().into_iter().rev());
            assert_eq!(told(&merged.expect("all shards")), whole, "{of} shards");
        }
    }
}

/// Shards of one row each have no other row that one could be the image of.
#[test]
fn rows_that_are_images_equal_those_gone_through() {
    let centred = |source, place: &str, angles: &str| {
        let read = |text: &str| text.parse().expect("a range");
        let ranges = Ranges {
            x0: read(place),
            y0: read("7.04:8.03:0.03"),
            angle: read(angles),
            ..Ranges::default()
        };
        Grid::new(source, Sensor::default(), Anchor::Centre, ranges).expect("a grid")
    };
    let tie = figure(Kind::Rectangle, 4.5, 2.5, 0.5);
    for grid in [
        small(
            figure(Kind::Rectangle, 6.0, 3.0, 0.0),
            "5:5.99:0.05",
            "0:90:7.5",
        ),
        small(tie.clone(), "4:5.98:0.02", "0:180:45"),
        small(
            figure(Kind::Rectangle, 3.3, 3.3, 0.7),
            "5.05:6.04:0.05",
            "0:180:15",
        ),
        small(
            figure(Kind::Ellipse, 5.0, 3.0, 1.0),
            "2.5:3.49:0.05",
            "0:90:30",
        ),
        small(picture("##.# .##. #.##"), "5:5.99:0.05", "0:180:45"),
        centred(
            figure(Kind::Hexagon, 3.0, 0.0, 1.0),
            "7:7.99:0.03",
            "0:59:10",
        ),
        centred(
            figure(Kind::Octagon, 2.0, 0.0, 0.5),
            "7.25:8.2:0.05",
            "0:44:9",
        ),
        // At the rim of the sensor at some angles and beyond it at others: no images there.
        small(tie, "0.5:1.48:0.02", "0:45:15"),
    ] {
        let whole = sweep(&grid);
        let rows = u32::try_from(grid.rows()).expect("a small grid");
        let one_by_one = (1..=rows).map(|number| {
            let row = Shard::new(number, rows).expect("a shard");
            Survey::of(&grid, row, Watch::nothing())
        });
        let merged = Survey::merge(one_by_one).expect("all shards");
        assert_eq!(told(&whole), told(&merged), "{:?}", grid.source());
        assert_eq!(differences(&grid), Ok(0), "{:?}", grid.source());
        assert!(whole.atlas.len() > 50, "{:?}", grid.source());
    }
}

#[test]
fn shards_are_merged_only_if_all_are_there() {
    let grid = small(
        figure(Kind::Triangle, 6.0, 0.0, 0.0),
        "5:5.9:0.1",
        "0:40:10",
    );
    let shard = |grid: &Grid, number, of| {
        Survey::of(
            grid,
            Shard::new(number, of).expect("a shard"),
            Watch::nothing(),
        )
    };
    let merge = |surveys: Vec<Survey>| Survey::merge(surveys).map(|survey| survey.poses);
    assert_eq!(merge(vec![]), Err(MergeError::Nothing));
    assert_eq!(
        merge(vec![shard(&grid, 1, 3), shard(&grid, 2, 3)]),
        Err(MergeError::Missing { number: 3, of: 3 })
    );
    let twice = Shard::new(1, 2).expect("a shard");
    assert_eq!(
        merge(vec![shard(&grid, 1, 2), shard(&grid, 1, 2)]),
        Err(MergeError::Count { shard: twice })
    );
    let other = small(
        figure(Kind::Triangle, 6.1, 0.0, 0.0),
        "5:5.9:0.1",
        "0:40:10",
    );
    let foreign = Shard::new(2, 2).expect("a shard");
    assert_eq!(
        merge(vec![shard(&grid, 1, 2), shard(&other, 2, 2)]),
        Err(MergeError::Foreign { shard: foreign })
    );
}

#[test]
fn a_stopped_sweep_keeps_what_is_complete() {
    let grid = small(
        figure(Kind::Heptagon, 3.0, 0.0, 1.0),
        "5:5.99:0.01",
        "0:100:1",
    );
    let pool = rayon::ThreadPoolBuilder::new().num_threads(1).build();
    let pool = pool.expect("a pool");
    let done = AtomicU64::new(0);
    let stopped_after = |most: u64| {
        done.store(0, Ordering::Relaxed);
        let enough = |poses| done.fetch_add(poses, Ordering::Relaxed) + poses < most;
        let watch = Watch {
            progress: &enough,
            rows: None,
        };
        pool.install(|| Survey::of(&grid, Shard::WHOLE, watch))
    };
    let survey = stopped_after(500_000);
    assert!(!survey.complete());
    assert_eq!(done.load(Ordering::Relaxed), 500_000);
    // Whole turns, and at most the last sixteen of them are lost.
    assert!((340_000..500_000).contains(&survey.poses) && survey.poses % 10_000 == 0);
    assert_eq!(
        survey.atlas.entries().map(|entry| entry.count).sum::<u64>(),
        survey.poses
    );
    assert!(survey.statistics[0].poses == survey.poses && survey.statistics[0].sd_angle.is_some());
    let incomplete = MergeError::Incomplete {
        shard: Shard::WHOLE,
    };
    assert_eq!(Survey::merge([survey]).err(), Some(incomplete));
    // Not even a turn is waited for.
    let survey = stopped_after(1);
    assert_eq!((survey.poses, survey.atlas.len()), (0, 0));
    assert!(done.load(Ordering::Relaxed) <= 5_000);
}

/// Sum of squares about the mean over the number.
fn variance(values: &[f64]) -> f64 {
    let count = values.len() as f64;
    let mean = values.iter().sum::<f64>() / count;
    values
        .iter()
        .map(|value| (value - mean).powi(2))
        .sum::<f64>()
        / count
}

/// Length of the mean unit vector, and its direction in degrees.
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
        figure(Kind::Triangle, 5.3, 0.0, 0.9),
        figure(Kind::Rectangle, 1.3, 0.6, 0.0),
        picture("##.# .### ##.. #..#"),
    ] {
        let grid = small(source, "4:5.4:0.07", "3:351:29");
        let survey = sweep(&grid);
        let mut plane = Plane::new(*grid.sensor());
        let mut turns: Vec<Vec<Vec<f64>>> = Vec::new();
        let turn = grid.ranges().x0.count() * grid.ranges().y0.count();
        for number in 0..grid.poses() {
            if number % turn == 0 {
                turns.push(vec![Vec::new(); quantities().len()]);
            }
            let regions = regions(&plane.touch(&grid.placed(grid.pose(number))));
            let Some(main) = main_region(&regions) else {
                continue;
            };
            let description = Description::of(&regions[main]);
            let lists = turns.last_mut().expect("a turn");
            values(&description, |index, value| lists[index].push(value));
        }
        for (index, statistic) in survey.statistics.iter().enumerate() {
            let key = &statistic.quantity.key;
            let by_turn: Vec<&[f64]> = turns.iter().map(|lists| &lists[index][..]).collect();
            let all = by_turn.concat();
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
                let sum = by_turn.iter().filter(|turn| !turn.is_empty());
                sum.map(|turn| of(turn) * turn.len() as f64).sum::<f64>() / all.len() as f64
            };
            if statistic.quantity.circular {
                let (length, direction) = resultant(&all);
                let turns = weighted(&|turn| resultant(turn).0);
                near(statistic.mean, direction, "mean");
                near(statistic.sd, deviation(length), "sd");
                near(statistic.sd_position, deviation(turns), "position");
                near(statistic.sd_angle, deviation(length / turns), "angle");
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
            let of_turn =
                |turn: &[f64]| (turn.iter().sum::<f64>() / turn.len() as f64 - mean).powi(2);
            near(statistic.sd_angle, weighted(&of_turn).sqrt(), "angle");
        }
    }
}

#[test]
fn ideal_values_are_those_of_the_continuous_figure() {
    let ideal = |source, key: &str| {
        let survey = sweep(&small(source, "4", "0"));
        let found = survey
            .statistics
            .iter()
            .find(|statistic| statistic.quantity.key == key);
        found.expect("a quantity").ideal
    };
    let near = |found: Option<f64>, expected: f64| {
        assert!(
            (found.expect("an ideal value") - expected).abs() < 1e-9,
            "{found:?}, {expected}"
        );
    };
    let frame = || figure(Kind::Rectangle, 6.0, 3.0, 1.0);
    near(ideal(frame(), "na"), 14.0);
    near(ideal(frame(), "nae"), 18.0);
    near(ideal(frame(), "p"), 18.0);
    near(ideal(frame(), "f"), 18.0);
    near(
        ideal(figure(Kind::Hexagon, 2.0, 0.0, 0.0), "na"),
        6.0 * 3_f64.sqrt(),
    );
    near(
        ideal(figure(Kind::Ellipse, 4.0, 4.0, 2.0), "na"),
        12.0 * std::f64::consts::PI,
    );
    near(
        ideal(figure(Kind::Ellipse, 4.0, 4.0, 2.0), "roundness"),
        1.0,
    );
    // The complete elliptic integral of the second kind, from tables: 4·5·E(1 − 9/25).
    near(
        ideal(figure(Kind::Ellipse, 5.0, 3.0, 0.0), "p"),
        25.526_998_863_398_1,
    );
    assert_eq!(ideal(frame(), "ce"), None);
    assert_eq!(ideal(picture("##"), "na"), None);
}

type Map = fn((i32, i32)) -> (i32, i32);

/// The eight images of a set of taxels, each moved to the top left corner.
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
fn classes_equal_those_of_all_images_written_out() {
    for (source, place) in [
        (figure(Kind::Rectangle, 3.0, 2.0, 0.0), "3:7.9:0.31"),
        (picture("##.# .###"), "-3:15:0.9"),
    ] {
        let survey = sweep(&small(source, place, "0:359:7"));
        let mut shifted = HashMap::new();
        let mut symmetric = HashMap::new();
        for entry in survey.atlas.entries() {
            let images = images(&entry.imprint);
            *shifted.entry(images[0].clone()).or_insert(0) += 1;
            *symmetric.entry(images.into_iter().min()).or_insert(0) += 1;
            assert_eq!(survey.atlas.find(&entry.imprint), Some(entry.id));
        }
        assert_eq!(
            survey.atlas.distinct_classes(),
            (shifted.len(), symmetric.len())
        );
        assert!(symmetric.len() < shifted.len() && shifted.len() < survey.atlas.len());
    }
}

#[test]
fn the_paper_s_ring_has_393_imprints() {
    let survey = sweep(&small(
        figure(Kind::Ellipse, 4.0, 4.0, 2.0),
        "1:1.99:0.01",
        "0:359:1",
    ));
    assert_eq!((survey.poses, survey.atlas.len()), (3_600_000, 393));
}

#[test]
fn ranges_are_exact_or_refused() {
    let range = |text: &str| text.parse::<DecimalRange>();
    let values = |text: &str| range(text).expect("a range").values().collect::<Vec<_>>();
    assert_eq!(values("0:0.3:0.1"), [0.0, 0.1, 0.2, 0.3]);
    assert_eq!(values("-0.02:0.02:0.01"), [-0.02, -0.01, 0.0, 0.01, 0.02]);
    assert_eq!(values("1:2:0.3"), [1.0, 1.3, 1.6, 1.9]);
    assert_eq!(values(" 7.50 "), [7.5]);
    assert_eq!(values("3:3:1"), [3.0]);
    let hundredths = range("5:5.99:0.01").expect("a range");
    for (index, value) in (500..600).zip(hundredths.values()) {
        assert_eq!(
            value,
            format!("{}.{:02}", index / 100, index % 100)
                .parse::<f64>()
                .expect("a number")
        );
    }
    let refused = |text: &str| range(text).expect_err("no range").to_string();
    assert_eq!(
        refused("1:2:0.00"),
        "step 0 leads nowhere, expected one above 0"
    );
    assert!(refused("2:1:0.1").starts_with("2:1:0.1 ends before it starts"));
    assert!(refused("1:2:-0.1").contains("a step above 0"));
    assert_eq!(
        refused("1:2"),
        "\"1:2\" is no range, expected a number or start:end:step"
    );
    assert!(refused("1:2:x").starts_with("\"x\" is not a decimal number"));
    assert!(refused("1e5").starts_with("\"1e5\" is not"));
    for odd in [
        "",
        ":",
        "::",
        ".",
        "-",
        "1:2:3:4",
        "0.0000000000001",
        "99999999999999999999",
        "NaN",
        "+-1",
    ] {
        assert!(range(odd).is_err(), "{odd}");
    }
    assert_eq!(
        refused("0:10:0.000001"),
        format!("10000001 values, expected at most {MAX_VALUES}")
    );
}

#[test]
fn grids_are_in_range_or_refused() {
    let grid = |source, ranges| {
        Grid::new(source, Sensor::default(), Anchor::Corner, ranges).map(|grid| grid.poses())
    };
    let read = |text: &str| text.parse().expect("a range");
    let paper = Ranges::default();
    let ring = || figure(Kind::Ellipse, 4.0, 4.0, 2.0);
    assert_eq!(grid(ring(), paper), Ok(3_600_000));
    let far = Ranges {
        x0: read("10:17:1"),
        ..paper
    };
    assert_eq!(
        grid(ring(), far).expect_err("no grid").to_string(),
        "x0: 17 is out of range, expected -16 to 16"
    );
    let round = Ranges {
        angle: read("0:360:1"),
        ..paper
    };
    assert!(
        grid(ring(), round)
            .expect_err("no grid")
            .to_string()
            .starts_with("angle: 360 is out of range")
    );
    let zoomed = Ranges {
        zoom_x: read("1:2:0.5"),
        ..paper
    };
    assert_eq!(
        grid(ring(), zoomed).expect_err("no grid").to_string(),
        "zoom_x, zoom_y: a figure has none, only pictures have"
    );
    assert_eq!(grid(picture("##"), zoomed), Ok(3 * 3_600_000));
    let fine = read("0:0.999999:0.000001");
    let many = Ranges {
        x0: fine,
        y0: fine,
        ..paper
    };
    assert_eq!(
        grid(ring(), many).expect_err("no grid").to_string(),
        "360000000000000 poses, expected at most 1000000000000"
    );
}
