//! Everything that can go wrong on the command line, and the exit status and message of each: the one place for these.

use std::io;

use crate::cli::input::content::InputError;
use crate::cli::output::charset::Charset;
use crate::formats::ArchiveError;
use crate::pose::GridError;
use crate::quote::legible;
use crate::storage::{FileError, LibraryError, SweepFileError};
use crate::sweep::MergeError;
use crate::tui::script::runner;

/// Why a command was not done, or not wholly.
#[derive(Debug, thiserror::Error)]
pub(crate) enum CliError {
    /// The command itself is wrong.
    #[error(transparent)]
    Usage(#[from] clap::Error),
    /// A number is, though it is one.
    #[error("--{flag} {text}: out of range, {expected}")]
    Range {
        /// The flag without its dashes.
        flag: String,
        /// What was given.
        text: String,
        /// What is allowed.
        expected: String,
    },
    /// A file is.
    #[error("{name}: {error}")]
    Input {
        /// Its name.
        name: String,
        /// What is wrong with it.
        error: InputError,
    },
    /// Some of the lines of a batch are; each has said so in its place.
    #[error("{bad} of {lines} lines could not be answered")]
    Lines {
        /// How many.
        bad: u64,
        /// Of how many that were not blank.
        lines: u64,
    },
    /// The poses of a batch cannot be read on.
    #[error("standard input: cannot read: {0}")]
    Read(io::Error),
    /// The answer cannot be written.
    #[error("cannot write: {0}")]
    Write(io::Error),
    /// The library refuses.
    #[error("{}", legible(&.0.to_string()))]
    Library(#[from] LibraryError),
    /// Neither a name nor a file.
    #[error("no shape is called {name:?}, and no file either")]
    Nowhere {
        /// What was asked for.
        name: String,
    },
    /// The name is that of another shape.
    #[error("{name:?} is there already; --force replaces it")]
    Taken {
        /// The name.
        name: String,
    },
    /// A file cannot be written.
    #[error("{name}: cannot write: {error}")]
    File {
        /// Its name, or that of its folder.
        name: String,
        /// Why not.
        error: io::Error,
    },
    /// Some shapes of the library are; each has been told.
    #[error("{broken} of {shapes} shapes cannot be read")]
    Shapes {
        /// How many.
        broken: usize,
        /// Of how many.
        shapes: usize,
    },
    /// The file of settings cannot be read, or says something wrong.
    #[error("{place}: {message}")]
    Settings {
        /// Its name, with line and column where these are known.
        place: String,
        /// What is wrong.
        message: String,
    },
    /// A script cannot be read.
    #[error("{name}: {error}")]
    NoScript {
        /// Its name.
        name: String,
        /// Why not.
        error: InputError,
    },
    /// A script did not hold.
    #[error("{}{failure}", name.as_ref().map_or_else(String::new, |name| format!("{name}: ")))]
    Script {
        /// Its name; none of keys that are no script.
        name: Option<String>,
        /// What did not.
        failure: runner::ScriptFailure,
    },
    /// There is a file already where a record was to be.
    #[error("{name} is there already, and a record does not replace it; {free} would be a new one")]
    Recorded {
        /// Its name.
        name: String,
        /// A name that is free.
        free: String,
    },
    /// A record cannot be begun.
    #[error("{name}: cannot record: {error}")]
    Record {
        /// Its file's name.
        name: String,
        /// Why not.
        error: io::Error,
    },
    /// There is no such grid.
    #[error(transparent)]
    Grid(#[from] GridError),
    /// An atlas that cannot be read.
    #[error("{name}: {error}")]
    Atlas {
        /// The file's name.
        name: String,
        /// What is wrong with it.
        error: ArchiveError,
    },
    /// An atlas or the numbers of all poses that cannot be written.
    #[error(transparent)]
    SweepFile(SweepFileError),
    /// Shards that do not make a whole.
    #[error(transparent)]
    Merge(#[from] MergeError),
    /// A signal stopped the command.
    #[error("stopped; nothing was written")]
    Stopped {
        /// The exit status, as a shell reports it for a program that the signal ended.
        status: u8,
    },
    /// The system refuses threads or signals.
    #[error("{0}")]
    System(io::Error),
    /// There is no screen.
    #[error("{0}")]
    Screen(io::Error),
}

impl From<FileError> for CliError {
    fn from(error: FileError) -> Self {
        let name = error.path.to_string_lossy().into_owned();
        if error.exists() {
            Self::Taken { name }
        } else {
            let error = error.into_io();
            Self::File { name, error }
        }
    }
}

impl From<SweepFileError> for CliError {
    fn from(error: SweepFileError) -> Self {
        if error.exists() {
            Self::Taken { name: error.name }
        } else {
            Self::SweepFile(error)
        }
    }
}

impl CliError {
    /// Nobody reads on: `taxel batch | head -1`. No failure of ours.
    fn is_closed_pipe(&self) -> bool {
        matches!(self, Self::Write(error) | Self::Screen(error) if error.kind() == io::ErrorKind::BrokenPipe)
    }

    /// The exit status.
    pub(crate) fn status(&self) -> u8 {
        match self {
            _ if self.is_closed_pipe() => 0,
            Self::Usage(_)
            | Self::Settings { .. }
            | Self::NoScript { .. }
            | Self::Script {
                failure: runner::ScriptFailure::Script(_),
                ..
            } => 2,
            Self::Script {
                failure: runner::ScriptFailure::Ended { .. },
                ..
            } => 3,
            Self::Stopped { status } => *status,
            _ => 1,
        }
    }

    /// What standard error shows, with its line end; nothing for a closed pipe.
    pub(crate) fn message(&self, charset: Charset) -> Option<String> {
        match self {
            _ if self.is_closed_pipe() => None,
            Self::Script { .. } => Some(charset.lines(&format!("error: {self}\n"))),
            Self::Usage(error) => Some(charset.lines(&error.render().to_string())),
            _ => Some(format!("error: {}\n", charset.line(&self.to_string()))),
        }
    }
}
