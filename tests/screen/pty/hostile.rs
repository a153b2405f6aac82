//! A system that does not answer or refuses, simulated with `strace`: a disk that hangs, threads that cannot be
//! started. Without a `strace` that is allowed to trace, the tests are skipped, and say so.

use std::process::{Command, Stdio};
use std::time::Instant;

use rustix::process::Signal;

use super::program::{Program, Start, TAXEL};
use super::tracer::Tracer;
use crate::skip;

/// Starts the program with some of its calls tampered with; None if that is not possible.
fn tampered(calls: &str, how: &str) -> Option<Program> {
    let traced = Command::new("strace")
        .args(["-qq", "-o", "/dev/null", "-e", "trace=?openat", "true"])
        .stderr(Stdio::null())
        .status();
    if !traced.is_ok_and(|status| status.success()) {
        skip::skipped("there is no strace that may trace");
        return None;
    }
    let (trace, inject) = (format!("trace={calls}"), format!("inject={calls}:{how}"));
    // With -D, strace is the grandchild, so the program itself has the process number that signals are sent to.
    let command = [
        "strace",
        "-D",
        "-f",
        "-qq",
        "-o",
        "/dev/null",
        "-e",
        &trace,
        "-e",
        &inject,
        TAXEL,
    ];
    let path = std::env::var("PATH").unwrap_or_default();
    Some(Program::started(&Start {
        command: &command,
        variables: &[
            ("TERM", "xterm-256color"),
            ("LANG", "C.UTF-8"),
            ("PATH", &path),
        ],
        ..Start::default()
    }))
}

/// Starts the program on a disk where every sync hangs until the tracer ends.
fn on_a_hanging_disk() -> Option<(Program, Tracer)> {
    let mut program = Program::started(&Start::default());
    let disk = Tracer::hang(&mut program, "?fsync,?fdatasync", &[])?;
    Some((program, disk))
}

#[test]
fn a_hanging_disk_blocks_neither_keys_nor_the_end() {
    // The cases run together, because they mostly wait for that disk.
    std::thread::scope(|scope| {
        for (keys, signal, status) in [
            (&b"q"[..], None, 0),
            (b"", Some(Signal::TERM), 143),
            (b"", Some(Signal::HUP), 129),
        ] {
            scope.spawn(move || ends_before_the_disk(keys, signal, status));
        }
    });
}

fn ends_before_the_disk(keys: &[u8], signal: Option<Signal>, status: i32) {
    let Some((mut program, disk)) = on_a_hanging_disk() else {
        return;
    };
    program.types(b" sname\r");
    program.shows("Saving name: waiting for the disk");
    program.types(b"\x1b[C ");
    program.shows("NA 2 in all");
    // Back to the version that is being saved, so that nothing else is lost.
    program.types(b"u");
    program.shows("undone");
    program.types(keys);
    if let Some(signal) = signal {
        program.signal(signal);
    }
    let begun = Instant::now();
    program.shows("Saving name: not done yet, because the disk does not answer");
    program.shows("unsaved work may not be on the disk");
    program.is_left();
    println!("the shell has the terminal after {:?}", begun.elapsed());
    // The system waits for the tracer.
    disk.end();
    let (ended, _) = program.ends();
    assert_eq!(ended.code(), Some(status));
}

#[test]
fn an_export_to_a_hanging_disk_does_not_block_the_program() {
    let folder = tempfile::tempdir().expect("a folder");
    let Some((mut program, disk)) = on_a_hanging_disk() else {
        return;
    };
    let path = folder.path().join("a.csv");
    program.types(format!(" :write {}\r", path.display()).as_bytes());
    program.shows("waiting for the disk");
    program.types(b"\x1b[C ");
    program.shows("NA 2 in all");
    program.types(b"qy");
    program.shows("not done yet, because the disk does not answer");
    program.is_left();
    disk.end();
    let (ended, _) = program.ends();
    assert_eq!(ended.code(), Some(0));
}

/// All threads except the first, and all except the first three, are refused.
#[test]
fn the_program_works_if_threads_cannot_be_started() {
    for which in ["1+", "4+"] {
        let how = format!("error=EAGAIN:when={which}");
        let Some(mut program) = tampered("?clone,?clone3", &how) else {
            return;
        };
        program.types(b"f\r");
        program.shows("NA ");
        // A sweep, a training, a save, an export: each is done, or says why it is not.
        program.types(b":explore --x0 0:0.99:0.1 --y0 0 --angle 0\r");
        program.until("a sweep or a reason", |program| {
            let screen = program.screen().contents();
            screen.contains("distinct") || screen.contains("cannot start a thread")
        });
        program.types(b"\x1b\x1b");
        program.types(b"\x1b");
        program.shows("? Help");
        program.types(b"sname\r");
        program.shows("saved as name");
        program.types(b"q");
        program.ends_well(0);
    }
}
