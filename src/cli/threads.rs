//! The threads for long work.

use std::io;

use rayon::{ThreadPool, ThreadPoolBuilder};

use crate::cli::error::CliError;

/// Returns the number of threads for `--jobs`. For 0, not given, it is that of `RAYON_NUM_THREADS`, or else one per
/// core.
pub(crate) fn count(jobs: usize) -> usize {
    match jobs {
        0 => rayon::current_num_threads(),
        jobs => jobs,
    }
}

pub(crate) fn pool(jobs: usize) -> Result<ThreadPool, CliError> {
    let pool = ThreadPoolBuilder::new().num_threads(jobs).build();
    pool.map_err(|error| CliError::System(io::Error::other(error)))
}
