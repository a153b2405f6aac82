//! A disk that hangs while the program runs, or a system that then refuses threads, simulated with `strace`.

use std::fs;
use std::path::Path;
use std::process::{Child, Command, Stdio};

use super::program::Program;
use crate::skip;

/// Longer than any test waits: only the end of the [`Tracer`] lets the program continue.
const DELAY: &str = "delay_enter=600000000";

/// Tampers with some calls of a program until it is dropped.
pub(super) struct Tracer(Child);

impl Tracer {
    /// Delays calls; if paths are given, only calls about these. Without a `strace` that is allowed to trace, reports
    /// the test as skipped and returns None.
    pub(super) fn hang(program: &mut Program, calls: &str, paths: &[&Path]) -> Option<Self> {
        Self::new(program, calls, DELAY, paths)
    }

    /// Refuses new threads, for the calls of each thread that `which` selects: `1+` for all. Otherwise like
    /// [`Self::hang`].
    pub(super) fn refuse_threads(program: &mut Program, which: &str) -> Option<Self> {
        let how = format!("error=EAGAIN:when={which}");
        Self::new(program, "?clone,?clone3", &how, &[])
    }

    fn new(program: &mut Program, calls: &str, how: &str, paths: &[&Path]) -> Option<Self> {
        let pid = program.pid().as_raw_nonzero().to_string();
        let mut strace = Command::new("strace");
        strace.args(["-f", "-qq", "-o", "/dev/null", "-p", &pid]);
        strace.args(["-e", &format!("trace={calls}")]);
        strace.args(["-e", &format!("inject={calls}:{how}")]);
        for path in paths {
            strace.arg("-P").arg(path);
        }
        let Ok(child) = strace.stderr(Stdio::null()).spawn() else {
            skip::lacking("strace");
            return None;
        };
        let mut tracer = Self(child);
        let mut refused = false;
        program.until("strace to trace it", |_| {
            refused = tracer.0.try_wait().expect("a child").is_some();
            refused || is_traced(&pid)
        });
        if refused {
            skip::skipped("strace may not trace");
            return None;
        }
        Some(tracer)
    }

    /// Ends the tampering: the disk answers again, and the system starts threads.
    pub(super) fn end(self) {
        drop(self);
    }
}

impl Drop for Tracer {
    fn drop(&mut self) {
        // When strace is killed, the system releases the program. Asked to end, strace would wait for the calls that
        // it delays.
        let _ = self.0.kill();
        let _ = self.0.wait();
    }
}

/// Returns true if all threads of a process are traced.
fn is_traced(pid: &str) -> bool {
    let tasks = fs::read_dir(format!("/proc/{pid}/task")).expect("it runs");
    tasks.flatten().all(|task| {
        let status = fs::read_to_string(task.path().join("status"));
        status.is_ok_and(|status| !status.contains("TracerPid:\t0\n"))
    })
}
