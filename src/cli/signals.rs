//! Signals that stop a long command: a sweep, a merge, a training.

use std::fs;
use std::io::{self, IsTerminal};
use std::sync::Arc;
use std::sync::atomic::{AtomicBool, AtomicUsize, Ordering};

use rayon::{ThreadPool, ThreadPoolBuilder};
use signal_hook::consts::{SIGHUP, SIGINT, SIGTERM, SIGXFSZ};
use signal_hook::flag;
use taxel_core::progress::{Progress, stop_if};
use taxel_files::memory::MemoryGuard;

use crate::cli::failure::Failure;
use crate::cli::output::progress::ProgressDisplay;

const STOPPING: [(i32, u8); 3] = [(SIGINT, 130), (SIGTERM, 143), (SIGHUP, 129)];

/// Lets a write beyond the limit of file sizes (`ulimit -f`) fail like a write to a full disk. Otherwise the signal
/// would end the program and leave the terminal as it is.
pub(crate) fn outlive_file_limit() {
    // If this fails, the signal only keeps its usual effect.
    let _ = flag::register(SIGXFSZ, Arc::default());
}

/// Returns true if a signal is ignored and must stay so: as `nohup` asks for SIGHUP, and a script for SIGINT in its
/// background jobs. If the system does not tell, SIGHUP counts as ignored when standard error is not a terminal.
fn is_ignored(signal: i32) -> bool {
    let ignored = || {
        let status = fs::read_to_string("/proc/self/status").ok()?;
        let mask = status
            .lines()
            .find_map(|line| line.strip_prefix("SigIgn:"))?;
        let mask = u64::from_str_radix(mask.trim(), 16).ok()?;
        Some(mask >> (signal - 1) & 1 == 1)
    };
    ignored().unwrap_or_else(|| signal == SIGHUP && !io::stderr().is_terminal())
}

/// Records whether a signal asks to stop the work. A second signal ends the program at once, as if it were not
/// caught.
pub(crate) struct Signals {
    pub(crate) stopped: Arc<AtomicBool>,
    last: Arc<AtomicUsize>,
}

impl Signals {
    pub(crate) fn catch() -> Result<Self, Failure> {
        let (stopped, last) = (Arc::default(), Arc::default());
        for (index, &(signal, status)) in STOPPING.iter().enumerate() {
            if is_ignored(signal) {
                continue;
            }
            flag::register_conditional_shutdown(signal, status.into(), Arc::clone(&stopped))?;
            flag::register_usize(signal, Arc::clone(&last), index)?;
            flag::register(signal, Arc::clone(&stopped))?;
        }
        Ok(Self { stopped, last })
    }

    pub(crate) fn progress<'a, Done: 'a>(
        &'a self,
        display: &'a dyn Progress<Done>,
    ) -> impl Progress<Done> + 'a {
        move |done| {
            display.add(done)?;
            stop_if(!self.goes_on())
        }
    }

    pub(crate) fn goes_on(&self) -> bool {
        !self.stopped.load(Ordering::Relaxed)
    }

    pub(crate) fn failure(&self) -> Failure {
        Failure::new("stopped; nothing was written").with_status(self.status())
    }

    pub(crate) fn status(&self) -> u8 {
        STOPPING[self.last.load(Ordering::Relaxed)].1
    }
}

/// Counts poses on several threads, until it is done, a signal comes or the memory is used up.
pub(crate) fn on_threads<T: Send>(
    signals: &Signals,
    poses: u64,
    (jobs, memory, quiet): (Option<u16>, MemoryGuard, bool),
    work: impl FnOnce(&dyn Progress) -> T + Send,
) -> Result<T, Failure> {
    let pool = pool(jobs.map_or(0, usize::from))?;
    let display = ProgressDisplay::new("poses", poses, quiet);
    let done = memory.limit(&signals.progress(&display), |progress| {
        pool.install(|| work(progress))
    });
    done.map_err(Failure::new)
}

pub(crate) fn pool(jobs: usize) -> Result<ThreadPool, Failure> {
    Ok(ThreadPoolBuilder::new().num_threads(jobs).build()?)
}
