//! The crash campaign: real programs, killed at every system call and at random, with every system call refused in
//! turn, on a full disk and on one that cannot be written to. After each of these, the library must be intact: no shape
//! lost or torn, no start blocked, either the old or the new file in place.
//!
//! `cargo test --test crash` kills 300 times at random; `TAXEL_KILLS=2000 cargo test --test crash`, or `-- --ignored`,
//! does it 2,000 times. The seed of a run is printed, and `TAXEL_SEED` sets it. Tests that the machine does not allow
//! are skipped and reported.

#[path = "../common/array.rs"]
mod array;

#[path = "../common/skip.rs"]
mod skip;

mod act;

mod state;

mod strace;

mod calls;

mod recording;

mod random;

mod disk;

mod lacking;

mod threads;

use std::num::NonZeroUsize;
use std::panic::catch_unwind;
use std::process::ExitCode;
use std::sync::Mutex;
use std::sync::atomic::{AtomicBool, Ordering};
use std::thread;
use std::time::Instant;

/// A campaign, which returns a summary in one line.
type Campaign = fn() -> String;

const CAMPAIGNS: [(&str, Campaign); 14] = [
    // The longest come first, so that no thread waits for one of them at the end.
    ("killed_at_random", random::killed),
    ("killed_at_every_call", calls::killed),
    ("every_error_is_reported", calls::refused),
    (
        "recordings_appear_with_their_description",
        recording::killed,
    ),
    ("a_refused_recording_keeps_the_old_one", recording::refused),
    ("naive_writing_is_caught", random::naive),
    ("file_systems_that_lack_something", lacking::done_without),
    ("owners_and_modes_that_cannot_be_set", lacking::owners),
    ("work_whose_files_are_refused_is_printed", lacking::printed),
    ("crafted_folders_do_no_harm", lacking::crafted),
    ("no_threads_are_done_without", threads::refused),
    ("a_full_disk_loses_nothing", disk::full),
    ("a_full_disk_ends_recordings_whole", disk::full_of_frames),
    ("a_read_only_disk_can_be_read", disk::read_only),
];

fn main() -> ExitCode {
    if act::perform() {
        return ExitCode::SUCCESS;
    }
    let asked = Asked::read();
    let left = CAMPAIGNS.iter().filter(|(name, _)| asked.runs(name));
    let left = Mutex::new(left);
    let failed = AtomicBool::new(false);
    // A campaign spends half of its time waiting for its programs.
    thread::scope(|scope| {
        for _ in 0..asked.threads.get() {
            scope.spawn(|| {
                let next = || left.lock().expect("nothing panics there").next();
                while let Some((name, campaign)) = next() {
                    if !passes(name, *campaign) {
                        failed.store(true, Ordering::Relaxed);
                    }
                }
            });
        }
    });
    if failed.into_inner() {
        ExitCode::FAILURE
    } else {
        ExitCode::SUCCESS
    }
}

/// Runs a campaign and prints its summary or its failure. Returns true if it passes.
fn passes(name: &str, campaign: Campaign) -> bool {
    let start = Instant::now();
    let result = catch_unwind(campaign);
    let seconds = start.elapsed().as_secs_f64();
    let Ok(seen) = result else {
        println!("test {name} ... FAILED in {seconds:.1} s");
        return false;
    };
    if let Some((_, why)) = seen.split_once("SKIPPED, ") {
        if why.contains("strace") {
            skip::lacking("strace that may trace");
        }
        skip::skipped(&format!("{name}: {}", why.trim_end()));
    }
    println!("test {name} ... ok in {seconds:.1} s: {seen}");
    true
}

/// The campaigns that are asked for, from the arguments that `cargo test` passes on.
struct Asked {
    /// Parts of the names of the campaigns to run; all run if there are none.
    names: Vec<String>,
    /// Parts of the names of the campaigns to skip.
    skipped: Vec<String>,
    /// Whether these are whole names instead of parts.
    exact: bool,
    /// The number of campaigns that run at once: one for each core, unless a number is given.
    threads: NonZeroUsize,
}

impl Asked {
    fn read() -> Self {
        let mut arguments = std::env::args().skip(1);
        let mut asked = Self {
            names: Vec::new(),
            skipped: Vec::new(),
            exact: false,
            threads: thread::available_parallelism().unwrap_or(NonZeroUsize::MIN),
        };
        while let Some(argument) = arguments.next() {
            if let Some(threads) = argument.strip_prefix("--test-threads=") {
                asked.threads = threads.parse().expect("a number of threads");
            }
            match argument.as_str() {
                "--list" => {
                    for (name, _) in CAMPAIGNS {
                        println!("{name}: test");
                    }
                    std::process::exit(0);
                }
                "--skip" => asked.skipped.extend(arguments.next()),
                "--exact" => asked.exact = true,
                "--test-threads" => {
                    let threads = arguments.next().unwrap_or_default();
                    asked.threads = threads.parse().expect("a number of threads");
                }
                "--color" | "--format" => drop(arguments.next()),
                flag if flag.starts_with('-') => {}
                _ => asked.names.push(argument),
            }
        }
        asked
    }

    fn runs(&self, name: &str) -> bool {
        let is_among = |parts: &[String]| {
            let is = |part: &String| name == part || !self.exact && name.contains(part.as_str());
            parts.iter().any(is)
        };
        (self.names.is_empty() || is_among(&self.names)) && !is_among(&self.skipped)
    }
}
