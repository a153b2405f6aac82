//! Kills at random moments, as by a power cut or the system's out-of-memory killer; and a control that must fail.

use std::io::{BufRead, BufReader, Read};
use std::sync::atomic::{AtomicU32, Ordering};
use std::time::{Duration, SystemTime};

use super::act;
use super::calls;
use super::state::State;
use super::state::each;
use super::strace;
use taxel::storage::LibraryError;

/// The number of kills in a normal run.
const KILLS: usize = 300;

/// The number of kills in a long run.
const MANY_KILLS: usize = 2000;

fn kills() -> usize {
    let asked = std::env::var("TAXEL_KILLS").ok();
    let ignored = std::env::args().any(|argument| argument.ends_with("ignored"));
    let many = if ignored { MANY_KILLS } else { KILLS };
    asked.and_then(|kills| kills.parse().ok()).unwrap_or(many)
}

/// Starts an act and kills it some time after its first save. Returns the last numbers that it printed after "saved"
/// and "kept".
fn kill(act: &str, state: &State, after: Duration) -> (u32, u32) {
    let mut child = act::command(act, &state.folder)
        .spawn()
        .expect("the program starts");
    let mut output = BufReader::new(child.stdout.take().expect("piped"));
    let mut said = String::new();
    // On a busy machine, the start alone may take longer than these moments.
    while !said.contains("saved") {
        let read = output.read_line(&mut said).expect("text");
        assert!(read > 0, "{act} ended before it saved: {said}");
    }
    std::thread::sleep(after);
    child.kill().expect("killed");
    child.wait().expect("a child");
    output.read_to_string(&mut said).expect("text");
    let last = |word: &str| {
        let number = said.lines().rev().find_map(|line| line.strip_prefix(word));
        number.map_or(1, |number| number.trim().parse().expect("a number"))
    };
    (last("saved"), last("kept"))
}

/// Returns the seed for the moments of a campaign: `TAXEL_SEED`, or a new one for each run, which is printed.
fn seed(campaign: &str) -> u32 {
    let given = std::env::var("TAXEL_SEED").ok();
    let given = given.map(|seed| seed.parse::<u32>().expect("TAXEL_SEED is a whole number"));
    let clock = SystemTime::now().duration_since(SystemTime::UNIX_EPOCH);
    let seed = given.unwrap_or_else(|| clock.map_or(1, |time| time.subsec_nanos()));
    println!("{campaign}: TAXEL_SEED={seed} kills at these moments again");
    seed
}

/// Returns random moments of up to 40 ms each.
fn moments(campaign: &str, count: usize) -> Vec<Duration> {
    let mut word = seed(campaign) | 1;
    let mut next = || {
        // Xorshift: G. Marsaglia, *Xorshift RNGs*, 2003.
        word ^= word << 13;
        word ^= word >> 17;
        word ^= word << 5;
        Duration::from_micros(u64::from(word % 40_000))
    };
    (0..count).map(|_| next()).collect()
}

/// Saves, deletes, restores and journals for ever, and is killed at random. Everything reported as saved must be
/// there.
pub(crate) fn killed() -> String {
    let (saves, in_trash) = (AtomicU32::new(0), AtomicU32::new(0));
    let kills = kills();
    each(&moments("killed_at_random", kills), |&after| {
        let state = State::new();
        let (saved, kept) = kill("churn", &state, after);
        let one = state.version("one").expect("there is always one");
        assert!(
            [saved, saved + 1].contains(&one),
            "{one} after {saved} was saved"
        );
        match state.orphans()[..] {
            [] => assert_eq!(kept, 1, "the journal is lost"),
            [work] => assert!(
                [kept, kept + 1].contains(&work),
                "{work} after {kept} was kept"
            ),
            _ => panic!("one program has one journal"),
        }
        if state.version("two").is_none() {
            in_trash.fetch_add(1, Ordering::Relaxed);
            state.library().restore("two").expect("it is in the trash");
        }
        assert_eq!(state.version("two"), Some(2));
        state.starts();
        saves.fetch_add(saved - 1, Ordering::Relaxed);
    });
    let (saves, in_trash) = (saves.into_inner(), in_trash.into_inner());
    assert!(saves > 0, "no kill after a save");
    format!(
        "{kills} kills in {saves} saves, nothing lost or torn, no start blocked; {in_trash} times between deleting and \
         restoring"
    )
}

/// Does the same with a program that writes into the file itself. Unless this is caught, the campaign finds nothing.
pub(crate) fn naive() -> String {
    let kills = kills() / 10;
    let mut torn = 0;
    for after in moments("naive_writing_is_caught", kills) {
        let state = State::new();
        kill("naive", &state, after);
        match state.library().load("one") {
            Ok(_) => {}
            Err(LibraryError::Broken { .. }) => torn += 1,
            Err(error) => panic!("{error}"),
        }
    }
    // The moments are random; on a busy machine none may hit the few that matter.
    let at_random = format!("{torn} of {kills} kills at random tore the file");
    if !strace::works() {
        return at_random + "; at every call SKIPPED, strace is missing or may not trace";
    }
    let (torn, kills) = calls::naive();
    assert!(torn > 0, "{kills} kills at every call, and no file torn");
    format!("{at_random}, and {torn} of {kills} at every call")
}
