//! An imprint as plain text: one line per row, `#` for an active taxel, `.` for an inactive one.
//!
//! Lines may end in blanks and in CRLF, and blank lines may follow the last row. In errors, lines and columns count
//! from 1.

use std::fmt;

use crate::imprint::{Imprint, ImprintError};
use crate::parameter::number::counted;
use crate::quote::quoted_character;

/// The error for bytes that are not an imprint as text.
#[derive(Clone, Debug, PartialEq, Eq)]
pub enum TextError {
    /// A byte that is not UTF-8.
    Byte {
        /// The line number.
        line: usize,
        /// The character in the line.
        column: usize,
        /// The byte that was found.
        byte: u8,
    },
    /// No lines, or too many.
    Lines {
        /// The number of lines.
        found: usize,
    },
    /// A line that is not a row of an imprint; the row is the number of the line.
    Row(ImprintError),
}

impl fmt::Display for TextError {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        // In a line of another length, the column of the first taxel too many, or after the end of a shorter line.
        let behind = |found: usize, most: usize| found.min(most) + 1;
        let (line, column, message) = match *self {
            Self::Byte { line, column, byte } => {
                let message = format!("found byte 0x{byte:02x}, expected '#' or '.'");
                (line, column, message)
            }
            Self::Row(ImprintError::Character { row, column, found }) => {
                let found = quoted_character(found);
                (row, column, format!("found {found}, expected '#' or '.'"))
            }
            Self::Row(ImprintError::Ragged {
                row,
                found,
                expected,
            }) => {
                let taxels = counted(found as u64, "taxel");
                let message = format!("found {taxels}, expected {expected} as in line 1");
                (row, behind(found, expected.into()), message)
            }
            Self::Row(ImprintError::Columns { row, found }) => {
                let message = format!("found {found} taxels, expected 1 to 64");
                (row, behind(found, 64), message)
            }
            Self::Row(ImprintError::Rows) => return ImprintError::Rows.fmt(f),
            Self::Lines { found } => {
                let lines = counted(found as u64, "line");
                return write!(f, "found {lines}, expected 1 to 64");
            }
        };
        write!(f, "line {line}, column {column}: {message}")
    }
}

impl std::error::Error for TextError {}

/// Reads an imprint as text from any bytes.
///
/// # Errors
/// Returns the first error and its place.
///
/// ```
/// use taxel_files::formats::text::{read, write};
/// let ring = read(b".##.\r\n#..# \r\n.##.\r\n\r\n")?;
/// assert_eq!(write(&ring), ".##.\n#..#\n.##.\n");
/// assert_eq!(
///     read(b"##\n#x").map_err(|error| error.to_string()),
///     Err("line 2, column 2: found 'x', expected '#' or '.'".to_owned())
/// );
/// # Ok::<(), taxel_files::formats::text::TextError>(())
/// ```
pub fn read(bytes: &[u8]) -> Result<Imprint, TextError> {
    let text = str::from_utf8(bytes).map_err(|error| no_text(bytes, error.valid_up_to()))?;
    let mut rows = lines(text);
    for row in &mut rows {
        *row = row.trim_end_matches([' ', '\t']);
    }
    Imprint::from_rows(rows.iter().copied()).map_err(|error| match error {
        ImprintError::Rows => TextError::Lines { found: rows.len() },
        error => TextError::Row(error),
    })
}

/// Reads rows of `0` and `1` without separators, and rows of `#` and `.` with a blank between the taxels, as other
/// programs write them; None for anything else.
///
/// A row of a single digit is left to tables, where it is a column.
pub(crate) fn of_other_signs(bytes: &[u8]) -> Option<Imprint> {
    let taxels = |row: &str| {
        let row = row.trim_end_matches([' ', '\t']).as_bytes();
        let spaced = row.len() > 1 && row.iter().skip(1).step_by(2).all(|&byte| byte == b' ');
        let signs = row.iter().step_by(if spaced { 2 } else { 1 });
        let taxel = |&byte: &u8| match (byte, spaced || row.len() < 2) {
            (b'1', false) | (b'#', true) => Some('#'),
            (b'0', false) | (b'.', true) => Some('.'),
            _ => None,
        };
        signs.map(taxel).collect::<Option<String>>()
    };
    let text = str::from_utf8(bytes).ok()?;
    let rows: Option<Vec<String>> = lines(text).into_iter().map(taxels).collect();
    Imprint::from_rows(rows?.iter().map(String::as_str)).ok()
}

/// Returns the first error in bytes that are UTF-8 only up to `end`.
fn no_text(bytes: &[u8], end: usize) -> TextError {
    let valid = String::from_utf8_lossy(&bytes[..end]);
    let is_stray = |found: &(usize, char)| !matches!(found.1, '#' | '.' | ' ' | '\t' | '\r' | '\n');
    let stray = valid.char_indices().find(is_stray);
    let before = &valid[..stray.map_or(valid.len(), |(at, _)| at)];
    let line = before.split('\n').count();
    let column = 1 + before.rsplit('\n').next().unwrap_or("").chars().count();
    match stray {
        Some((_, found)) => TextError::Row(ImprintError::Character {
            row: line,
            column,
            found,
        }),
        None => TextError::Byte {
            line,
            column,
            byte: bytes[end],
        },
    }
}

/// Splits a text into lines, without line ends and without the blank lines at the end.
pub(crate) fn lines(text: &str) -> Vec<&str> {
    let mut lines: Vec<&str> = text
        .split('\n')
        .map(|line| line.strip_suffix('\r').unwrap_or(line))
        .collect();
    while lines.last().is_some_and(|line| line.trim_end().is_empty()) {
        lines.pop();
    }
    lines
}

/// Returns the text, with a line end after each row.
pub fn write(imprint: &Imprint) -> String {
    format!("{imprint}\n")
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_first_error_counts_whether_or_not_the_rest_is_text() {
        for bytes in [&b"##\n#x"[..], b"##\n#x\xff"] {
            let error = read(bytes).map_err(|error| error.to_string());
            let expected = "line 2, column 2: found 'x', expected '#' or '.'";
            assert_eq!(error, Err(expected.to_owned()));
        }
    }

    #[test]
    fn rows_of_digits_and_spaced_signs_are_read() {
        let shown = |text: &str| of_other_signs(text.as_bytes()).map(|imprint| write(&imprint));
        assert_eq!(shown("010\n111 \r\n\n").as_deref(), Some(".#.\n###\n"));
        assert_eq!(shown(". # .\n# # #\n").as_deref(), Some(".#.\n###\n"));
        for other in [
            "", "0\n1", "0 1\n1 0", "01\n2#", "01\n011", "0,1", ".#", "10\n\n10",
        ] {
            assert_eq!(shown(other), None, "{other:?}");
        }
    }
}
