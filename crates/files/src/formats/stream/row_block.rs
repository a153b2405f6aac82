//! The rows of a frame, one per line, and what is wrong with them.

use crate::formats::recording::side::frame_size;
use crate::formats::recording::time::exact::Time;
use crate::formats::recording::time::moment;
use crate::frame::{FrameSize, MAX_FRAME_SIDE};
use crate::parameter::number::counted;

/// A block of rows, which an empty line ends.
#[derive(Debug, Default)]
pub(super) struct RowBlock {
    /// The values, row by row.
    pub(super) values: Vec<f64>,
    /// The number of rows.
    pub(super) rows: u16,
    /// The timestamp at the beginning of the first line.
    pub(super) time: Option<Time>,
    /// Whether a row is invalid.
    pub(super) broken: bool,
    /// The beginning of that row, or of the first row if none is invalid.
    pub(super) sample: Vec<u8>,
    /// The length of that row and the expected one, if it has only numbers; None otherwise.
    pub(super) wrong: Option<WrongRow>,
    /// The form of the first line.
    first: FirstLine,
    /// Whether the stream ended within the last row.
    is_torn: bool,
}

/// The form of the first line of a block.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
enum FirstLine {
    /// A row.
    #[default]
    Row,
    /// A single value, which may be the time of the frame, or a row of one column.
    SingleValue,
    /// A single value above a line with several numbers.
    ValueAboveRow,
}

/// A row with the wrong number of numbers.
#[derive(Clone, Copy, Debug)]
pub(super) struct WrongRow {
    /// The number of the row in its block, from 1.
    row: u16,
    /// The number of its numbers.
    found: usize,
    /// The number of numbers in the rows above it.
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
                let is_one = found.map_or_else(|| moment::is_alone(line), |count| count == 1);
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

    /// Keeps the beginning of a row, and what is wrong with it.
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
            return Some(format!("{}{end}", moment::ABOVE_ROWS));
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

    /// Adds the beginning of a line whose end never came.
    pub(super) fn add_torn(&mut self, torn: &[u8]) {
        self.rows = self.rows.saturating_add(1);
        if !std::mem::replace(&mut self.broken, true) {
            self.is_torn = true;
            self.note_row(torn, None);
        }
    }

    /// Prepares for the next block, in the same memory.
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
