//! Names never lead out of the folder, ignore case, and follow the file's name.

use taxel::formats::{Name, NameError};
use taxel::storage::{Expected, LibraryError};

use super::Scratch;
use super::refusal;
use super::shape;

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
    assert_eq!(Name::new(&"𝔸".repeat(51)), Err(NameError::Bytes(204)));
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
