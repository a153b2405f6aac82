//! Sweeps equal single touches for any number of threads and shards, and their summaries are correct.

#![expect(clippy::cast_precision_loss, reason = "numbers of poses in a test")]

mod cases;

mod statistics;

mod ranges;

mod reach;

use std::sync::atomic::{AtomicU64, Ordering};

use taxel_core::figure::FigureKind;
use taxel_core::parameter::Parameter;
use taxel_core::pose::{Anchor, Axis, PoseGrid, Ranges};
use taxel_core::progress::stop_if;
use taxel_core::sensor::Sensor;
use taxel_core::source::Source;
use taxel_core::sweep::{MergeError, Shard, Sweep, SweepMerge, SweepResult};

use self::cases::{cases, differences, figure, picture};
use crate::paper::RING_IMPRINTS;

fn sweep(grid: &PoseGrid) -> SweepResult {
    Sweep::new(grid).run()
}

fn small(source: Source, place: &str, angles: &str) -> PoseGrid {
    let read = |text: &str| text.parse().expect("a range");
    let ranges = Ranges::default()
        .with(Axis::X0, read(place))
        .with(Axis::Y0, read(place))
        .with(Axis::Angle, read(angles));
    PoseGrid::new(source, Sensor::default(), Anchor::Corner, ranges).expect("a grid")
}

#[test]
fn sweeps_equal_touches_at_many_angles() {
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
fn sweeps_equal_touches_with_nearly_upright_edges() {
    for source in [
        figure(FigureKind::Rectangle, 6.0, 3.0, 0.5),
        figure(FigureKind::Ellipse, 5.0, 3.0, 1.0),
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
fn sweeps_equal_touches_with_very_fine_steps() {
    let grid = small(
        figure(FigureKind::Hexagon, 3.0, 0.0, 1.0),
        "5.49999:5.50001:0.0000005",
        "0:30:30",
    );
    assert_eq!(differences(&grid), Ok(0));
    let grid = small(
        figure(FigureKind::Rectangle, 3.0, 2.0, 0.0),
        "5.4999999999:5.5:0.000000000005",
        "0",
    );
    assert_eq!(differences(&grid), Ok(0));
}

/// Formats all values of a result as one text.
fn told(result: &SweepResult) -> String {
    let entries: Vec<_> = result.atlas.entries().collect();
    format!(
        "{} {} {:?} {entries:?} {:?}",
        result.poses,
        result.partly_off,
        result.atlas.distinct_classes(),
        result.statistics
    )
}

#[test]
fn the_result_does_not_depend_on_threads_and_shards() {
    let zoomed = cases().into_iter().find(|case| case.zoom.contains(':'));
    let grids = [
        small(
            figure(FigureKind::Hexagon, 3.0, 0.0, 1.0),
            "5:5.99:0.03",
            "0:359:5",
        ),
        small(
            figure(FigureKind::Ellipse, 5.0, 3.0, 1.0),
            "5:5.99:0.05",
            "0:200:10",
        ),
        small(
            figure(FigureKind::Ellipse, 4.0, 4.0, 2.0),
            "-3:14:0.25",
            "0:3:1",
        ),
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
                Sweep::new(&grid).with_shard(shard).run()
            });
            let merged = merge_all(shards).expect("all shards");
            assert_eq!(told(&merged), whole, "{of} shards");
        }
    }
}

/// A shard of one row has no other row of which the row could be the image.
#[test]
fn rows_taken_from_symmetry_equal_computed_rows() {
    let centred = |source, place: &str, angles: &str| {
        let read = |text: &str| text.parse().expect("a range");
        let ranges = Ranges::default()
            .with(Axis::X0, read(place))
            .with(Axis::Y0, read("7.04:8.03:0.03"))
            .with(Axis::Angle, read(angles));
        PoseGrid::new(source, Sensor::default(), Anchor::Centre, ranges).expect("a grid")
    };
    let tie = figure(FigureKind::Rectangle, 4.5, 2.5, 0.5);
    for grid in [
        small(
            figure(FigureKind::Rectangle, 6.0, 3.0, 0.0),
            "5:5.99:0.05",
            "0:90:7.5",
        ),
        small(tie.clone(), "4:5.98:0.02", "0:180:45"),
        small(
            figure(FigureKind::Rectangle, 3.3, 3.3, 0.7),
            "5.05:6.04:0.05",
            "0:180:15",
        ),
        small(
            figure(FigureKind::Ellipse, 5.0, 3.0, 1.0),
            "2.5:3.49:0.05",
            "0:90:30",
        ),
        small(picture("##.# .##. #.##"), "5:5.99:0.05", "0:180:45"),
        centred(
            figure(FigureKind::Hexagon, 3.0, 0.0, 1.0),
            "7:7.99:0.03",
            "0:59:10",
        ),
        centred(
            figure(FigureKind::Octagon, 2.0, 0.0, 0.5),
            "7.25:8.2:0.05",
            "0:44:9",
        ),
        // At some angles at the rim of the sensor, at others beyond it: there are no images then.
        small(tie, "0.5:1.48:0.02", "0:45:15"),
    ] {
        let whole = sweep(&grid);
        let rows = u32::try_from(grid.rows()).expect("a small grid");
        let one_by_one = (1..=rows).map(|number| {
            let row = Shard::new(number, rows).expect("a shard");
            Sweep::new(&grid).with_shard(row).run()
        });
        let merged = merge_all(one_by_one).expect("all shards");
        assert_eq!(told(&whole), told(&merged), "{:?}", grid.source());
        assert_eq!(differences(&grid), Ok(0), "{:?}", grid.source());
        assert!(whole.atlas.len() > 50, "{:?}", grid.source());
    }
}

/// Merges shards in the given order.
fn merge_all(shards: impl IntoIterator<Item = SweepResult>) -> Result<SweepResult, MergeError> {
    let mut merge = SweepMerge::default();
    for shard in shards {
        merge.add(shard)?;
    }
    merge.finish()
}

#[test]
fn shards_are_merged_only_if_all_are_there() {
    let grid = small(
        figure(FigureKind::Triangle, 6.0, 0.0, 0.0),
        "5:5.9:0.1",
        "0:40:10",
    );
    let shard = |grid: &PoseGrid, number, of| {
        Sweep::new(grid)
            .with_shard(Shard::new(number, of).expect("a shard"))
            .run()
    };
    let merge = |results: Vec<SweepResult>| {
        let merged = merge_all(results).map(|result| result.poses);
        merged.map_err(|error| error.to_string())
    };
    let refused = |results: Vec<SweepResult>| merge(results).expect_err("no whole");
    assert_eq!(refused(vec![]), "no shards to merge");
    assert_eq!(
        refused(vec![shard(&grid, 1, 3), shard(&grid, 2, 3)]),
        "shard 3/3 is missing"
    );
    assert_eq!(
        refused(vec![shard(&grid, 1, 3), shard(&grid, 3, 3)]),
        "shard 2/3 is missing"
    );
    // The original place of the shape does not matter.
    let moved = figure(FigureKind::Triangle, 6.0, 0.0, 0.0)
        .with(Parameter::Y0, 2.5, &Sensor::default())
        .and_then(|source| source.with(Parameter::Angle, 77.0, &Sensor::default()));
    let moved = small(moved.expect("in range"), "5:5.9:0.1", "0:40:10");
    assert_eq!(
        merge(vec![shard(&grid, 1, 2), shard(&moved, 2, 2)]),
        Ok(grid.poses())
    );
    let other = small(
        figure(FigureKind::Triangle, 6.1, 0.0, 0.0),
        "5:5.9:0.1",
        "0:40:10",
    );
    // A shard that is refused changes nothing, even if it comes first.
    let mut refused = SweepMerge::default();
    let mut add = |part| refused.add(part).map_err(|error| error.to_string());
    let error = |text: &str| Err(text.to_owned());
    assert_eq!(add(shard(&other, 2, 3)), error("shard 1/3 is missing"));
    assert_eq!(add(shard(&grid, 1, 2)), Ok(()));
    assert_eq!(
        add(shard(&other, 2, 2)),
        error("shard 2/2 differs from the first one in its shape")
    );
    assert_eq!(add(shard(&grid, 1, 2)), error("shard 1/2 is given twice"));
    assert_eq!(add(shard(&grid, 2, 2)), Ok(()));
    let merged = refused.finish().map(|result| told(&result));
    assert_eq!(merged, Ok(told(&sweep(&grid))));
}

#[test]
fn a_stopped_sweep_keeps_what_is_complete() {
    let grid = small(
        figure(FigureKind::Heptagon, 3.0, 0.0, 1.0),
        "5:5.99:0.01",
        "0:100:1",
    );
    let pool = rayon::ThreadPoolBuilder::new().num_threads(1).build();
    let pool = pool.expect("a pool");
    let done = AtomicU64::new(0);
    let stopped_after = |most: u64| {
        done.store(0, Ordering::Relaxed);
        let progress = |poses| stop_if(done.fetch_add(poses, Ordering::Relaxed) + poses >= most);
        pool.install(|| Sweep::new(&grid).with_progress(&progress).run())
    };
    let result = stopped_after(500_000);
    assert!(!result.complete());
    assert_eq!(done.load(Ordering::Relaxed), 500_000);
    // Only whole orientations are kept, and at most the last sixteen of them are lost.
    assert!((340_000..500_000).contains(&result.poses) && result.poses % 10_000 == 0);
    assert_eq!(
        result.atlas.entries().map(|entry| entry.count).sum::<u64>(),
        result.poses
    );
    assert!(result.statistics[0].poses == result.poses && result.statistics[0].sd_angle.is_some());
    let refused = merge_all([result]).expect_err("incomplete");
    assert_eq!(
        refused.to_string(),
        "shard 1/1 was stopped early, run it again"
    );
    // The sweep does not even wait for the end of an orientation.
    let result = stopped_after(1);
    assert_eq!((result.poses, result.atlas.len()), (0, 0));
    assert!(done.load(Ordering::Relaxed) <= 5_000);
}

#[test]
fn the_papers_ring_leaves_the_same_imprints_at_all_angles_as_at_one() {
    let result = sweep(&small(
        figure(FigureKind::Ellipse, 4.0, 4.0, 2.0),
        "1:1.99:0.01",
        "0:359:1",
    ));
    let counts = (result.poses, result.atlas.len());
    assert_eq!(counts, (3_600_000, RING_IMPRINTS));
}
