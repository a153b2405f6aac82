//! The shipped shapes: each equals the output of its command, and moves like a picture.

use std::path::Path;

use taxel_core::description::{RegionKind, regions};
use taxel_core::imprint::Imprint;
use taxel_core::parameter::Parameter;
use taxel_core::picture::Picture;
use taxel_core::source::Source;
use taxel_core::touch::Plane;
use taxel_files::storage::{Library, LoadedShape, ShapeOrigin, shipped};

use super::{Scratch, files};

const FOLDER: &str = concat!(env!("CARGO_MANIFEST_DIR"), "/library");

fn all() -> Vec<LoadedShape> {
    let scratch = Scratch::new();
    shipped::names()
        .map(|name| scratch.library.load(name).expect("whole"))
        .collect()
}

#[test]
fn every_file_is_compiled_in_and_listed() {
    let in_folder: Vec<String> = files(Path::new(FOLDER))
        .into_iter()
        .filter_map(|file| file.strip_suffix(".json").map(str::to_owned))
        .collect();
    assert!(shipped::names().eq(in_folder), "by alphabet, all of them");
    let nowhere = Library::open("/nowhere/at/all".into());
    let listed = nowhere
        .list()
        .expect("no folder is an empty one")
        .into_iter();
    assert!(listed.map(|entry| entry.name).eq(shipped::names()));
}

#[test]
fn there_are_shipped_shapes_of_all_kinds() {
    let all = all();
    assert!(all.len() >= 16, "{}", all.len());
    let with = |sort: fn(usize, usize) -> bool| {
        let fits = |loaded: &&LoadedShape| {
            let regions = regions(&loaded.shape.imprint);
            let holes = regions
                .iter()
                .filter(|region| region.kind() == RegionKind::Hole)
                .count();
            sort(regions.len() - holes, holes)
        };
        all.iter().filter(fits).count()
    };
    assert!(with(|_, holes| holes == 0) >= 4);
    assert!(with(|_, holes| holes == 1) >= 4);
    assert!(with(|_, holes| holes > 1) >= 4);
    assert!(with(|pieces, _| pieces > 1) >= 4);
    for LoadedShape { shape, origin, .. } in all {
        assert_eq!(origin, ShapeOrigin::Shipped);
        if let Some(source) = shape.source {
            let touched = Plane::new(shape.sensor).touch(&source);
            assert_eq!(touched, shape.imprint, "{}", shape.name);
        }
    }
}

#[cfg(unix)]
#[test]
fn each_shipped_shape_equals_the_output_of_its_command() {
    let scratch = Scratch::new();
    let made = std::process::Command::new("bash")
        .arg(format!("{FOLDER}/make"))
        .arg(env!("CARGO_BIN_EXE_taxel"))
        .arg(&scratch.folder)
        .output();
    let Ok(made) = made else {
        crate::skip::lacking("bash");
        return;
    };
    assert!(made.status.success(), "{made:?}");
    for name in shipped::names() {
        let read = |folder: &Path| std::fs::read(folder.join(format!("{name}.json")));
        let (made, kept) = (read(&scratch.folder), read(Path::new(FOLDER)));
        assert_eq!(made.ok(), kept.ok(), "{name}");
    }
    assert_eq!(scratch.own().len(), shipped::names().count());
}

/// Returns an imprint moved by whole cells; nothing may leave the sensor.
fn shifted(imprint: &Imprint, right: i16, down: i16) -> Imprint {
    let mut shifted = Imprint::empty(imprint.size());
    for (column, row) in imprint.active() {
        let to = |from: u8, by: i16| u8::try_from(i16::from(from) + by).expect("inside");
        shifted.set(to(column, right), to(row, down), true);
    }
    shifted
}

#[test]
fn without_angle_and_zoom_a_picture_is_only_shifted() {
    let mut positions = 0;
    for LoadedShape { shape, .. } in all() {
        let (imprint, sensor) = (shape.imprint, shape.sensor);
        let bounds = imprint.bounds().expect("not empty");
        let home = Source::from(Picture::at_home(imprint));
        let mut plane = Plane::new(sensor);
        assert_eq!(plane.touch(&home), imprint, "{}", shape.name);
        for top in 0..=sensor.rows() - (bounds.bottom - bounds.top) {
            for left in 0..=sensor.columns() - (bounds.right - bounds.left) {
                let moved = home
                    .clone()
                    .with(Parameter::X0, left.into(), &sensor)
                    .and_then(|home| home.with(Parameter::Y0, top.into(), &sensor))
                    .expect("inside");
                let by = |to: u8, from: u8| i16::from(to) - i16::from(from);
                let expected = shifted(&imprint, by(left, bounds.left), by(top, bounds.top));
                assert_eq!(plane.touch(&moved), expected, "{}", shape.name);
                positions += 1;
            }
        }
    }
    assert!(positions > 250, "{positions}");
}
