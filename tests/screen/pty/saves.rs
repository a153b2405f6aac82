//! Saving while another program holds the library, like a disk that hangs: keys keep working, the status line says what
//! the program waits for, and the end does not wait.

use std::fs::File;
use std::path::Path;

use rustix::process::Signal;
use taxel_files::storage::{Library, Orphan};

use super::program::{Program, Start};

/// Draws a taxel and saves it in a locked library, until the screen says what the program waits for.
fn saving(library: &Path) -> (Program, File) {
    let lock = File::create(library.join(".lock")).expect("a lock");
    lock.lock().expect("it is free");
    let mut program = Program::started(&Start {
        library: Some(library),
        ..Start::default()
    });
    program.types(b" sname\r");
    program.shows("Saving name: waiting for another taxel to release the library");
    (program, lock)
}

#[test]
fn keys_work_while_another_program_holds_the_library() {
    let folder = tempfile::tempdir().expect("a folder");
    let (mut program, lock) = saving(folder.path());
    program.types(b"\x1b[C \x1b[C ");
    program.shows("NA 3 in all");
    // A second save would be confused with this one.
    program.types(b"s");
    program.shows("name is still being saved");
    lock.unlock().expect("held");
    program.shows("saved as name");
    let library = Library::open(folder.path().to_owned());
    let saved = library.load("name").expect("saved");
    assert_eq!(
        saved.shape.imprint.count(),
        1,
        "as it was when it was saved"
    );
    // Taxels drawn meanwhile are not saved.
    program.types(b"q");
    program.shows("The imprint is not saved");
    program.types(b"nuuq");
    program.ends_well(0);
    assert!(Orphan::all(&library).is_empty());
}

#[test]
fn the_end_does_not_wait_for_another_program() {
    // The cases run together, because they mostly wait for that program.
    std::thread::scope(|scope| {
        for (keys, signal, status) in [
            (&b"q"[..], None, 0),
            (b"", Some(Signal::TERM), 143),
            (b"", Some(Signal::HUP), 129),
        ] {
            scope.spawn(move || ends_before_the_lock(keys, signal, status));
        }
    });
}

fn ends_before_the_lock(keys: &[u8], signal: Option<Signal>, status: i32) {
    let folder = tempfile::tempdir().expect("a folder");
    let (mut program, _lock) = saving(folder.path());
    program.types(keys);
    if let Some(signal) = signal {
        program.signal(signal);
    }
    let (ended, took) = program.ends();
    assert_eq!(ended.code(), Some(status));
    println!("ended within {took:?}");
    program.is_left();
    // If the program had waited for the save, the save would have failed.
    program.shows("Saving name: not done yet, because another program holds the library");
    program.shows("the next start offers it as unsaved work");
    let library = Library::open(folder.path().to_owned());
    assert!(library.load("name").is_err());
    let left = Orphan::all(&library);
    let taxels: Vec<u32> = left.iter().map(|left| left.shape.imprint.count()).collect();
    assert_eq!(taxels, [1]);
}

/// A reading waits behind the save; Esc drops it.
#[test]
fn esc_gives_up_what_is_read_late() {
    let folder = tempfile::tempdir().expect("a folder");
    let (mut program, lock) = saving(folder.path());
    program.types(b"l");
    program.shows("the library is being read");
    program.types(b"washe");
    program.shows("filter: washe");
    program.types(b"\x1b");
    program.shows("Listing the shapes: stopped waiting");
    lock.unlock().expect("held");
    program.shows("? Help");
    program.types(b"l");
    program.types(b"washer\r");
    program.shows("washer loaded");
    program.types(b"q");
    program.ends_well(0);
}
