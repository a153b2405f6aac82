//! Measures the lines per second of `taxel batch`, with the lines of the README: on one core, and on all of them.
//!
//! The runs alternate, and ratios are taken between the fastest of each: other work on the machine slows both.

use std::fs::{self, File};
use std::process::{Command, Stdio};
use std::thread::available_parallelism;
use std::time::{Duration, Instant};

/// The number of times that the lines of the README's file are repeated.
const TIMES: usize = 40_000;

/// The number of turns.
const TURNS: usize = 7;

/// Returns the fastest time of each function over several turns.
fn fastest<const N: usize>(mut run: [&mut dyn FnMut(); N]) -> [Duration; N] {
    let mut best = [Duration::MAX; N];
    for _ in 0..TURNS {
        for (run, best) in run.iter_mut().zip(&mut best) {
            let start = Instant::now();
            run();
            *best = start.elapsed().min(*best);
        }
    }
    best
}

/// Answers a file with the given number of threads.
fn batch(input: &std::path::Path, jobs: usize) {
    let status = Command::new(env!("CARGO_BIN_EXE_taxel"))
        .args(["batch", "--jobs", &jobs.to_string()])
        .stdin(File::open(input).expect("it is there"))
        .stdout(Stdio::null())
        .status();
    assert!(status.is_ok_and(|status| status.success()));
}

/// Measures one thread, then one for each core.
fn lines() {
    let folder = tempfile::tempdir().expect("a folder");
    let input = folder.path().join("lines.jsonl");
    let poses = include_str!("../examples/poses.jsonl");
    fs::write(&input, poses.repeat(TIMES)).expect("written");
    let lines = poses.lines().count() * TIMES;
    let cores = available_parallelism().map_or(1, Into::into);
    let mut one = || batch(&input, 1);
    let mut all = || batch(&input, cores);
    let [one, all] = fastest([&mut one, &mut all]);
    #[expect(clippy::cast_precision_loss, reason = "a rate")]
    let rate = |time: Duration| lines as f64 / time.as_secs_f64();
    println!("one thread: {:.0} lines a second", rate(one));
    println!("{cores} threads: {:.0} lines a second", rate(all));
    let ratio = one.as_secs_f64() / all.as_secs_f64();
    println!("{cores} threads / one thread: {ratio:.2}");
}

fn main() {
    lines();
}
