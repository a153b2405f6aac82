//! Shapes are loaded as they were saved. Names never lead out of the folder, ignore case, and follow the file's name.
//! Of two programs on one library, neither overwrites the other's work unnoticed.

use std::thread;

use taxel_core::figure::Figure;
use taxel_core::outline::{Outline, Ring};
use taxel_core::parameter::Parameter;
use taxel_core::picture::Picture;
use taxel_core::sensor::Sensor;
use taxel_core::source::Source;
use taxel_files::formats::{Name, StoredShape};
use taxel_files::storage::{Expected, Library, LibraryError, ShapeOrigin};

use super::{Scratch, files, refusal, shape};

/// Drawn by hand, figures, pictures and outlines; numbers with all their digits.
fn shapes() -> Vec<StoredShape> {
    let sensor = Sensor::default()
        .with(Parameter::Threshold, 1.0 / 3.0)
        .and_then(|sensor| sensor.with(Parameter::Pitch, 0.1 + 0.2))
        .expect("in range");
    let triangle = vec![[0.0, 0.1], [4.9, 0.0], [0.7, 3.3]];
    let outline = Outline::new(vec![Ring::Polygon(triangle)], Some(sensor.pitch_mm()));
    let picture = Source::from(Picture::at_home("#.\n##".parse().expect("rows")));
    let placed = |source: Source| {
        let zoomed = source.with(Parameter::ZoomX, 1.7, &sensor)?;
        zoomed.with(Parameter::X0, 2.0 / 7.0, &sensor)
    };
    let figure = Figure::hexagon(3.3).at(-0.1, 1e-9).thickness(0.7);
    let sources = [
        None,
        Some(figure.on(&sensor).expect("in range").into()),
        Some(placed(picture).expect("in range")),
        Some(placed(outline.expect("a triangle").into()).expect("in range")),
    ];
    let made = sources.into_iter().enumerate().map(|(number, source)| {
        let imprint = shape("any", number + 1).imprint;
        let name = Name::new(&format!("é字 {number}.a_-")).expect("by the rules");
        StoredShape::new(name, sensor, imprint, source).expect("of one size")
    });
    made.collect()
}

#[test]
fn a_saved_shape_is_loaded_unchanged() {
    let scratch = Scratch::new();
    for first in shapes() {
        let name = first.name.as_str();
        let stamp = scratch.library.save(&first, Expected::Nothing);
        let stamp = stamp.expect("saved");
        let loaded = scratch.library.load(name).expect("loaded");
        assert_eq!(loaded.shape, first);
        assert_eq!((loaded.stamp, loaded.origin), (stamp, ShapeOrigin::Own));
        // Another shape replaces it, and then goes through the trash.
        for second in shapes() {
            let second = second.renamed(first.name.clone());
            let saved = scratch.library.save(&second, Expected::Anything);
            saved.expect("replaced");
            scratch.library.delete(name).expect("deleted");
            scratch.library.restore(Some(name)).expect("restored");
            assert_eq!(scratch.library.load(name).expect("loaded").shape, second);
        }
    }
}

#[test]
fn no_name_leads_out_of_the_folder() {
    let scratch = Scratch::with(&["one"]);
    let refused = [
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
    ];
    // Letters and format characters that are invisible.
    let invisible = [
        "\u{3164}",
        "a\u{115f}\u{1160}",
        "\u{ffa0}b",
        "a\u{ad}b",
        "a\u{202e}b",
    ];
    for name in refused.iter().chain(&invisible) {
        assert!(Name::new(name).is_err(), "{name:?}");
        for refused in [
            scratch.library.load(name).map(drop),
            scratch.library.delete(name).map(drop),
            scratch.library.restore(Some(name)).map(drop),
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
        let restored = scratch.library.restore(Some(&name));
        assert_eq!(restored.expect("restored"), name);
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
    let save = |number, expected| {
        let shape = shape("washing LINE", number);
        scratch.library.save(&shape, expected)
    };
    let taken = refusal(save(3, Expected::Nothing), &scratch);
    assert_eq!(taken, "\"Washing Line\" already exists");
    let stamp = scratch.library.load("WASHING line").expect("loaded").stamp;
    save(4, Expected::Stamp(stamp)).expect("replaced");
    assert_eq!(
        scratch.own(),
        ["Washing Line", "ÉTÉ"],
        "replaced, not doubled"
    );
    assert_eq!(scratch.number("washing line"), Some(4));
    let deleted = scratch.library.delete("washing line");
    assert_eq!(deleted.expect("deleted"), "Washing Line");
    let restored = scratch.library.restore(Some("WASHING LINE"));
    assert_eq!(restored.expect("restored"), "Washing Line");
    // A letter with two lower-case forms is one letter, too, and so is one with two upper-case forms.
    scratch.save("ΟΔΟΣ", 5);
    scratch.save("Maß", 6);
    for (name, number) in [
        ("οδος", 5),
        ("οδοσ", 5),
        ("Οδος", 5),
        ("MAẞ", 6),
        ("mass", 6),
        ("maß", 6),
    ] {
        assert_eq!(scratch.number(name), Some(number), "{name}");
    }
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
    let save = |number, expected| scratch.library.save(&shape("one", number), expected);
    let mine = scratch.library.load("one").expect("loaded").stamp;
    let theirs = other.save(&shape("one", 2), Expected::Stamp(mine));
    let theirs = theirs.expect("nobody else has written");
    let saved = save(3, Expected::Stamp(mine));
    assert!(matches!(&saved, Err(LibraryError::Changed { stamp, .. }) if *stamp == theirs));
    let message = "\"one\" was changed by another program since it was loaded";
    assert_eq!(refusal(saved, &scratch), message);
    assert_eq!(scratch.number("one"), Some(2));
    // When asked, the user wants to overwrite it.
    save(3, Expected::Stamp(theirs)).expect("saved");
    assert_eq!(scratch.number("one"), Some(3));
    // A shape that was deleted meanwhile is stored again, since this overwrites nothing.
    other.delete("one").expect("deleted");
    save(4, Expected::Stamp(theirs)).expect("saved");
    let exists = save(5, Expected::Nothing);
    assert!(matches!(exists, Err(LibraryError::Exists { .. })));
}

#[test]
fn writers_at_once_lose_nothing() {
    const COUNTS: usize = 40;
    let scratch = Scratch::new();
    scratch.save("counter", 0);
    // Each has opened the library itself, as a program does.
    let writer = || {
        let library = Library::open(scratch.folder.clone());
        let mut firsts = 0;
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
                Ok(_) => firsts += 1,
                Err(LibraryError::Exists { .. }) => {}
                Err(error) => panic!("{error}"),
            }
        }
        firsts
    };
    let firsts = thread::scope(|scope| {
        let writers = [(); 3].map(|()| scope.spawn(writer));
        writers.map(|writer| writer.join().expect("no panic"))
    });
    let counted = scratch.number("counter");
    assert_eq!(
        counted,
        Some(3 * COUNTS),
        "every save counts on from the one before"
    );
    assert_eq!(
        firsts.iter().sum::<usize>(),
        COUNTS,
        "one is the first, the others are told"
    );
    let is_own = |file: &String| !file.starts_with(".taxel-");
    assert!(
        files(&scratch.folder).iter().all(is_own),
        "nothing else is left"
    );
}
