//! Any shape is loaded as it was saved.

use proptest::collection::vec;
use proptest::prelude::*;
use taxel::figure::{Figure, FigureKind};
use taxel::formats::{Name, StoredShape};
use taxel::imprint::Imprint;
use taxel::parameter::Parameter;
use taxel::picture::Picture;
use taxel::sensor::Sensor;
use taxel::source::Source;
use taxel::storage::{Expected, ShapeOrigin};

use super::Scratch;
use crate::common::size;
use crate::property::config;

fn imprints() -> impl Strategy<Value = Imprint> {
    (1..=64_u8, 1..=64_u8, vec(any::<u64>(), 64)).prop_map(|(columns, rows, words)| {
        let mut imprint = Imprint::empty(size(columns, rows));
        for (row, word) in words.into_iter().enumerate() {
            imprint.set_word(row, word);
        }
        imprint
    })
}

fn sources(sensor: Sensor) -> impl Strategy<Value = Option<Source>> {
    let reach = f64::from(sensor.side());
    let figure = (
        0..FigureKind::ALL.len(),
        -reach..=reach,
        0.0..360.0,
        any::<bool>(),
    );
    let figure = figure.prop_map(move |(kind, x0, angle, hollow)| {
        let figure = Figure::default_of(FigureKind::ALL[kind], &sensor)
            .with(Parameter::X0, x0, &sensor)
            .and_then(|figure| figure.with(Parameter::Angle, angle, &sensor))
            .expect("in range");
        Source::Figure(if hollow {
            figure
                .with(Parameter::Thickness, reach / 7.0, &sensor)
                .expect("in range")
        } else {
            figure
        })
    });
    let picture = (imprints(), -reach..=reach, 1e-9..=64.0);
    let picture = picture.prop_map(move |(imprint, y0, zoom)| {
        Source::Picture(
            // The picture is only in its own place if it is not larger than the sensor.
            Picture::at_home(imprint)
                .with(Parameter::X0, 0.0, &sensor)
                .and_then(|picture| picture.with(Parameter::Y0, y0, &sensor))
                .and_then(|picture| picture.with(Parameter::ZoomX, zoom, &sensor))
                .expect("in range"),
        )
    });
    prop_oneof![Just(None), figure.prop_map(Some), picture.prop_map(Some)]
}

fn shapes() -> impl Strategy<Value = StoredShape> {
    (imprints(), 1e-6..=1.0, 1e-6..=1000.0)
        .prop_flat_map(|(imprint, threshold, pitch)| {
            let sensor = Sensor::new(imprint.columns(), imprint.rows())
                .and_then(|sensor| sensor.with(Parameter::Threshold, threshold))
                .and_then(|sensor| sensor.with(Parameter::Pitch, pitch))
                .expect("in range");
            let name = "[A-Za-z0-9_é字-][A-Za-z0-9_. é字-]{0,30}[A-Za-z0-9_.é字-]";
            (name, Just(imprint), Just(sensor), sources(sensor))
        })
        .prop_map(|(name, imprint, sensor, source)| {
            let name = Name::new(&name).expect("by the rules");
            StoredShape::new(name, sensor, imprint, source).expect("of one size")
        })
}

proptest! {
    #![proptest_config(config(64))]

    #[test]
    fn a_saved_shape_is_loaded_unchanged(first in shapes(), second in shapes()) {
        let scratch = Scratch::new();
        let stamp = scratch.library.save(&first, Expected::Nothing).expect("saved");
        let loaded = scratch.library.load(first.name.as_str()).expect("loaded");
        prop_assert_eq!(&loaded.shape, &first);
        prop_assert_eq!((loaded.stamp, loaded.origin), (stamp, ShapeOrigin::Own));
        // Another shape replaces it, and then goes through the trash.
        let second = second.renamed(first.name.clone());
        scratch.library.save(&second, Expected::Stamp(stamp)).expect("replaced");
        scratch.library.delete(second.name.as_str()).expect("deleted");
        scratch.library.restore(second.name.as_str()).expect("restored");
        prop_assert_eq!(scratch.library.load(second.name.as_str()).expect("loaded").shape, second);
    }
}
