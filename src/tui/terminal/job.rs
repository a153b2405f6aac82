//! Job control: the program is stopped and continued by a shell.
//!
//! If the program stopped itself and no shell could continue it, it would never come back. So it looks for a shell
//! among the parents of the process first.

#[cfg(target_os = "linux")]
use std::fs;

use rustix::process::{Signal, kill_current_process_group};
#[cfg(not(target_os = "linux"))]
use rustix::process::{getpgid, getsid};

/// Returns true if somebody could continue the program: a process above it, on the same terminal, in another process
/// group. The first process of a connection has no such process; stopped, it would never come back.
///
/// Everything is read from `/proc`, where a process, group or session outside the program's PID namespace (a
/// container's) appears as 0; the system calls answer 0 there too, which is not a process number. A controlling
/// terminal belongs to one session only, so it replaces the session's number.
#[cfg(target_os = "linux")]
pub(in crate::tui) fn has_shell() -> bool {
    let Some(own) = Process::read("self") else {
        return false;
    };
    if own.terminal == 0 {
        return false;
    }
    let mut above = own.parent;
    while above != 0 {
        match Process::read(&above.to_string()) {
            Some(process) if process.terminal != own.terminal => return false,
            Some(process) if process.group != own.group => return true,
            Some(process) => above = process.parent,
            None => return false,
        }
    }
    false
}

/// Returns true if there is a shell that could continue the program: the program is in another process group than the
/// first process of its session.
#[cfg(not(target_os = "linux"))]
pub(in crate::tui) fn has_shell() -> bool {
    match (getsid(None), getpgid(None)) {
        (Ok(session), Ok(group)) => session != group,
        _ => false,
    }
}

/// Stops the whole process group, as the terminal itself would: a program that waits for this one (an editor or a
/// version control system) must stop too, or the shell would not notice.
pub(in crate::tui) fn stop() -> rustix::io::Result<()> {
    kill_current_process_group(Signal::STOP)
}

#[cfg(target_os = "linux")]
#[derive(Debug, PartialEq)]
struct Process {
    parent: u32,
    group: u32,
    /// The device number of the controlling terminal; 0 if there is none.
    terminal: i32,
}

#[cfg(target_os = "linux")]
impl Process {
    /// Reads `/proc/PID/stat`; `number` may be `self`.
    fn read(number: &str) -> Option<Self> {
        let stat = fs::read_to_string(format!("/proc/{number}/stat")).ok()?;
        Self::parse(&stat)
    }

    /// Parses `number (name) state parent group session terminal …`; the name may contain any character.
    fn parse(stat: &str) -> Option<Self> {
        let (_, rest) = stat.rsplit_once(')')?;
        let mut fields = rest.split_whitespace().skip(1);
        Some(Self {
            parent: fields.next()?.parse().ok()?,
            group: fields.next()?.parse().ok()?,
            terminal: fields.nth(1)?.parse().ok()?,
        })
    }
}

#[cfg(all(test, target_os = "linux"))]
mod tests {
    use super::*;

    #[test]
    fn a_name_may_contain_any_character_and_a_group_may_be_0() {
        let stat = "17 (a) S 1) (b) R 4 0 0 34816 17 4194304";
        assert_eq!(
            Process::parse(stat),
            Some(Process {
                parent: 4,
                group: 0,
                terminal: 34816
            })
        );
        assert_eq!(Process::parse("17 (a) S 4"), None);
        assert_eq!(Process::parse(""), None);
    }

    #[test]
    fn the_parent_is_the_one_that_the_system_reports() {
        let own = Process::read("self").expect("/proc/self/stat");
        assert_eq!(own.parent, std::os::unix::process::parent_id());
    }
}
