//! The errors of a recording, with their places.

use std::io;
use std::sync::Arc;

use taxel_core::frame::{FrameSize, MAX_FRAME_SIDE};
use taxel_core::parameter::named;
use taxel_core::parameter::number::counted;

use crate::formats::file::system_reason;

/// The error for a recording that cannot be read, or not to its end.
#[derive(Clone, Debug, thiserror::Error)]
pub enum RecordingError {
    /// An error of the system.
    #[error("cannot read: {}", system_reason(.0))]
    Io(Arc<io::Error>),
    /// Not one of the known formats.
    #[error("not a recording of a known format: expected {}", known_formats())]
    Unknown,
    /// A file of another kind.
    #[error("{kind}, expected {}", known_formats())]
    Foreign {
        /// The kind of file, with its article: "an imprint as text".
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

pub(super) fn known_formats() -> String {
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

    pub(super) fn in_line(line: u64, message: impl Into<String>) -> Self {
        let message = message.into();
        Self::Damaged {
            line: Some(line),
            column: None,
            message,
        }
    }

    pub(super) fn in_field(line: u64, column: usize, message: impl Into<String>) -> Self {
        Self::Damaged {
            line: Some(line),
            column: Some(column as u64),
            message: message.into(),
        }
    }
}

/// A format of recordings.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash)]
pub enum RecordingFormat {
    /// Tekscan's ASCII export.
    Tekscan,
    /// XSENSOR's CSV export.
    Xsensor,
    /// Numbers separated by commas, semicolons, tabs or spaces: one frame per line, or one row per line.
    Csv,
    /// A numpy array.
    Npy,
    /// An archive of numpy arrays.
    Npz,
    /// JSON lines: one object per line.
    JsonLines,
    /// The output of `ros2 topic echo`.
    Ros2,
    /// An MCAP file.
    Mcap,
    /// The bytes of a `FlexiTac` board.
    Flexitac,
}

impl RecordingFormat {
    /// All formats.
    pub const ALL: &'static [Self] = &[
        Self::Tekscan,
        Self::Xsensor,
        Self::Csv,
        Self::Npy,
        Self::Npz,
        Self::JsonLines,
        Self::Ros2,
        Self::Mcap,
        Self::Flexitac,
    ];

    /// Returns the name of the format, as it is in answers.
    pub fn name(self) -> &'static str {
        match self {
            Self::Tekscan => "tekscan",
            Self::Xsensor => "xsensor",
            Self::Csv => "csv",
            Self::Npy => "npy",
            Self::Npz => "npz",
            Self::JsonLines => "jsonl",
            Self::Ros2 => "ros2",
            Self::Mcap => "mcap",
            Self::Flexitac => "flexitac",
        }
    }

    pub(super) fn title(self) -> &'static str {
        match self {
            Self::Tekscan => "Tekscan ASCII",
            Self::Xsensor => "XSENSOR CSV",
            Self::Csv => "CSV",
            Self::Npy => "NPY",
            Self::Npz => "NPZ",
            Self::JsonLines => "JSON lines",
            Self::Ros2 => "ros2 topic echo",
            Self::Mcap => "MCAP",
            Self::Flexitac => "FlexiTac",
        }
    }

    /// Returns true if frames in this format can be a stream, too: they are written one after the other as they are
    /// measured, and can be read as they arrive. A file that they are appended to can be followed.
    pub(crate) fn can_be_streamed(self) -> bool {
        match self {
            Self::Csv | Self::JsonLines | Self::Ros2 | Self::Flexitac => true,
            Self::Tekscan | Self::Xsensor | Self::Npy | Self::Npz | Self::Mcap => false,
        }
    }

    pub(crate) fn is_text_stream(self) -> bool {
        self.can_be_streamed() && self != Self::Flexitac
    }
}

named!(RecordingFormat, "format", RecordingFormat::ALL);
