//! Folders, pipes, read-only places and broken files: each is reported, and none affects the other shapes.
#![cfg(unix)]

use std::fs::{self, Permissions};
use std::os::unix::fs::{PermissionsExt, symlink};
use std::path::Path;
use std::process::Command;

use taxel_files::storage::{Expected, Journal, Library, Orphan};

use super::{Scratch, is_root, refusal, shape};
use crate::skip::skipped;

fn pipe(path: &Path) {
    let made = Command::new("mkfifo").arg(path).status();
    assert!(made.expect("mkfifo starts").success(), "a pipe");
}

#[test]
fn what_is_no_file_is_reported_and_left_alone() {
    let scratch = Scratch::with(&["good"]);
    fs::create_dir(scratch.path("dir.json")).expect("a folder");
    pipe(&scratch.path("pipe.json"));
    for (name, what) in [("dir", "a folder"), ("pipe", "a FIFO")] {
        let expected = format!("FOLDER/{name}.json: is {what}, expected a regular file");
        let new = shape(name, 9);
        assert_eq!(refusal(scratch.library.load(name), &scratch), expected);
        for replaced in [Expected::Nothing, Expected::Stamp(0)] {
            let saved = scratch.library.save(&new, replaced);
            assert_eq!(refusal(saved, &scratch), expected);
        }
    }
    // A link is not replaced, and nothing is written through it.
    symlink("good.json", scratch.path("link.json")).expect("a link");
    let stamp = scratch.library.load("link").expect("loaded").stamp;
    let saved = scratch
        .library
        .save(&shape("link", 9), Expected::Stamp(stamp));
    let message = "it is a symbolic link, and only regular files are replaced";
    assert!(refusal(saved, &scratch).contains(message));
    assert_eq!(scratch.own(), ["dir", "good", "link", "pipe"]);
    assert_eq!(scratch.number("good"), Some(1));
}

#[test]
fn a_library_path_that_is_not_a_folder_is_reported() {
    let scratch = Scratch::new();
    scratch.put("file", "");
    symlink("nowhere", scratch.path("dangling")).expect("a link");
    for (inner, message) in [
        ("file", "FOLDER/file: is a file, expected a folder"),
        ("file/inner", "FOLDER/file: is a file, expected a folder"),
        (
            "dangling",
            "FOLDER/dangling: is a broken symbolic link, expected a folder",
        ),
    ] {
        let library = Library::open(scratch.path(inner));
        let saved = library.save(&shape("new", 1), Expected::Nothing);
        assert_eq!(refusal(saved, &scratch), message);
        assert_eq!(Orphan::all(&library).len(), 0);
        let kept = Journal::new(&library).keep(&shape("work", 1));
        assert_eq!(refusal(kept, &scratch), message);
    }
    let library = Library::open(scratch.path("file"));
    let message = "FOLDER/file: cannot read the folder: it is a file";
    assert_eq!(refusal(library.list(), &scratch), message);
    let folder = scratch.path("a/b/c");
    let library = Library::open(folder.clone());
    assert!(library.list().is_ok() && library.load("new").is_err());
    assert!(!scratch.path("a").exists(), "nothing is made by looking");
    library
        .save(&shape("new", 1), Expected::Nothing)
        .expect("made with those above it");
}

#[test]
fn broken_files_are_listed_and_reported_without_affecting_others() {
    let scratch = Scratch::with(&["good"]);
    let good = shape("x", 1).write();
    for (name, content, message) in [
        (
            "cut",
            &good[..good.len() / 2],
            "line 15, column 20: EOF while parsing a string",
        ),
        (
            "newer",
            &good.replace("shape/1", "shape/2"),
            "line 2, column 27: unknown value `taxel-shape/2`, expected `taxel-shape/1`",
        ),
        (
            "huge",
            &" ".repeat((1 << 20) + 1),
            "larger than 1 MiB, the limit for a shape",
        ),
    ] {
        scratch.put(&format!("{name}.json"), content);
        let told = refusal(scratch.library.load(name), &scratch);
        let start = format!("FOLDER/{name}.json: ");
        assert!(told.starts_with(&start) && told.contains(message), "{told}");
    }
    let all = ["cut", "good", "huge", "newer"];
    assert_eq!(scratch.own(), all);
    assert_eq!(scratch.number("good"), Some(1));
    // A broken file is moved into the trash and back unchanged.
    scratch.library.delete("cut").expect("deleted");
    scratch.library.restore("cut").expect("restored");
    let back = fs::read_to_string(scratch.path("cut.json")).expect("there");
    assert_eq!(back, good[..good.len() / 2]);
}

#[test]
fn foreign_files_are_skipped_and_reported() {
    let scratch = Scratch::with(&["good"]);
    fs::create_dir(scratch.path(".journal")).expect("made");
    for (file, what) in [
        (".hidden.json", None),
        (".journal/1-0.json", Some("unsaved work, of a running")),
        (".journal/1-0.lock", None),
        (".taxel-AbC123Ab", Some("half-written")),
        ("a:b.json", Some("not a shape: shapes cannot have")),
        ("good.json~", Some("not a shape: its name is not")),
        ("notes.txt", Some("not a shape: its name is not")),
        ("x.JSON", Some("not a shape: its name is not")),
    ] {
        scratch.put(file, "");
        let left = scratch.library.leftovers().expect("read");
        let found = left.iter().find(|(path, _)| *path == scratch.path(file));
        assert_eq!(found.is_some(), what.is_some(), "{file}");
        let words = found.map_or("", |(_, words)| words);
        assert!(words.starts_with(what.unwrap_or_default()), "{words}");
    }
    assert_eq!(scratch.own(), ["good"]);
}

#[test]
fn read_only_files_are_not_replaced_and_modes_are_kept() {
    let scratch = Scratch::with(&["kept", "own"]);
    let mode = |name: &str| {
        let found = fs::metadata(scratch.path(name)).expect("there");
        found.permissions().mode() & 0o7777
    };
    let stamp = |name: &str| scratch.library.load(name).expect("loaded").stamp;
    fs::set_permissions(scratch.path("kept.json"), Permissions::from_mode(0o444)).expect("set");
    fs::set_permissions(scratch.path("own.json"), Permissions::from_mode(0o640)).expect("set");
    let kept = scratch
        .library
        .save(&shape("kept", 9), Expected::Stamp(stamp("kept")));
    let message = "FOLDER/kept.json: cannot replace it, it is read-only: permission denied";
    assert_eq!(refusal(kept, &scratch), message);
    let own = scratch
        .library
        .save(&shape("own", 9), Expected::Stamp(stamp("own")));
    assert!(own.is_ok());
    assert_eq!(
        (scratch.number("kept"), scratch.number("own")),
        (Some(1), Some(9))
    );
    assert_eq!((mode("kept.json"), mode("own.json")), (0o444, 0o640));
}

#[test]
fn a_read_only_folder_can_be_read() {
    if is_root() {
        skipped("root may write everywhere; tests/crash does this with a read-only disk");
        return;
    }
    let scratch = Scratch::with(&["one"]);
    let mode = |mode| fs::set_permissions(&scratch.folder, Permissions::from_mode(mode));
    mode(0o555).expect("set");
    let again = Library::open(scratch.folder.clone());
    let (listed, loaded) = (scratch.own(), scratch.number("one"));
    let saved = again.save(&shape("new", 1), Expected::Nothing);
    let deleted = again.delete("one");
    mode(0o755).expect("set");
    assert_eq!((listed, loaded), (vec!["one".to_owned()], Some(1)));
    for message in [refusal(saved, &scratch), refusal(deleted, &scratch)] {
        assert!(
            message.starts_with("FOLDER") && message.contains("Permission denied"),
            "{message}"
        );
    }
    // In a writable folder, another user's lock file is sufficient.
    fs::set_permissions(scratch.path(".lock"), Permissions::from_mode(0o444)).expect("set");
    scratch.save("new", 1);
}
