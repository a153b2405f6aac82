//! What the killed programs do: commands of taxel, and this binary, started again with a variable that names an act.
//! Each act prints every step as soon as it is done; what was printed must survive the kill.

use std::fs::{self, File};
use std::io::{Write, stdout};
use std::path::Path;
use std::process::{Command, Output};

use taxel_files::storage::{Expected, Journal, Library};

use super::array;
use super::state::{State, program, shape};

pub(crate) struct Deed {
    pub(crate) name: &'static str,
    pub(crate) command: fn(&State) -> Command,
    /// Checks that the state is the one before or after the deed; true if it is the one after.
    pub(crate) done: fn(&State, &Output, &str) -> bool,
    /// Whether it writes into the file itself: a control, which must be caught.
    pub(crate) is_naive: bool,
}

pub(crate) const DEEDS: [Deed; 7] = [
    Deed {
        name: "saving a new shape",
        command: |state| save(state, "fresh", &[]),
        done: |state, _, context| either(state.version("fresh"), [None, Some(9)], context),
        is_naive: false,
    },
    Deed {
        name: "replacing a shape",
        command: |state| save(state, "one", &["--force"]),
        done: |state, _, context| either(state.version("one"), [Some(1), Some(9)], context),
        is_naive: false,
    },
    Deed {
        name: "deleting",
        command: |state| program(&["library", "delete", "one"], state),
        done: |state, _, context| {
            let deleted = either(state.version("one"), [Some(1), None], context);
            assert_eq!(state.library().restore("one").is_ok(), deleted, "{context}");
            assert_eq!(state.version("one"), Some(1), "{context}");
            deleted
        },
        is_naive: false,
    },
    Deed {
        name: "restoring",
        command: |state| program(&["library", "restore", "gone"], state),
        done: |state, _, context| {
            let restored = either(state.version("gone"), [None, Some(3)], context);
            assert_eq!(state.library().restore("gone").is_err(), restored);
            assert_eq!(state.version("gone"), Some(3), "{context}");
            restored
        },
        is_naive: false,
    },
    Deed {
        name: "journalling",
        command: |state| restart("journal", state),
        done: |state, output, context| {
            let said = String::from_utf8_lossy(&output.stdout).into_owned();
            let possible: &[&[u32]] = match said.lines().last() {
                None => &[&[], &[1]],
                Some("kept 1") => &[&[1], &[2]],
                Some("kept 2") => &[&[2], &[]],
                _ => &[&[]],
            };
            let found = state.orphans();
            let is_full = output.status.code() == Some(0) && found == [2];
            assert!(
                possible.contains(&&found[..]) || is_full,
                "{found:?} {context}"
            );
            said.ends_with("cleared\n")
        },
        is_naive: false,
    },
    Deed {
        name: "recording",
        command: |state| record(state, "new.txt"),
        done: |state, output, context| {
            let (is_new, frames, is_described) = recorded(state, context);
            let is_whole = is_new && frames == 3 && is_described;
            assert!(
                output.status.code() != Some(0) || is_whole,
                "{frames} {context}"
            );
            // An array is never described by another recording; whether it has ended does not matter here.
            let again = record(state, "new.txt").output().expect("it runs");
            assert!(again.status.success(), "{context}: {again:?}");
            assert_eq!(recorded(state, context), (true, 3, true), "{context}");
            is_whole
        },
        is_naive: false,
    },
    Deed {
        name: "writing into the file itself",
        command: |state| restart("naive", state),
        done: |_, _, _| true,
        is_naive: true,
    },
];

/// Asserts that `found` is one of two values, and returns whether it is the second.
fn either(found: Option<u32>, [before, after]: [Option<u32>; 2], context: &str) -> bool {
    assert!(found == before || found == after, "{found:?} {context}");
    found == after
}

fn save(state: &State, name: &str, more: &[&str]) -> Command {
    let new = state.path("new.json");
    program(&[&["library", "save", name, &new], more].concat(), state)
}

/// Records a file of frames over the old recording, which has one frame with the values 1 to 4.
fn record(state: &State, source: &str) -> Command {
    let (source, touch) = (state.path(source), state.path("touch.npy"));
    program(
        &["watch", &source, "--once", "--write", &touch, "--force"],
        state,
    )
}

/// Whether the array is the new one, its number of frames, and whether it is described. Checks that the description
/// is of the same source, and that all frames are whole.
fn recorded(state: &State, context: &str) -> (bool, usize, bool) {
    let array = fs::read(state.path("touch.npy")).expect("there is always one");
    let frames = array::records(&array).expect("a header");
    let start = array::start(&array).expect("a header");
    assert!(array.len() >= start + frames * (16 + 4 * 8), "{context}");
    let value = |bytes: &[u8]| f64::from_le_bytes(bytes.try_into().expect("eight bytes"));
    // A record begins with its time and its number, 8 bytes each. The new array has no frame at first.
    let first = (frames > 0).then(|| value(&array[start + 16..start + 24]));
    let is_new = first != Some(1.0);
    let Ok(text) = fs::read_to_string(state.path("touch.json")) else {
        return (is_new, frames, false);
    };
    let json: serde_json::Value = serde_json::from_str(&text).expect("whole");
    let source = json["source"].as_str().expect("a source");
    assert_eq!(source.ends_with("new.txt"), is_new, "{context}");
    (is_new, frames, true)
}

const VARIABLE: &str = "TAXEL_CRASH_ACT";

/// The command that starts this binary to perform an act.
pub(crate) fn restart(act: &str, state: &State) -> Command {
    let mut command = Command::new(std::env::current_exe().expect("this binary"));
    command.env(VARIABLE, format!("{act}:{}", state.folder.display()));
    super::state::piped(&mut command);
    command
}

/// Performs the act that the variable names; returns false if it is not set.
pub(crate) fn perform() -> bool {
    let Ok(asked) = std::env::var(VARIABLE) else {
        return false;
    };
    let (act, folder) = asked.split_once(':').expect("an act and a folder");
    let library = Library::open(folder.into());
    let done = match act {
        "journal" => journal(&library),
        "churn" => churn(&library),
        "naive" => naive(Path::new(folder)),
        _ => panic!("an unknown act: {act}"),
    };
    if let Err(error) = done {
        eprintln!("{error}");
        std::process::exit(1);
    }
    true
}

fn say(text: &str) {
    let mut out = stdout().lock();
    // Once this program is to be killed, nobody reads its output any more.
    let _ = writeln!(out, "{text}").and_then(|()| out.flush());
}

type Done = Result<(), Box<dyn std::error::Error>>;

/// Keeps two versions of unsaved work, one after the other, and then clears the journal.
fn journal(library: &Library) -> Done {
    let mut journal = Journal::new(library);
    for version in [1, 2] {
        journal.keep(&shape("work", version))?;
        say(&format!("kept {version}"));
    }
    journal.clear();
    say("cleared");
    Ok(())
}

/// Saves, journals, deletes and restores for ever.
fn churn(library: &Library) -> Done {
    let mut journal = Journal::new(library);
    let mut stamp = library.load("one")?.stamp;
    for version in 2.. {
        stamp = library.save(&shape("one", version), Expected::Stamp(stamp))?;
        say(&format!("saved {version}"));
        journal.keep(&shape("work", version))?;
        say(&format!("kept {version}"));
        library.delete("two")?;
        library.restore("two")?;
    }
    Ok(())
}

/// Saves in the unsafe way: writes into the file itself, line by line.
fn naive(folder: &Path) -> Done {
    let mut file = File::create(folder.join("one.json"))?;
    for line in shape("one", 2).write().lines() {
        writeln!(file, "{line}")?;
    }
    Ok(file.sync_all()?)
}
