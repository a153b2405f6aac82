//! Deleting and restoring.

use taxel_files::storage::{Library, LibraryError, TRASH_KEPT};

use super::{Scratch, files, refusal, shape};

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
    assert_eq!(files(&scratch.path(".trash")).len(), TRASH_KEPT);
    assert!(scratch.library.restore("shape 4").is_err());
    assert!(scratch.library.restore("shape 5").is_ok());
    assert!(scratch.library.restore("shape 54").is_ok());
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
        scratch.library.restore("one").expect("restored");
        assert_eq!(scratch.number("one"), Some(number));
        std::fs::remove_file(scratch.path("one.json")).expect("removed");
    }
    assert!(scratch.library.restore("one").is_err());
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
