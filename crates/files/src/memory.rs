//! Limits the memory of long work. Sweeps and trainings keep every distinct imprint.
//!
//! The program checks its own memory while it works. Tables grow by doubling, so the work stops when half of the
//! free memory is in use: the next step still fits, and none has to be abandoned halfway.

use std::path::Path;
use std::sync::{Mutex, OnceLock};
use std::time::{Duration, Instant};

use taxel_core::lock::try_locked;
use taxel_core::progress::{Progress, stop_if};

const PAUSE: Duration = Duration::from_millis(20);

/// Keeps a piece of work within the memory that is free.
#[derive(Debug)]
pub struct MemoryGuard {
    /// The end of the message, which says what the user can do about too little memory.
    advice: &'static str,
    /// In bytes; None if the system does not tell how much is free.
    allowed: Option<u64>,
    due: Mutex<Instant>,
    exceeded: OnceLock<String>,
}

impl MemoryGuard {
    /// Nothing beyond half of the address space is allowed: no table can be larger.
    pub fn new(advice: &'static str) -> Self {
        let addressable = (usize::MAX / 2) as u64;
        Self {
            advice,
            allowed: free().map(|free| free.min(addressable)),
            due: Mutex::new(Instant::now()),
            exceeded: OnceLock::new(),
        }
    }

    /// Does work that reports to the progress it is given, which reports to `progress` and stops the work when memory
    /// runs short.
    ///
    /// # Errors
    /// A sentence, if memory ran short.
    pub fn limit<T, Done>(
        &self,
        progress: &dyn Progress<Done>,
        work: impl FnOnce(&dyn Progress<Done>) -> T,
    ) -> Result<T, String> {
        let result = work(&|done| {
            progress.add(done)?;
            // If another thread is checking, this one need not.
            if let Some(mut due) = try_locked(&self.due)
                && Instant::now() >= *due
            {
                *due = Instant::now() + PAUSE;
                let _ = self.check().map_err(|message| self.exceeded.set(message));
            }
            stop_if(self.exceeded.get().is_some())
        });
        self.exceeded.get().cloned().map_or(Ok(result), Err)
    }

    /// Checks memory now, between two steps of work that are few and large.
    ///
    /// # Errors
    /// A sentence, if more than half of the free memory is in use.
    pub fn check(&self) -> Result<(), String> {
        match (self.allowed, used()) {
            (Some(allowed), Some(used)) if used > allowed / 2 => Err(format!(
                "stopped: needs more memory than is free; {}",
                self.advice
            )),
            _ => Ok(()),
        }
    }
}

/// Reads a line of one of the system's tables, such as `VmRSS:      5120 kB`; None on systems other than Linux.
fn listed(table: &str, name: &str) -> Option<u64> {
    let table = std::fs::read_to_string(table).ok()?;
    let line = table.lines().find_map(|line| line.strip_prefix(name))?;
    let kilobytes: u64 = line.split_whitespace().next()?.parse().ok()?;
    Some(kilobytes * 1024)
}

fn used() -> Option<u64> {
    listed("/proc/self/status", "VmRSS:")
}

/// How much memory the program may use: the machine's free memory and what the program uses already, or less if its
/// control group or one around it has a limit (`memory.max`, see cgroups(7)).
fn free() -> Option<u64> {
    let machine = listed("/proc/meminfo", "MemAvailable:")? + used()?;
    let groups = std::fs::read_to_string("/proc/self/cgroup").unwrap_or_default();
    let own = groups.lines().find_map(|line| line.strip_prefix("0::/"));
    let around = own.into_iter().flat_map(|own| Path::new(own).ancestors());
    let limits = around.filter_map(|group| {
        let file = Path::new("/sys/fs/cgroup").join(group).join("memory.max");
        // A group without a limit has the word `max`; the outermost group has no file.
        std::fs::read_to_string(file).ok()?.trim().parse().ok()
    });
    limits.chain([machine]).min()
}

#[cfg(test)]
mod tests {
    use std::ops::ControlFlow;

    use taxel_core::progress::ToTheEnd;

    use super::*;

    #[test]
    fn a_guard_stops_what_needs_too_much() {
        let large = MemoryGuard::new("");
        let small = MemoryGuard {
            allowed: Some(1024),
            ..MemoryGuard::new("work in shards (--shard)")
        };
        let flow = |guard: &MemoryGuard| guard.limit(&ToTheEnd, |progress| progress.add(1_u64));
        assert_eq!(flow(&large), Ok(ControlFlow::Continue(())));
        let stopped = "stopped: needs more memory than is free; work in shards (--shard)";
        if used().is_some() {
            assert_eq!(flow(&small), Err(stopped.to_owned()));
            assert_eq!(small.check(), Err(stopped.to_owned()));
            assert!(free().expect("on Linux") > 1 << 20);
        }
        assert_eq!(large.check(), Ok(()));
    }

    #[test]
    fn work_that_its_own_progress_stops_is_no_matter_of_memory() {
        let guard = MemoryGuard::new("");
        let stopped = guard.limit(&|_: u64| ControlFlow::Break(()), |progress| progress.add(1));
        assert_eq!(stopped, Ok(ControlFlow::Break(())));
    }
}
