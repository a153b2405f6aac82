//! Calls of the system, listed and tampered with by `strace`.

use std::path::Path;
use std::process::{Command, Output, Stdio};

use super::state::finish;

/// All that can change files; those that a machine does not have are left out.
const CALLS: &str = "?openat,?open,?creat,?write,?pwrite64,?writev,?fsync,?fdatasync,?rename,?renameat,?renameat2,\
    ?unlink,?unlinkat,?link,?linkat,?symlink,?symlinkat,?mkdir,?mkdirat,?rmdir,?truncate,?ftruncate,?flock,?chmod,\
    ?fchmod,?fchmodat";

/// The so-many-th call of a name, counted from 1.
#[derive(Clone, Debug)]
pub(crate) struct Call {
    pub(crate) name: String,
    pub(crate) number: usize,
}

/// Whether there is a `strace` that may trace.
pub(crate) fn works() -> bool {
    let traced = Command::new("strace")
        .args(["-qq", "-o", "/dev/null", "-e", "trace=?openat", "true"])
        .stderr(Stdio::null())
        .status();
    traced.is_ok_and(|status| status.success())
}

/// The calls of a command that touch a folder or what is in it.
pub(crate) fn calls(command: &Command, folder: &Path) -> Vec<Call> {
    let log = tempfile::NamedTempFile::new().expect("there is a folder for temporary files");
    let log_path = log.path().to_str().expect("a text");
    let trace = format!("trace={CALLS}");
    let output = traced(command, &["-y", "-o", log_path, "-e", &trace]);
    assert!(output.status.success(), "{output:?}");
    let text = std::fs::read_to_string(log.path()).expect("a log");
    let folder = folder.to_str().expect("a text");
    let mut counted: Vec<Call> = Vec::new();
    let mut calls = Vec::new();
    for line in text.lines() {
        let Some((name, _)) = line.split_once('(') else {
            continue;
        };
        let number = 1 + counted.iter().filter(|call| call.name == name).count();
        let name = name.to_owned();
        let call = Call { name, number };
        counted.push(call.clone());
        if line.contains(folder) {
            calls.push(call);
        }
    }
    calls
}

/// Runs a command with one of its calls tampered with: `signal=KILL` kills it just before, `error=EIO` refuses the call.
pub(crate) fn tampered(command: &Command, call: &Call, how: &str) -> Output {
    let Call { name, number } = call;
    let trace = format!("trace={name}");
    let inject = format!("inject={name}:{how}:when={number}");
    traced(
        command,
        &["-qq", "-o", "/dev/null", "-e", &trace, "-e", &inject],
    )
}

/// Runs a command with every call of some names, as of `trace=`, refused.
pub(crate) fn refused(command: &Command, names: &str, error: &str) -> Output {
    let trace = format!("trace={names}");
    let inject = format!("inject={names}:error={error}");
    traced(
        command,
        &["-f", "-qq", "-o", "/dev/null", "-e", &trace, "-e", &inject],
    )
}

fn traced(command: &Command, options: &[&str]) -> Output {
    let mut strace = Command::new("strace");
    strace
        .args(options)
        .arg("--")
        .arg(command.get_program())
        .args(command.get_args());
    for (name, value) in command.get_envs() {
        match value {
            Some(value) => strace.env(name, value),
            None => strace.env_remove(name),
        };
    }
    finish(
        strace
            .stdin(Stdio::null())
            .stdout(Stdio::piped())
            .stderr(Stdio::piped()),
    )
}
