//! A disk that hangs while the program runs, as `strace` makes it, and answers again when it is let go.

use std::fs;
use std::path::Path;
use std::process::{Child, Command, Stdio};

use super::program::Program;

/// Longer than any test waits: only the end of [`Hanging`] lets the program go on.
const DELAY: &str = "delay_enter=600000000";

/// Holds up some calls of a program until it is dropped.
pub(super) struct Hanging(Child);

impl Hanging {
    /// Holds up calls, those about some paths only where there are any. None, which is said, where there is no `strace`
    /// that may trace.
    pub(super) fn new(program: &mut Program, calls: &str, paths: &[&Path]) -> Option<Self> {
        let pid = program.pid().as_raw_nonzero().to_string();
        let mut strace = Command::new("strace");
        strace.args(["-f", "-qq", "-o", "/dev/null", "-p", &pid]);
        strace.args(["-e", &format!("trace={calls}")]);
        strace.args(["-e", &format!("inject={calls}:{DELAY}")]);
        for path in paths {
            strace.arg("-P").arg(path);
        }
        let Ok(child) = strace.stderr(Stdio::null()).spawn() else {
            println!("SKIPPED, there is no strace");
            return None;
        };
        let mut hanging = Self(child);
        let mut refused = false;
        program.until("strace to trace it", |_| {
            refused = hanging.0.try_wait().expect("a child").is_some();
            refused || is_traced(&pid)
        });
        if refused {
            println!("SKIPPED, strace may not trace");
            return None;
        }
        Some(hanging)
    }

    /// The disk answers again.
    pub(super) fn answers(self) {
        drop(self);
    }
}

impl Drop for Hanging {
    fn drop(&mut self) {
        // The system lets go of the program then. Asked to end, it would wait for calls that it holds up itself.
        let _ = self.0.kill();
        let _ = self.0.wait();
    }
}

/// Whether each thread of a process is traced.
fn is_traced(pid: &str) -> bool {
    let tasks = fs::read_dir(format!("/proc/{pid}/task")).expect("it runs");
    tasks.flatten().all(|task| {
        let status = fs::read_to_string(task.path().join("status"));
        status.is_ok_and(|status| !status.contains("TracerPid:\t0\n"))
    })
}
