//! Deleting and restoring.

use taxel_files::storage::{Expected, Library, LibraryError, TRASH_KEPT};

use super::{Scratch, files, refusal, shape};

#[test]
fn a_deleted_shape_is_restored_unchanged() {
    let scratch = Scratch::with(&["one", "two"]);
    let before = std::fs::read(scratch.path("one.json")).expect("there");
    assert_eq!(scratch.library.delete("one").expect("deleted"), "one");
    assert_eq!(scratch.own(), ["two"]);
    let missing = "no shape named \"one\"";
    assert_eq!(refusal(scratch.library.load("one"), &scratch), missing);
    let restored = scratch.library.restore(Some("one"));
    assert_eq!(restored.expect("restored"), "one");
    let after = std::fs::read(scratch.path("one.json")).expect("there");
    assert_eq!(before, after);
    let again = refusal(scratch.library.restore(Some("one")), &scratch);
    assert_eq!(again, format!("{missing} in the trash"));
}

#[test]
fn the_last_deleted_shape_is_restored_first_and_never_over_another() {
    let scratch = Scratch::with(&["two"]);
    for number in 1..=3 {
        scratch.save("one", number);
        scratch.library.delete("one").expect("deleted");
    }
    scratch.library.delete("two").expect("deleted");
    let names = scratch.library.deleted().expect("listed");
    assert_eq!(names, ["two", "one"], "the newest first, each once");
    scratch.save("ONE", 4);
    let taken = scratch.library.restore(Some("one"));
    assert!(matches!(&taken, Err(LibraryError::Exists { name, .. }) if name == "ONE"));
    assert_eq!(scratch.number("one"), Some(4));
    std::fs::remove_file(scratch.path("ONE.json")).expect("removed by hand");
    for number in [3, 2, 1] {
        scratch.library.restore(Some("ONE")).expect("restored");
        assert_eq!(scratch.number("one"), Some(number));
        std::fs::remove_file(scratch.path("one.json")).expect("removed by hand");
    }
    // Another program knows the last one, too.
    let other = Library::open(scratch.folder.clone());
    assert_eq!(other.restore(None).expect("restored"), "two");
    let empty = "the trash is empty";
    assert_eq!(refusal(scratch.library.restore(None), &scratch), empty);
}

#[test]
fn the_last_fifty_deleted_shapes_are_kept() {
    let scratch = Scratch::new();
    for number in 0..TRASH_KEPT + 5 {
        let name = format!("shape {number}");
        scratch.save(&name, 1);
        scratch.library.delete(&name).expect("deleted");
    }
    assert_eq!(files(&scratch.path(".trash")).len(), TRASH_KEPT);
    for (name, is_kept) in [("shape 4", false), ("shape 5", true), ("shape 54", true)] {
        let restored = scratch.library.restore(Some(name));
        assert_eq!(restored.is_ok(), is_kept, "{name}");
    }
}

#[test]
fn shipped_shapes_can_be_neither_deleted_nor_replaced() {
    let scratch = Scratch::new();
    let deleted = refusal(scratch.library.delete("Washer"), &scratch);
    assert_eq!(deleted, "\"Washer\" comes with taxel and cannot be deleted");
    let saved = scratch
        .library
        .save(&shape("WASHER", 1), Expected::Anything);
    assert_eq!(
        refusal(saved, &scratch),
        "\"WASHER\" comes with taxel and cannot be replaced; choose another name"
    );
    assert!(scratch.library.load("WASHER").is_ok());
    let nowhere = Library::open(scratch.path("nowhere"));
    let deleted = refusal(nowhere.delete("nothing"), &scratch);
    assert_eq!(deleted, "no shape named \"nothing\"");
    assert!(nowhere.restore(Some("nothing")).is_err() && !scratch.path("nowhere").exists());
}

/// A time in the future: a clock was set back since.
#[test]
fn foreign_files_and_later_times_in_a_trash_do_no_harm() {
    let scratch = Scratch::with(&["one"]);
    let trash = scratch.path(".trash");
    std::fs::create_dir(&trash).expect("made");
    for file in ["notes.txt", "one-x.json", "1-.bad.json", "one.json"] {
        std::fs::write(trash.join(file), "").expect("written");
    }
    let later = trash.join("one-99999999999999.json");
    std::fs::write(later, shape("one", 7).write()).expect("written");
    scratch.library.delete("one").expect("deleted");
    assert!(trash.join("one-100000000000000.json").exists());
    for number in [1, 7] {
        scratch.library.restore(Some("one")).expect("restored");
        assert_eq!(scratch.number("one"), Some(number));
        std::fs::remove_file(scratch.path("one.json")).expect("removed");
    }
    assert!(scratch.library.restore(Some("one")).is_err());
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
    scratch.library.restore(Some("lost 3")).expect("restored");
    assert_eq!(scratch.number("lost 3"), Some(7));
    let none = Scratch::new();
    none.put(".trash", "in the way");
    assert!(none.library.throw_away(&shape("lost", 7)).is_err());
    assert!(none.own().is_empty());
}
