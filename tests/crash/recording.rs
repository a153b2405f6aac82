//! A recording that replaces another one, killed at each system call. The array and its description always belong to
//! the same recording, and the description of a killed recording says that it has not ended.

use std::ffi::OsString;
use std::fs;
use std::os::unix::process::ExitStatusExt;
use std::path::Path;
use std::process::Command;
use std::sync::atomic::{AtomicUsize, Ordering};

use super::array;
use super::state::{each, program};
use super::strace;

/// The source, with three frames.
const SOURCE: &str = "0,1\n2,3\n\n4,5\n6,7\n\n8,9\n1,2\n\n";

/// Makes a folder with a recording of one frame, which the program has made from another source.
fn before() -> tempfile::TempDir {
    let folder = tempfile::tempdir().expect("there is a folder for temporary files");
    fs::write(folder.path().join("new.txt"), SOURCE).expect("written");
    fs::write(folder.path().join("old.txt"), "1,2\n3,4\n\n").expect("written");
    let run = record(folder.path(), "old.txt").output().expect("it runs");
    assert!(run.status.success(), "{run:?}");
    folder
}

/// Returns the command that records a source over the old recording.
fn record(folder: &Path, source: &str) -> Command {
    let path = |name: &str| folder.join(name).to_string_lossy().into_owned();
    let (source, touch) = (path(source), path("touch.npy"));
    program(
        &["watch", &source, "--once", "--write", &touch, "--force"],
        folder,
    )
}

/// Returns whether the recording is of the new source, its number of frames, and whether it has ended; None if the
/// description or the array is missing. Checks that both are of the same source, if the array has frames.
fn found(folder: &Path) -> Option<(bool, usize, bool)> {
    let recording = fs::read(folder.join("touch.npy")).ok()?;
    let frames = array::records(&recording).expect("a header");
    let text = fs::read_to_string(folder.join("touch.json")).ok()?;
    let json: serde_json::Value = serde_json::from_str(&text).expect("whole");
    let source = json["source"].as_str().expect("a source");
    let ended = json["ended"].as_bool().expect("said");
    let is_new = source.ends_with("new.txt");
    // A record begins with its time and its number, 8 bytes each.
    let start = array::start(&recording).expect("a header") + 16;
    if let Some(value) = recording.get(start..start + 8) {
        let first = f64::from_le_bytes(value.try_into().expect("eight bytes"));
        assert_eq!(first, if is_new { 0.0 } else { 1.0 }, "of two recordings");
    }
    Some((is_new, frames, ended))
}

pub(crate) fn killed() -> String {
    if !strace::works() {
        return "SKIPPED, strace is missing or may not trace".to_owned();
    }
    let folder = before();
    let calls = strace::calls(&record(folder.path(), "new.txt"), folder.path());
    assert_eq!(found(folder.path()), Some((true, 3, true)), "{calls:?}");
    assert!(calls.len() > 3, "{calls:?}");
    each(&calls, |call| {
        let folder = before();
        let command = record(folder.path(), "new.txt");
        let output = strace::tampered(&command, call, "signal=KILL");
        assert_eq!(output.status.signal(), Some(9), "{call:?}: {output:?}");
        match found(folder.path()) {
            // The old recording unchanged, or the new one, begun or complete.
            Some((false, 1, true) | (true, _, false) | (true, 3, true)) => {}
            // No description: the next recording writes it.
            None => assert!(folder.path().join("touch.npy").exists(), "{call:?}"),
            other => panic!("{call:?}: {other:?}"),
        }
        // In every state, the next recording can read it and replace it.
        let again = record(folder.path(), "new.txt").output().expect("it runs");
        assert!(again.status.success(), "{call:?}: {again:?}");
        assert_eq!(found(folder.path()), Some((true, 3, true)), "{call:?}");
    });
    format!(
        "{} kills: array and description of one recording, or no description",
        calls.len()
    )
}

/// Refuses each call: the old recording with its description must be there, or the new one. A recording that only could
/// not be synced has frames and an end.
pub(crate) fn refused() -> String {
    if !strace::works() {
        return "SKIPPED, strace is missing or may not trace".to_owned();
    }
    let folder = before();
    let calls = strace::calls(&record(folder.path(), "new.txt"), folder.path());
    let errors = ["ENOSPC", "EIO", "EACCES"];
    let refused: Vec<_> = (calls.iter())
        .flat_map(|call| errors.map(|error| (call, error)))
        .collect();
    let kept = AtomicUsize::new(0);
    each(&refused, |(call, error)| {
        let folder = before();
        let command = record(folder.path(), "new.txt");
        let output = strace::tampered(&command, call, &format!("error={error}"));
        let context = format!("{call:?} {error}: {output:?}");
        let (is_new, frames, ended) = found(folder.path()).expect(&context);
        let is_sync = call.name.ends_with("sync");
        assert!(!is_new || !is_sync || frames > 0 && ended, "{context}");
        match output.status.code() {
            Some(0) => assert!(is_new && frames == 3, "{context}"),
            Some(1) => assert!(is_new || frames == 1, "{context}"),
            _ => panic!("{context}"),
        }
        kept.fetch_add(usize::from(!is_new), Ordering::Relaxed);
        let entries = fs::read_dir(folder.path()).expect("read").flatten();
        let names: Vec<_> = entries.map(|entry| entry.file_name()).collect();
        let is_left = |name: &OsString| name.to_string_lossy().starts_with(".taxel-");
        // A file that cannot be removed is left for the next program that writes there.
        let is_clean = call.name.starts_with("unlink") || !names.iter().any(is_left);
        assert!(is_clean, "{names:?} {context}");
    });
    format!(
        "{} calls refused: array and description of one recording, {} times the old one",
        refused.len(),
        kept.into_inner()
    )
}
