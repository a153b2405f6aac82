//! The files of a sweep: they are complete, replace others only on request, and are not left by a sweep that was
//! stopped.

use std::fs;
use std::time::{Duration, Instant};

use super::finish;
use super::program;
use super::refused;
use super::sweep::folder;
use super::sweep::names;
use super::taxel;
use super::until;

/// Prints the time until it stops: `cargo test --release --test cli interrupt -- --nocapture`.
#[test]
fn an_interrupt_stops_at_once_and_leaves_no_files() {
    let scratch = folder();
    let folder = scratch.path();
    let path = |name: &str| folder.join(name).display().to_string();
    // A sweep that would take hours.
    let line = format!(
        "sweep heptagon --side 3 --thickness 1 --x0 5:5.999:0.001 --y0 5:5.999:0.001 --angle 0:359.999:0.001 --quiet --memory 900000T --atlas {} --poses {}",
        path("a.npz"),
        path("p.npy")
    );
    let arguments: Vec<&str> = line.split_whitespace().collect();
    let mut child = program(&arguments, "C.UTF-8")
        .spawn()
        .expect("the program starts");
    let id = i32::try_from(child.id()).expect("a process");
    // The program listens for signals before it opens a file, which may have no name yet.
    let opened = format!("/proc/{id}/fd");
    let is_open = || {
        let files = fs::read_dir(&opened).into_iter().flatten().flatten();
        let mut targets = files.filter_map(|file| fs::read_link(file.path()).ok());
        targets.any(|target| target.starts_with(folder)) || !names(folder).is_empty()
    };
    until("open file", || {
        let ended = child.try_wait().expect("a child");
        assert_eq!(ended, None, "it ended before it was interrupted");
        is_open()
    });
    // Now the sweep is under way.
    std::thread::sleep(Duration::from_millis(200));
    let start = Instant::now();
    let id = rustix::process::Pid::from_raw(id).expect("a process");
    rustix::process::kill_process(id, rustix::process::Signal::TERM).expect("it runs still");
    let run = finish(child, b"");
    let took = start.elapsed();
    println!("stopped after {took:?}");
    assert!(took < Duration::from_secs(5), "{took:?}");
    refused(&run, 143, "stopped; nothing was written");
    assert_eq!(names(folder), [""; 0]);
}

/// Hours of work are not lost by a mistake, and not done in vain either: the refusal comes first.
#[test]
fn files_are_only_replaced_with_force() {
    let scratch = folder();
    let path = |name: &str| scratch.path().join(name);
    let sweep = |files: &str| {
        let line = format!("sweep hexagon --x0 5 --y0 5 --angle 0:2:1 --quiet {files}");
        taxel(&line, "")
    };
    let (atlas, poses) = (path("a.NPZ"), path("p.npy"));
    let (atlas, poses) = (atlas.display(), poses.display());
    assert_eq!(
        sweep(&format!("--atlas {atlas} --poses {poses}")).status,
        Some(0)
    );
    let first = fs::read(path("a.NPZ")).expect("written");
    fs::write(path("a.NPZ"), "mine").expect("written");
    let there = format!("{:?} already exists; --force replaces it", path("a.NPZ"));
    refused(&sweep(&format!("--atlas {atlas}")), 1, &there);
    let there = format!("{:?} already exists; --force replaces it", path("p.npy"));
    refused(&sweep(&format!("--poses {poses}")), 1, &there);
    assert_eq!(fs::read(path("a.NPZ")).ok().as_deref(), Some(&b"mine"[..]));
    assert_eq!(sweep(&format!("--atlas {atlas} --force")).status, Some(0));
    assert_eq!(fs::read(path("a.NPZ")).ok(), Some(first));
    // A merge does not replace its own shard, either.
    let run = taxel(&format!("merge {atlas} --atlas {atlas} --quiet"), "");
    refused(
        &run,
        1,
        &format!("{:?} already exists; --force replaces it", path("a.NPZ")),
    );
    let run = sweep(&format!("--poses {atlas}"));
    assert_eq!(run.status, Some(2));
    assert!(
        run.stderr.contains("expected a name that ends in .npy"),
        "{}",
        run.stderr
    );
    assert_eq!(names(scratch.path()), ["a.NPZ", "p.npy"]);
}
