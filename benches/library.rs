//! `taxel library list` of 100,000 shapes, compared with reading their files one after the other.

use std::fs;
use std::process::{Command, Stdio};

use taxel_core::prelude::*;
use taxel_files::formats::{Name, StoredShape};

use timing::{Work, in_turn};

mod timing;

/// The number of shapes.
const SHAPES: usize = 100_000;

fn main() {
    let folder = tempfile::tempdir().expect("a folder");
    let sensor = Sensor::default();
    let ring = Figure::ellipse(4.0, 4.0).at(1.99, 1.47).thickness(2.0);
    let ring = ring.on(&sensor).expect("the paper's Fig. 1");
    let imprint = Plane::new(sensor).touch(&ring);
    for number in 0..SHAPES {
        let name = format!("shape {number}");
        let shape = StoredShape::new(Name::new(&name).expect("a name"), sensor, imprint, None);
        let text = shape.expect("of one size").write();
        fs::write(folder.path().join(name + ".json"), text).expect("written");
    }
    let list = Work::new(|| {
        let status = Command::new(env!("CARGO_BIN_EXE_taxel"))
            .args(["library", "list", "--library"])
            .arg(folder.path())
            .stdout(Stdio::null())
            .status();
        assert!(status.is_ok_and(|status| status.success()));
    });
    let plain = Work::new(|| {
        let files = fs::read_dir(folder.path()).expect("a folder").flatten();
        let bytes = files.map(|file| fs::read(file.path()).expect("read").len());
        assert!(bytes.sum::<usize>() > SHAPES);
    });
    let [list, plain] = in_turn(5, [list, plain]).map(|least| least.wall);
    println!("library list of {SHAPES} shapes: {list:.2} s");
    println!(
        "library list / reading the files one by one: {:.2}",
        list / plain
    );
}
