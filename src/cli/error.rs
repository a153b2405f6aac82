//! Everything that can go wrong on the command line.
//!
//! The message of each failure is beside it here; its exit status is in [`CliError::status`]. Text from files or
//! arguments is shortened before it is quoted, and escaped when it is printed.

use std::io;

use taxel_core::frame::FrameError;
use taxel_core::quote::shortened_message;
use taxel_core::recognition::{NoiseError, TrainingError};
use taxel_files::acquire::RecorderError;
use taxel_files::formats::file::{system_reason, write_reason};
use taxel_files::formats::recording::RecordingNote;
use taxel_files::storage::{FileError, LibraryError};
use taxel_files::{ReadError, ReadErrorKind};

use crate::cli::failure::Failure;

#[derive(Debug, thiserror::Error)]
pub(crate) enum CliError {
    #[error("{}", .0.text)]
    Failure(Failure),
    #[error(transparent)]
    Usage(#[from] clap::Error),
    #[error("--{flag} has no effect {reason}")]
    Unused { flag: &'static str, reason: String },
    #[error("--{flag} {text} {complaint}")]
    Range {
        flag: String,
        text: String,
        complaint: String,
    },
    #[error("{name}: {error}")]
    Input { name: String, error: ReadError },
    #[error("{name}: empty, expected frames of a sensor")]
    Empty { name: String },
    #[error("cannot write to standard output: {}", system_reason(.0))]
    Write(io::Error),
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
    #[error("{name}: {}{}", shortened_message(&.error.to_string()), size_advice(.error))]
    Recording { name: String, error: ReadError },
    #[error("{error}{help}", error = .0, help = advice(.0))]
    Recorder(RecorderError),
    #[error("{name}: {}", shortened_message(.message))]
    Frames { name: String, message: String },
    #[error(transparent)]
    Archive(ReadError),
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

fn advice(error: &RecorderError) -> &'static str {
    match error {
        RecorderError::Exists { .. } => "; --force replaces it",
        _ => "",
    }
}

fn place_advice(error: &LibraryError) -> &'static str {
    match error {
        LibraryError::NoPlace => "; name a folder with --library DIR or TAXEL_LIBRARY",
        _ => "",
    }
}

/// Returns the end of a message that says what to do if a recording does not state the size of its frames; empty for
/// other errors.
fn size_advice(error: &ReadError) -> &'static str {
    if error.kind == ReadErrorKind::Unsized {
        "; give --rows and --columns"
    } else {
        ""
    }
}

pub(crate) fn note_advice(note: &RecordingNote) -> &'static str {
    match note {
        RecordingNote::Flat(_) => "; if so, give --rows and --columns",
        _ => "",
    }
}

pub(crate) fn frame_advice(error: &FrameError) -> &'static str {
    match error {
        FrameError::NoTare => ", such as --tare 30",
        _ => "",
    }
}

impl CliError {
    /// Puts the flag that gave a file before the file's name, if the error is in the file.
    pub(crate) fn of_flag(self, flag: &str) -> Self {
        match self {
            Self::Input { name, error } => {
                let name = format!("{flag} {name}");
                Self::Input { name, error }
            }
            error => error,
        }
    }

    /// Returns true if the reader of our output has closed it, as in `taxel batch | head -1`. This is not an error.
    pub(crate) fn is_closed_pipe(&self) -> bool {
        matches!(self, Self::Write(error) if error.kind() == io::ErrorKind::BrokenPipe)
    }

    pub(crate) fn status(&self) -> u8 {
        match self {
            _ if self.is_closed_pipe() => 0,
            Self::Failure(failure) => failure.status,
            Self::Usage(_) | Self::Unused { .. } => 2,
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
