//! The live page in a terminal: recording by a key, a terminal that is not read for a while, and how often it is drawn.

use std::fs;
use std::io::Write;
use std::path::{Path, PathBuf};
use std::process::Command;
use std::time::{Duration, Instant};

use super::program::{Program, Start, TAXEL};

/// A pipe with a name in a folder; None where there is no mkfifo.
fn fifo(folder: &Path) -> Option<PathBuf> {
    let path = folder.join("frames");
    let made = Command::new("mkfifo").arg(&path).status();
    if made.is_ok_and(|status| status.success()) {
        return Some(path);
    }
    eprintln!("SKIPPED: there is no mkfifo");
    None
}

/// Frames of 4 x 4, of which the first value counts.
fn frames(numbers: std::ops::Range<u32>) -> String {
    numbers
        .map(|number| format!("{number} 1 2 3\n4 5 6 7\n8 9 10 11\n12 13 14 15\n\n"))
        .collect()
}

/// The program that watches a pipe in a folder, and the pipe's other end.
fn watching(folder: &Path, fifo: &Path) -> (Program, fs::File) {
    let line = format!(
        "cd '{}' && exec {TAXEL} watch frames --format lines --at-least 9",
        folder.display()
    );
    let program = Program::start(&Start {
        command: &["sh", "-c", &line],
        variables: &[
            ("TERM", "xterm-256color"),
            ("LANG", "C.UTF-8"),
            ("PATH", "/usr/bin:/bin"),
        ],
        ..Start::default()
    });
    // Waits until the program reads it.
    let pipe = fs::File::options().write(true).open(fifo);
    (program, pipe.expect("the pipe opens"))
}

/// The number of records that an array counts.
fn records(path: &Path) -> Option<u64> {
    let bytes = fs::read(path).ok()?;
    let text = String::from_utf8_lossy(bytes.get(..256)?).into_owned();
    let (_, rest) = text.split_once("'shape': (")?;
    rest.split(',').next()?.parse().ok()
}

#[test]
fn a_key_records_and_a_key_ends_it() {
    let folder = tempfile::tempdir().expect("a folder");
    let Some(fifo) = fifo(folder.path()) else {
        return;
    };
    let (mut program, mut pipe) = watching(folder.path(), &fifo);
    pipe.write_all(frames(0..3).as_bytes()).expect("it is read");
    program.shows("frame 2");
    program.types(b"r");
    program.shows("recording in touch-1.npy");
    pipe.write_all(frames(3..23).as_bytes())
        .expect("it is read");
    program.shows("frame 22");
    program.types(b"m");
    program.shows("frame 22: marked");
    program.types(b"r");
    program.shows("touch-1.npy: 20 frames recorded");
    let file = folder.path().join("touch-1.npy");
    assert_eq!(records(&file), Some(20));
    let beside = fs::read_to_string(file.with_extension("json")).expect("it is there");
    let beside: serde_json::Value = serde_json::from_str(&beside).expect("JSON");
    assert_eq!(beside["marks"][0]["number"], 22, "{beside}");
    assert_eq!(beside["rule"]["at_least"], 9, "{beside}");
    program.types(b"q");
    program.types(b"q");
    program.ends_well(0);
}

#[test]
fn a_terminal_that_is_not_read_holds_up_no_recording() {
    let folder = tempfile::tempdir().expect("a folder");
    let Some(fifo) = fifo(folder.path()) else {
        return;
    };
    let (mut program, mut pipe) = watching(folder.path(), &fifo);
    pipe.write_all(frames(0..1).as_bytes()).expect("it is read");
    program.shows("frame 0");
    program.types(b"r");
    program.shows("recording in touch-1.npy");
    // Nothing is read from the terminal while these come, far more than its buffers hold.
    for piece in 0..200 {
        pipe.write_all(frames(piece * 20 + 1..piece * 20 + 21).as_bytes())
            .expect("it is read");
    }
    let file = folder.path().join("touch-1.npy");
    let start = Instant::now();
    while records(&file) != Some(4000) {
        assert!(
            start.elapsed() < Duration::from_secs(100),
            "{:?} records",
            records(&file)
        );
        std::thread::sleep(Duration::from_millis(20));
    }
    // Now the newest picture comes.
    program.shows("frame 4000");
    program.types(b"r");
    program.shows("4,000 frames recorded");
    program.types(b"qq");
    program.ends_well(0);
}

#[test]
fn it_is_drawn_at_most_thirty_times_a_second() {
    let folder = tempfile::tempdir().expect("a folder");
    let Some(fifo) = fifo(folder.path()) else {
        return;
    };
    let (mut program, mut pipe) = watching(folder.path(), &fifo);
    pipe.write_all(frames(0..1).as_bytes()).expect("it is read");
    program.shows("frame 0");
    // A picture of so few taxels comes in one piece.
    let before = program.reads;
    let start = Instant::now();
    // 500 frames, one every two milliseconds or slower.
    for number in 1..=500 {
        pipe.write_all(frames(number..number + 1).as_bytes())
            .expect("it is read");
        program.read(Duration::from_millis(2));
    }
    program.shows("frame 500");
    let seconds = start.elapsed().as_secs_f64();
    let drawn = program.reads - before;
    println!("{drawn} pictures of 500 frames in {seconds:.2} s");
    let drawn_f = f64::from(u32::try_from(drawn).expect("a few hundred"));
    assert!(
        drawn_f <= 30.0 * seconds + 2.0,
        "{drawn} pictures in {seconds:.2} s"
    );
    assert!(drawn >= 2, "{drawn}");
    program.types(b"qq");
    program.ends_well(0);
}
