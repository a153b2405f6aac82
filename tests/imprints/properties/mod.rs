//! Properties that hold for every shape. Shapes are drawn at random from a fixed seed, and a failing one is shrunk.
//!
//! All coordinates are hundredths, so that a moved or mirrored shape is written with as few decimals as the original,
//! and ties remain ties: imprints are compared taxel by taxel, without tolerance.

mod drawn;

use proptest::prelude::*;
use taxel_core::figure::{Figure, FigureKind};
use taxel_core::geometry::Extent;
use taxel_core::imprint::Imprint;
use taxel_core::parameter::{PARAMETERS, Parameter};
use taxel_core::picture::Picture;
use taxel_core::sensor::Sensor;
use taxel_core::source::Source;
use taxel_core::touch::{Plane, reaches_beyond};
use taxel_files::formats::StoredShape;

use self::drawn::{angle, area, drawn, figure, hundredths, imprints, kind, moved, polygon, star};
use crate::common::{sensor, size};
use crate::property::config;

proptest! {
    #![proptest_config(config(10_000))]

    #[test]
    fn coverages_add_up_to_the_area(drawn in drawn(500..1400)) {
        let figure = figure(&drawn, 32);
        let mut plane = Plane::new(sensor(32, 32, 0.5));
        prop_assert!(!reaches_beyond(&figure, plane.sensor()));
        plane.touch(&figure);
        let sum: f64 = plane.coverages().values().iter().sum();
        prop_assert!((sum - area(&figure)).abs() < 1e-9, "{sum} and {}", area(&figure));
    }

    #[test]
    fn a_figure_moved_by_whole_cells_leaves_the_moved_imprint(
        drawn in drawn(0..1100), by in (-11..=11, -11..=11), threshold in 1..=100
    ) {
        // The first sensor is so large that nothing is cut off by the move.
        let mut plane = Plane::new(sensor(48, 48, hundredths(threshold)));
        let (kind, sizes, (x0, y0), angle, wall) = drawn;
        let put = |right: i32, down: i32| {
            figure(&(kind, sizes, (x0 + 100 * right, y0 + 100 * down), angle, wall), 48)
        };
        let first = plane.touch(&put(16, 16));
        let second = plane.touch(&put(16 + by.0, 16 + by.1));
        prop_assert_eq!(second, moved(&first, |i, j| (i + by.0, j + by.1)));
    }

    #[test]
    fn a_quarter_turn_of_a_centred_figure_turns_the_imprint(
        ellipse in any::<bool>(), half in (1..800, 1..800), angle in angle(), wall in proptest::option::of(1..300), odd in any::<bool>()
    ) {
        // Only these two kinds have a centre that decimals can place in the middle of the sensor.
        let side: u8 = if odd { 17 } else { 16 };
        let middle = i32::from(side) * 50;
        let sizes = if ellipse { half } else { (half.0 * 2, half.1 * 2) };
        let kind = if ellipse { FigureKind::Ellipse } else { FigureKind::Rectangle };
        let place = (middle - half.0, middle - half.1);
        let mut plane = Plane::new(sensor(side, side, 0.5));
        let mut at = |angle: i32| plane.touch(&figure(&(kind, sizes, place, angle, wall), side));
        let last = i32::from(side) - 1;
        let expected = moved(&at(angle), |i, j| (last - j, i));
        prop_assert_eq!(at((angle + 90) % 360), expected);
        // Both kinds have two axes of symmetry, so the opposite angle gives the mirror image.
        let expected = moved(&at(angle), |i, j| (last - i, j));
        prop_assert_eq!(at((360 - angle) % 360), expected);
    }

    #[test]
    fn a_figure_repeats_after_a_part_of_a_turn(drawn in drawn(300..900), steps in 1..8) {
        let (kind, sizes, place, angle, wall) = drawn;
        let corner = match kind {
            FigureKind::Triangle => 120,
            FigureKind::Pentagon => 72,
            FigureKind::Hexagon => 60,
            FigureKind::Octagon => 45,
            FigureKind::Ellipse | FigureKind::Rectangle => 180,
            // A seventh of a turn is not a whole number of degrees.
            FigureKind::Heptagon => return Ok(()),
        };
        let mut plane = Plane::new(sensor(16, 16, 0.5));
        let mut at = |angle: i32| plane.touch(&figure(&(kind, sizes, place, angle, wall), 16));
        prop_assert_eq!(at(angle), at((angle + steps * corner) % 360));
    }

    #[test]
    fn a_higher_threshold_never_activates_a_taxel(drawn in drawn(-200..1500), low in 1..=100_i32, high in 1..=100_i32) {
        let figure = figure(&drawn, 16);
        let (low, high) = (low.min(high), low.max(high));
        let touch = |threshold: i32| Plane::new(sensor(16, 16, hundredths(threshold))).touch(&figure);
        let (many, few) = (touch(low), touch(high));
        prop_assert!(many.words().iter().zip(few.words()).all(|(many, few)| many & few == *few));
        prop_assert!(few.count() <= many.count());
    }

    #[test]
    fn a_touch_does_not_depend_on_the_touch_before(first in drawn(-400..1500), second in drawn(-400..1500)) {
        let mut used = Plane::new(Sensor::default());
        used.touch(&figure(&first, 16));
        let mut fresh = Plane::new(Sensor::default());
        prop_assert_eq!(used.touch(&figure(&second, 16)), fresh.touch(&figure(&second, 16)));
        prop_assert_eq!(used.coverages(), fresh.coverages());
        prop_assert!(used.coverages().values().iter().all(|coverage| (0.0..=1.0).contains(coverage)));
    }

    #[test]
    fn a_mirrored_polygon_leaves_the_mirrored_imprint(vertices in star(), threshold in 1..=100) {
        let mut plane = Plane::new(sensor(16, 16, hundredths(threshold)));
        let imprint = plane.touch(&polygon(vertices.clone()));
        let sideways = plane.touch(&polygon(vertices.iter().map(|&(x, y)| (1600 - x, y))));
        prop_assert_eq!(sideways, moved(&imprint, |i, j| (15 - i, j)));
        let swapped = plane.touch(&polygon(vertices.iter().map(|&(x, y)| (y, x))));
        prop_assert_eq!(swapped, moved(&imprint, |i, j| (j, i)));
    }

    #[test]
    fn a_polygon_may_start_at_any_vertex_and_run_in_either_direction(vertices in star(), start in 0..12_usize) {
        let mut plane = Plane::new(Sensor::default());
        let imprint = plane.touch(&polygon(vertices.clone()));
        let coverages = plane.coverages();
        let mut other = vertices;
        let start = start % other.len();
        other.rotate_left(start);
        for _ in 0..2 {
            prop_assert_eq!(plane.touch(&polygon(other.clone())), imprint);
            for (a, b) in plane.coverages().values().iter().zip(coverages.values()) {
                prop_assert!((a - b).abs() < 1e-12);
            }
            other.reverse();
        }
    }
}

proptest! {
    #![proptest_config(config(2_000))]

    #[test]
    fn a_picture_at_home_is_its_imprint(imprint in imprints(1..=64, 1..=64), threshold in 1..=100) {
        let mut plane = Plane::new(sensor(imprint.columns(), imprint.rows(), hundredths(threshold)));
        prop_assert_eq!(plane.touch(&Picture::at_home(imprint)), imprint);
    }

    #[test]
    fn a_picture_moved_by_whole_cells_is_shifted(imprint in imprints(1..=20, 1..=20), by in (-15..=15, -15..=15)) {
        let imprint = imprint.resized(size(20, 20));
        let mut picture = Source::from(Picture::at_home(imprint));
        for (parameter, by) in [(Parameter::X0, by.0), (Parameter::Y0, by.1)] {
            let at = picture.get(parameter).expect("a parameter of pictures") + f64::from(by);
            prop_assume!((-20.0..=20.0).contains(&at));
            picture = picture.with(parameter, at, &sensor(20, 20, 0.5)).expect("in range");
        }
        let found = Plane::new(sensor(20, 20, 0.5)).touch(&picture);
        prop_assert_eq!(found, moved(&imprint, |i, j| (i + by.0, j + by.1)));
    }

    #[test]
    fn four_quarter_turns_of_a_square_picture_change_nothing(imprint in imprints(1..=24, 1..=24), side in 1..=24_u8) {
        let mut first = imprint.resized(size(side, side));
        // Two taxels at opposite corners make the bounding rectangle the whole matrix.
        first.set(0, 0, true);
        first.set(side - 1, side - 1, true);
        let last = i32::from(side) - 1;
        let mut plane = Plane::new(sensor(side, side, 0.5));
        let mut turned = first;
        for _ in 0..4 {
            let picture = Source::from(Picture::at_home(turned)).with(Parameter::Angle, 90.0, plane.sensor()).expect("in range");
            let expected = moved(&turned, |i, j| (j, last - i));
            turned = plane.touch(&picture);
            prop_assert_eq!(turned, expected);
        }
        prop_assert_eq!(turned, first);
        let half = Source::from(Picture::at_home(first)).with(Parameter::Angle, 180.0, plane.sensor()).expect("in range");
        prop_assert_eq!(plane.touch(&half), moved(&first, |i, j| (last - i, last - j)));
    }

    #[test]
    fn an_imprint_reads_back_from_its_text(imprint in imprints(1..=64, 1..=64)) {
        let text = imprint.to_string();
        prop_assert_eq!(text.parse::<Imprint>(), Ok(imprint));
        prop_assert_eq!((text + "\r\n").replace('\n', "\r\n").replace("\r\r", "\r").parse::<Imprint>(), Ok(imprint));
        prop_assert_eq!(imprint.active().count(), usize::try_from(imprint.count()).unwrap_or(0));
    }

    #[test]
    fn a_stored_shape_reads_back(
        imprint in imprints(1..=64, 1..=64), name in "[A-Za-z0-9_][A-Za-z0-9_. é-]{0,18}[A-Za-z0-9_é-]",
        drawn in drawn(0..100), source in 0..3, (threshold, pitch) in (1..=1000, 1..=100_000), numbers in any::<[u32; 2]>()
    ) {
        let sensor = sensor(imprint.columns(), imprint.rows(), f64::from(threshold) / 1000.0)
            .with(Parameter::Pitch, f64::from(pitch) / 1000.0).expect("in range");
        // Numbers with all their digits must also come back.
        let long = |number: u32| f64::from(number) / f64::from(u32::MAX) * f64::from(sensor.side());
        let source = match source {
            0 => None,
            1 => Some(Source::from(Picture::at_home(imprint))
                .with(Parameter::X0, long(numbers[0]), &sensor).expect("in range")
                .with(Parameter::ZoomY, f64::from(numbers[1]) / 1e9 + 1e-9, &sensor).expect("in range")),
            _ => {
                let (kind, sizes, place, angle, wall) = drawn;
                let sizes = (sizes.0.min(100), sizes.1.min(100));
                let drawn = (kind, sizes, place, angle, wall.map(|wall| wall.min(100)));
                Some(Source::Figure(figure(&drawn, sensor.side()).with(Parameter::Y0, long(numbers[1]), &sensor).expect("in range")))
            }
        };
        let name = taxel_files::formats::Name::new(&name).expect("the names of the test are right");
        let shape = StoredShape::new(name, sensor, imprint, source).expect("of one size");
        let text = shape.write();
        let marked = format!("\u{feff}{text}");
        for text in [marked, text] {
            prop_assert_eq!(StoredShape::read(text.as_bytes()), Ok(shape.clone()));
        }
    }

    #[test]
    fn forms_read_what_they_show_and_stay_in_range(
        index in 0..PARAMETERS.len(), side in 1..=64_u8, share in -1.0..=1.0_f64, steps in proptest::collection::vec(-1..=1, 0..40)
    ) {
        let (parameter, sensor) = (PARAMETERS[index].parameter, sensor(side, side, 0.5));
        let mut value = sensor.default_value(parameter);
        prop_assert!(sensor.range(parameter).contains(value));
        let given = share * f64::from(side);
        if sensor.range(parameter).contains(given) {
            // The number is shown in full, even if it has more decimals than a form accepts.
            prop_assert_eq!(parameter.format(given).parse::<f64>(), Ok(given));
            if parameter.row().unit != taxel_core::parameter::Unit::Taxels {
                prop_assert_eq!(sensor.read(parameter, &parameter.format(given)), Ok(given));
                value = given;
            }
        }
        for direction in steps {
            let next = sensor.step(parameter, value, direction);
            prop_assert!(sensor.range(parameter).contains(next), "{parameter:?} {value} {direction} {next}");
            if direction != 0 {
                // After one step, the value has the paper's decimals and reads back.
                prop_assert_eq!(sensor.step(parameter, next, 0), next);
                prop_assert_eq!(sensor.read(parameter, &parameter.format(next)), Ok(next));
            }
            // For a number with more decimals, a step at the end of the range may lead to the other side of it.
            let taken = sensor.step(parameter, value, 0) == value;
            if taken && parameter != Parameter::Angle {
                prop_assert!((next - value) * f64::from(direction) >= 0.0, "{parameter:?} {value} {direction} {next}");
            }
            if taken && next != value {
                // A step and its reverse lead back, also across the change of decimals at 10 and across 360 degrees.
                prop_assert_eq!(sensor.step(parameter, next, -direction), value);
            }
            value = next;
        }
    }

    #[test]
    fn shapes_of_any_size_have_coverages_from_0_to_1(
        kind in kind(), exponents in (-300..2, -300..2), place in (-64.0..64.0_f64, -64.0..64.0_f64), angle in 0.0..360.0_f64, wall in -300..2
    ) {
        let size = |exponent: i32| 6.0 * 10_f64.powi(exponent);
        let figure = Figure::new(kind, &Sensor::LARGEST, |parameter| Some(match parameter {
            Parameter::X0 => place.0,
            Parameter::Y0 => place.1,
            Parameter::Angle => angle,
            Parameter::Thickness => size(wall),
            Parameter::RadiusY | Parameter::Width => size(exponents.1),
            _ => size(exponents.0),
        }));
        let mut plane = Plane::new(sensor(64, 64, 0.5));
        let figure = figure.expect("in range");
        plane.touch(&figure);
        prop_assert!(plane.coverages().values().iter().all(|share| (0.0..=1.0).contains(share)));
        let extent = Extent::of(&figure).expect("it has a boundary");
        prop_assert!(extent.left <= extent.right && extent.top <= extent.bottom);
    }
}
