//! The poses that the sensor cuts off, the default ranges of a sweep, and the smallest sensor that is large enough.

use proptest::prelude::*;
use taxel_core::figure::{Figure, FigureKind};
use taxel_core::geometry::Extent;
use taxel_core::parameter::Parameter;
use taxel_core::picture::Picture;
use taxel_core::pose::{
    Anchor, Axis, DecimalRange, GivenRanges, PoseGrid, Ranges, Reach, SensorSides, default_ranges,
};
use taxel_core::sensor::Sensor;
use taxel_core::source::Source;
use taxel_core::sweep::Sweep;
use taxel_core::touch::reaches_beyond;
use taxel_files::formats::StoredShape;

use super::cases::{self, picture};

/// Counts the poses of a grid that are cut off, one by one.
fn cut_off_one_by_one(grid: &PoseGrid) -> u64 {
    let cut = |&number: &u64| reaches_beyond(&grid.placed(number), grid.sensor());
    (0..grid.poses()).filter(cut).count() as u64
}

fn range(text: &str) -> DecimalRange {
    text.parse().expect("a range")
}

/// Returns the shapes that are shipped with the program, by name: their source, or their imprint as a picture.
fn shipped() -> Vec<(String, Source)> {
    let folder = std::fs::read_dir("library").expect("the folder of the crate");
    let paths = folder.map(|entry| entry.expect("an entry").path());
    let files = paths.filter(|path| path.extension().is_some_and(|end| end == "json"));
    let read = |path: std::path::PathBuf| {
        let text = std::fs::read(&path).expect("a file");
        let shape = StoredShape::read(&text).expect("a shape");
        let picture = || Source::Picture(Picture::at_home(shape.imprint));
        (shape.name.to_string(), shape.source.unwrap_or_else(picture))
    };
    files.map(read).collect()
}

fn hexagon() -> Source {
    cases::figure(FigureKind::Hexagon, 3.0, 0.0, 0.0)
}

fn sensor(side: u8) -> Sensor {
    Sensor::new(side, side).expect("in range")
}

/// Returns a shape of any kind. The sensor is so small that shapes are often cut off.
fn shapes() -> impl Strategy<Value = Source> {
    let kinds = prop::sample::select(FigureKind::ALL.to_vec());
    let figures = (kinds, 5_u32..60, 5_u32..60).prop_map(|(kind, one, other)| {
        let mut sizes = [one, other].map(|size| f64::from(size) / 10.0).into_iter();
        let value = |parameter: Parameter| match parameter {
            Parameter::X0 | Parameter::Y0 | Parameter::Angle => Some(0.0),
            Parameter::Thickness => None,
            _ => sizes.next(),
        };
        Source::Figure(Figure::new(kind, &sensor(12), value).expect("in range"))
    });
    prop_oneof![figures, Just(picture("##.. #... ####")), Just(picture("#")),]
}

proptest! {
    #[test]
    fn the_number_of_cut_off_poses_equals_a_count_one_by_one(
        source in shapes(),
        columns in 1_u8..14,
        rows in 1_u8..14,
        first in prop::array::uniform2(-90_i32..90),
        angle in 0_u32..90,
        zoom in prop::sample::select(vec!["1", "0.5:1.5:0.5"]),
        centred: bool,
    ) {
        let zoom = if source.kind().is_some() { "1" } else { zoom };
        let from = |tenths: i32| {
            let start = f64::from(tenths) / 10.0;
            range(&format!("{start:.1}:{:.1}:0.5", start + 3.0))
        };
        let ranges = Ranges::new([
            from(first[0]),
            from(first[1]),
            range(&format!("{angle}:{}:45", angle + 90)),
            range(zoom),
            range(zoom),
        ]);
        let sensor = Sensor::new(columns, rows).expect("in range");
        let anchor = Anchor::ALL[usize::from(centred)];
        // Positions beyond the range of a small sensor are refused.
        let Ok(grid) = PoseGrid::new(source, sensor, anchor, ranges) else { return Ok(()) };
        let counted = grid.poses_beyond_sensor();
        prop_assert_eq!(counted, cut_off_one_by_one(&grid));
        prop_assert_eq!(counted, Sweep::new(&grid).run().partly_off);
    }

    /// The default ranges cut off no pose of a shape, unless no cell would do.
    #[test]
    fn default_ranges_cut_nothing_off_if_possible(
        source in shapes(),
        columns in 1_u8..20,
        rows in 1_u8..20,
        angles in prop::sample::select(vec!["0", "45", "0:90:10", "10:350:20"]),
        centred: bool,
    ) {
        let sensor = Sensor::new(columns, rows).expect("in range");
        let anchor = Anchor::ALL[usize::from(centred)];
        let given = GivenRanges::default().with(Axis::Angle, Some(range(angles)));
        let ranges = default_ranges(&source, &sensor, anchor, &given).expect("in range");
        let grid = PoseGrid::new(source, sensor, anchor, ranges).expect("in range");
        let reach = grid.reach().expect("it has a boundary");
        let fits = |low: f64, high: f64, side: u8| high - low + 1.0 <= f64::from(side);
        if fits(reach.left, reach.right, columns) && fits(reach.top, reach.bottom, rows) {
            prop_assert_eq!(grid.poses_beyond_sensor(), 0, "{}", ranges[Axis::X0]);
        }
        for axis in [Axis::X0, Axis::Y0] {
            prop_assert_eq!(ranges[axis].count(), 100);
            prop_assert_eq!(ranges[axis].step(), 0.01);
        }
    }
}

#[test]
fn default_ranges_cut_no_shipped_shape_off_that_fits() {
    let mut whole = 0;
    for side in [16, 20, 24] {
        for (name, source) in shipped() {
            for &anchor in Anchor::ALL {
                let given = GivenRanges::default();
                let ranges = default_ranges(&source, &sensor(side), anchor, &given);
                let ranges = ranges.expect("in range");
                let grid = PoseGrid::new(source.clone(), sensor(side), anchor, ranges);
                let grid = grid.expect("in range");
                let reach = grid.reach().expect("it has a boundary");
                let room = f64::from(side) - 0.99;
                let fits = reach.right - reach.left <= room && reach.bottom - reach.top <= room;
                let cut = grid.poses_beyond_sensor();
                assert_eq!(cut == 0, fits, "{name} on {side}: {cut} cut off");
                whole += usize::from(fits);
            }
        }
    }
    assert!(whole > 100, "only {whole} fit");
}

#[test]
fn a_shape_keeps_its_cell_if_nothing_is_cut_off_there() {
    use Parameter::{Length, Width, X0, Y0};
    let own = |source: &Source, anchor, angles: &str| {
        let given = GivenRanges::default().with(Axis::Angle, Some(range(angles)));
        let ranges = default_ranges(source, &sensor(16), anchor, &given).expect("in range");
        [ranges[Axis::X0].to_string(), ranges[Axis::Y0].to_string()]
    };
    let figure = |kind, values: &[(Parameter, f64)]| {
        let place = |source: Source, &(parameter, value): &(Parameter, f64)| {
            source
                .with(parameter, value, &sensor(16))
                .expect("in range")
        };
        values
            .iter()
            .fold(cases::figure(kind, 3.0, 3.0, 0.0), place)
    };
    let bar = |x0, y0| {
        figure(
            FigureKind::Rectangle,
            &[(Length, 6.0), (Width, 2.0), (X0, x0), (Y0, y0)],
        )
    };
    let (first, all) = ("0", "0:359:1");
    assert_eq!(
        own(&bar(1.99, 3.0), Anchor::Corner, first),
        ["1:1.99:0.01", "3:3.99:0.01"]
    );
    // Turned, the bar reaches above its corner, by 2.2 upwards from its centre.
    assert_eq!(
        own(&bar(1.99, 3.0), Anchor::Corner, all),
        ["1:1.99:0.01", "3:3.99:0.01"]
    );
    assert_eq!(
        own(&bar(1.99, 1.0), Anchor::Corner, all),
        ["4:4.99:0.01", "6:6.99:0.01"]
    );
    assert_eq!(
        own(&bar(2.0, 3.0), Anchor::Centre, all),
        ["5:5.99:0.01", "4:4.99:0.01"]
    );
    // Its cell is beyond the sensor, so poses would be cut off there.
    assert_eq!(
        own(&bar(-2.5, 3.0), Anchor::Corner, first),
        ["4:4.99:0.01", "6:6.99:0.01"]
    );
}

#[test]
fn given_ranges_are_kept() {
    let source = hexagon();
    let given = GivenRanges::default()
        .with(Axis::X0, Some(range("-3:3:0.5")))
        .with(Axis::Angle, Some(range("0:59:1")));
    let ranges = default_ranges(&source, &sensor(16), Anchor::Corner, &given).expect("in range");
    assert_eq!(ranges[Axis::X0], range("-3:3:0.5"));
    assert_eq!(ranges[Axis::Angle], range("0:59:1"));
    assert_eq!(ranges[Axis::Y0].count(), 100);
    let zoomed = given.with(Axis::ZoomX, Some(range("2")));
    let refused = default_ranges(&source, &sensor(16), Anchor::Corner, &zoomed);
    assert!(refused.is_err(), "a figure has no zoom");
}

fn smallest_sensor(
    set: &[&Source],
    anchor: Anchor,
    given: &GivenRanges,
) -> Option<(Sensor, Ranges)> {
    let reach = Reach::of_all(set.iter().copied(), anchor, given).expect("in range");
    reach.smallest_sensor(set, given, SensorSides::at_least(16), 1)
}

#[test]
fn the_smallest_sensor_holds_all_shapes_and_no_smaller_one_does() {
    let large = sensor(64);
    let triangle = Source::from(Figure::triangle(20.0).on(&large).expect("in range"));
    let disc = Source::from(Figure::ellipse(9.5, 9.5).on(&large).expect("in range"));
    let set = [&triangle, &disc];
    for &anchor in Anchor::ALL {
        for angles in ["0", "30", "0:359:1"] {
            let given = GivenRanges::default().with(Axis::Angle, Some(range(angles)));
            let (fit, ranges) = smallest_sensor(&set, anchor, &given).expect("64 are enough");
            let cut = |sensor: Sensor, ranges: &Ranges| -> u64 {
                let grids = set.iter().map(|&source| {
                    PoseGrid::new(source.clone(), sensor, anchor, *ranges).expect("in range")
                });
                grids.map(|grid| grid.poses_beyond_sensor()).sum()
            };
            assert_eq!(cut(fit, &ranges), 0);
            // Every cell in hundredths on the next smaller sensor, along one axis at a time.
            let smaller = sensor(fit.columns() - 1);
            let fits_along = |axis: Axis| {
                (-1500..1500).any(|start: i32| {
                    let (from, to) = (f64::from(start) / 100.0, f64::from(start + 99) / 100.0);
                    set.iter().all(|&source| {
                        let still = ranges
                            .with(Axis::X0, DecimalRange::whole(0))
                            .with(Axis::Y0, DecimalRange::whole(0));
                        let grid = PoseGrid::new(source.clone(), large, anchor, still);
                        let Extent {
                            left,
                            top,
                            right,
                            bottom,
                        } = grid.expect("in range").reach().expect("it has a boundary");
                        let (low, high) = if axis == Axis::X0 {
                            (left, right)
                        } else {
                            (top, bottom)
                        };
                        low + from >= -1e-9 && high + to <= f64::from(smaller.columns()) + 1e-9
                    })
                })
            };
            let smaller_holds = fits_along(Axis::X0) && fits_along(Axis::Y0);
            assert!(!smaller_holds, "{anchor:?} {angles}: {}", fit.columns());
        }
    }
    let small = smallest_sensor(&[&hexagon()], Anchor::Corner, &GivenRanges::default());
    assert_eq!(small.expect("it fits").0.columns(), 16);
}

#[test]
fn a_shape_too_large_for_any_sensor_has_no_smallest_sensor() {
    let large = Source::from(
        Figure::ellipse(33.0, 1.0)
            .on(&sensor(64))
            .expect("in range"),
    );
    let given = GivenRanges::default();
    assert_eq!(smallest_sensor(&[&large], Anchor::Corner, &given), None);
}
