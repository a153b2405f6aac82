//! Everything that can go wrong on the command line.
//!
//! Each failure has its message beside it here, and its exit status in [`CliError::status`]. Text that comes from
//! files or arguments is shortened before it is quoted, and escaped when it is printed.

use std::io;
use std::path::PathBuf;

use crate::acquire::RecorderError;
use crate::cli::input::content::InputError;
use crate::cli::output::charset::Charset;
use crate::formats::Name;
use crate::formats::recording::RecordingError;
use crate::parameter::ParameterError;
use crate::parameter::number::short;
use crate::pose::GridError;
use crate::quote::shortened_message;
use crate::recognition::{NoiseError, TrainingError};
use crate::storage::{ArchiveFileError, FileError, LibraryError};
use crate::sweep::MergeError;
use crate::tui::script::runner;

/// The most shapes of a table of pairs; as JSON it takes a gigabyte of memory for this many.
pub(crate) const MOST_PAIRED: usize = 4096;

/// Why a command failed, or was not done completely.
#[derive(Debug, thiserror::Error)]
pub(crate) enum CliError {
    /// The arguments are wrong: clap's own message, with the usage of the command.
    #[error(transparent)]
    Usage(#[from] clap::Error),
    /// A flag that the others leave nothing to do.
    #[error("--{flag} has no effect {reason}")]
    Unused {
        /// The flag without its dashes.
        flag: &'static str,
        /// With or without what.
        reason: String,
    },
    /// A number out of range.
    #[error("--{flag} {text} {complaint}")]
    Range {
        /// The flag without its dashes.
        flag: String,
        /// What was given.
        text: String,
        /// Which bound it misses, and what is allowed: "is above 16 (allowed: above 0, up to 16)".
        complaint: String,
    },
    /// An invalid input file.
    #[error("{name}: {error}")]
    Input {
        /// Its name.
        name: String,
        /// What is wrong with it.
        error: InputError,
    },
    /// A source of frames without a byte.
    #[error("{name} is empty")]
    Empty {
        /// Its name.
        name: String,
    },
    /// Some lines of a batch were wrong. The answer to each contains its own message.
    #[error("{bad} of {lines} lines could not be answered")]
    Lines {
        /// How many were wrong.
        bad: u64,
        /// How many there were, not counting blank ones.
        lines: u64,
    },
    /// Lines cannot be read, or not to their end.
    #[error("{name}: cannot read: {error}")]
    Read {
        /// The file, or standard input.
        name: String,
        /// The system's reason.
        error: io::Error,
    },
    /// Standard output failed.
    #[error("cannot write to standard output: {0}")]
    Write(io::Error),
    /// The library cannot do it: no such shape, no folder, a damaged file.
    #[error("{}", shortened_message(&.0.to_string()))]
    Library(#[from] LibraryError),
    /// The argument is neither the name of a shape nor a file.
    #[error("no stored shape and no file is called {name:?}{near}")]
    Nowhere {
        /// The argument.
        name: String,
        /// The name of a stored shape that is nearly the same, as the end of the message.
        near: String,
    },
    /// No shape has that name, in the library or in its trash.
    #[error("{}{near}", shortened_message(&error.to_string()))]
    NoShape {
        /// Which name it is, and where it is not.
        error: LibraryError,
        /// A name that is nearly the same, as the end of the message.
        near: String,
    },
    /// A shape of a set that cannot be read.
    #[error("{place}: {error}")]
    Set {
        /// The file and the line, or the flag.
        place: String,
        /// What is wrong.
        error: String,
    },
    /// A training that is refused.
    #[error(transparent)]
    Training(#[from] TrainingError),
    /// A training of poses that the sensor cuts off.
    #[error("{error}; {remedy}, or allow it with --allow-cut")]
    Cut {
        /// How many poses of which shape.
        error: TrainingError,
        /// What helps.
        remedy: &'static str,
    },
    /// A file that cannot be of that form.
    #[error("{name}: {what} is written as {expected}")]
    Ending {
        /// Its name.
        name: String,
        /// What was to be written.
        what: &'static str,
        /// The ending that is right.
        expected: &'static str,
    },
    /// A model under the name of a built-in one would never be used.
    #[error("{name} is the name of a built-in model; choose another")]
    BuiltInSet {
        /// The name.
        name: Name,
    },
    /// A built-in model has no file to delete.
    #[error("{name} is built in and cannot be deleted")]
    BuiltInModel {
        /// The name.
        name: Name,
    },
    /// The argument is neither the name of a set of shapes nor a file.
    #[error("{0}")]
    NoSet(String),
    /// A matrix on which none of a shape's imprints fits.
    #[error("{name}: none of its imprints fits on {columns} × {rows} taxels")]
    NoTouch {
        /// The first such shape.
        name: String,
        /// Columns of the matrix.
        columns: u8,
        /// Its rows.
        rows: u8,
    },
    /// There is no model of that name beside the library.
    #[error("no model is called {name:?}; 'taxel model list' shows all{near}")]
    NoModel {
        /// The argument.
        name: String,
        /// The name of a model that is nearly the same, as the end of the message.
        near: String,
    },
    /// An invalid noise.
    #[error(transparent)]
    Noise(#[from] NoiseError),
    /// A mask of another size than the imprint.
    #[error("--mask has {} × {} taxels, the imprint {} × {}", mask.0, mask.1, imprint.0, imprint.1)]
    Mask {
        /// Columns and rows of the mask.
        mask: (u8, u8),
        /// Columns and rows of the imprint.
        imprint: (u8, u8),
    },
    /// A name that no shape of the model has.
    #[error("--expect: no shape of the model is called {name:?}{near}")]
    NotInModel {
        /// The name.
        name: String,
        /// The name of a shape that is nearly the same, as the end of the message.
        near: String,
    },
    /// `--expect` names another shape than the answer, or than some of the answers.
    #[error("--expect: expected {expected:?}, found {found}")]
    Unexpected {
        /// The name.
        expected: String,
        /// What was answered, in words.
        found: String,
    },
    /// A set that is too large to be drawn.
    #[error("{name}: {shapes} shapes, and a drawing shows at most 64; .csv takes all")]
    TooManyShapes {
        /// The file.
        name: String,
        /// How many.
        shapes: usize,
    },
    /// A set that is too large for a table of all pairs.
    #[error("--pairs: the model has {shapes} shapes (allowed: up to {MOST_PAIRED})")]
    TooManyPairs {
        /// How many.
        shapes: usize,
    },
    /// A size or a threshold at which a set cannot be evaluated.
    #[error("{place}: {error}")]
    Separation {
        /// The size and the threshold.
        place: String,
        /// Why not.
        error: TrainingError,
    },
    /// There is a shape or a file of that name already.
    #[error("{name:?} already exists; --force replaces it")]
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
    /// Some shapes of the library are damaged. Each has been listed.
    #[error("{broken} of {shapes} shapes cannot be read")]
    Shapes {
        /// How many are damaged.
        broken: usize,
        /// How many there are.
        shapes: usize,
    },
    /// The settings file cannot be read, or has an error in it.
    #[error("{place}: {message}")]
    Settings {
        /// Its name, with line and column if they are known.
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
    /// A script failed: an expectation, a command, or the program ended too early.
    #[error("{}{failure}", name.as_ref().map_or_else(String::new, |name| format!("{name}: ")))]
    Script {
        /// Its name; None for the keys of `--keys`.
        name: Option<String>,
        /// What failed.
        failure: runner::ScriptFailure,
    },
    /// `--record` names a file that exists.
    #[error("{name} already exists and is not replaced; {free} is free")]
    Recorded {
        /// Its name.
        name: String,
        /// A similar name that is free.
        free: String,
    },
    /// The file of `--record` cannot be created.
    #[error("{name}: cannot record: {error}")]
    Record {
        /// Its file's name.
        name: String,
        /// Why not.
        error: io::Error,
    },
    /// A sweep or a training needs more memory than it may use.
    #[error("{0}")]
    Memory(String),
    /// The ranges do not make a grid for the shape.
    #[error("{}", with_flag(.0))]
    Grid(#[from] GridError),
    /// A recording is damaged, or no recording.
    #[error("{name}: {}", shortened_message(&.error.to_string()))]
    Recording {
        /// Its name.
        name: String,
        /// What is wrong with it, and where.
        error: RecordingError,
    },
    /// Frames cannot be recorded.
    #[error("{error}{help}", error = .0, help = advice(.0))]
    Recorder(RecorderError),
    /// A recording does not have what is asked for.
    #[error("{name}: {}", shortened_message(.message))]
    Frames {
        /// Its name.
        name: String,
        /// What is wrong, and what would be right.
        message: String,
    },
    /// `--resume` finds a file that is not this shard.
    #[error(
        "{name} is {what} ({reason}); remove it, or use --force instead of --resume to replace it"
    )]
    NotResumed {
        /// Its name.
        name: String,
        /// What it is: damaged, or of another study.
        what: &'static str,
        /// Why.
        reason: String,
    },
    /// An atlas cannot be read; or it cannot be written, or the file of all poses.
    #[error(transparent)]
    SweepFile(ArchiveFileError),
    /// A shard that does not fit the others, or that would be replaced.
    #[error("{}: {reason}", shortened_message(&path.to_string_lossy()))]
    Shard {
        /// Its file.
        path: PathBuf,
        /// Why it is refused.
        reason: String,
    },
    /// The shards are not those of one grid, or some are missing or given twice.
    #[error(transparent)]
    Merge(#[from] MergeError),
    /// A signal stopped the command.
    #[error("stopped; nothing was written")]
    Stopped {
        /// The exit status, as a shell reports it for a program that the signal ended.
        status: u8,
    },
    /// The system does not allow more threads or signal handlers.
    #[error("{0}")]
    System(io::Error),
    /// The screen cannot be opened: no terminal, or it failed.
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

impl From<ArchiveFileError> for CliError {
    fn from(error: ArchiveFileError) -> Self {
        if error.exists() {
            Self::Taken { name: error.name }
        } else {
            Self::SweepFile(error)
        }
    }
}

/// What helps where frames cannot be recorded, as the end of a message.
fn advice(error: &RecorderError) -> &'static str {
    match error {
        RecorderError::Exists { .. } => "; --force replaces it",
        _ => "",
    }
}

/// The message about ranges; a number out of range is named by its flag, as in [`CliError::Range`].
fn with_flag(error: &GridError) -> String {
    match error {
        GridError::Parameter(error @ ParameterError::Range { value, .. }) => {
            let flag = error.parameter().flag();
            format!("--{flag} {} {}", short(*value), error.complaint())
        }
        error => error.to_string(),
    }
}

impl CliError {
    /// Whether the reader of our output has closed it, as in `taxel batch | head -1`. That is not an error.
    fn is_closed_pipe(&self) -> bool {
        matches!(self, Self::Write(error) | Self::Screen(error) if error.kind() == io::ErrorKind::BrokenPipe)
    }

    /// The exit status; see the table in [`crate::cli`].
    pub(crate) fn status(&self) -> u8 {
        match self {
            _ if self.is_closed_pipe() => 0,
            Self::Usage(_)
            | Self::Unused { .. }
            | Self::Settings { .. }
            | Self::NoScript { .. }
            | Self::Script {
                failure: runner::ScriptFailure::Script(_),
                ..
            } => 2,
            Self::Script {
                failure: runner::ScriptFailure::Ended { .. },
                ..
            }
            | Self::Unexpected { .. } => 3,
            Self::Stopped { status } => *status,
            _ => 1,
        }
    }

    /// The message for standard error, with its line end; None for a closed pipe.
    pub(crate) fn message(&self, charset: Charset) -> Option<String> {
        match self {
            _ if self.is_closed_pipe() => None,
            Self::Script { .. } => Some(charset.lines(&format!("error: {self}\n"))),
            Self::Usage(error) => Some(charset.lines(&error.render().to_string())),
            _ => Some(format!("error: {}\n", charset.line(&self.to_string()))),
        }
    }
}
