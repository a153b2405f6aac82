//! Goes through the system calls of an act: the program is killed just before each call, or the call is refused.

use std::os::unix::process::ExitStatusExt;
use std::process::{Command, Output};
use std::sync::atomic::{AtomicUsize, Ordering};

use super::act;
use super::state::State;
use super::state::each;
use super::state::program;
use super::strace;
use super::strace::Call;
use taxel::storage::LibraryError;

/// An act on a library, with the states that it may leave.
#[derive(Clone, Copy)]
struct Deed {
    name: &'static str,
    state: fn() -> State,
    command: fn(&State) -> Command,
    /// Checks that the state is the one before or after the act, and returns true if it is the one after.
    done: fn(&State, &Output) -> bool,
}

const DEEDS: [Deed; 8] = [
    Deed {
        name: "saving over a shape",
        state: State::new,
        command: |state| {
            let new = state.new.to_string_lossy();
            program(&["library", "save", "one", &new, "--force"], &state.folder)
        },
        done: |state, _| either(state.version("one"), Some(1), Some(9)),
    },
    Deed {
        name: "saving a new shape",
        state: State::new,
        command: |state| {
            let new = state.new.to_string_lossy();
            program(&["library", "save", "fresh", &new], &state.folder)
        },
        done: |state, _| either(state.version("fresh"), None, Some(9)),
    },
    Deed {
        name: "saving into a new library",
        state: || {
            let state = State::new();
            std::fs::remove_dir_all(&state.folder).expect("removed");
            state
        },
        command: |state| {
            let new = state.new.to_string_lossy();
            program(&["library", "save", "fresh", &new], &state.folder)
        },
        done: |state, _| either(state.version("fresh"), None, Some(9)),
    },
    Deed {
        name: "deleting",
        state: State::new,
        command: |state| program(&["library", "delete", "one"], &state.folder),
        done: |state, _| {
            let deleted = either(state.version("one"), Some(1), None);
            let restored = state.library().restore("one").is_ok();
            assert_eq!(deleted, restored, "in its place or in the trash");
            assert_eq!(state.version("one"), Some(1));
            deleted
        },
    },
    Deed {
        name: "restoring",
        state: State::new,
        command: |state| program(&["library", "restore", "gone"], &state.folder),
        done: |state, _| {
            let restored = either(state.version("gone"), None, Some(3));
            assert_eq!(state.library().restore("gone").is_ok(), !restored);
            assert_eq!(state.version("gone"), Some(3));
            restored
        },
    },
    Deed {
        name: "throwing away",
        state: State::new,
        command: |state| act::command("throw away", &state.folder),
        done: |state, output| {
            let thrown = state.library().restore("lost 1").is_ok();
            assert_eq!(state.version("lost 1"), thrown.then_some(7));
            assert!(thrown || output.stdout.is_empty(), "{output:?}");
            thrown
        },
    },
    Deed {
        name: "journalling",
        state: State::new,
        command: |state| act::command("journal", &state.folder),
        done: |state, output| {
            let said = String::from_utf8_lossy(&output.stdout).into_owned();
            let possible: &[&[u32]] = match said.lines().last() {
                None => &[&[], &[1]],
                Some("kept 1") => &[&[1], &[2]],
                Some("kept 2") => &[&[2]],
                Some("clearing") => &[&[2], &[]],
                _ => &[&[]],
            };
            let found = state.orphans();
            assert!(possible.contains(&&found[..]), "{said}: {found:?}");
            said.ends_with("cleared\n")
        },
    },
    Deed {
        name: "recovering",
        state: || State::new().with_orphan(),
        command: |state| act::command("recover", &state.folder),
        done: |state, output| {
            let found = state.orphans();
            assert!(
                [&[7][..], &[7, 7]].contains(&&found[..]),
                "offered again: {found:?}"
            );
            output.stdout == b"recovered\n"
        },
    },
];

/// Asserts that `found` is one of two values, and returns true if it is the second.
fn either(found: Option<u32>, before: Option<u32>, after: Option<u32>) -> bool {
    assert!(
        found == before || found == after,
        "{found:?} is neither {before:?} nor {after:?}"
    );
    found == after
}

/// Checks that the rest of the library is still intact.
fn others(deed: &Deed, state: &State) {
    state.starts();
    if deed.name != "saving into a new library" {
        assert_eq!(state.version("two"), Some(2), "{}", deed.name);
    }
}

/// Pairs every deed with each system call that it makes in the library.
fn jobs() -> Vec<(Deed, Call)> {
    let mut jobs = Vec::new();
    for deed in DEEDS {
        let state = (deed.state)();
        let calls = strace::calls(&(deed.command)(&state), &state.folder);
        assert!(calls.len() > 3, "{}: {calls:?}", deed.name);
        jobs.extend(calls.into_iter().map(|call| (deed, call)));
    }
    jobs
}

/// Kills the program just before each call.
pub(crate) fn killed() -> String {
    if !strace::works() {
        return "SKIPPED, strace is missing or may not trace".to_owned();
    }
    let jobs = jobs();
    let after = AtomicUsize::new(0);
    each(&jobs, |(deed, call)| {
        let state = (deed.state)();
        let output = strace::tampered(&(deed.command)(&state), call, "signal=KILL");
        let signal = output.status.signal();
        assert_eq!(signal, Some(9), "{}, {call:?}: {output:?}", deed.name);
        let done = (deed.done)(&state, &output);
        after.fetch_add(usize::from(done), Ordering::Relaxed);
        others(deed, &state);
    });
    format!(
        "{} kills, nothing lost or torn, no start blocked; the new state there {} times, else the old one",
        jobs.len(),
        after.into_inner()
    )
}

/// Returns how many kills tore the file of a program that writes into it directly, and the number of kills.
pub(crate) fn naive() -> (usize, usize) {
    let state = || {
        let state = State::new();
        std::fs::write(state.folder.join("enough"), "").expect("written");
        state
    };
    let plan = state();
    let calls = strace::calls(&act::command("naive", &plan.folder), &plan.folder);
    let torn = AtomicUsize::new(0);
    each(&calls, |call| {
        let state = state();
        strace::tampered(&act::command("naive", &state.folder), call, "signal=KILL");
        let loaded = state.library().load("one");
        let broken = matches!(loaded, Err(LibraryError::Broken { .. }));
        torn.fetch_add(usize::from(broken), Ordering::Relaxed);
    });
    (torn.into_inner(), calls.len())
}

/// The errors that a file system returns, with the system's texts for them.
const ERRORS: [(&str, &str); 5] = [
    ("ENOSPC", "No space left on device"),
    ("EIO", "Input/output error"),
    ("EACCES", "Permission denied"),
    ("EROFS", "read-only"),
    ("EDQUOT", "Disk quota exceeded"),
];

/// Refuses each call with each error; also interrupts calls.
pub(crate) fn refused() -> String {
    if !strace::works() {
        return "SKIPPED, strace is missing or may not trace".to_owned();
    }
    let calls = jobs().into_iter();
    let by_program = calls.filter(|(deed, _)| {
        let by_act = ["throwing away", "journalling", "recovering"];
        !by_act.contains(&deed.name)
    });
    let refused: Vec<(Deed, Call, &str, &str)> = by_program
        .flat_map(|(deed, call)| {
            let error = move |(error, text)| (deed, call.clone(), error, text);
            ERRORS.into_iter().map(error)
        })
        .collect();
    let told = AtomicUsize::new(0);
    each(&refused, |(deed, call, error, text)| {
        let state = (deed.state)();
        let how = format!("error={error}");
        let output = strace::tampered(&(deed.command)(&state), call, &how);
        let message = String::from_utf8_lossy(&output.stderr).into_owned();
        let context = format!("{}, {call:?} {error}: {output:?}", deed.name);
        let done = (deed.done)(&state, &output);
        others(deed, &state);
        match output.status.code() {
            // If another user's file cannot be opened in one way, another is tried; a file that cannot be removed is
            // left.
            Some(0) => assert!(done && message.is_empty(), "{context}"),
            Some(1) => {
                let one = message.lines().count() == 1 && message.starts_with("error: ");
                let has_reason = message.to_lowercase().contains(&text.to_lowercase());
                assert!(one && has_reason, "{context}");
                assert!(message.contains("library"), "it names the place: {context}");
                // If only the last step fails, the new state is in place, and the message says so.
                assert_eq!(done, message.contains("a power cut may undo"), "{context}");
                told.fetch_add(1, Ordering::Relaxed);
            }
            _ => panic!("{context}"),
        }
    });
    let calls = jobs().into_iter();
    let interrupted: Vec<(Deed, Call)> = calls
        .filter(|(_, call)| matches!(call.name.as_str(), "openat" | "write" | "fsync" | "flock"))
        .collect();
    each(&interrupted, |(deed, call)| {
        let state = (deed.state)();
        let output = strace::tampered(&(deed.command)(&state), call, "error=EINTR");
        let context = format!("{}, {call:?}: {output:?}", deed.name);
        assert_eq!(output.status.code(), Some(0), "{context}");
        assert!((deed.done)(&state, &output), "{context}");
        others(deed, &state);
    });
    format!(
        "{} calls refused, {} of them told by a message and status 1; {} interrupted, and done again",
        refused.len(),
        told.into_inner(),
        interrupted.len()
    )
}
