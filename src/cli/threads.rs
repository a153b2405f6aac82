//! The threads for long work. If the system provides none, the calling thread does the work.

use std::io;

use rayon::{ThreadPool, ThreadPoolBuilder};

use crate::cli::error::CliError;

/// Creates a pool of `jobs` threads, or if 0, one per core. If the system provides none, the pool is this thread
/// alone.
///
/// # Errors
/// Returns an error if this thread is in such a pool already.
pub(crate) fn pool(jobs: usize) -> Result<ThreadPool, CliError> {
    let pool = ThreadPoolBuilder::new().num_threads(jobs).build();
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
