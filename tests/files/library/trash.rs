//! Deleting and restoring.

use taxel::storage::{Library, LibraryError, TRASH_KEPT};

use super::Scratch;
use super::files;
use super::refusal;
use super::shape;

#[test]
fn a_deleted_shape_is_restored_unchanged() {
    let scratch = Scratch::with(&["one", "two"]);
    let before = std::fs::read(scratch.path("one.json")).expect("there");
    assert_eq!(scratch.library.delete("one").expect("deleted"), "one");
    assert_eq!(scratch.own(), ["two"]);
    assert_eq!(
        refusal(scratch.library.load("one"), &scratch),
        "no shape named \"one\""
    );
    assert_eq!(scratch.library.restore("one").expect("restored"), "one");
    let after = std::fs::read(scratch.path("one.json")).expect("there");
    assert_eq!(before, after);
    assert_eq!(
        refusal(scratch.library.restore("one"), &scratch),
        "no shape named \"one\" in the trash"
    );
}

#[test]
fn the_last_deleted_shape_is_restored_first_and_never_over_another() {
    let scratch = Scratch::new();
    for number in 1..=3 {
        scratch.save("one", number);
        scratch.library.delete("one").expect("deleted");
    }
    scratch.save("one", 4);
    let taken = scratch.library.restore("ONE");
    assert!(matches!(&taken, Err(LibraryError::Exists { name, .. }) if name == "one"));
    assert_eq!(scratch.number("one"), Some(4));
    for number in [4, 3, 2, 1] {
        assert_eq!(scratch.number("one"), Some(number));
        let path = scratch.path("one.json");
        std::fs::remove_file(path).expect("removed by hand");
        let restored = scratch.library.restore("one");
        assert_eq!(restored.is_ok(), number > 1);
    }
}

#[test]
fn a_name_that_was_deleted_more_than_once_is_listed_once() {
    let scratch = Scratch::with(&["one", "two"]);
    for name in ["one", "two"] {
        scratch.library.delete(name).expect("deleted");
    }
    scratch.save("ONE", 2);
    scratch.library.delete("one").expect("deleted");
    // The newest comes first.
    let listed = scratch.library.in_trash().expect("listed");
    assert_eq!(listed, ["ONE", "two"]);
}

#[test]
fn the_last_deleted_shape_is_restored_without_naming_it() {
    let scratch = Scratch::with(&["one", "two"]);
    let empty = "the trash is empty";
    assert_eq!(refusal(scratch.library.restore_last(), &scratch), empty);
    for name in ["two", "one"] {
        scratch.library.delete(name).expect("deleted");
    }
    // Another program knows it, too.
    let other = Library::open(scratch.folder.clone());
    assert_eq!(other.restore_last().expect("restored"), "one");
    scratch.save("TWO", 3);
    let taken = other.restore_last();
    assert!(matches!(&taken, Err(LibraryError::Exists { name, .. }) if name == "TWO"));
    scratch.library.delete("two").expect("deleted");
    assert_eq!(other.restore_last().expect("restored"), "TWO");
}

#[test]
fn the_last_fifty_deleted_shapes_are_kept() {
    let scratch = Scratch::new();
    for number in 0..TRASH_KEPT + 5 {
        let name = format!("shape {number}");
        scratch.save(&name, 1);
        scratch.library.delete(&name).expect("deleted");
    }
    let trash = files(&scratch.path(".trash"));
    assert_eq!(trash.len(), TRASH_KEPT);
    assert_eq!(
        trash.first().map(String::as_str),
        Some("0000000006 shape 5.json")
    );
    assert!(scratch.library.restore("shape 4").is_err());
    assert!(scratch.library.restore("shape 5").is_ok());
    assert!(scratch.library.restore("shape 54").is_ok());
    // Numbers continue, so that nothing in the trash is overwritten.
    scratch.library.delete("shape 5").expect("deleted");
    let trash = files(&scratch.path(".trash"));
    assert_eq!(
        trash.last().map(String::as_str),
        Some("0000000055 shape 5.json")
    );
}

#[test]
fn shipped_shapes_cannot_be_deleted() {
    let scratch = Scratch::new();
    let message = "\"Washer\" comes with taxel and cannot be deleted";
    assert_eq!(refusal(scratch.library.delete("Washer"), &scratch), message);
    assert_eq!(
        refusal(scratch.library.delete("nothing"), &scratch),
        "no shape named \"nothing\""
    );
    let nowhere = Library::open(scratch.path("nowhere"));
    assert_eq!(
        refusal(nowhere.delete("nothing"), &scratch),
        "no shape named \"nothing\""
    );
    assert!(nowhere.restore("nothing").is_err() && !scratch.path("nowhere").exists());
}

#[test]
fn a_trash_with_foreign_files_is_still_used() {
    let scratch = Scratch::with(&["one"]);
    let trash = scratch.path(".trash");
    std::fs::create_dir(&trash).expect("made");
    for file in [
        "notes.txt",
        "x one.json",
        "18446744073709551615 one.json",
        "00099 .bad.json",
        "1 one",
    ] {
        std::fs::write(trash.join(file), "").expect("written");
    }
    std::fs::create_dir(trash.join("77 one.json")).expect("a folder");
    scratch.library.delete("one").expect("deleted");
    assert!(trash.join("0000000078 one.json").exists());
    scratch.library.restore("one").expect("restored");
    assert_eq!(scratch.number("one"), Some(1));
    std::fs::remove_file(scratch.path("one.json")).expect("removed");
    assert_eq!(
        refusal(scratch.library.restore("one"), &scratch),
        "FOLDER/.trash/77 one.json: is a folder, expected a regular file"
    );
}

#[test]
fn a_trash_whose_last_number_is_taken_is_renumbered() {
    let scratch = Scratch::with(&["old", "new"]);
    let trash = scratch.path(".trash");
    std::fs::create_dir(&trash).expect("made");
    let crafted = [
        "9999999999 z.json",
        "9999999998 y.json",
        "99999999999 x.json",
    ];
    for file in crafted {
        std::fs::write(trash.join(file), shape("z", 7).write()).expect("written");
    }
    scratch.library.delete("old").expect("deleted");
    scratch.library.delete("new").expect("deleted");
    let expected = [
        "0000000001 y.json",
        "0000000002 z.json",
        "0000000003 old.json",
        "0000000004 new.json",
        "99999999999 x.json",
    ];
    assert_eq!(files(&trash), expected);
    for (name, number) in [("new", 2), ("old", 1), ("z", 7)] {
        scratch.library.restore(name).expect("restored");
        assert_eq!(scratch.number(name), Some(number));
    }
    assert!(
        scratch.library.restore("x").is_err(),
        "not one of its numbers"
    );
}

/// It gets a free name, both in the library and in the trash.
#[test]
fn a_shape_that_was_never_stored_can_be_thrown_away_and_restored() {
    let scratch = Scratch::with(&["lost 2"]);
    for name in ["lost 1", "lost 3"] {
        let thrown = scratch.library.throw_away(&shape("lost", 7));
        assert_eq!(thrown.expect("thrown away"), name);
    }
    assert_eq!(scratch.own(), ["lost 2"]);
    scratch.library.restore("lost 3").expect("restored");
    assert_eq!(scratch.number("lost 3"), Some(7));
    let none = Scratch::new();
    none.put(".trash", "in the way");
    assert!(none.library.throw_away(&shape("lost", 7)).is_err());
    assert!(none.own().is_empty());
}
