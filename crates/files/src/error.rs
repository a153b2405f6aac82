//! The error of everything that is read: where, what was found, what was expected.

use std::fmt;
use std::io;

use taxel_core::imprint::ImprintError;
use taxel_core::outline::OutlineError;
use taxel_core::parameter::ParameterError;

use crate::formats::file::system_reason;
use crate::formats::json;

/// Why something cannot be read.
///
/// It is shown as `line 3, column 2: found "x", expected a number`, without the place where a source has no lines.
/// The name of the file is added by the caller, who knows it.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct ReadError {
    /// What callers tell errors apart by.
    pub kind: ReadErrorKind,
    /// The line, from 1.
    pub line: Option<u64>,
    /// The column, from 1: of a table, its field; of other text, the character.
    pub column: Option<u64>,
    /// What was found and what was expected.
    pub message: String,
}

/// What callers tell errors of reading apart by.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum ReadErrorKind {
    /// The content is wrong.
    Invalid,
    /// The content has none of the known formats.
    UnknownFormat,
    /// The rows and columns of a frame are missing: giving them helps.
    Unsized,
    /// The system refused.
    Io(io::ErrorKind),
}

impl ReadError {
    /// An error in the content, without a place.
    pub fn new(message: impl Into<String>) -> Self {
        Self {
            kind: ReadErrorKind::Invalid,
            line: None,
            column: None,
            message: message.into(),
        }
    }

    /// The same error, of another kind.
    #[must_use]
    pub fn of_kind(mut self, kind: ReadErrorKind) -> Self {
        self.kind = kind;
        self
    }

    /// The same error, in the value of this key.
    #[must_use]
    pub fn of_key(mut self, key: &str) -> Self {
        self.message = format!("{key}: {}", self.message);
        self
    }

    /// The same error, in this line, counted from 1.
    #[must_use]
    pub fn in_line(mut self, line: u64) -> Self {
        self.line = Some(line);
        self
    }

    /// The same error, in this column, counted from 1.
    #[must_use]
    pub fn in_column(mut self, column: u64) -> Self {
        self.column = Some(column);
        self
    }
}

impl fmt::Display for ReadError {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        match (self.line, self.column) {
            (Some(line), Some(column)) => write!(f, "line {line}, column {column}: ")?,
            (Some(line), None) => write!(f, "line {line}: ")?,
            (None, Some(column)) => write!(f, "column {column}: ")?,
            (None, None) => {}
        }
        f.write_str(&self.message)
    }
}

impl std::error::Error for ReadError {}

impl From<io::Error> for ReadError {
    fn from(error: io::Error) -> Self {
        Self::new(format!("cannot read: {}", system_reason(&error)))
            .of_kind(ReadErrorKind::Io(error.kind()))
    }
}

impl From<serde_json::Error> for ReadError {
    fn from(error: serde_json::Error) -> Self {
        if let Some(kind) = error.io_error_kind() {
            return Self::from(io::Error::from(kind));
        }
        let read = Self::new(json::message(&error));
        match (error.line() as u64, error.column() as u64) {
            (0, _) => read,
            (line, column) => read.in_line(line).in_column(column.max(1)),
        }
    }
}

impl From<ParameterError> for ReadError {
    fn from(error: ParameterError) -> Self {
        Self::new(error.to_string())
    }
}

impl From<OutlineError> for ReadError {
    fn from(error: OutlineError) -> Self {
        Self::new(error.to_string()).of_key("outline")
    }
}

impl From<ImprintError> for ReadError {
    fn from(error: ImprintError) -> Self {
        Self {
            line: error.row,
            column: error.column,
            ..Self::new(error.message)
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_place_stands_before_the_message() {
        let error = ReadError::new("found \"x\", expected a number");
        assert_eq!(error.to_string(), "found \"x\", expected a number");
        let placed = error.in_line(3).in_column(2);
        assert_eq!(
            placed.to_string(),
            "line 3, column 2: found \"x\", expected a number"
        );
    }

    #[test]
    fn an_error_of_json_gives_its_place_once() {
        let error = serde_json::from_str::<u8>("\n  x").expect_err("no number");
        let read = ReadError::from(error);
        assert_eq!((read.line, read.column), (Some(2), Some(3)));
        assert_eq!(read.message, "expected value");
    }
}
