//! System calls, listed by `strace`, and programs that it kills before one of them.

use std::collections::HashMap;
use std::path::Path;
use std::process::{Command, Output, Stdio};

/// All system calls that can change files. The `?` lets strace ignore those that a machine does not have.
const CALLS: &str = "trace=?openat,?open,?creat,?write,?pwrite64,?writev,?fsync,?fdatasync,?rename,?renameat,?renameat2,\
    ?unlink,?unlinkat,?link,?linkat,?symlink,?symlinkat,?mkdir,?mkdirat,?rmdir,?truncate,?ftruncate,?flock,?fchmod";

/// A system call: its name, and which call of that name it is, counted from 1.
pub(crate) type Call = (String, usize);

/// Whether there is a `strace` that is allowed to trace.
pub(crate) fn works() -> bool {
    let mut strace = Command::new("strace");
    strace.args(["-qq", "-o", "/dev/null", "-e", "trace=?openat", "true"]);
    let traced = strace.stderr(Stdio::null()).status();
    traced.is_ok_and(|status| status.success())
}

/// The calls of a command that concern a folder or its contents.
pub(crate) fn calls(command: &Command, folder: &Path) -> Vec<Call> {
    let log = tempfile::NamedTempFile::new().expect("there is a folder for temporary files");
    let path = log.path().to_str().expect("a text");
    let output = traced(command, &["-y", "-o", path, "-e", CALLS]);
    assert!(output.status.success(), "{output:?}");
    let text = std::fs::read_to_string(path).expect("a log");
    let folder = folder.to_str().expect("a text");
    let mut counts: HashMap<&str, usize> = HashMap::new();
    let mut calls = Vec::new();
    for (name, rest) in text.lines().filter_map(|line| line.split_once('(')) {
        let number = counts.entry(name).or_default();
        *number += 1;
        if rest.contains(folder) {
            calls.push((name.to_owned(), *number));
        }
    }
    calls
}

/// Runs a command until it is killed just before a call.
pub(crate) fn killed_before(command: &Command, (name, number): &Call) -> Output {
    let trace = format!("trace={name}");
    let kill = format!("inject={name}:signal=KILL:when={number}");
    traced(
        command,
        &["-qq", "-o", "/dev/null", "-e", &trace, "-e", &kill],
    )
}

fn traced(command: &Command, options: &[&str]) -> Output {
    let mut strace = Command::new("strace");
    strace
        .args(options)
        .arg("--")
        .arg(command.get_program())
        .args(command.get_args());
    strace.envs(
        command
            .get_envs()
            .filter_map(|(name, value)| Some((name, value?))),
    );
    strace.current_dir(command.get_current_dir().unwrap_or(Path::new(".")));
    strace.stdin(Stdio::null()).output().expect("it starts")
}
