//! A disk that hangs while the program runs, or a system that refuses threads from then on, as `strace` makes them.

use std::fs;
use std::path::Path;
use std::process::{Child, Command, Stdio};

use super::program::Program;
use crate::skip;

/// Longer than any test waits: only the end of the [`Tracer`] lets the program go on.
const DELAY: &str = "delay_enter=600000000";

/// Tampers with some calls of a program until it is dropped.
pub(super) struct Tracer(Child);

impl Tracer {
    /// Holds up calls; with paths, those about them only. None, which is said, where there is no `strace` that may trace.
    pub(super) fn hang(program: &mut Program, calls: &str, paths: &[&Path]) -> Option<Self> {
        Self::new(program, calls, DELAY, paths)
    }

    /// Refuses threads, those of each thread that `which` names: `1+` for all of them. The same otherwise.
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

    /// The disk answers again, the system gives threads.
    pub(super) fn end(self) {
        drop(self);
    }
}

impl Drop for Tracer {
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
