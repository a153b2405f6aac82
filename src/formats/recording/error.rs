//! What can be wrong with a recording, and where.

use std::io;

use crate::parameter::number::counted;

/// Why a recording cannot be read, or not to its end.
#[derive(Debug, thiserror::Error)]
#[non_exhaustive]
pub enum RecordingError {
    /// The system refuses.
    #[error("cannot read: {0}")]
    Io(#[from] io::Error),
    /// None of the formats that are known.
    #[error("not a recording of a known format: expected {FORMS}")]
    Unknown,
    /// A file of another kind.
    #[error("{kind}, expected {FORMS}")]
    Foreign {
        /// What it is, with its article: "a PNG image".
        kind: &'static str,
    },
    /// The file does not follow its format from here on. Lines and columns count from 1; a column is a field of the line.
    #[error("{}{message}", prefix(*line, *column))]
    Damaged {
        /// Which line, in a text.
        line: Option<u64>,
        /// Which field of it, where it is one.
        column: Option<u64>,
        /// What is wrong, and what would be right.
        message: String,
    },
    /// The file does not say how its values are arranged.
    /// A list of cells, without rows. The numbers can be named with [`ReadOptions`](super::ReadOptions).
    #[error("{} a frame, but no rows and columns; give --rows and --columns", counted(*values, "value"))]
    Shape {
        /// How many values a frame has.
        values: u64,
    },
    /// The same of a table without a header: not all numbers of a line need be values.
    #[error(
        "{} a line, but no rows and columns; give --rows and --columns (a frame number and a time may be among the numbers)",
        counted(*numbers, "number")
    )]
    Columns {
        /// How many numbers a line has.
        numbers: u64,
    },
}

/// The formats for a file whose content is none of them.
const FORMS: &str = "Tekscan ASCII, XSENSOR CSV, emed .lst, zebris .apd, CSV, NPY, NPZ, JSON lines, PoPu JSON, MCAP, \
                     ros2 topic echo";

/// `line 3, column 2: `; nothing in a file that has no lines.
fn prefix(line: Option<u64>, column: Option<u64>) -> String {
    match (line, column) {
        (Some(line), Some(column)) => format!("line {line}, column {column}: "),
        (Some(line), None) => format!("line {line}: "),
        _ => String::new(),
    }
}

impl RecordingError {
    /// Whether rows and columns would help.
    pub fn is_of_size(&self) -> bool {
        matches!(self, Self::Shape { .. } | Self::Columns { .. })
    }

    /// A damage without a place.
    pub(crate) fn damaged(message: impl Into<String>) -> Self {
        let message = message.into();
        Self::Damaged {
            line: None,
            column: None,
            message,
        }
    }

    /// A damage of a line.
    pub(crate) fn in_line(line: u64, message: impl Into<String>) -> Self {
        let message = message.into();
        Self::Damaged {
            line: Some(line),
            column: None,
            message,
        }
    }

    /// A damage of a field of a line.
    pub(crate) fn in_field(line: u64, column: usize, message: impl Into<String>) -> Self {
        Self::Damaged {
            line: Some(line),
            column: Some(column as u64),
            message: message.into(),
        }
    }
}
