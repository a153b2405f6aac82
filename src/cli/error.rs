//! Everything that can go wrong on the command line.
//!
//! The message of each failure is beside it here; its exit status is in [`CliError::status`]. Text from files or
//! arguments is shortened before it is quoted, and escaped when it is printed.

use std::io;

use taxel_core::quote::shortened_message;
use taxel_core::recognition::{NoiseError, TrainingError};
use taxel_files::formats::file::{system_reason, write_reason};
use taxel_files::storage::{FileError, LibraryError};

use crate::cli::failure::Failure;

#[derive(Debug, thiserror::Error)]
pub(crate) enum CliError {
    #[error("{}", .0.text)]
    Failure(Failure),
    #[error(transparent)]
    Usage(#[from] clap::Error),
    #[error("{}{}", shortened_message(&.0.to_string()), place_advice(.0))]
    Library(#[from] LibraryError),
    #[error(transparent)]
    Training(#[from] TrainingError),
    #[error(transparent)]
    Noise(#[from] NoiseError),
    #[error("{name:?} already exists; --force replaces it")]
    Taken { name: String },
    #[error("{name}: cannot write: {}", write_reason(error))]
    File { name: String, error: io::Error },
    #[error("{name} does not exist; it is made when a shape is saved")]
    NoFolder { name: String },
    #[error("{broken} of {shapes} shapes cannot be read")]
    Shapes { broken: usize, shapes: usize },
    #[error("stopped; nothing was written")]
    Stopped { status: u8 },
    #[error("{}", system_reason(.0))]
    System(io::Error),
}

impl From<FileError> for CliError {
    fn from(error: FileError) -> Self {
        let name = error.path.to_string_lossy().into_owned();
        if error.exists() {
            Self::Taken { name }
        } else {
            let error = error.error;
            Self::File { name, error }
        }
    }
}

fn place_advice(error: &LibraryError) -> &'static str {
    match error {
        LibraryError::NoPlace => "; name a folder with --library DIR or TAXEL_LIBRARY",
        _ => "",
    }
}

impl CliError {
    pub(crate) fn status(&self) -> u8 {
        match self {
            Self::Failure(failure) => failure.status,
            Self::Usage(_) => 2,
            Self::Stopped { status } => *status,
            _ => 1,
        }
    }

    /// The same as a [`Failure`].
    pub(crate) fn failure(&self) -> Failure {
        let failure = match self {
            Self::Usage(error) => Failure::of_arguments(error),
            _ => Failure::new(self.to_string()),
        };
        failure.with_status(self.status())
    }
}

impl From<Failure> for CliError {
    fn from(failure: Failure) -> Self {
        Self::Failure(failure)
    }
}
