//! An imprint as a table of numbers (CSV): a line a row, 1 for an active taxel, 0 for an inactive one.
//!
//! Written with commas and without a heading. Read as other programs write such a table: parted by commas, semicolons
//! or tabs, with or without quotes, as `1`, `1.0`, `1.000e+00` or `true`. Lines and columns of errors count from 1; a
//! column is one of the table.

use std::fmt;

use crate::formats::text::lines;
use crate::imprint::Imprint;
use crate::quote::shortened;
use crate::sensor::MAX_SIDE;

/// Why bytes are no table of an imprint.
#[derive(Clone, Debug, PartialEq, Eq)]
#[non_exhaustive]
pub enum TableError {
    /// A byte that is no text.
    Text {
        /// Which line.
        line: usize,
    },
    /// Something else than 0 or 1.
    Value {
        /// Which line.
        line: usize,
        /// Which value of it.
        column: usize,
        /// What stands there.
        found: String,
    },
    /// A line of another length than the first.
    Ragged {
        /// Which line.
        line: usize,
        /// Its length.
        found: usize,
        /// The first line's length.
        expected: u8,
    },
    /// A line with too many values.
    Columns {
        /// Which line.
        line: usize,
        /// Its length.
        found: usize,
    },
    /// No lines, or too many.
    Lines {
        /// How many.
        found: usize,
    },
}

impl fmt::Display for TableError {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        match self {
            Self::Text { line } => write!(f, "line {line}: not UTF-8, expected numbers 0 and 1"),
            Self::Value {
                line,
                column,
                found,
            } => write!(
                f,
                "line {line}, column {column}: found {found:?}, expected 0 or 1"
            ),
            Self::Ragged {
                line,
                found,
                expected,
            } => write!(
                f,
                "line {line}: found {found} values, expected {expected} as in line 1"
            ),
            Self::Columns { line, found } => {
                write!(f, "line {line}: found {found} values, expected 1 to 64")
            }
            Self::Lines { found } => write!(f, "found {found} lines, expected 1 to 64"),
        }
    }
}

impl std::error::Error for TableError {}

/// Reads any bytes.
///
/// # Errors
/// What is wrong first, and where.
///
/// ```
/// use taxel::formats::table::{read, write};
/// let cup = read(b"1;0;1\r\n\"1\";1.0;true\r\n")?;
/// assert_eq!(cup.to_string(), "#.#\n###");
/// assert_eq!(write(&cup), "1,0,1\n1,1,1\n");
/// # Ok::<(), taxel::formats::table::TableError>(())
/// ```
pub fn read(bytes: &[u8]) -> Result<Imprint, TableError> {
    let bytes = bytes.strip_prefix(b"\xef\xbb\xbf").unwrap_or(bytes);
    let text = str::from_utf8(bytes).map_err(|error| {
        let valid = &bytes[..error.valid_up_to()];
        let line = valid.split(|&byte| byte == b'\n').count();
        TableError::Text { line }
    })?;
    let lines = lines(text);
    let height = u8::try_from(lines.len()).ok();
    let height = height.filter(|rows| (1..=MAX_SIDE).contains(rows));
    let found = lines.len();
    let rows = height.ok_or(TableError::Lines { found })?;
    // The first line tells what parts its values; one without any is a single column.
    let mark = lines[0]
        .chars()
        .find(|mark| matches!(mark, ',' | ';' | '\t'));
    let mark = mark.unwrap_or(',');
    let mut imprint: Option<Imprint> = None;
    for ((line, text), row) in (1..).zip(&lines).zip(0..rows) {
        let found = text.split(mark).count();
        let columns = u8::try_from(found).ok();
        let columns = columns.filter(|columns| *columns <= MAX_SIDE);
        let columns = columns.ok_or(TableError::Columns { line, found })?;
        let imprint = imprint.get_or_insert_with(|| Imprint::empty(columns, rows));
        if columns != imprint.columns() {
            let expected = imprint.columns();
            return Err(TableError::Ragged {
                line,
                found,
                expected,
            });
        }
        for (column, field) in (0..columns).zip(text.split(mark)) {
            let active = value(field).ok_or_else(|| TableError::Value {
                line,
                column: usize::from(column) + 1,
                found: shortened(field),
            })?;
            imprint.set(column, row, active);
        }
    }
    imprint.ok_or(TableError::Lines { found })
}

/// Whether a field stands for an active taxel; none of what is neither 0 nor 1.
fn value(field: &str) -> Option<bool> {
    let field = field.trim();
    let bare = field
        .strip_prefix('"')
        .and_then(|field| field.strip_suffix('"'));
    let bare = bare.unwrap_or(field).trim();
    if bare.eq_ignore_ascii_case("true") || bare.eq_ignore_ascii_case("false") {
        return Some(bare.len() == "true".len());
    }
    let number: f64 = bare.parse().ok()?;
    (number == 0.0 || number == 1.0).then_some(number == 1.0)
}

/// The table, with a line end after each row.
pub fn write(imprint: &Imprint) -> String {
    let mut text = String::new();
    for row in 0..imprint.rows() {
        for column in 0..imprint.columns() {
            if column > 0 {
                text.push(',');
            }
            text.push(if imprint.get(column, row) { '1' } else { '0' });
        }
        text.push('\n');
    }
    text
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn tables_of_other_programs_are_read() {
        let cup = Ok("#.#\n###".to_owned());
        for text in [
            // numpy.savetxt, and with its delimiter set.
            "1.000000000000000000e+00,0.000000000000000000e+00,1.000000000000000000e+00\n1e0,1e0,1e0\n",
            "True,False,True\nTRUE,true,True",
            "\u{feff}1\t0\t1\r\n1\t1\t1\r\n\r\n",
            " 1 ; 0 ; 1 \n1;1;1",
        ] {
            assert_eq!(
                read(text.as_bytes()).map(|cup| cup.to_string()),
                cup,
                "{text:?}"
            );
        }
        assert_eq!(
            read(b"1\n0\n").map(|bar| bar.to_string()),
            Ok("#\n.".to_owned())
        );
    }

    #[test]
    fn what_is_wrong_is_told_with_its_place() {
        let wrong = |bytes: &[u8], message: &str| {
            let told = read(bytes).map_err(|error| error.to_string());
            assert_eq!(told, Err(message.to_owned()));
        };
        wrong(b"", "found 0 lines, expected 1 to 64");
        wrong(&b"1\n".repeat(65), "found 65 lines, expected 1 to 64");
        wrong(
            &b"1,".repeat(64),
            "line 1: found 65 values, expected 1 to 64",
        );
        wrong(b"1,0\n1", "line 2: found 1 values, expected 2 as in line 1");
        wrong(
            b"1,0\n1,2",
            "line 2, column 2: found \"2\", expected 0 or 1",
        );
        wrong(b"1,NaN", "line 1, column 2: found \"NaN\", expected 0 or 1");
        wrong(
            b"a,b\n1,0",
            "line 1, column 1: found \"a\", expected 0 or 1",
        );
        wrong(
            b"1,0\n\n1,0",
            "line 2: found 1 values, expected 2 as in line 1",
        );
        wrong(b"1\n\xff", "line 2: not UTF-8, expected numbers 0 and 1");
    }
}
