//! The errors of a recording, with their places.

use std::io;
use std::sync::Arc;

use crate::formats::file::system_reason;
use crate::formats::recording::format::RecordingFormat;
use crate::frame::FrameSize;
use crate::frame::MAX_FRAME_SIDE;
use crate::parameter::number::counted;

/// The error for a recording that cannot be read, or not to its end.
#[derive(Clone, Debug, thiserror::Error)]
pub enum RecordingError {
    /// An error of the system.
    #[error("cannot read: {}", system_reason(.0))]
    Io(Arc<io::Error>),
    /// Not one of the known formats.
    #[error("not a recording of a known format: expected {}", readable_formats())]
    Unknown,
    /// A file of another kind.
    #[error("{kind}, expected {}", readable_formats())]
    Foreign {
        /// The kind of file, with its article: "a PNG image".
        kind: &'static str,
    },
    /// A place from which on the file does not follow its format. Lines and columns count from 1; a column is a field
    /// of the line.
    #[error("{}{message}", prefix(*line, *column))]
    Damaged {
        /// The line number, if the file is a text.
        line: Option<u64>,
        /// The field in the line, if a single field is wrong.
        column: Option<u64>,
        /// The message, which says what was found and what was expected.
        message: String,
    },
    /// The file does not say how its values are arranged: it has a list of cells, without rows. Their size can be given
    /// in [`ReadOptions`](super::ReadOptions).
    #[error("{} a frame, but its rows and columns are not stated", counted(*values, "value"))]
    Shape {
        /// The number of values of a frame.
        values: u64,
    },
    /// A table without a header, which does not say how its values are arranged: some numbers of a line may not be
    /// values.
    #[error(
        "{} a line, but the rows and columns of a frame{} are not stated (a frame number and a time may be among the \
         numbers)",
        counted(*numbers, "number"),
        most_of(*numbers)
    )]
    Columns {
        /// The number of numbers in a line.
        numbers: u64,
    },
}

/// Returns how large rows and columns may be, for a line that is too long to be a row.
fn most_of(numbers: u64) -> String {
    if numbers > MAX_FRAME_SIDE.into() {
        format!(", each at most {MAX_FRAME_SIDE},")
    } else {
        String::new()
    }
}

/// The formats that are read, for the message about any other file.
fn readable_formats() -> String {
    let titles: Vec<&str> = RecordingFormat::ALL
        .iter()
        .map(|format| format.title())
        .collect();
    titles.join(", ")
}

/// Returns the place for a message, `line 3, column 2: `; empty in a file without lines.
fn prefix(line: Option<u64>, column: Option<u64>) -> String {
    match (line, column) {
        (Some(line), Some(column)) => format!("line {line}, column {column}: "),
        (Some(line), None) => format!("line {line}: "),
        _ => String::new(),
    }
}

impl From<io::Error> for RecordingError {
    /// Converts an error of the system. It is part of the message, so it is not the source of this error, too.
    fn from(error: io::Error) -> Self {
        Self::Io(Arc::new(error))
    }
}

impl RecordingError {
    /// Returns true if giving rows and columns would help.
    pub fn is_of_size(&self) -> bool {
        matches!(self, Self::Shape { .. } | Self::Columns { .. })
    }

    /// Returns the error for frames of this number of values whose rows and columns are unknown, though some may be
    /// given: then they do not fit.
    pub fn unshaped(values: u64, given: Option<FrameSize>) -> Self {
        match given {
            None => Self::Shape { values },
            Some(size) => Self::damaged(format!(
                "found {} a frame, expected {}: {}",
                counted(values, "value"),
                size.cells(),
                size.in_words()
            )),
        }
    }

    /// Returns the error for damage without a place.
    pub(crate) fn damaged(message: impl Into<String>) -> Self {
        let message = message.into();
        Self::Damaged {
            line: None,
            column: None,
            message,
        }
    }

    /// Returns the error for damage in a line.
    pub(super) fn in_line(line: u64, message: impl Into<String>) -> Self {
        let message = message.into();
        Self::Damaged {
            line: Some(line),
            column: None,
            message,
        }
    }

    /// Returns the error for damage in a field of a line.
    pub(super) fn in_field(line: u64, column: usize, message: impl Into<String>) -> Self {
        Self::Damaged {
            line: Some(line),
            column: Some(column as u64),
            message: message.into(),
        }
    }
}
