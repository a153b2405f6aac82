//! Real programs, killed just before every system call that can change a file, and killed at random. After each kill
//! either the old or the new content is in place, nothing else is lost or torn, and the next program can read, save and
//! record.
//!
//! `cargo test --test crash` kills 200 times at random; `TAXEL_KILLS=2000 cargo test --test crash` does it more often.
//! Without a `strace` that may trace, only random kills are tried.

#[path = "../common/array.rs"]
mod array;

#[path = "../common/skip.rs"]
mod skip;

mod state;
mod strace;

use std::io::Write;
use std::os::unix::process::ExitStatusExt;
use std::process::{Command, Output};
use std::sync::atomic::{AtomicUsize, Ordering};
use std::time::Duration;
use std::{env, fs};

use rayon::iter::{IntoParallelRefIterator, ParallelIterator};
use taxel_files::storage::{Expected, Journal, Library, LibraryError};

use state::{ACT, State, shape};

fn main() {
    if let Ok(asked) = env::var(ACT) {
        let (act, folder) = asked.split_once(':').expect("an act and a folder");
        if let Err(error) = perform(act, &Library::open(folder.into())) {
            eprintln!("{error}");
            std::process::exit(1);
        }
    } else if env::args().any(|argument| argument == "--list") {
        println!("at_every_call: test\nat_random: test");
    } else {
        println!("test at_every_call ... ok: {}", at_every_call());
        println!("test at_random ... ok: {}", at_random());
    }
}

/// What the killed programs do. The last one is a control, which must be caught.
const DEEDS: [&str; 6] = ["save", "replace", "delete", "journal", "record", "naive"];

fn command(deed: &str, state: &State) -> Command {
    match deed {
        "save" => state.taxel(&["library", "save", "fresh", "./new.json"]),
        "replace" => state.taxel(&["library", "save", "one", "./new.json", "--force"]),
        "delete" => state.taxel(&["library", "delete", "one"]),
        "record" => {
            let to = ["--once", "--write", "touch.npy", "--force"];
            state.taxel(&[&["watch", "new.txt"], &to[..]].concat())
        }
        act => state.act(act),
    }
}

/// Checks that the state is the one before or the one after a deed whose program was killed.
fn check(deed: &str, state: &State, output: &Output) {
    match deed {
        "save" => assert!([None, Some(9)].contains(&state.version("fresh"))),
        "replace" => assert!([Some(1), Some(9)].contains(&state.version("one"))),
        "delete" => {
            let is_deleted = state.version("one").is_none();
            let restored = state.library().restore(Some("one"));
            assert_eq!(restored.is_ok(), is_deleted);
            assert_eq!(state.version("one"), Some(1));
        }
        "journal" => {
            let said = String::from_utf8_lossy(&output.stdout);
            let possible: [&[u32]; 2] = match said.lines().last() {
                None => [&[], &[1]],
                Some("kept 1") => [&[1], &[2, 3]],
                Some("kept 2") => [&[2, 3], &[]],
                _ => [&[], &[]],
            };
            let found = state.orphans();
            assert!(possible.contains(&&found[..]), "{found:?} after {said}");
        }
        _ => {
            state.recorded();
            let again = command(deed, state).output().expect("it starts");
            assert!(again.status.success(), "{again:?}");
            assert_eq!(state.recorded(), (3, true));
        }
    }
}

/// Goes through the system calls of each deed that concern its folder, and kills the program just before each.
fn at_every_call() -> String {
    if !strace::works() {
        skip::lacking("strace that may trace");
        return "skipped".to_owned();
    }
    let mut jobs = Vec::new();
    for deed in DEEDS {
        let state = State::new();
        let calls = strace::calls(&command(deed, &state), state.place());
        assert!(calls.len() > 3, "{deed}: {calls:?}");
        jobs.extend(calls.into_iter().map(|call| (deed, call)));
    }
    let torn = AtomicUsize::new(0);
    jobs.par_iter().for_each(|(deed, call)| {
        let state = State::new();
        let output = strace::killed_before(&command(deed, &state), call);
        assert_eq!(
            output.status.signal(),
            Some(9),
            "{deed}, {call:?}: {output:?}"
        );
        // Shown if one of the checks fails.
        eprintln!("{deed}: killed before {call:?}");
        if *deed == "naive" {
            let is_torn = matches!(state.library().load("one"), Err(LibraryError::Refused(_)));
            torn.fetch_add(is_torn.into(), Ordering::Relaxed);
        } else {
            check(deed, &state, &output);
            state.goes_on();
        }
    });
    let (calls, torn) = (jobs.len(), torn.into_inner());
    // Unless writing into the file itself is caught, this campaign finds nothing.
    assert!(torn > 0, "naive writing was not caught");
    format!("{calls} kills, nothing lost or torn; naive writing torn {torn} times")
}

/// Saves, keeps work, deletes and restores for ever, and is killed at some moment, as by a power cut or the system's
/// out-of-memory killer. Everything reported as saved must be there.
fn at_random() -> String {
    let kills = env::var("TAXEL_KILLS").map_or(200, |kills| kills.parse().expect("a number"));
    // Evenly spread moments hit anything, because no two programs have the same pace.
    let moments: Vec<u64> = (0..kills).map(|kill| kill * 40_000 / kills).collect();
    let saves = AtomicUsize::new(0);
    moments.par_iter().for_each(|&after| {
        let state = State::new();
        let (saved, kept) = state.churned(Duration::from_micros(after));
        let one = state.version("one").expect("there is always one");
        assert!([saved, saved + 1].contains(&one), "{one} after {saved}");
        match state.orphans()[..] {
            [] => assert_eq!(kept, 1, "the journal is lost"),
            [work] => assert!([kept, kept + 1].contains(&work), "{work} after {kept}"),
            _ => panic!("more than was kept"),
        }
        if state.version("two").is_none() {
            let restored = state.library().restore(Some("two"));
            restored.expect("it is in the trash");
        }
        state.goes_on();
        saves.fetch_add(saved as usize - 1, Ordering::Relaxed);
    });
    let saves = saves.into_inner();
    assert!(saves > 0, "no kill after a save");
    format!("{kills} kills in {saves} saves, nothing lost or torn")
}

/// Performs an act. Each step is printed as soon as it is done; what was printed must survive the kill.
fn perform(act: &str, library: &Library) -> Result<(), Box<dyn std::error::Error>> {
    let say = |text: &str| {
        // Once this program is to be killed, nobody reads its output any more.
        let mut out = std::io::stdout().lock();
        let _ = writeln!(out, "{text}").and_then(|()| out.flush());
    };
    let mut journal = Journal::new(library);
    match act {
        "journal" => {
            journal.keep(vec![shape("work", 1)])?;
            say("kept 1");
            journal.keep(vec![shape("work", 2), shape("more", 3)])?;
            say("kept 2");
            journal.keep(Vec::new())?;
            say("cleared");
        }
        "churn" => {
            for version in 2.. {
                library.save(&shape("one", version), Expected::Anything)?;
                say(&format!("saved {version}"));
                journal.keep(vec![shape("work", version)])?;
                say(&format!("kept {version}"));
                library.delete("two")?;
                library.restore(Some("two"))?;
            }
        }
        _ => {
            let mut file = fs::File::create(library.folder().join("one.json"))?;
            for line in shape("one", 2).write().lines() {
                writeln!(file, "{line}")?;
            }
        }
    }
    Ok(())
}
