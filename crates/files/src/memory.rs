//! Limits the memory of long work. Sweeps and trainings keep every distinct imprint.
//!
//! The program checks its own memory while it works. Tables grow by doubling, so the work stops when half of the
//! allowed memory is in use: the next step still fits, and none has to be abandoned halfway.

use std::fmt;
use std::path::Path;
use std::str::FromStr;
use std::sync::{Mutex, OnceLock};
use std::time::{Duration, Instant};

use taxel_core::lock::try_locked;
use taxel_core::progress::{Progress, stop_if};

use crate::formats::value::counted;

const PAUSE: Duration = Duration::from_millis(20);

/// An amount of memory in bytes, written as `2G`, `500M` or `1.5G`. K is 1024 bytes, M is 1024 K, G is 1024 M, T is
/// 1024 G.
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord)]
pub struct MemorySize(pub u64);

/// The letters of [`MemorySize`] and their numbers of bytes.
const UNITS: [(char, f64); 4] = [
    ('T', 1_099_511_627_776.0),
    ('G', 1_073_741_824.0),
    ('M', 1_048_576.0),
    ('K', 1024.0),
];

impl FromStr for MemorySize {
    type Err = &'static str;

    #[expect(
        clippy::cast_possible_truncation,
        clippy::cast_sign_loss,
        reason = "checked to be in range"
    )]
    fn from_str(text: &str) -> Result<Self, Self::Err> {
        let unit = UNITS.iter().find_map(|(letter, bytes)| {
            let number = text.strip_suffix([*letter, letter.to_ascii_lowercase()])?;
            Some((number, *bytes))
        });
        let (number, bytes) = unit.unwrap_or((text, 1.0));
        match number.parse::<f64>().map(|number| number * bytes) {
            Ok(total) if (1.0..1e18).contains(&total) => Ok(Self(total as u64)),
            _ => Err("expected an amount of memory such as 2G or 500M"),
        }
    }
}

impl fmt::Display for MemorySize {
    /// Writes the amount rounded to a tenth, such as `1.5G`; less than 1K in bytes, such as `12 bytes`.
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        #[expect(clippy::cast_precision_loss, reason = "rounded anyway")]
        let total = self.0 as f64;
        match UNITS.iter().find(|(_, bytes)| total >= *bytes) {
            Some((letter, bytes)) => write!(f, "{:.1}{letter}", total / bytes),
            None => f.write_str(&counted(self.0, "byte")),
        }
    }
}

/// Keeps a piece of work within its memory.
#[derive(Debug)]
pub struct MemoryGuard {
    /// The end of the message, which says what the user can do about too little memory.
    advice: &'static str,
    /// None if nobody set a limit and the system does not tell how much is free.
    allowed: Option<MemorySize>,
    due: Mutex<Instant>,
    exceeded: OnceLock<String>,
}

impl MemoryGuard {
    /// Creates a guard with this limit, or if None, with all memory that is free. Nothing beyond half of the address
    /// space is allowed: no table can be larger.
    pub fn new(allowed: Option<MemorySize>, advice: &'static str) -> Self {
        let addressable = MemorySize((usize::MAX / 2) as u64);
        Self {
            advice,
            allowed: allowed
                .or_else(free)
                .map(|allowed| allowed.min(addressable)),
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
    /// A sentence, if more than half of the allowed memory is in use.
    pub fn check(&self) -> Result<(), String> {
        match (self.allowed, used()) {
            (Some(allowed), Some(used)) if used > allowed.0 / 2 => Err(format!(
                "stopped: needs more memory than the {allowed} allowed; {}",
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
fn free() -> Option<MemorySize> {
    let machine = listed("/proc/meminfo", "MemAvailable:")? + used()?;
    let groups = std::fs::read_to_string("/proc/self/cgroup").unwrap_or_default();
    let own = groups.lines().find_map(|line| line.strip_prefix("0::/"));
    let around = own.into_iter().flat_map(|own| Path::new(own).ancestors());
    let limits = around.filter_map(|group| {
        let file = Path::new("/sys/fs/cgroup").join(group).join("memory.max");
        // A group without a limit has the word `max`; the outermost group has no file.
        std::fs::read_to_string(file).ok()?.trim().parse().ok()
    });
    limits.chain([machine]).min().map(MemorySize)
}

#[cfg(test)]
mod tests {
    use std::ops::ControlFlow;

    use taxel_core::progress::ToTheEnd;

    use super::*;

    #[test]
    fn amounts_are_read_and_shown() {
        for (text, bytes, shown) in [
            ("2G", 2 << 30, "2.0G"),
            ("1.5g", 3 << 29, "1.5G"),
            ("500M", 500 << 20, "500.0M"),
            ("1024", 1024, "1.0K"),
            ("12", 12, "12 bytes"),
        ] {
            assert_eq!(text.parse(), Ok(MemorySize(bytes)), "{text}");
            assert_eq!(MemorySize(bytes).to_string(), shown);
        }
        for text in ["", "G", "-1G", "0", "2GB", "1e30", "NaN", "two"] {
            assert!(text.parse::<MemorySize>().is_err(), "{text}");
        }
    }

    #[test]
    fn a_guard_stops_what_needs_too_much() {
        let small = MemoryGuard::new(Some(MemorySize(1024)), "work in shards (--shard)");
        let large = MemoryGuard::new(Some(MemorySize(u64::MAX)), "");
        // No table can be larger than half of the address space.
        let addressable = (usize::MAX / 2) as u64;
        assert_eq!(large.allowed, Some(MemorySize(addressable)));
        let flow = |guard: &MemoryGuard| guard.limit(&ToTheEnd, |progress| progress.add(1_u64));
        assert_eq!(flow(&large), Ok(ControlFlow::Continue(())));
        let stopped = "stopped: needs more memory than the 1.0K allowed; work in shards (--shard)";
        if used().is_some() {
            assert_eq!(flow(&small), Err(stopped.to_owned()));
            assert_eq!(small.check(), Err(stopped.to_owned()));
            assert!(free().expect("on Linux") > MemorySize(1 << 20));
        }
        assert_eq!(large.check(), Ok(()));
    }

    #[test]
    fn work_that_its_own_progress_stops_is_no_matter_of_memory() {
        let guard = MemoryGuard::new(Some(MemorySize(1 << 50)), "");
        let stopped = guard.limit(&|_: u64| ControlFlow::Break(()), |progress| progress.add(1));
        assert_eq!(stopped, Ok(ControlFlow::Break(())));
    }
}
