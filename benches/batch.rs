//! Measures the lines per second of `taxel batch`, with the lines of the README: on one core, and on all of them.

use std::fs::{self, File};
use std::process::{Command, Stdio};
use std::thread::available_parallelism;

use timing::{Work, in_turn};

mod timing;

/// The number of times that the lines of the README's file are repeated.
const TIMES: usize = 40_000;

/// Answers a file with the given number of threads.
fn batch(input: &std::path::Path, jobs: usize) {
    let status = Command::new(env!("CARGO_BIN_EXE_taxel"))
        .args(["batch", "--jobs", &jobs.to_string()])
        .stdin(File::open(input).expect("it is there"))
        .stdout(Stdio::null())
        .status();
    assert!(status.is_ok_and(|status| status.success()));
}

fn main() {
    let folder = tempfile::tempdir().expect("a folder");
    let input = folder.path().join("lines.jsonl");
    let poses = include_str!("../examples/poses.jsonl");
    fs::write(&input, poses.repeat(TIMES)).expect("written");
    let lines = poses.lines().count() * TIMES;
    let cores = available_parallelism().map_or(1, Into::into);
    let one = Work::new(|| batch(&input, 1));
    let all = Work::new(|| batch(&input, cores));
    let [one, all] = in_turn(7, [one, all]).map(|least| least.wall);
    #[expect(clippy::cast_precision_loss, reason = "a rate")]
    let rate = |time: f64| lines as f64 / time;
    println!("one thread: {:.0} lines a second", rate(one));
    println!("{cores} threads: {:.0} lines a second", rate(all));
    println!("{cores} threads / one thread: {:.2}", one / all);
}
