//! An imprint as plain text: one line per row, `#` for an active taxel, `.` for an inactive one.
//!
//! Lines may end in blanks and in CRLF, and blank lines may follow the last row. In errors, lines and columns count
//! from 1.

use std::fmt;

use crate::imprint::{Imprint, ImprintError};
use crate::parameter::number::counted;

/// The error for bytes that are not an imprint as text.
#[derive(Clone, Debug, PartialEq, Eq)]
#[non_exhaustive]
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
    /// A character that is not a taxel.
    Character {
        /// The line number.
        line: usize,
        /// The character in the line.
        column: usize,
        /// The character that was found.
        found: char,
    },
    /// A line of another length than the first.
    Ragged {
        /// The line number.
        line: usize,
        /// The column of the first taxel too many, or after the end of a shorter line.
        column: usize,
        /// The length of the line.
        found: usize,
        /// The length of the first line.
        expected: u8,
    },
    /// An empty line, or a line with too many taxels.
    Columns {
        /// The line number.
        line: usize,
        /// The column of the first taxel too many, or 1 in an empty line.
        column: usize,
        /// The length of the line.
        found: usize,
    },
    /// No lines, or too many.
    Lines {
        /// The number of lines.
        found: usize,
    },
}

impl fmt::Display for TextError {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        match self {
            Self::Byte { line, column, byte } => write!(
                f,
                "line {line}, column {column}: found byte 0x{byte:02x}, expected '#' or '.'"
            ),
            Self::Character {
                line,
                column,
                found,
            } => write!(
                f,
                "line {line}, column {column}: found {found:?}, expected '#' or '.'"
            ),
            Self::Ragged {
                line,
                column,
                found,
                expected,
            } => {
                let found = counted(*found as u64, "taxel");
                write!(
                    f,
                    "line {line}, column {column}: found {found}, expected {expected} as in line 1"
                )
            }
            Self::Columns {
                line,
                column,
                found,
            } => write!(
                f,
                "line {line}, column {column}: found {found} taxels, expected 1 to 64"
            ),
            Self::Lines { found } => {
                write!(
                    f,
                    "found {}, expected 1 to 64",
                    counted(*found as u64, "line")
                )
            }
        }
    }
}

impl std::error::Error for TextError {}

/// Reads an imprint as text from any bytes.
///
/// # Errors
/// Returns the first error and its place.
///
/// ```
/// use taxel::formats::text::{read, write};
/// let ring = read(b".##.\r\n#..# \r\n.##.\r\n\r\n")?;
/// assert_eq!(write(&ring), ".##.\n#..#\n.##.\n");
/// assert_eq!(
///     read(b"##\n#x").map_err(|error| error.to_string()),
///     Err("line 2, column 2: found 'x', expected '#' or '.'".to_owned())
/// );
/// # Ok::<(), taxel::formats::text::TextError>(())
/// ```
pub fn read(bytes: &[u8]) -> Result<Imprint, TextError> {
    let text = str::from_utf8(bytes).map_err(|error| no_text(bytes, error.valid_up_to()))?;
    let mut rows = lines(text);
    for row in &mut rows {
        *row = row.trim_end_matches([' ', '\t']);
    }
    Imprint::from_rows(rows.iter().copied()).map_err(|error| match error {
        ImprintError::Rows => TextError::Lines { found: rows.len() },
        ImprintError::Columns { row, found } => TextError::Columns {
            line: row,
            column: found.min(64) + 1,
            found,
        },
        ImprintError::Ragged {
            row,
            found,
            expected,
        } => TextError::Ragged {
            line: row,
            column: found.min(usize::from(expected)) + 1,
            found,
            expected,
        },
        ImprintError::Character { row, column, found } => TextError::Character {
            line: row,
            column,
            found,
        },
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
        Some((_, found)) => TextError::Character {
            line,
            column,
            found,
        },
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
