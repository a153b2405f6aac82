//! Everything that can go wrong on the command line.
//!
//! The message of each failure is beside it here; its exit status is in [`CliError::status`]. Text from files or
//! arguments is shortened before it is quoted, and escaped when it is printed.

use std::io;
use std::path::{Path, PathBuf};

use crate::acquire::RecorderError;
use crate::cli::input::content::InputError;
use crate::cli::output::charset::Charset;
use crate::formats::Name;
use crate::formats::recording::{RecordingError, RecordingNote};
use crate::formats::stream::StreamRefusal;
use crate::formats::system_error::{system_reason, write_reason};
use crate::formats::value::counted;
use crate::frame::FrameError;
use crate::parameter::ParameterError;
use crate::parameter::number::short;
use crate::pose::GridError;
use crate::quote::shortened_message;
use crate::recognition::{NoiseError, TrainingError};
use crate::sensor::MatrixSize;
use crate::storage::{ArchiveFileError, FileError, LibraryError};
use crate::sweep::MergeError;
use crate::tui::script::runner;

/// The most shapes for a table of all pairs of shapes; as JSON, this many take a gigabyte of memory.
pub(crate) const MOST_PAIRED: usize = 4096;

/// The reason why a command failed, or was not done completely.
#[derive(Debug, thiserror::Error)]
pub(crate) enum CliError {
    /// The arguments are wrong: clap's own message, with the usage of the command.
    #[error(transparent)]
    Usage(#[from] clap::Error),
    /// A flag without effect, given the other arguments.
    #[error("--{flag} has no effect {reason}")]
    Unused {
        /// The flag without its dashes.
        flag: &'static str,
        /// The reason: "with …" or "without …" other arguments.
        reason: String,
    },
    /// A number that is out of range.
    #[error("--{flag} {text} {complaint}")]
    Range {
        /// The flag without its dashes.
        flag: String,
        /// The number as it was typed.
        text: String,
        /// The bound that it misses and the allowed range: "is above 16 (allowed: above 0, up to 16)".
        complaint: String,
    },
    /// An invalid input file.
    #[error("{name}: {error}")]
    Input {
        /// The name of the file.
        name: String,
        /// The error in the file.
        error: InputError,
    },
    /// A source of frames without a byte.
    #[error("{name}: empty, expected frames of a sensor")]
    Empty {
        /// The name of the source.
        name: String,
    },
    /// Some lines of a batch were wrong. The answer to each of them contains its own message.
    #[error("{bad} of {} could not be answered", counted(*lines, "line"))]
    Lines {
        /// The number of wrong lines.
        bad: u64,
        /// The number of all lines except blank ones.
        lines: u64,
    },
    /// Lines cannot be read, or not to the end.
    #[error("{name}: cannot read: {}", system_reason(error))]
    Read {
        /// The file, or standard input.
        name: String,
        /// The system's reason.
        error: io::Error,
    },
    /// Standard output cannot be written to.
    #[error("cannot write to standard output: {}", system_reason(.0))]
    Write(io::Error),
    /// An operation of the library failed: no such shape, no folder, a damaged file.
    #[error("{}{}", shortened_message(&.0.to_string()), place_advice(.0))]
    Library(#[from] LibraryError),
    /// An argument is neither the name of a shape nor a file.
    #[error("no stored shape or file named {name:?}{near}")]
    Nowhere {
        /// The argument.
        name: String,
        /// The end of the message: a stored shape with a similar name, or the command that lists them.
        near: String,
    },
    /// No shape has this name in the library or in its trash.
    #[error("{}{near}", shortened_message(&error.to_string()))]
    NoShape {
        /// The name, and where it was not found.
        error: LibraryError,
        /// The end of the message: a similar name, or the command that lists the names.
        near: String,
    },
    /// A shape of a set cannot be read.
    #[error("{place}: {error}")]
    Set {
        /// The file and the line, or the flag.
        place: String,
        /// The reason.
        error: String,
    },
    /// A training is refused.
    #[error(transparent)]
    Training(#[from] TrainingError),
    /// A training is refused because the sensor cuts off some poses.
    #[error("{error}; {remedy}, or allow it with --allow-cut")]
    Cut {
        /// The shape, and the number of its poses that are cut off.
        error: TrainingError,
        /// The advice to the user.
        remedy: &'static str,
    },
    /// A file name with the wrong extension for its content.
    #[error("{name}: expected a name that ends in {expected}, for {what}")]
    Ending {
        /// The file name.
        name: String,
        /// The content to be written.
        what: &'static str,
        /// The right extension.
        expected: &'static str,
    },
    /// A model would get the name of a built-in one, and never be used.
    #[error("{name} is the name of a built-in model; choose another name")]
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
    /// An argument is neither the name of a set of shapes nor a file.
    #[error("{0}")]
    NoSet(String),
    /// None of a shape's imprints fits on the matrix.
    #[error("{name}: none of its imprints fits on {size} taxels")]
    NoTouch {
        /// The first such shape.
        name: String,
        /// The size of the matrix.
        size: MatrixSize,
    },
    /// No model beside the library has this name.
    #[error("no model named {name:?}; 'taxel model list' shows all{near}")]
    NoModel {
        /// The argument.
        name: String,
        /// The end of the message: a model with a similar name.
        near: String,
    },
    /// An invalid noise.
    #[error(transparent)]
    Noise(#[from] NoiseError),
    /// A mask of another size than the imprint.
    #[error("--mask has {mask} taxels, the imprint {imprint}")]
    Mask {
        /// The size of the mask.
        mask: MatrixSize,
        /// The size of the imprint.
        imprint: MatrixSize,
    },
    /// A name that no shape of the model has.
    #[error("--expect: the model has no shape named {name:?}; its shapes are {shapes}{near}")]
    NotInModel {
        /// The name.
        name: String,
        /// The names of the model's shapes, or the first of them.
        shapes: String,
        /// The end of the message: a shape with a similar name.
        near: String,
    },
    /// The answer, or one of several, differs from the shape that `--expect` names.
    #[error("--expect: expected {expected:?}, found {found}")]
    Unexpected {
        /// The expected name.
        expected: String,
        /// The answer, in words.
        found: String,
    },
    /// A set with too many shapes for a drawing.
    #[error("{name}: {shapes} shapes, and a drawing shows at most 64; .csv takes all")]
    TooManyShapes {
        /// The file.
        name: String,
        /// The number of shapes.
        shapes: usize,
    },
    /// A set with too many shapes for a table of all pairs.
    #[error("{table}: the model has {shapes} shapes (allowed: up to {MOST_PAIRED})")]
    TooManyPairs {
        /// The flag of the table, or its name.
        table: &'static str,
        /// The number of shapes.
        shapes: usize,
    },
    /// A set cannot be evaluated at one of the sizes and thresholds.
    #[error("{place}: {error}")]
    Separation {
        /// The size and the threshold.
        place: String,
        /// The reason.
        error: TrainingError,
    },
    /// A shape or a file of this name exists already.
    #[error("{name:?} already exists; --force replaces it")]
    Taken {
        /// The name.
        name: String,
    },
    /// A file cannot be written.
    #[error("{name}: cannot write: {}", write_reason(error))]
    File {
        /// The name of the file or of its folder.
        name: String,
        /// The system's reason.
        error: io::Error,
    },
    /// There is no folder to check.
    #[error("{name} does not exist; it is made when a shape is saved")]
    NoFolder {
        /// The folder that `--library` names.
        name: String,
    },
    /// Nothing in the library can be changed.
    #[error("{name}: the library is read-only")]
    ReadOnlyLibrary {
        /// The folder of the library.
        name: String,
    },
    /// Some shapes of the library are damaged. Each has been listed.
    #[error("{broken} of {shapes} shapes cannot be read")]
    Shapes {
        /// The number of damaged shapes.
        broken: usize,
        /// The number of all shapes.
        shapes: usize,
    },
    /// Unsaved work in the library is damaged. Each file has been listed.
    #[error("{} of unsaved work cannot be read", counted(*files as u64, "file"))]
    UnsavedWork {
        /// The number of damaged files.
        files: usize,
    },
    /// The settings file cannot be read, or has an error.
    #[error("{place}: {message}")]
    Settings {
        /// The file's name.
        place: String,
        /// The reason, with line and column if they are known.
        message: String,
    },
    /// A script cannot be read.
    #[error("{name}: {error}")]
    NoScript {
        /// The script's name.
        name: String,
        /// The reason.
        error: InputError,
    },
    /// A script failed: an expectation or a command failed, or the program ended too early.
    #[error("{}{failure}", name.as_ref().map_or_else(String::new, |name| format!("{name}: ")))]
    Script {
        /// The script's name; None for the keys of `--keys`.
        name: Option<String>,
        /// The failure.
        failure: runner::ScriptFailure,
    },
    /// `--record` names a file that exists already.
    #[error("{name:?} already exists and is not replaced; {free} is free")]
    Recorded {
        /// Its name.
        name: String,
        /// A similar name that is free.
        free: String,
    },
    /// The file of `--record` cannot be created.
    #[error("{name}: cannot record: {}", write_reason(error))]
    Record {
        /// The file's name.
        name: String,
        /// The system's reason.
        error: io::Error,
    },
    /// A sweep or a training needs more memory than it may use.
    #[error("{0}")]
    Memory(String),
    /// The ranges do not make a grid for the shape.
    #[error("{}", with_flag(.0))]
    Grid(#[from] GridError),
    /// A recording is damaged, or the file is not a recording.
    #[error("{name}: {}{}", shortened_message(&.error.to_string()), size_advice(.error))]
    Recording {
        /// The recording's name.
        name: String,
        /// The reason, and where it is in the recording.
        error: RecordingError,
    },
    /// Recording frames failed.
    #[error("{error}{help}", error = .0, help = advice(.0))]
    Recorder(RecorderError),
    /// A recording does not have what was asked for.
    #[error("{name}: {}", shortened_message(.message))]
    Frames {
        /// The recording's name.
        name: String,
        /// A description of the error, and how to correct it.
        message: String,
    },
    /// An atlas cannot be read or written, or the file of all poses cannot be written.
    #[error(transparent)]
    SweepFile(ArchiveFileError),
    /// A shard does not fit the others, or it would be replaced.
    #[error("{}: {reason}", shortened_message(&path.to_string_lossy()))]
    Shard {
        /// The shard's file.
        path: PathBuf,
        /// The reason why it is refused.
        reason: String,
    },
    /// Several shards are missing.
    #[error("{count} of {of} shards are missing: {numbers}")]
    MissingShards {
        /// The number of missing shards.
        count: u64,
        /// The number of all shards.
        of: u32,
        /// The numbers of the first of them.
        numbers: String,
    },
    /// The shards are not from one grid, or some are missing or given twice.
    #[error(transparent)]
    Merge(#[from] MergeError),
    /// A signal stopped the command.
    #[error("stopped; nothing was written")]
    Stopped {
        /// The exit status that a shell reports for a program ended by this signal.
        status: u8,
    },
    /// The system does not provide threads or signal handlers.
    #[error("{}", system_reason(.0))]
    System(io::Error),
    /// The screen cannot be opened, as without a terminal, or it failed.
    #[error("{}", system_reason(.0))]
    Screen(io::Error),
}

impl CliError {
    /// Returns the error of a file whose content cannot be made or written.
    pub(crate) fn of_file(path: &Path, error: io::Error) -> Self {
        let name = path.to_string_lossy().into_owned();
        Self::File { name, error }
    }
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

/// Returns advice for frames that cannot be recorded, as the end of the message.
fn advice(error: &RecorderError) -> &'static str {
    match error {
        RecorderError::Exists { .. } => "; --force replaces it",
        _ => "",
    }
}

/// Returns the end of a message that says what to do if there is no place for the library; empty for other errors.
fn place_advice(error: &LibraryError) -> &'static str {
    match error {
        LibraryError::NoPlace => "; name a folder with --library DIR or TAXEL_LIBRARY",
        _ => "",
    }
}

/// Returns the end of a message that says what to do if a recording does not state the size of its frames; empty for
/// other errors.
fn size_advice(error: &RecordingError) -> &'static str {
    if error.is_of_size() {
        "; give --rows and --columns"
    } else {
        ""
    }
}

/// Returns the end of a message that says what to do if a stream cannot be decoded without more flags; may be empty.
pub(crate) fn stream_advice(refusal: StreamRefusal) -> &'static str {
    match refusal {
        StreamRefusal::Unknown => "; --format names one",
        StreamRefusal::Size => "; give --rows and --columns, and --format if it is text",
        StreamRefusal::Shape { .. } => "; give --rows and --columns",
        StreamRefusal::Cut => "",
    }
}

/// Returns the end of a note that says what to do if something odd in a recording is a mistake; may be empty.
pub(crate) fn note_advice(note: &RecordingNote) -> &'static str {
    match note {
        RecordingNote::Flat { .. } => "; if so, give --rows and --columns",
        _ => "",
    }
}

/// Returns the end of a message about a frame that says which flag helps; may be empty.
pub(crate) fn frame_advice(error: &FrameError) -> &'static str {
    match error {
        FrameError::NoTare => ", such as --tare 30",
        _ => "",
    }
}

/// Returns the message about ranges. A number out of range is named by its flag, as in [`CliError::Range`].
fn with_flag(error: &GridError) -> String {
    match error {
        GridError::Parameter(
            error @ (ParameterError::Range { value, .. } | ParameterError::Fraction { value, .. }),
        ) => {
            let flag = error.parameter().flag();
            format!("--{flag} {} {}", short(*value), error.complaint())
        }
        GridError::Zoom { .. } => {
            "--zoom-x and --zoom-y are for pictures only (--picture)".to_owned()
        }
        error => error.to_string(),
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
        matches!(self, Self::Write(error) | Self::Screen(error) if error.kind() == io::ErrorKind::BrokenPipe)
    }

    /// Returns the exit status; see the table in [`crate::cli`].
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

    /// Returns the message for standard error, with its line end; None for a closed pipe.
    pub(crate) fn message(&self, charset: Charset) -> Option<String> {
        match self {
            _ if self.is_closed_pipe() => None,
            Self::Script { .. } => Some(charset.lines(&format!("error: {self}\n"))),
            Self::Usage(error) => Some(charset.lines(&error.render().to_string())),
            _ => Some(format!("error: {}\n", charset.line(&self.to_string()))),
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_flags_that_help_follow_the_message_of_the_library() {
        let recording = |error| {
            let name = "a.csv".to_owned();
            CliError::Recording { name, error }.to_string()
        };
        let advice = "; give --rows and --columns";
        let expected =
            format!("a.csv: 1 value a frame, but its rows and columns are not stated{advice}");
        assert_eq!(recording(RecordingError::Shape { values: 1 }), expected);
        let columns = recording(RecordingError::Columns { numbers: 2 });
        assert!(columns.ends_with(advice), "{columns}");
        assert!(!recording(RecordingError::Unknown).contains("--"));
        let place = CliError::Library(LibraryError::NoPlace).to_string();
        assert!(place.ends_with("--library DIR or TAXEL_LIBRARY"), "{place}");
    }
}
