//! Being stopped and continued by a shell.

use std::fs;

use rustix::process::{Pid, Signal, getpgid, getpgrp, getppid, getsid, kill_current_process_group};

/// Whether anybody is there who would continue the program: a process of the same session that is not of its own
/// process group, above it. The first process of a connection has none; stopped, it would never come back.
pub(super) fn has_shell() -> bool {
    let Ok(session) = getsid(None) else {
        return false;
    };
    let group = getpgrp();
    let mut above = getppid();
    while let Some(process) = above {
        let (Ok(its_session), Ok(its_group)) = (getsid(Some(process)), getpgid(Some(process)))
        else {
            return false;
        };
        if its_session != session {
            return false;
        }
        if its_group != group {
            return true;
        }
        above = parent(process);
    }
    false
}

/// Stops the whole process group, as the terminal itself would: a program that waits for this one (an editor's or a
/// version control's) must stop too, or the shell would not notice.
pub(super) fn stop() -> rustix::io::Result<()> {
    kill_current_process_group(Signal::STOP)
}

/// `/proc/PID/stat`: number, (name), state, parent; the name may hold anything.
fn parent(process: Pid) -> Option<Pid> {
    let stat = fs::read_to_string(format!("/proc/{}/stat", process.as_raw_nonzero())).ok()?;
    let (_, rest) = stat.rsplit_once(')')?;
    let number = rest.split_whitespace().nth(1)?.parse().ok()?;
    Pid::from_raw(number)
}
