//! Shapes are loaded as they were saved. Names never lead out of the folder, ignore case, and follow the file's name.
//! Of two programs on one library, neither overwrites the other's work unnoticed.

use std::path::Path;
use std::process::{Child, Command, Stdio};

use proptest::collection::vec;
use proptest::prelude::*;
use taxel_core::figure::{Figure, FigureKind};
use taxel_core::imprint::Imprint;
use taxel_core::parameter::Parameter;
use taxel_core::picture::Picture;
use taxel_core::sensor::Sensor;
use taxel_core::source::Source;
use taxel_files::formats::{Name, StoredShape};
use taxel_files::storage::{Expected, Library, LibraryError, ShapeOrigin};

use super::{Scratch, refusal, shape};
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

#[test]
fn no_name_leads_out_of_the_folder() {
    let scratch = Scratch::with(&["one"]);
    for name in [
        "",
        ".",
        "..",
        "../one",
        "a/b",
        "a\\b",
        "/etc/passwd",
        "one\0",
        "one ",
        " one",
        ".one",
        "C:one",
        "one\n",
        "o\u{301}ne",
        "*",
        "~",
        // Letters and format characters that are invisible.
        "\u{3164}",
        "a\u{115f}\u{1160}",
        "\u{ffa0}b",
        "a\u{ad}b",
        "a\u{202e}b",
    ] {
        assert!(Name::new(name).is_err(), "{name:?}");
        for refused in [
            scratch.library.load(name).map(drop),
            scratch.library.delete(name).map(drop),
            scratch.library.restore(name).map(drop),
        ] {
            assert!(matches!(refused, Err(LibraryError::Name(_))), "{name:?}");
        }
    }
    for name in ["a", "a.b", "a..", "-", "_x_", "Ünï cödé 9", "con", "a.json"] {
        scratch.save(name, 3);
        assert_eq!(scratch.number(name), Some(3), "{name:?}");
    }
}

#[test]
fn the_longest_names_are_stored_deleted_and_restored() {
    let scratch = Scratch::new();
    // One, two, three and four bytes per character.
    for (letter, longest) in [("a", 64), ("é", 64), ("字", 64), ("𝔸", 50)] {
        let name = letter.repeat(longest);
        scratch.save(&name, 5);
        assert_eq!(scratch.library.delete(&name).expect("deleted"), name);
        assert_eq!(scratch.library.restore(&name).expect("restored"), name);
        assert_eq!(scratch.number(&name), Some(5));
        assert!(Name::new(&letter.repeat(longest + 1)).is_err());
    }
}

#[test]
fn names_that_differ_only_in_case_are_the_same() {
    let scratch = Scratch::with(&["Washing Line", "ÉTÉ"]);
    for name in ["washing line", "WASHING LINE", "Washing Line"] {
        assert_eq!(scratch.number(name), Some(1), "{name}");
    }
    assert_eq!(scratch.number("été"), Some(2));
    let saved = scratch
        .library
        .save(&shape("washing LINE", 3), Expected::Nothing);
    assert_eq!(refusal(saved, &scratch), "\"Washing Line\" already exists");
    let stamp = scratch.library.load("WASHING line").expect("loaded").stamp;
    let replaced = scratch
        .library
        .save(&shape("washing LINE", 4), Expected::Stamp(stamp));
    assert!(replaced.is_ok());
    assert_eq!(
        scratch.own(),
        ["Washing Line", "ÉTÉ"],
        "replaced, not doubled"
    );
    assert_eq!(scratch.number("washing line"), Some(4));
    let deleted = scratch.library.delete("washing line").expect("deleted");
    assert_eq!(deleted, "Washing Line");
    let restored = scratch.library.restore("WASHING LINE").expect("restored");
    assert_eq!(restored, "Washing Line");
    // A letter with two lower-case forms is one letter, too.
    scratch.save("ΟΔΟΣ", 5);
    for name in ["οδος", "οδοσ", "Οδος"] {
        assert_eq!(scratch.number(name), Some(5), "{name}");
    }
    // So is a letter with two upper-case forms.
    scratch.save("Maß", 6);
    for name in ["MAẞ", "mass", "maß"] {
        assert_eq!(scratch.number(name), Some(6), "{name}");
    }
    // The same applies to shipped shapes.
    assert_eq!(
        refusal(
            scratch.library.save(&shape("WASHER", 1), Expected::Nothing),
            &scratch
        ),
        "\"WASHER\" comes with taxel and cannot be replaced; choose another name"
    );
    assert!(scratch.library.load("WASHER").is_ok());
}

#[test]
fn a_renamed_file_has_its_new_name() {
    let scratch = Scratch::new();
    scratch.put("new.json", shape("old", 8).write());
    let loaded = scratch.library.load("new").expect("loaded");
    assert_eq!(loaded.shape, shape("new", 8));
    assert_eq!(scratch.number("old"), None);
    // A user's shape with the name of a shipped shape hides it.
    scratch.put("Washer.json", shape("Washer", 6).write());
    assert_eq!(scratch.number("washer"), Some(6));
    let listed = scratch.library.list().expect("listed").into_iter();
    let washers = listed.filter(|entry| entry.name.eq_ignore_ascii_case("washer"));
    assert_eq!(washers.count(), 1);
}

#[test]
fn a_shape_that_was_changed_meanwhile_is_not_overwritten() {
    let scratch = Scratch::with(&["one"]);
    let other = Library::open(scratch.folder.clone());
    let mine = scratch.library.load("one").expect("loaded").stamp;
    let theirs = other
        .save(&shape("one", 2), Expected::Stamp(mine))
        .expect("nobody else has written");
    let saved = scratch
        .library
        .save(&shape("one", 3), Expected::Stamp(mine));
    assert!(matches!(&saved, Err(LibraryError::Changed { stamp, .. }) if *stamp == theirs));
    assert_eq!(
        refusal(saved, &scratch),
        "\"one\" was changed by another program since it was loaded"
    );
    assert_eq!(scratch.number("one"), Some(2));
    // When asked, the user wants to overwrite it.
    let saved = scratch
        .library
        .save(&shape("one", 3), Expected::Stamp(theirs));
    assert!(saved.is_ok());
    assert_eq!(scratch.number("one"), Some(3));
    // A shape that was deleted meanwhile is stored again, since this overwrites nothing.
    other.delete("one").expect("deleted");
    let saved = scratch
        .library
        .save(&shape("one", 4), Expected::Stamp(theirs));
    assert!(saved.is_ok());
    let exists = scratch.library.save(&shape("one", 5), Expected::Nothing);
    assert!(matches!(exists, Err(LibraryError::Exists { .. })));
}

const VARIABLE: &str = "TAXEL_LIBRARY_COUNTER";

/// The number of increments by each program.
const COUNTS: usize = 40;

/// The other program, which is this test with a variable set: it increments "counter", and also saves a new shape.
#[test]
fn counter() {
    let Ok(asked) = std::env::var(VARIABLE) else {
        return;
    };
    let (own, folder) = asked.split_once(':').expect("a name and a folder");
    let library = Library::open(folder.into());
    for index in 0..COUNTS {
        loop {
            let loaded = library.load("counter").expect("whole");
            let number = usize::try_from(loaded.shape.imprint.words()[0]).expect("small");
            match library.save(&shape("counter", number + 1), Expected::Stamp(loaded.stamp)) {
                Ok(_) => break,
                Err(LibraryError::Changed { .. }) => {}
                Err(error) => panic!("{error}"),
            }
        }
        match library.save(&shape(&format!("new {index}"), 1), Expected::Nothing) {
            Ok(_) => println!("FIRST {own} {index}"),
            Err(LibraryError::Exists { .. }) => {}
            Err(error) => panic!("{error}"),
        }
    }
}

fn count(own: &str, folder: &Path) -> Child {
    Command::new(std::env::current_exe().expect("this binary"))
        .args(["--exact", "library::shapes::counter", "--nocapture"])
        .env(VARIABLE, format!("{own}:{}", folder.display()))
        .stdout(Stdio::piped())
        .stderr(Stdio::piped())
        .spawn()
        .expect("the program starts")
}

#[test]
fn programs_that_save_at_once_lose_nothing() {
    let scratch = Scratch::with(&["counter"]);
    scratch.library.delete("counter").expect("deleted");
    scratch.save("counter", 0);
    let programs = ["a", "b", "c"].map(|own| count(own, &scratch.folder));
    let mut said = String::new();
    for program in programs {
        let output = program.wait_with_output().expect("it ends");
        assert!(output.status.success(), "{output:?}");
        said += &String::from_utf8(output.stdout).expect("text");
    }
    assert_eq!(
        scratch.number("counter"),
        Some(3 * COUNTS),
        "every save counts on from the one before"
    );
    for index in 0..COUNTS {
        let firsts = said
            .lines()
            .filter(|line| line.contains("FIRST ") && line.ends_with(&format!(" {index}")));
        assert_eq!(
            firsts.count(),
            1,
            "one is the first, the others are told: {index}"
        );
    }
}
