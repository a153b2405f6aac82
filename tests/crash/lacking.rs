//! File systems without some features, simulated with `strace`: locks, renaming without replacing, hard links, free
//! space. Also folders that a stranger has filled.

use std::fs;
use std::path::Path;
use std::process::Command;

use taxel::storage::{Library, Orphan};

use super::array;
use super::state::{State, program, shape, taxel};
use super::strace;

pub(crate) fn done_without() -> String {
    if !strace::works() {
        return "SKIPPED, strace is missing or may not trace".to_owned();
    }
    for error in ["ENOLCK", "EPERM", "EINVAL"] {
        let state = State::new();
        let new = state.new.to_string_lossy();
        let save = program(&["library", "save", "fresh", &new], &state.folder);
        let run = strace::refused(&save, "?flock", error);
        assert_eq!(run.status.code(), Some(0), "{error}: {run:?}");
        assert_eq!(state.version("fresh"), Some(9), "{error}");
    }
    let state = State::new();
    let target = state.folder.join("fresh.svg");
    let name = target.to_string_lossy();
    let export = program(&["figure", "hexagon", "--export", &name], &state.folder);
    let run = strace::refused(&export, "?renameat2,?link,?linkat", "EPERM");
    assert_eq!(run.status.code(), Some(0), "{run:?}");
    let text = fs::read_to_string(&target).expect("written");
    assert!(text.ends_with("</svg>\n"), "whole");
    // A recording continues in the file with the requested name, even if that is a copy.
    let (frames, array) = (
        state.folder.join("frames.txt"),
        state.folder.join("rec.npy"),
    );
    fs::write(&frames, "1 2\n3 4\n\n".repeat(50)).expect("written");
    let (source, name) = (frames.to_string_lossy(), array.to_string_lossy());
    let mut watch = Command::new(env!("CARGO_BIN_EXE_taxel"));
    let arguments = ["--format", "lines", "--once", "--at-least", "1", "--write"];
    watch
        .args(["watch", &source])
        .args(arguments)
        .arg(&*name)
        .env("TAXEL_CONFIG", "/dev/null");
    let run = strace::refused(&watch, "?linkat", "EPERM");
    assert_eq!(run.status.code(), Some(0), "{run:?}");
    assert_eq!(recorded(&array), 50);
    // The message names the requested file, not the temporary one.
    fs::remove_file(&target).expect("removed");
    let run = strace::refused(&export, "?fsync,?fdatasync", "EIO");
    let message = String::from_utf8_lossy(&run.stderr).into_owned();
    assert_eq!(run.status.code(), Some(1), "{run:?}");
    assert!(
        message.contains("fresh.svg: ") && !message.contains(".taxel-"),
        "{message}"
    );
    "no locks, no links, no names without replacing: saved; what is refused is told by its own name"
        .to_owned()
}

/// Returns the number of frames in an array, and checks that its header and its length agree on it.
fn recorded(path: &Path) -> usize {
    let array = fs::read(path).expect("it is there");
    let records = (array.len() - 256) / (16 + 4 * 8);
    assert_eq!(array::records(&array), Some(records));
    records
}

pub(crate) fn crafted() -> String {
    let state = State::new();
    // The trash entry with the last number but one: later deletions must not be lost.
    let crafted = state.folder.join(".trash/18446744073709551614 z.json");
    fs::write(&crafted, shape("z", 5).write()).expect("written");
    assert!(
        taxel(&["library", "delete", "one"], &state.folder)
            .status
            .success()
    );
    assert!(
        taxel(&["library", "restore", "one"], &state.folder)
            .status
            .success()
    );
    assert_eq!(state.version("one"), Some(1));
    // More unsaved work than the number of files that a program may open.
    let journal = state.folder.join(".journal");
    fs::create_dir(&journal).expect("made");
    for number in 0..1500 {
        fs::write(journal.join(format!("{number}-0.lock")), "").expect("written");
        let work = shape(&format!("work {number}"), 7).write();
        fs::write(journal.join(format!("{number}-0.json")), work).expect("written");
    }
    let waiting = Orphan::all(&Library::open(state.folder.clone()));
    assert_eq!(waiting.len(), 100, "at once; the others wait");
    let list = taxel(&["library", "list"], &state.folder);
    assert!(list.status.success(), "{list:?}");
    "a crafted number in the trash, 1,500 journals: nothing lost, nothing refused".to_owned()
}
