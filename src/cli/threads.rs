//! The threads for long work. If the system provides none, the calling thread does the work.

use std::env;
use std::io;
use std::num::NonZero;
use std::thread::available_parallelism;

use rayon::{ThreadPool, ThreadPoolBuilder};

use crate::cli::error::CliError;

/// The most threads per core. More do not make anything faster, and a million take minutes to start.
const MOST_PER_CORE: usize = 8;

/// Returns the number of cores that the program may use.
fn cores() -> usize {
    available_parallelism().map_or(1, NonZero::get)
}

/// Returns the value of `RAYON_NUM_THREADS`, which rayon reads too; None if it is not a number above 0.
fn variable() -> Option<usize> {
    let threads = env::var("RAYON_NUM_THREADS").ok()?.parse().ok()?;
    (threads > 0).then_some(threads)
}

/// Returns the number of threads for `--jobs`. For 0, not given, it is that of `RAYON_NUM_THREADS`, or else one per
/// core. It is at most [`MOST_PER_CORE`] for each core.
pub(crate) fn count(jobs: usize) -> usize {
    let cores = cores();
    let asked = match jobs {
        0 => variable().unwrap_or(cores),
        jobs => jobs,
    };
    asked.min(MOST_PER_CORE * cores)
}

/// Bounds the threads of work outside of a [`pool`], if `RAYON_NUM_THREADS` asks for too many. Otherwise rayon starts
/// them when they are first needed.
pub(crate) fn bound() {
    let most = count(usize::MAX);
    if variable().is_some_and(|asked| asked > most) {
        // If the system provides fewer, rayon tries again when they are needed.
        let _ = ThreadPoolBuilder::new().num_threads(most).build_global();
    }
}

/// Creates a pool of that [`count`] of threads. If the system provides none, the pool is this thread alone.
///
/// # Errors
/// Returns an error if this thread is in such a pool already.
pub(crate) fn pool(jobs: usize) -> Result<ThreadPool, CliError> {
    let pool = ThreadPoolBuilder::new().num_threads(count(jobs)).build();
    let pool = pool.or_else(|_| {
        let alone = ThreadPoolBuilder::new().num_threads(1);
        alone.use_current_thread().build()
    });
    pool.map_err(|error| CliError::System(io::Error::other(error)))
}

/// Runs work that uses all cores in a thread pool of its own: the global pool fails for good if it gets no threads.
///
/// # Errors
/// Returns the errors of the work.
pub(crate) fn on_all_cores<R: Send>(
    work: impl FnOnce() -> Result<R, CliError> + Send,
) -> Result<R, CliError> {
    pool(0)?.install(work)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn there_are_at_most_eight_threads_per_core() {
        assert_eq!([1, 3, 8].map(count), [1, 3, 8]);
        assert_eq!(count(999_999), 8 * cores());
        assert!((1..=8 * cores()).contains(&count(0)));
    }
}
