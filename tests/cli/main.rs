//! Tests of the program as users run it: arguments and standard input in, text and exit status out.

#[path = "../common/paper.rs"]
mod paper;

#[path = "../common/array.rs"]
mod array;

#[path = "../common/commands.rs"]
mod commands;

#[path = "../common/skip.rs"]
mod skip;

#[path = "../common/wait.rs"]
mod wait;

mod figure;

mod describe;

mod export;

mod foreign;

mod frames;

mod watch;

mod watch_files;

mod batch;

mod library;

mod outlines;

mod picture;

mod sweep;

mod model;

mod recognise;

mod separate;

mod settings;

mod shell;

mod streams;

mod script;

use std::ffi::OsStr;
use std::io::Write;
use std::process::{Child, Command, Stdio};
use std::time::{Duration, Instant};

/// Returns the command that runs the program in a locale, with pipes for all its streams.
fn program<A: AsRef<OsStr>>(arguments: &[A], locale: &str) -> Command {
    let mut command = alone(Command::new(env!("CARGO_BIN_EXE_taxel")), locale);
    command.args(arguments);
    command
}

/// Returns the command that runs a script in `sh`, in a UTF-8 locale, as [`program`] runs the program, which is `$0` in
/// the script. Arguments that are added are `$1` and so on.
fn sh(script: &str) -> Command {
    let mut command = alone(Command::new("sh"), "C.UTF-8");
    command.args(["-c", script, env!("CARGO_BIN_EXE_taxel")]);
    command
}

/// Gives a command pipes for all its streams, a locale, and no files of the user: no settings, no library, no cache.
fn alone(mut command: Command, locale: &str) -> Command {
    command
        .env_remove("LC_CTYPE")
        .env_remove("LANG")
        .env("LC_ALL", locale)
        // Uses no settings file.
        .env("TAXEL_CONFIG", "/dev/null")
        // Uses no library, only the shapes that are shipped with the program.
        .env(
            "TAXEL_LIBRARY",
            concat!(env!("CARGO_TARGET_TMPDIR"), "/no-library"),
        )
        // Uses no model that another version has cached.
        .env(
            "XDG_CACHE_HOME",
            concat!(env!("CARGO_TARGET_TMPDIR"), "/cache"),
        )
        .stdin(Stdio::piped())
        .stdout(Stdio::piped())
        .stderr(Stdio::piped());
    command
}

/// The result of running the program.
#[derive(Debug, PartialEq, Eq)]
struct Run {
    status: Option<i32>,
    stdout: String,
    stderr: String,
}

fn finish(mut child: Child, input: &[u8]) -> Run {
    let mut stdin = child.stdin.take().expect("standard input is piped");
    let output = std::thread::scope(|scope| {
        // A program that stops early may close its end of the pipe.
        scope.spawn(move || drop(stdin.write_all(input)));
        child.wait_with_output().expect("the program ends")
    });
    Run {
        status: output.status.code(),
        stdout: String::from_utf8(output.stdout).expect("answers are UTF-8"),
        stderr: String::from_utf8(output.stderr).expect("messages are UTF-8"),
    }
}

fn run_in<A: AsRef<OsStr>>(locale: &str, arguments: &[A], input: &[u8]) -> Run {
    let child = program(arguments, locale).spawn();
    finish(child.expect("the program starts"), input)
}

/// Runs a command line, split at spaces, in a UTF-8 locale.
fn taxel(line: &str, input: impl AsRef<[u8]>) -> Run {
    let arguments: Vec<&str> = line.split_whitespace().collect();
    run_in("C.UTF-8", &arguments, input.as_ref())
}

/// Checks that a run wrote nothing but one message.
fn refused(run: &Run, status: i32, message: &str) {
    let stderr = format!("error: {message}\n");
    let stdout = String::new();
    let expected = Run {
        status: Some(status),
        stdout,
        stderr,
    };
    assert_eq!(*run, expected);
}

/// Checks that a line is wrong usage: status 2, and a message that begins with `message`.
fn misused(line: &str, message: &str) {
    let run = taxel(line, "");
    assert_eq!(run.status, Some(2), "{line}");
    assert_eq!(run.stdout, "", "{line}");
    assert!(
        run.stderr.starts_with(&format!("error: {message}")),
        "{line}: {}",
        run.stderr
    );
}

/// Waits until a condition holds, for half a minute at most.
fn until(what: &str, mut holds: impl FnMut() -> bool) {
    let start = Instant::now();
    while !holds() {
        assert!(start.elapsed() < Duration::from_secs(30), "no {what}");
        std::thread::sleep(Duration::from_millis(5));
    }
}

/// Returns true if Python has these modules; otherwise reports the test as skipped. With `TAXEL_NUMPY` set, they are
/// required.
fn python_has(modules: &str) -> bool {
    let found = Command::new("python3")
        .args(["-c", &format!("import {modules}")])
        .stderr(Stdio::null())
        .status();
    let there = found.is_ok_and(|status| status.success());
    if !there {
        let must = std::env::var_os("TAXEL_NUMPY").is_some();
        assert!(!must, "Python has no {modules}");
        skip::skipped(&format!("Python has no {modules}"));
    }
    there
}

/// The paper's Fig. 1.
const RING: &str = "figure ellipse --radius-x 4 --radius-y 4 --x0 1.99 --y0 1.47 --thickness 2";
