//! System calls, listed and tampered with by `strace`.

use std::path::Path;
use std::process::{Command, Output, Stdio};

use super::state::{finish, piped};

/// All system calls that can change files. The `?` lets strace ignore those that a machine does not have.
const CALLS: &str = "?openat,?open,?creat,?write,?pwrite64,?writev,?fsync,?fdatasync,?rename,?renameat,?renameat2,\
    ?unlink,?unlinkat,?link,?linkat,?symlink,?symlinkat,?mkdir,?mkdirat,?rmdir,?truncate,?ftruncate,?flock,?fchmod";

/// A system call: its name, and which call of that name it is, counted from 1.
#[derive(Clone, Debug)]
pub(crate) struct Call {
    pub(crate) name: String,
    pub(crate) number: usize,
}

/// Returns true if there is a `strace` that is allowed to trace.
pub(crate) fn works() -> bool {
    let traced = Command::new("strace")
        .args(["-qq", "-o", "/dev/null", "-e", "trace=?openat", "true"])
        .stderr(Stdio::null())
        .status();
    traced.is_ok_and(|status| status.success())
}

/// Returns the calls of a command that concern a folder or its contents.
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

/// Runs a command and tampers with one of its calls: `signal=KILL` kills it just before, `error=EIO` refuses the call.
pub(crate) fn tampered(command: &Command, call: &Call, how: &str) -> Output {
    let Call { name, number } = call;
    let trace = format!("trace={name}");
    let inject = format!("inject={name}:{how}:when={number}");
    traced(
        command,
        &["-qq", "-o", "/dev/null", "-e", &trace, "-e", &inject],
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
    piped(&mut strace);
    finish(&mut strace)
}
