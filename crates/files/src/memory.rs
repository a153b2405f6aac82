//! Limits the memory of long work. Sweeps and trainings keep every distinct imprint.
//!
//! The program checks its own memory while it works. Tables grow by doubling, so the work stops when half of the
//! allowed memory is in use: the next step still fits, and none has to be abandoned halfway.

use std::fmt;
#[cfg(target_os = "linux")]
use std::path::Path;
use std::str::FromStr;
use std::sync::Mutex;
use std::sync::atomic::{AtomicBool, Ordering};
use std::time::{Duration, Instant};

use taxel_core::lock::{locked, try_locked};
use taxel_core::pose::PoseGrid;
use taxel_core::progress::{Progress, stop_if};
use taxel_core::sweep::{Sweep, TimingSample};

use crate::formats::value::counted;

const PAUSE: Duration = Duration::from_millis(20);

/// Bytes that an imprint takes in an atlas in addition to its own: its count, hash, description and statistics
/// values.
const BYTES_BESIDE: u64 = 500;

/// Work stops at half of the address space, whatever is allowed: 2 GiB in a 32-bit program. No table can be larger, and
/// many systems give a program little more.
const ADDRESSABLE: MemorySize = MemorySize((usize::MAX / 2) as u64);

/// An amount of memory in bytes, written as `2G`, `500M` or `1.5G`. K is 1024 bytes, M is 1024 K, G is 1024 M, T is
/// 1024 G.
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord)]
pub struct MemorySize(pub u64);

/// The letters of [`MemorySize`] and their numbers of bytes.
const UNITS: [(char, u64); 4] = [
    ('T', 1 << 40),
    ('G', 1 << 30),
    ('M', 1 << 20),
    ('K', 1 << 10),
];

impl FromStr for MemorySize {
    type Err = &'static str;

    fn from_str(text: &str) -> Result<Self, Self::Err> {
        const EXPECTED: &str = "expected an amount of memory such as 2G or 500M";
        let unit = UNITS.iter().find_map(|(letter, bytes)| {
            let number = text.strip_suffix([*letter, letter.to_ascii_lowercase()])?;
            Some((number, *bytes))
        });
        let (number, bytes) = unit.unwrap_or((text, 1));
        let number: f64 = number.parse().map_err(|_| EXPECTED)?;
        #[expect(clippy::cast_precision_loss, reason = "powers of two")]
        let total = number * bytes as f64;
        if !(1.0..1e18).contains(&total) {
            return Err(EXPECTED);
        }
        #[expect(
            clippy::cast_possible_truncation,
            clippy::cast_sign_loss,
            reason = "in range"
        )]
        let bytes = total as u64;
        Ok(Self(bytes))
    }
}

impl fmt::Display for MemorySize {
    /// Writes the amount rounded to a tenth, such as `1.5G`; less than 1K in bytes, such as `12 bytes`.
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        let unit = UNITS.iter().find(|(_, bytes)| self.0 >= *bytes);
        match unit {
            Some((letter, bytes)) => {
                #[expect(clippy::cast_precision_loss, reason = "rounded anyway")]
                let number = self.0 as f64 / *bytes as f64;
                write!(f, "{number:.1}{letter}")
            }
            None => f.write_str(&counted(self.0, "byte")),
        }
    }
}

/// Keeps a piece of work within its memory.
#[derive(Debug)]
pub struct MemoryGuard {
    /// None if nobody set a limit and the system does not tell how much is free.
    limits: Option<Limits>,
}

#[derive(Debug)]
struct Limits {
    /// The end of each message, which says what the user can do about too little memory.
    advice: &'static str,
    allowed: MemorySize,
    due: Mutex<Instant>,
    exceeded: AtomicBool,
}

impl MemoryGuard {
    /// Creates a guard with this limit, or if None, with all memory that is free and within the system's limits.
    pub fn new(allowed: Option<MemorySize>, advice: &'static str) -> Self {
        let allowed = allowed.or_else(|| free().map(|free| free.min(ADDRESSABLE)));
        let limits = allowed.map(|allowed| Limits {
            advice,
            allowed,
            due: Mutex::new(Instant::now()),
            exceeded: AtomicBool::new(false),
        });
        Self { limits }
    }

    /// Creates a guard for a sweep on the screen, with its results in memory.
    pub fn of_sweep() -> Self {
        Self::new(
            None,
            "take coarser steps, or sweep it in shards on the command line (taxel sweep --shard)",
        )
    }

    /// Creates a guard for a search for poses, which keeps all poses of an imprint until they are counted.
    pub fn of_pose_search() -> Self {
        Self::new(None, "train the model in coarser steps to see poses")
    }

    /// Does work that reports to the progress it is given, which reports to `progress` and stops the work when memory
    /// runs short.
    pub fn limit<T, Done>(
        &self,
        progress: &dyn Progress<Done>,
        work: impl FnOnce(&dyn Progress<Done>) -> T,
    ) -> Result<T, String> {
        let Some(limits) = &self.limits else {
            return Ok(work(progress));
        };
        let result = work(&|done| {
            progress.add(done)?;
            stop_if(!limits.allows())
        });
        if limits.exceeded() {
            return Err(limits.message());
        }
        Ok(result)
    }

    /// Checks memory between two steps of a merge, which are few and large.
    pub fn check_merge(&self) -> Result<(), String> {
        match &self.limits {
            Some(limits) if !limits.allows_now() => Err(limits.message_of_merge()),
            _ => Ok(()),
        }
    }

    /// Refuses a sweep, before it starts, if its grid needs far more memory than is allowed.
    pub fn check(&self, grid: &PoseGrid) -> Result<(), String> {
        let Some(limits) = &self.limits else {
            return Ok(());
        };
        let expected = expected(grid);
        // The estimate may be twice too high: several angles may leave the same imprints.
        if expected.0 / 2 <= limits.allowed.0 {
            return Ok(());
        }
        Err(limits.refusal(expected))
    }
}

impl Limits {
    /// Whether the work may go on. It is cheap enough to be called often.
    fn allows(&self) -> bool {
        if self.exceeded() {
            return false;
        }
        // If another thread is checking, this one need not.
        if let Some(mut due) = try_locked(&self.due)
            && Instant::now() >= *due
        {
            *due = Instant::now() + PAUSE;
            if used().is_some_and(|used| used.0 > self.addressable().0 / 2) {
                self.exceeded.store(true, Ordering::Relaxed);
                return false;
            }
        }
        true
    }

    /// Like [`Self::allows`], but checks memory at each call.
    fn allows_now(&self) -> bool {
        *locked(&self.due) = Instant::now();
        self.allows()
    }

    fn exceeded(&self) -> bool {
        self.exceeded.load(Ordering::Relaxed)
    }

    /// The part of the allowed memory that has addresses.
    fn addressable(&self) -> MemorySize {
        self.allowed.min(ADDRESSABLE)
    }

    fn message(&self) -> String {
        let (allowed, advice) = (self.addressable(), self.advice);
        format!("stopped: needs more memory than the {allowed} allowed; {advice}")
    }

    fn message_of_merge(&self) -> String {
        let (allowed, advice) = (self.addressable(), self.advice);
        format!(
            "stopped: the merged imprints need more than half of the {allowed} of memory allowed, and writing them needs \
             the other half; {advice}"
        )
    }

    fn refusal(&self, needed: MemorySize) -> String {
        let (allowed, advice) = (self.allowed, self.advice);
        format!("about {needed} of memory needed, but only {allowed} allowed; {advice}")
    }
}

/// Estimates the memory that the sweep of a grid needs, from the imprints of a small part of the grid.
fn expected(grid: &PoseGrid) -> MemorySize {
    let sample = TimingSample::of(grid);
    let found = Sweep::new(&sample.grid).run().atlas.len();
    let sensor = grid.sensor();
    let taxels = u64::from(sensor.columns()) * u64::from(sensor.rows());
    #[expect(
        clippy::cast_precision_loss,
        clippy::cast_possible_truncation,
        clippy::cast_sign_loss,
        reason = "an estimate, and it saturates"
    )]
    let bytes = (found as f64 * sample.factor * (BYTES_BESIDE + taxels / 8) as f64) as u64;
    MemorySize(bytes)
}

/// Reads a line of one of the system's tables, such as `VmRSS:      5120 kB`.
#[cfg(target_os = "linux")]
fn listed(table: &str, name: &str) -> Option<MemorySize> {
    let table = std::fs::read_to_string(table).ok()?;
    let line = table.lines().find_map(|line| line.strip_prefix(name))?;
    let kilobytes: u64 = line.split_whitespace().next()?.parse().ok()?;
    Some(MemorySize(kilobytes * 1024))
}

#[cfg(target_os = "linux")]
fn used() -> Option<MemorySize> {
    listed("/proc/self/status", "VmRSS:")
}

/// How much memory the program may use: the machine's free memory and what the program uses already, or less if its
/// control group or one around it has a limit (`memory.max`, see cgroups(7)).
#[cfg(target_os = "linux")]
fn free() -> Option<MemorySize> {
    let machine = listed("/proc/meminfo", "MemAvailable:")?.0 + used()?.0;
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

#[cfg(not(target_os = "linux"))]
fn used() -> Option<MemorySize> {
    None
}

#[cfg(not(target_os = "linux"))]
fn free() -> Option<MemorySize> {
    None
}

#[cfg(test)]
mod tests {
    use std::ops::ControlFlow;

    use taxel_core::figure::{Figure, FigureKind};
    use taxel_core::pose::{Anchor, Axis, Ranges};
    use taxel_core::progress::ToTheEnd;
    use taxel_core::sensor::Sensor;
    use taxel_core::source::Source;

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
    fn work_stops_at_half_of_the_address_space_whatever_is_allowed() {
        assert!(ADDRESSABLE >= MemorySize((1 << 31) - 1));
        let limits = |allowed| MemoryGuard::new(allowed, "").limits;
        let free = limits(None);
        assert!(free.is_none_or(|limits| limits.allowed <= ADDRESSABLE));
        let limits = limits(Some(MemorySize(u64::MAX))).expect("one is set");
        let said = format!("more memory than the {ADDRESSABLE} ");
        assert!(limits.message().contains(&said), "{}", limits.message());
        // An estimate may be far too high: what is allowed decides whether the work begins.
        assert_eq!(limits.allowed, MemorySize(u64::MAX));
    }

    #[test]
    fn a_guard_stops_what_needs_too_much() {
        let small = MemoryGuard::new(Some(MemorySize(1024)), "work in shards (--shard)");
        let large = MemoryGuard::new(Some(MemorySize(1 << 50)), "");
        let flow = |guard: &MemoryGuard| guard.limit(&ToTheEnd, |progress| progress.add(1_u64));
        assert_eq!(flow(&large), Ok(ControlFlow::Continue(())));
        let stopped = "stopped: needs more memory than the 1.0K allowed; work in shards (--shard)";
        match used() {
            Some(_) => assert_eq!(flow(&small), Err(stopped.to_owned())),
            None => assert_eq!(flow(&small), Ok(ControlFlow::Continue(()))),
        }
        let source = Source::Figure(Figure::default_of(FigureKind::Heptagon, &Sensor::default()));
        let cell = Ranges::default().with(Axis::Angle, "0:359.9:0.1".parse().expect("a range"));
        let grid =
            PoseGrid::new(source, Sensor::default(), Anchor::Corner, cell).expect("in range");
        let refused = small.check(&grid).expect_err("far too little");
        assert!(refused.contains("--shard"), "{refused}");
        assert_eq!(large.check(&grid), Ok(()));
    }

    #[test]
    fn work_that_its_own_progress_stops_is_no_matter_of_memory() {
        let guard = MemoryGuard::new(Some(MemorySize(1 << 50)), "");
        let stopped = guard.limit(&|_: u64| ControlFlow::Break(()), |progress| progress.add(1));
        assert_eq!(stopped, Ok(ControlFlow::Break(())));
    }
}
