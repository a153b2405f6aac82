//! The crash campaign: real programs, killed at every call of the system and at random, refused every call in turn, on
//! a full disk and on one that cannot be written to. After each of these the library must be whole: no shape lost or
//! torn, no start blocked, the old file or the new one in its place.
//!
//! `cargo test --test crash` kills 300 times at random; `TAXEL_KILLS=2000 cargo test --test crash`, or `-- --ignored`,
//! does it 2,000 times. The seed of a run is printed, and `TAXEL_SEED` sets it. What the machine does not allow is skipped
//! and reported.

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

use std::panic::catch_unwind;
use std::process::ExitCode;
use std::time::Instant;

/// What a campaign has seen, in one line.
type Campaign = fn() -> String;

const CAMPAIGNS: [(&str, Campaign); 12] = [
    ("killed_at_every_call", calls::killed),
    ("every_error_is_told", calls::refused),
    (
        "recordings_appear_with_their_description",
        recording::killed,
    ),
    ("a_refused_recording_keeps_the_old_one", recording::refused),
    ("killed_at_random", random::killed),
    ("naive_writing_is_caught", random::naive),
    ("file_systems_that_lack_something", lacking::done_without),
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
    let mut failed = 0;
    for (name, campaign) in CAMPAIGNS {
        if !asked.runs(name) {
            continue;
        }
        let start = Instant::now();
        let result = catch_unwind(campaign);
        let seconds = start.elapsed().as_secs_f64();
        if let Ok(seen) = result {
            if let Some((_, why)) = seen.split_once("SKIPPED, ") {
                if why.contains("strace") {
                    skip::lacking("strace that may trace");
                }
                skip::skipped(&format!("{name}: {}", why.trim_end()));
            }
            println!("test {name} ... ok in {seconds:.1} s: {seen}");
        } else {
            println!("test {name} ... FAILED in {seconds:.1} s");
            failed += 1;
        }
    }
    if failed == 0 {
        ExitCode::SUCCESS
    } else {
        ExitCode::FAILURE
    }
}

/// Which campaigns are asked for, as `cargo test` passes it on.
#[derive(Default)]
struct Asked {
    /// Parts of their names; all if there are none.
    names: Vec<String>,
    /// Parts of the names of those to leave out.
    skipped: Vec<String>,
    /// Whether these are whole names.
    exact: bool,
}

impl Asked {
    fn read() -> Self {
        let mut arguments = std::env::args().skip(1);
        let mut asked = Self::default();
        while let Some(argument) = arguments.next() {
            match argument.as_str() {
                "--list" => {
                    for (name, _) in CAMPAIGNS {
                        println!("{name}: test");
                    }
                    std::process::exit(0);
                }
                "--skip" => asked.skipped.extend(arguments.next()),
                "--exact" => asked.exact = true,
                "--test-threads" | "--color" | "--format" => drop(arguments.next()),
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
