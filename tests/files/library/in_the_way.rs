//! Folders, pipes, read-only places and broken files: each is reported, and none affects the other shapes.
#![cfg(unix)]

use std::fs::{self, Permissions};
use std::os::unix::fs::{PermissionsExt, symlink};
use std::process::Command;

use taxel_files::storage::{Expected, Journal, Library, Orphan};

use super::{Scratch, is_root, refusal, shape};
use crate::skip::skipped;

#[test]
fn what_is_no_file_is_reported_and_left_alone() {
    let scratch = Scratch::with(&["good"]);
    fs::create_dir(scratch.path("dir.json")).expect("a folder");
    let made = Command::new("mkfifo")
        .arg(scratch.path("pipe.json"))
        .status();
    assert!(made.expect("mkfifo starts").success(), "a pipe");
    for name in ["dir", "pipe"] {
        let expected = format!("FOLDER/{name}.json: cannot read: not a regular file");
        let load = scratch.library.load(name);
        assert_eq!(refusal(load, &scratch), expected);
        for replaced in [Expected::Nothing, Expected::Stamp(0), Expected::Anything] {
            let saved = scratch.library.save(&shape(name, 9), replaced);
            assert_eq!(refusal(saved, &scratch), expected);
        }
    }
    // A link is not replaced, and nothing is written through it.
    symlink("good.json", scratch.path("link.json")).expect("a link");
    let saved = scratch.library.save(&shape("link", 9), Expected::Anything);
    assert!(refusal(saved, &scratch).contains("only regular files are replaced"));
    assert_eq!(scratch.own(), ["dir", "good", "link", "pipe"]);
    assert_eq!(scratch.number("good"), Some(1));
}

#[test]
fn a_library_path_that_is_not_a_folder_is_reported() {
    let scratch = Scratch::new();
    scratch.put("file", "");
    symlink("nowhere", scratch.path("dangling")).expect("a link");
    for inner in ["file", "file/inner", "dangling"] {
        let library = Library::open(scratch.path(inner));
        let saved = library.save(&shape("new", 1), Expected::Nothing);
        let refused = format!("FOLDER/{inner}: cannot make the folder: ");
        assert!(refusal(saved, &scratch).starts_with(&refused));
        assert_eq!(Orphan::all(&library).len(), 0);
        let kept = Journal::new(&library).keep(vec![shape("work", 1)]);
        assert!(kept.is_err());
    }
    let library = Library::open(scratch.path("file"));
    let message = "FOLDER/file: cannot read the folder: not a folder";
    assert_eq!(refusal(library.list(), &scratch), message);
    let library = Library::open(scratch.path("a/b/c"));
    assert!(library.list().is_ok() && library.load("new").is_err());
    assert!(!scratch.path("a").exists(), "nothing is made by looking");
    let saved = library.save(&shape("new", 1), Expected::Nothing);
    saved.expect("made with those above it");
}

#[test]
fn broken_files_are_listed_and_reported_without_affecting_others() {
    let scratch = Scratch::with(&["good"]);
    let good = shape("x", 1).write();
    let cut = &good[..good.len() / 2];
    for (name, content, message) in [
        ("cut", cut, "line 15, column 20: "),
        (
            "newer",
            &good.replace("shape/1", "shape/2"),
            "`taxel-shape/2`, expected `taxel-shape/1`",
        ),
        (
            "huge",
            &" ".repeat((1 << 20) + 5),
            "larger than 1 MiB, the limit for a shape",
        ),
    ] {
        scratch.put(&format!("{name}.json"), content);
        let told = refusal(scratch.library.load(name), &scratch);
        let start = format!("FOLDER/{name}.json: ");
        assert!(told.starts_with(&start) && told.contains(message), "{told}");
    }
    assert_eq!(scratch.own(), ["cut", "good", "huge", "newer"]);
    assert_eq!(scratch.number("good"), Some(1));
    // A broken file is moved into the trash and back unchanged.
    scratch.library.delete("cut").expect("deleted");
    scratch.library.restore(Some("cut")).expect("restored");
    let back = fs::read_to_string(scratch.path("cut.json")).expect("there");
    assert_eq!(back, cut);
}

#[test]
fn foreign_files_are_skipped() {
    let scratch = Scratch::with(&["good"]);
    for own in ["models", ".journal", ".trash"] {
        fs::create_dir(scratch.path(own)).expect("made");
        scratch.put(&format!("{own}/x.json"), "");
    }
    for file in [
        "a:b.json",
        "good.json~",
        "notes.txt",
        "x.JSON",
        ".hidden.json",
        ".taxel-AbC123Ab",
    ] {
        scratch.put(file, "");
    }
    assert_eq!(scratch.own(), ["good"]);
}

#[test]
fn read_only_files_are_not_replaced_and_modes_are_kept() {
    let scratch = Scratch::with(&["kept", "own"]);
    for (name, mode, saved) in [("kept", 0o444, false), ("own", 0o640, true)] {
        let path = scratch.path(&format!("{name}.json"));
        fs::set_permissions(&path, Permissions::from_mode(mode)).expect("set");
        let replaced = scratch.library.save(&shape(name, 9), Expected::Anything);
        assert_eq!(replaced.is_ok(), saved, "{replaced:?}");
        assert_eq!(scratch.number(name) == Some(9), saved);
        let found = fs::metadata(path).expect("there").permissions();
        assert_eq!(found.mode() & 0o7777, mode);
    }
}

#[test]
fn a_read_only_folder_can_be_read() {
    if is_root() {
        skipped("root may write everywhere");
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
