//! Real programs, killed or refused at every system call, and killed at random. After each of these, either the old or
//! the new content is in place, nothing else is lost or torn, and the next program can read, save and record.
//!
//! `cargo test --test crash` kills 300 times at random; `TAXEL_KILLS=2000 cargo test --test crash` does it more often.
//! The seed of a run is printed, and `TAXEL_SEED` sets it. Without a `strace` that may trace, only random kills are
//! tried.

#[path = "../common/array.rs"]
mod array;

#[path = "../common/skip.rs"]
mod skip;

mod deeds;
mod state;
mod strace;

use std::io::{BufRead, BufReader, Read};
use std::os::unix::process::ExitStatusExt;
use std::sync::atomic::{AtomicUsize, Ordering};
use std::time::{Duration, SystemTime};
use std::{env, thread};

use taxel_files::storage::LibraryError;

use deeds::{DEEDS, Deed, perform, restart};
use state::State;

fn main() {
    if perform() {
        return;
    }
    let asked: Vec<String> = env::args().skip(1).collect();
    for (name, campaign) in [
        ("at_every_call", at_every_call as fn() -> String),
        ("at_random", at_random),
    ] {
        if asked.iter().any(|argument| argument == "--list") {
            println!("{name}: test");
        } else if asked
            .iter()
            .all(|part| part.starts_with('-') || name.contains(part.as_str()))
        {
            println!("test {name} ... ok: {}", campaign());
        }
    }
}

/// Runs all jobs, one at a time on each core.
fn each<T: Sync>(jobs: &[T], run: impl Fn(&T) + Sync) {
    let next = AtomicUsize::new(0);
    let cores = thread::available_parallelism().map_or(1, usize::from);
    thread::scope(|scope| {
        for _ in 0..cores {
            scope.spawn(|| {
                while let Some(job) = jobs.get(next.fetch_add(1, Ordering::Relaxed)) {
                    run(job);
                }
            });
        }
    });
}

/// Goes through the system calls of each deed that concern its folder. Just before each, the program is killed; in
/// another run, the call is refused as on a full disk.
fn at_every_call() -> String {
    if !strace::works() {
        skip::lacking("strace that may trace");
        return "skipped".to_owned();
    }
    let jobs: Vec<(&Deed, strace::Call)> = DEEDS
        .iter()
        .flat_map(|deed| {
            let state = State::new();
            let calls = strace::calls(&(deed.command)(&state), state.place());
            assert!(calls.len() > 3, "{}: {calls:?}", deed.name);
            let output = state::finish(&mut (deed.command)(&State::new()));
            assert!(output.status.success(), "{}: {output:?}", deed.name);
            calls.into_iter().map(move |call| (deed, call))
        })
        .collect();
    let (new, refused, torn) = Default::default();
    let count = |number: &AtomicUsize, is: bool| number.fetch_add(is.into(), Ordering::Relaxed);
    each(&jobs, |(deed, call)| {
        let state = State::new();
        let output = strace::tampered(&(deed.command)(&state), call, "signal=KILL");
        let context = format!("{}, {call:?}: {output:?}", deed.name);
        assert_eq!(output.status.signal(), Some(9), "{context}");
        if deed.is_naive {
            let is_broken = matches!(state.load("one"), Err(LibraryError::Broken { .. }));
            count(&torn, is_broken);
            return;
        }
        count(&new, (deed.done)(&state, &output, &context));
        state.goes_on(&context);

        let state = State::new();
        let output = strace::tampered(&(deed.command)(&state), call, "error=ENOSPC");
        let context = format!("{}, {call:?} refused: {output:?}", deed.name);
        let done = (deed.done)(&state, &output, &context);
        let message = String::from_utf8_lossy(&output.stderr);
        match output.status.code() {
            // What cannot be removed or locked against others is left.
            Some(0) => assert!(done, "{context}"),
            Some(_) => assert!(message.contains("No space left on device"), "{context}"),
            None => panic!("{context}"),
        }
        count(&refused, output.status.code() != Some(0));
        let left = state.temporary_files();
        assert!(left == 0 || call.name.starts_with("unlink"), "{context}");
        state.goes_on(&context);
    });
    let [new, refused, torn] = [new, refused, torn].map(AtomicUsize::into_inner);
    // Unless writing into the file itself is caught, this campaign finds nothing.
    assert!(torn > 0, "naive writing was not caught");
    format!(
        "{} calls, nothing lost or torn; the new content was there {new} times after a kill, {refused} refusals told, \
         naive writing torn {torn} times",
        jobs.len()
    )
}

/// Saves, journals, deletes and restores for ever, and is killed at random moments, as by a power cut or the system's
/// out-of-memory killer. Everything reported as saved must be there.
fn at_random() -> String {
    let number = |name: &str| Some(env::var(name).ok()?.parse().expect("a whole number"));
    let kills = number("TAXEL_KILLS").unwrap_or(300);
    let clock = SystemTime::now().duration_since(SystemTime::UNIX_EPOCH);
    let seed = number("TAXEL_SEED").unwrap_or(clock.map_or(1, |time| time.subsec_nanos()));
    println!("TAXEL_SEED={seed} kills at these moments again");
    let mut word = seed | 1;
    let mut moment = || {
        // Xorshift: G. Marsaglia, *Xorshift RNGs*, 2003.
        word ^= word << 13;
        word ^= word >> 17;
        word ^= word << 5;
        Duration::from_micros(u64::from(word % 40_000))
    };
    let moments: Vec<Duration> = (0..kills).map(|_| moment()).collect();
    let (saves, in_trash) = (AtomicUsize::new(0), AtomicUsize::new(0));
    each(&moments, |&after| {
        let state = State::new();
        let (saved, kept) = churned(&state, after);
        let one = state.version("one").expect("there is always one");
        assert!([saved, saved + 1].contains(&one), "{one} after {saved}");
        match state.orphans()[..] {
            [] => assert_eq!(kept, 1, "the journal is lost"),
            [work] => assert!([kept, kept + 1].contains(&work), "{work} after {kept}"),
            _ => panic!("one program has one journal"),
        }
        if state.version("two").is_none() {
            in_trash.fetch_add(1, Ordering::Relaxed);
            state.library().restore("two").expect("it is in the trash");
        }
        state.goes_on("killed at random");
        saves.fetch_add(saved as usize - 1, Ordering::Relaxed);
    });
    let (saves, in_trash) = (saves.into_inner(), in_trash.into_inner());
    assert!(saves > 0, "no kill after a save");
    format!(
        "{kills} kills in {saves} saves, nothing lost or torn; {in_trash} times between deleting and restoring"
    )
}

/// Kills a program some time after its first save. Returns the last numbers that it printed after "saved" and "kept".
fn churned(state: &State, after: Duration) -> (u32, u32) {
    let mut child = restart("churn", state).spawn().expect("it starts");
    let mut output = BufReader::new(child.stdout.take().expect("piped"));
    let mut said = String::new();
    // On a busy machine, the start alone may take longer than these moments.
    while !said.contains("saved") {
        let read = output.read_line(&mut said).expect("text");
        assert!(read > 0, "it ended before it saved: {said}");
    }
    thread::sleep(after);
    child.kill().expect("killed");
    child.wait().expect("a child");
    output.read_to_string(&mut said).expect("text");
    let last = |word: &str| {
        let number = said.lines().rev().find_map(|line| line.strip_prefix(word));
        number.map_or(1, |number| number.trim().parse().expect("a number"))
    };
    (last("saved"), last("kept"))
}
