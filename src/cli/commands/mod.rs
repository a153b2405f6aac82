//! The commands. Each takes its checked arguments and returns its answer as text or bytes, which [`crate::cli::run`]
//! prints; answers that come one by one are written at once. Files that a command writes are complete or do not exist:
//! they get their names last.

pub(super) mod export;

pub(super) mod touch;

pub(super) mod library;

pub(super) mod sweep;

pub(super) mod model;

pub(super) mod recognise;

pub(super) mod frames;

pub(super) mod recording_scan;

pub(super) mod watch;

pub(super) mod screen;

pub(super) mod script;

pub(super) mod man;

pub(super) mod config;

pub(super) mod completions;

use crate::cli::error::CliError;

#[derive(Debug)]
pub(super) struct Summary {
    pub(super) text: String,
    /// Whether the files were written. An error is reported after the text is printed, so that the work is not lost.
    pub(super) written: Result<(), CliError>,
}

/// Returns the outcome of writing files unless a signal stopped it: then there is no summary.
fn unless_stopped(written: Result<(), CliError>) -> Result<Result<(), CliError>, CliError> {
    match written {
        Err(stopped @ CliError::Stopped { .. }) => Err(stopped),
        written => Ok(written),
    }
}
