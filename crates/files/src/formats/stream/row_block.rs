//! The rows of a frame, one per line, and what is wrong with them.

use crate::formats::stream::old::{self};
use taxel_core::frame::{FrameSize, MAX_FRAME_SIDE};
use taxel_core::parameter::number::counted;

use crate::formats::recording::size::frame_size;
use crate::formats::recording::text::{Separator, unquoted};
use crate::formats::recording::time::Time;

#[derive(Debug, Default)]
pub(super) struct RowBlock {
    pub(super) values: Vec<f64>,
    pub(super) rows: u16,
    pub(super) time: Option<Time>,
    pub(super) broken: bool,
    pub(super) sample: Vec<u8>,
    /// The length of that row and the expected one, if it has only numbers; None otherwise.
    pub(super) wrong: Option<WrongRow>,
    first: FirstLine,
    is_torn: bool,
}

#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
enum FirstLine {
    #[default]
    Row,
    /// A single value, which may be the time of the frame, or a row of one column.
    SingleValue,
    ValueAboveRow,
}

#[derive(Clone, Copy, Debug)]
pub(super) struct WrongRow {
    row: u16,
    found: usize,
    expected: usize,
}

impl WrongRow {
    /// Describes a row of `found` numbers; None if that is the expected number, or if it has anything else.
    pub(super) fn of(row: u16, found: Option<usize>, expected: usize) -> Option<Self> {
        let found = found.filter(|&found| found != expected)?;
        Some(Self {
            row,
            found,
            expected,
        })
    }
}

impl RowBlock {
    /// Returns the rows and columns; None if the block is not a frame.
    pub(super) fn size(&self) -> Option<FrameSize> {
        let columns = self.values.len().checked_div(self.rows.into())?;
        frame_size(columns, self.rows.into()).filter(|_| !self.broken)
    }

    /// Counts the next row. `found` is the number of its numbers; None if it has anything else.
    pub(super) fn begin_row(&mut self, time: Option<Time>, line: &[u8], found: Option<usize>) {
        match self.rows {
            0 => {
                let is_one = found.map_or_else(|| old::is_alone(line), |count| count == 1);
                self.first = match time {
                    None if is_one => FirstLine::SingleValue,
                    _ => FirstLine::Row,
                };
                self.time = time;
            }
            1 if self.first == FirstLine::SingleValue && found.is_some_and(|count| count > 1) => {
                self.first = FirstLine::ValueAboveRow;
            }
            _ => {}
        }
        self.rows = self.rows.saturating_add(1);
    }

    pub(super) fn note_row(&mut self, line: &[u8], wrong: Option<WrongRow>) {
        self.sample.clear();
        self.sample.extend(line.iter().take(64));
        self.wrong = wrong;
    }

    /// Returns why the block is not a frame: the stream ended within a row, a single value stands above it, or a row
    /// has another number of numbers than the rows above it or than was given, or too many. None if something else is
    /// wrong. `named` are the given rows and columns; `parted` tells whether the stream has empty lines.
    pub(super) fn reason(&self, named: Option<FrameSize>, parted: bool) -> Option<String> {
        // Even the right number of numbers may lack the last digits.
        if self.is_torn {
            return Some("no line break after it".to_owned());
        }
        if self.first == FirstLine::ValueAboveRow {
            let end = if parted {
                ""
            } else {
                ", and end each frame with an empty line"
            };
            return Some(format!("{}{end}", old::ABOVE_ROWS));
        }
        let numbers = |count: usize| counted(count as u64, "number");
        let Some(WrongRow {
            row,
            found,
            expected,
        }) = self.wrong
        else {
            let columns = self.values.len().checked_div(self.rows.into())?;
            let is_wide = !self.broken && columns > MAX_FRAME_SIDE.into();
            let columns = numbers(columns);
            return is_wide.then(|| format!("{columns} a row, expected at most {MAX_FRAME_SIDE}"));
        };
        let Some(size) = named else {
            let found = numbers(found);
            return Some(format!("row {row} has {found}, expected {expected}"));
        };
        let (found, columns, cells) = (numbers(found), size.columns(), size.cells());
        Some(match size.rows() {
            1 => format!("{found}, expected {cells}"),
            _ => format!(
                "{found}, expected {cells} for a frame of {}, or {columns} for a row",
                size.in_words()
            ),
        })
    }

    pub(super) fn add_torn(&mut self, torn: &[u8]) {
        self.rows = self.rows.saturating_add(1);
        if !std::mem::replace(&mut self.broken, true) {
            self.is_torn = true;
            self.note_row(torn, None);
        }
    }

    pub(super) fn clear(&mut self) {
        self.values.clear();
        (self.rows, self.broken, self.is_torn) = (0, false, false);
        self.first = FirstLine::Row;
    }
}

/// Returns true if the first of two blocks may be the end of one like the second: its last rows, or the end of its
/// last row.
pub(super) fn may_be_end(own: FrameSize, next: FrameSize) -> bool {
    let (columns, next_columns) = (own.columns(), next.columns());
    own.rows() < next.rows()
        && (columns == next_columns || own.rows() == 1 && columns < next_columns)
}

/// The most digits of a number that is read here; longer ones are left to the general reader.
const FAST_DIGITS: usize = 9;

/// Appends the numbers of a line to `values`. They are separated as in a table: by the first of [`SEPARATORS`] that
/// the line contains, with or without blanks, otherwise by blanks. With semicolons, a comma is the decimal sign.
/// Quotes around a number are ignored. An empty field and words such as `nan` mean that there is no cell; a separator
/// at the end of the line is ignored, as are tabs at both ends. Returns None if there is anything else, or more than
/// `most` numbers.
pub(super) fn read_row(line: &[u8], values: &mut Vec<f64>, most: usize) -> Option<()> {
    let mut marks = old::SEPARATORS.into_iter();
    let mark = marks.find(|mark| line.contains(mark)).unwrap_or(b'\t');
    let line = if mark == b'\t' {
        line.trim_ascii()
    } else {
        line
    };
    let is_separator = |byte: u8| byte == mark || matches!(byte, b' ' | b'\t' | b'\r');
    let first = values.len();
    let mut at = 0;
    loop {
        let mut marks = 0;
        while let Some(&byte) = line.get(at).filter(|byte| is_separator(**byte)) {
            marks += usize::from(byte == mark);
            at += 1;
        }
        let is_end = at == line.len();
        let empty = match values.len() > first {
            true => marks.saturating_sub(1),
            false if is_end => 0,
            false => marks,
        };
        let room = most - (values.len() - first);
        if empty + usize::from(!is_end) > room {
            return None;
        }
        values.extend(std::iter::repeat_n(f64::NAN, empty));
        if is_end {
            return Some(());
        }
        let start = at;
        let mut whole = 0_u32;
        while let Some(digit) = line.get(at).map(|byte| byte.wrapping_sub(b'0')) {
            if digit > 9 || at - start == FAST_DIGITS {
                break;
            }
            whole = whole * 10 + u32::from(digit);
            at += 1;
        }
        if line.get(at).is_none_or(|&byte| is_separator(byte)) {
            values.push(f64::from(whole));
            continue;
        }
        while line.get(at).is_some_and(|&byte| !is_separator(byte)) {
            at += 1;
        }
        let field = unquoted(&line[start..at]);
        values.push(Separator::Byte(mark).value(field).cell()?);
    }
}

#[cfg(test)]
mod tests {
    use super::read_row;

    #[test]
    fn numbers_of_all_kinds_are_read() {
        let mut values = Vec::new();
        let line = b" 12, 7\t-3.5 0 1234567890123 1e3,5 6\r";
        assert_eq!(read_row(line, &mut values, 8), Some(()));
        assert_eq!(
            values,
            [12.0, 7.0, -3.5, 0.0, 1_234_567_890_123.0, 1000.0, 5.0, 6.0]
        );
        for line in [&b"1 2x"[..], b"x", b"1 2 3", b"1e999", b"--1"] {
            values.clear();
            assert_eq!(read_row(line, &mut values, 2), None, "{line:?}");
        }
        values.clear();
        assert_eq!(read_row(b"nan", &mut values, 1), Some(()));
        assert!(values[0].is_nan());
    }

    #[test]
    fn with_semicolons_a_comma_is_the_decimal_sign_and_an_empty_field_is_not_a_cell() {
        for (line, expected) in [
            ("0,5;1,5", "[0.5, 1.5]"),
            ("1;2;", "[1.0, 2.0]"),
            ("1,,2", "[1.0, NaN, 2.0]"),
            (",1 , , 2,,", "[NaN, 1.0, NaN, 2.0, NaN]"),
            ("1 null\tNA none", "[1.0, NaN, NaN, NaN]"),
            ("1\t\t2", "[1.0, NaN, 2.0]"),
            ("\t1 \t 2  3\t\t\r", "[1.0, 2.0, 3.0]"),
            ("1,\t\t2", "[1.0, 2.0]"),
            ("#N/A 1 N/A -nan", "[NaN, 1.0, NaN, NaN]"),
            (" , ,, ", "[]"),
            ("\"1\",\"2.5\",\"\",3", "[1.0, 2.5, NaN, 3.0]"),
            ("\"1,5\";2", "[1.5, 2.0]"),
        ] {
            let mut values = Vec::new();
            assert_eq!(
                read_row(line.as_bytes(), &mut values, 5),
                Some(()),
                "{line}"
            );
            assert_eq!(format!("{values:?}"), expected, "{line}");
        }
        // An item of a list.
        assert_eq!(read_row(b"- 12", &mut Vec::new(), 5), None);
        let mut values = vec![7.0];
        assert_eq!(read_row(b"1,,2", &mut values, 2), None);
    }
}
