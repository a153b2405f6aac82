//! A system that refuses to start threads, simulated with `strace`: work on all cores is done on one, with the same
//! answers.

use std::fs;
use std::path::Path;
use std::process::{Command, Output, Stdio};

use super::state::finish;
use super::strace;

/// Returns a shell line as a command in a folder. `exec` replaces the shell by the program, since a shell could not
/// start a thread either.
fn line(text: &str, folder: &Path) -> Command {
    let mut command = Command::new("sh");
    command
        .arg("-c")
        .arg(format!(
            "cd '{}' && exec \"$TAXEL\" {text}",
            folder.display()
        ))
        .env("TAXEL", env!("CARGO_BIN_EXE_taxel"))
        .env("TAXEL_LIBRARY", folder.join("library"))
        .env("TAXEL_CONFIG", "/dev/null")
        .env("XDG_CACHE_HOME", folder.join("cache"))
        .env("LC_ALL", "C.UTF-8")
        .stdin(Stdio::null())
        .stdout(Stdio::piped())
        .stderr(Stdio::piped());
    command
}

/// Runs a line without threads.
fn alone(text: &str, folder: &Path) -> Output {
    strace::refused(&line(text, folder), "?clone,?clone3", "EAGAIN")
}

/// Returns the output, except the line with the time it took.
fn answer(run: &Output) -> String {
    let text = String::from_utf8_lossy(&run.stdout);
    let lines = text.lines().filter(|line| !line.ends_with(" s"));
    lines.map(|line| line.to_owned() + "\n").collect()
}

/// Ranges with only a few poses.
const FEW: &str = "--x0 0:0.9:0.3 --y0 0 --angle 0 --quiet";

pub(crate) fn refused() -> String {
    if !strace::works() {
        return "SKIPPED, strace is missing or may not trace".to_owned();
    }
    let folder = tempfile::tempdir().expect("a folder");
    let folder = folder.path();
    let lines = "{\"figure\":\"rectangle\",\"length\":6,\"width\":5}\n".repeat(9);
    fs::write(folder.join("lines.jsonl"), lines).expect("written");
    fs::write(folder.join("touch.txt"), "1 2\n3 4\n\n").expect("written");
    for shard in ["1", "2"] {
        let text = format!("sweep rectangle {FEW} --shard {shard}/2 --atlas {shard}.npz");
        let run = alone(&text, folder);
        assert_eq!(run.status.code(), Some(0), "{run:?}");
    }
    let run = alone(&format!("model train arrow bar {FEW} --out m.npz"), folder);
    assert_eq!(run.status.code(), Some(0), "{run:?}");
    for text in [
        "merge 1.npz 2.npz --atlas all.npz --force",
        "model touches m.npz --runs 10",
        "model confusion m.npz",
        "library list",
        "batch --jobs 2 <lines.jsonl",
    ] {
        let (run, expected) = (alone(text, folder), finish(&mut line(text, folder)));
        assert_eq!(expected.status, run.status, "{text}: {run:?}");
        assert!(!run.stdout.is_empty(), "{text}: {run:?}");
        assert_eq!(answer(&expected), answer(&run), "{text}");
    }
    // Lines are written by a thread of their own, which cannot be replaced.
    let run = alone("watch touch.txt --format lines --at-least 2 --json", folder);
    assert_eq!(run.status.code(), Some(1), "{run:?}");
    let message = String::from_utf8_lossy(&run.stderr).into_owned();
    assert!(message.contains("cannot start a thread"), "{message}");
    "the same answers on one thread; a stream says that it cannot be written".to_owned()
}
