//! Tests of `taxel sweep` and `taxel merge`: summaries, files, shards, interrupts, refusals. Files are whole, replace
//! others only on request, and are not left by a sweep that was stopped.

use std::fs;
use std::path::Path;
use std::process::Command;
use std::time::{Duration, Instant};

use serde_json::Value;

use crate::paper::RING_IMPRINTS;

use super::finish;
use super::program;
use super::python_has;
use super::refused;
use super::sh;
use super::taxel;
use super::until;

/// A sweep of the paper's ring over one cell.
const RING: &str = "sweep ellipse --radius-x 4 --radius-y 4 --thickness 2 --angle 0 --x0 1:1.99:0.01 --y0 1:1.99:0.01";

/// Makes an empty folder for a test.
pub(crate) fn folder() -> tempfile::TempDir {
    tempfile::tempdir().expect("a folder can be made")
}

pub(crate) fn names(folder: &Path) -> Vec<String> {
    let files = fs::read_dir(folder).expect("the folder is there");
    let name = |file: std::io::Result<fs::DirEntry>| {
        let name = file.expect("a file").file_name();
        name.to_string_lossy().into_owned()
    };
    let mut names: Vec<String> = files.map(name).collect();
    names.sort();
    names
}

fn json(line: &str) -> Value {
    let run = taxel(line, "");
    let notes = run.stderr.lines().all(|note| note.starts_with("written: "));
    assert!(run.status == Some(0) && notes, "{line}: {}", run.stderr);
    serde_json::from_str(&run.stdout).expect("a line of JSON")
}

#[test]
fn the_summary_has_the_numbers_of_the_paper_s_ring() {
    let summary = json(&format!("{RING} --json"));
    let keys: Vec<&str> = summary
        .as_object()
        .expect("an object")
        .keys()
        .map(String::as_str)
        .collect();
    let expected = "descriptors distinct distinct_shifts distinct_symmetry empty partly_off poses ranges seconds shard";
    assert_eq!(keys.join(" "), expected);
    let count = |key: &str| summary[key].as_u64().expect("a count");
    let counts = ["poses", "distinct", "distinct_shifts", "distinct_symmetry"].map(count);
    assert_eq!(counts, [10_000, RING_IMPRINTS as u64, 376, 58]);
    let na = &summary["descriptors"]["na"];
    assert_eq!(
        (na["min"].as_f64(), na["max"].as_f64()),
        (Some(35.0), Some(40.0))
    );
    let ideal = na["ideal"].as_f64().expect("an ideal value");
    assert!((ideal - 12.0 * std::f64::consts::PI).abs() < 1e-9);
    assert_eq!(na["sd"], na["sd_position"]);
    assert_eq!(na["sd_angle"].as_f64(), Some(0.0));
    assert!(summary["descriptors"]["ce"]["ideal"].is_null());
}

/// Without x0 and y0, a sweep chooses a cell that suits the shape. The summary has it, so no note repeats it.
#[test]
fn the_default_ranges_are_printed_once() {
    let ran = |line: &str, ranges: [&str; 2], cut: u64, notes: &str| {
        let run = taxel(line, "");
        assert_eq!(
            (run.status, run.stderr.as_str()),
            (Some(0), notes),
            "{line}"
        );
        let summary: Value = serde_json::from_str(&run.stdout).expect("a line of JSON");
        let taken = ["x0", "y0"].map(|axis| summary["ranges"][axis].as_str().expect("a range"));
        assert_eq!(taken, ranges, "{line}");
        assert_eq!(summary["partly_off"], cut, "{line}");
    };
    let paper = ["5:5.99:0.01"; 2];
    let bar = "sweep rectangle --length 6 --width 3 --angle 0:90:45 --json";
    ran(bar, paper, 0, "");
    ran(&format!("{bar} --quiet"), paper, 0, "");
    ran(&format!("{bar} --x0 5:5.99:0.01"), paper, 0, "");
    // At 5 it would be cut off when turned.
    ran(
        "sweep rectangle --length 10 --width 8 --angle 0:90:45 --json",
        ["2:2.99:0.01", "3:3.99:0.01"],
        0,
        "",
    );
    // No cell is large enough for the triangle at every angle.
    let noted = "the figure reaches beyond the sensor in 20,000 of 20,000 poses\n";
    ran(
        "sweep triangle --side 16 --rows 4 --angle 0:60:60 --json",
        ["-0.5:0.49:0.01", "-7.73:-6.74:0.01"],
        20_000,
        noted,
    );
    // A picture stays in its own cell.
    let washer = "sweep --picture washer --angle 0:90:45 --json";
    ran(washer, ["2:2.99:0.01"; 2], 0, "");
    // A corner that is zoomed moves by half a cell, a centre by a whole one.
    let zoomed = "sweep --picture washer --zoom-x 0.5 --zoom-y 0.5 --angle 0 --json --quiet";
    ran(zoomed, ["2:2.99:0.01"; 2], 0, "");
    let centred = format!("{zoomed} --anchor centre");
    ran(&centred, ["6:6.99:0.01", "5:5.99:0.01"], 0, "");
}

#[test]
fn tables_contain_every_imprint() {
    let scratch = folder();
    let path = |name: &str| scratch.path().join(name).display().to_string();
    json(&format!("{RING} --json --atlas {}", path("ring.csv")));
    json(&format!("{RING} --json --atlas {}", path("ring.jsonl")));
    let table = fs::read_to_string(path("ring.csv")).expect("the table");
    let lines: Vec<&str> = table.lines().collect();
    let titles = "id,count,share,first_x0,first_y0,first_angle,pieces,holes,na,nae,ce,";
    assert!(lines[0].starts_with(titles));
    assert_eq!(lines.len(), 1 + RING_IMPRINTS);
    assert!(lines[1].starts_with("0,258,0.0258,1,1,0,1,1,40,52,20,200,200,5,5,"));
    assert!(lines[1].contains(",0,,................/...####........./"));
    let count = |line: &&str| {
        line.split(',')
            .nth(1)
            .and_then(|count| count.parse::<u64>().ok())
    };
    let sum: Option<u64> = lines[1..].iter().map(count).sum();
    assert_eq!(sum, Some(10_000));
    let lines = fs::read_to_string(path("ring.jsonl")).expect("the lines");
    assert_eq!(lines.lines().count(), RING_IMPRINTS);
    for (id, line) in lines.lines().enumerate().step_by(40) {
        let line: Value = serde_json::from_str(line).expect("JSON");
        // The first pose leaves this imprint, and its main region is described like elsewhere.
        let (x0, y0) = (&line["first"]["x0"], &line["first"]["y0"]);
        let figure = "figure ellipse --radius-x 4 --radius-y 4 --thickness 2 --json";
        let answer = json(&format!("{figure} --x0 {x0} --y0 {y0}"));
        assert_eq!(
            (&line["id"], &line["imprint"]),
            (&id.into(), &answer["imprint"])
        );
        assert_eq!(line["main"], answer["regions"][0]);
    }
    assert_eq!(names(scratch.path()), ["ring.csv", "ring.jsonl"]);
}

#[test]
fn shards_merge_into_the_same_bytes() {
    let scratch = folder();
    let path = |name: &str| scratch.path().join(name).display().to_string();
    let sweep = "sweep pentagon --side 3 --thickness 0.8 --x0 4:6:0.05 --y0 4:5:0.05 --angle 0:359:3 --quiet --json";
    let whole = json(&format!("{sweep} --jobs 1 --atlas {}", path("whole.npz")));
    let files = [4, 2, 5, 1, 3].map(|number| {
        let name = path(&format!("{number}.npz"));
        json(&format!(
            "{sweep} --jobs 2 --shard {number}/5 --atlas {name}"
        ));
        name
    });
    let merge = |files: &str, out: &str| {
        let out = path(out);
        json(&format!("merge {files} --json --quiet --out {out}"))
    };
    let mut merged = merge(&files.join(" "), "merged.npz");
    merged["seconds"] = whole["seconds"].clone();
    assert_eq!(merged, whole);
    let read = |name: &str| fs::read(path(name)).expect("an atlas");
    assert!(
        read("merged.npz") == read("whole.npz"),
        "the archives differ"
    );
    merge(&path("whole.npz"), "again.csv");
    json(&format!("{sweep} --atlas {}", path("whole.csv")));
    assert!(read("again.csv") == read("whole.csv"), "the tables differ");
    let two = files[..2].join(" ");
    let run = taxel(&format!("merge {two} --out {}", path("no.npz")), "");
    refused(&run, 1, "3 of 5 shards are missing: 1, 3, 5");
}

#[test]
fn a_sweep_goes_on_if_a_signal_is_ignored() {
    let sweep = "sweep octagon --side 6 --columns 32 --rows 32 --angle 0:44:0.02 --jobs 1 --quiet";
    let script = format!("trap '' INT TERM; echo ready; exec \"$0\" {sweep}");
    let mut child = sh(&script).spawn().expect("there is a shell");
    let mut output = std::io::BufReader::new(child.stdout.take().expect("piped"));
    let mut line = String::new();
    std::io::BufRead::read_line(&mut output, &mut line).expect("text");
    let id = rustix::process::Pid::from_child(&child);
    for signal in [rustix::process::Signal::INT, rustix::process::Signal::TERM] {
        std::thread::sleep(Duration::from_millis(100));
        let ended = child.try_wait().expect("a child");
        assert_eq!(ended, None, "it ended before the signal");
        rustix::process::kill_process(id, signal).expect("it still runs");
    }
    std::io::copy(&mut output, &mut std::io::sink()).expect("read");
    let status = child.wait().expect("it ends");
    assert_eq!(status.code(), Some(0));
}

#[test]
fn shards_that_do_not_belong_together_are_refused() {
    let scratch = folder();
    let path = |name: &str| scratch.path().join(name).display().to_string();
    let (one, two) = (path("1.npz"), path("2.npz"));
    for (number, name) in [(1, &one), (2, &two)] {
        json(&format!("{RING} --json --shard {number}/2 --atlas {name}"));
    }
    let merge = |what: &str| taxel(&format!("merge {what}"), "");
    let out = path("m.npz");
    let run = merge(&format!("{two} {one} --atlas {out}"));
    assert_eq!(
        (run.status, run.stderr),
        (Some(0), format!("written: {out}\n"))
    );
    assert!(run.stdout.contains("393 "), "{}", run.stdout);
    let no = path("no.npz");
    for (line, message) in [
        (
            format!("{two} {one} --atlas {one} --force"),
            format!("{one}: one of the shards; write to another file"),
        ),
        (
            format!("{one} {out} --atlas {no}"),
            format!("{out}: shard 1/1 differs from the first one in the number of shards"),
        ),
        (
            format!("{one} --atlas {no}"),
            "1 of 2 shards is missing: 2".to_owned(),
        ),
        (
            format!("{one} {one} --atlas {no}"),
            format!("{one}: shard 1/2 is given twice"),
        ),
    ] {
        refused(&merge(&line), 1, &message);
    }
    assert!(!scratch.path().join("no.npz").exists());
}

/// Returns which bytes of an archive belong to the numbers of an array. Arrays are stored one after the other. Each
/// has a local header of 30 bytes, which contains the sizes of its parts (APPNOTE.TXT by PKWARE).
pub(super) fn numbers_in(archive: &[u8]) -> Vec<bool> {
    let mut inside = vec![false; archive.len()];
    let number = |at: usize, length: usize| {
        let bytes = archive[at..at + length].iter().rev();
        bytes.fold(0, |number, &byte| number << 8 | usize::from(byte))
    };
    let mut at = 0;
    while archive[at..].starts_with(b"PK\x03\x04") {
        let start = at + 30 + number(at + 26, 2) + number(at + 28, 2);
        let end = start + number(at + 18, 4);
        inside[start..end].fill(true);
        at = end;
    }
    inside
}

#[test]
fn damaged_archives_are_refused() {
    let scratch = folder();
    let folder = scratch.path();
    let path = |name: &str| folder.join(name).display().to_string();
    json(&format!("{RING} --json --atlas {}", path("ring.npz")));
    let good = fs::read(path("ring.npz")).expect("the archive");
    let merged = format!(
        "merge {} --json --quiet --atlas {}",
        path("bad.npz"),
        path("x.csv")
    );
    // In the arrays every byte counts, whether it is used or not. The bytes between them may not matter.
    let numbers = numbers_in(&good);
    let mut refusals = 0;
    for place in (0..good.len()).step_by(991) {
        let mut bad = good.clone();
        bad[place] ^= 0x55;
        fs::write(path("bad.npz"), &bad).expect("a file");
        let run = taxel(&merged, "");
        let expected = run.status == Some(1) || !numbers[place] && run.status == Some(0);
        assert!(expected, "{place}: {:?} {}", run.status, run.stderr);
        refusals += i32::from(numbers[place]);
    }
    assert!(refusals > 100, "{refusals}");
    for content in [&b"no archive"[..], &good[..good.len() / 2]] {
        fs::write(path("bad.npz"), content).expect("a file");
        let run = taxel(&merged, "");
        let told = "bad.npz: cannot be read as an atlas or a model";
        assert!(
            run.status == Some(1) && run.stderr.contains(told),
            "{run:?}"
        );
    }
}

#[test]
fn impossible_sweeps_are_refused() {
    for (status, line, message) in [
        (
            1,
            "sweep hexagon --x0 1:20:1",
            "20 is above 16 (allowed: -16 to 16)\n",
        ),
        (
            1,
            "sweep hexagon --x0 0:0.999999:0.000001 --y0 0:0.999999:0.000001",
            "360,000,000,000,000 poses, expected at most 1,000,000,000,000\n",
        ),
        (
            1,
            "sweep hexagon --zoom-x 2",
            "a figure has no zoom, only a picture has one\n",
        ),
        (
            2,
            "sweep hexagon --x0 1:2",
            "'--x0 <RANGE>': expected a number or start:end:step\n",
        ),
        (
            2,
            "sweep hexagon --shard 4/3",
            "invalid value '4/3' for '--shard <K/N>': expected K/N with K from 1 to N and N up to 4294967295",
        ),
        (
            2,
            "sweep hexagon --length 3",
            "'--length' does not belong to 'hexagon'",
        ),
        (
            2,
            "sweep --picture washer --side 3",
            "'--side' does not belong to a picture\n",
        ),
        (
            2,
            "sweep",
            "required arguments were not provided:\n  <KIND|--picture <NAME|FILE>>\n",
        ),
        (
            1,
            "sweep hexagon --angle 0 --quiet --atlas /nowhere/a.csv",
            "error: /nowhere/a.csv: ",
        ),
        (
            2,
            "sweep hexagon --poses a.npz",
            "expected a name that ends in .npy",
        ),
    ] {
        let run = taxel(line, "");
        assert_eq!(
            (run.status, run.stdout.as_str()),
            (Some(status), ""),
            "{line}"
        );
        assert!(run.stderr.contains(message), "{line}: {}", run.stderr);
    }
}

/// The real numpy reads atlas and poses, if Python has it; with `TAXEL_NUMPY` set, it is required.
#[test]
fn numpy_reads_atlas_and_poses() {
    if !python_has("numpy") {
        return;
    }
    let scratch = folder();
    let folder = scratch.path();
    let path = |name: &str| folder.join(name).display().to_string();
    json(&format!(
        "sweep rectangle --length 4 --width 4 --x0 5:5.9:0.1 --y0 5:5.4:0.2 --angle 0:180:45 --json --poses {} --atlas {}",
        path("poses.npy"),
        path("atlas.npz")
    ));
    let check = r"
import sys, json, numpy
poses, atlas = numpy.load(sys.argv[1]), numpy.load(sys.argv[2])
assert poses.shape == (5, 3, 10) and poses.dtype == numpy.uint32, (poses.shape, poses.dtype)
count = atlas['count']
assert (numpy.bincount(poses.ravel()) == count).all() and count.sum() == 150
flat = poses.ravel()
assert (atlas['first_pose'] == [numpy.argmax(flat == id) for id in range(len(count))]).all()
bits = atlas['rows'][:, :, None] >> numpy.arange(16, dtype=numpy.uint64) & 1
assert bits.shape == (len(count), 16, 16)
assert (bits.sum(axis=(1, 2)) == atlas['na']).all() and (poses[0] == poses[2]).all()
header = json.loads(atlas['header'].tobytes())
assert header['format'] == 'taxel-atlas/1' and header['poses'] == 150
x0 = atlas['first'][:, 0]
assert x0[0] == 5.0 and x0.max() <= 5.9 and numpy.isnan(atlas['cg_cd_direction']).any()
";
    let mut python = Command::new("python3");
    python.args(["-c", check, &path("poses.npy"), &path("atlas.npz")]);
    let run = python.output().expect("python3 runs");
    let wrong = String::from_utf8_lossy(&run.stderr);
    assert!(run.status.success(), "{wrong}");
}

/// The signal of `ulimit -f` would end the program without a message.
#[test]
fn a_file_beyond_the_limit_is_an_error_like_a_full_disk() {
    let scratch = folder();
    let path = scratch.path().join("a.npz").display().to_string();
    let mut command = sh("ulimit -f 8; exec \"$0\" \"$@\"");
    command.args("sweep hexagon --side 3 --quiet --angle 0:50:10 --atlas".split(' '));
    let run = command.arg(&path).output().expect("started");
    let said = String::from_utf8_lossy(&run.stderr);
    assert!(
        run.status.code() == Some(1) && said.contains("too large"),
        "{said}"
    );
    assert!(!Path::new(&path).exists(), "nothing is left behind");
}

/// Prints the time until it stops: `cargo test --release --test cli interrupt -- --nocapture`.
#[test]
fn an_interrupt_stops_at_once_and_leaves_no_files() {
    let scratch = folder();
    let folder = scratch.path();
    let path = |name: &str| folder.join(name).display().to_string();
    // A sweep that would take hours.
    let line = format!(
        "sweep heptagon --side 3 --thickness 1 --x0 5:5.999:0.001 --y0 5:5.999:0.001 --angle 0:359.999:0.001 --quiet --atlas {} --poses {}",
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
    assert_eq!(names(scratch.path()), ["a.NPZ", "p.npy"]);
}
