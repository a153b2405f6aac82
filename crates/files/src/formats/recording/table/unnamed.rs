//! Finds the arrangement of a table without a header: from the number of fields in a line, and from empty lines.
//!
//! All numbers are cells. With rows and columns given, two more may stand beside them, in one of two layouts:
//! ```text
//! 0,0.00,1,2,3,4      number and time before the cells
//! 1,2,3,4,0,50        number and milliseconds behind the cells
//! ```
//! The number counts up by 1 from line to line and the time never falls. Everything else is refused: a wrong guess
//! would shift all cells by one.

use std::io::BufRead;

use crate::formats::recording::error::RecordingError;
use crate::formats::recording::event::ReadOptions;
use crate::formats::recording::side::side;
use crate::formats::recording::table::arrangement::{FrameFields, LineLayout, TableLayout};
use crate::formats::recording::table::clock::TimeFields;
use crate::formats::recording::table::header::moment_of_row;
use crate::formats::recording::text::lines::{TextLines, is_blank, text};
use crate::formats::recording::text::number::whole;
use crate::formats::recording::text::row;
use crate::formats::recording::text::separator::{Separator, is_comment};
use crate::formats::recording::time::moment;
use crate::formats::recording::time::unit::TimeUnit;
use crate::frame::{FrameSize, MAX_FRAME_SIDE};
use crate::parameter::number::counted;

/// The number of lines that are compared to tell the two layouts apart.
const COMPARED: u16 = 8;

/// Finds the arrangement of a table without names. Its first lines are in `read`, which begins in line `number` of
/// the file.
pub(super) fn of_numbers(
    lines: &mut TextLines<impl BufRead>,
    separator: Separator,
    (number, read): (u64, &[&[u8]]),
    options: ReadOptions,
) -> Result<TableLayout, RecordingError> {
    let size = options.size;
    let first = UnnamedFirst::new(separator, read[0], size);
    let mut compared: Vec<Vec<u8>> = read.iter().map(|line| line.to_vec()).collect();
    let enough = first.lines_needed(size);
    let block = first_block(lines, (read.len(), enough), |line| {
        compared.push(line.to_owned());
    })?;
    first.layout(number, &compared, block, size)
}

/// The first line of a table without names.
struct UnnamedFirst<'a> {
    separator: Separator,
    fields: Vec<&'a [u8]>,
    /// The indices of the numbers among the fields.
    numeric: Vec<usize>,
    /// The timestamp at its beginning.
    moment: Option<&'a [u8]>,
    /// The number of columns, if it is the row of a frame.
    width: Option<u16>,
}

impl<'a> UnnamedFirst<'a> {
    fn new(separator: Separator, line: &'a [u8], size: Option<FrameSize>) -> Self {
        let fields = first_fields(separator, line, size);
        let numeric = (0..fields.len()).filter(|&field| separator.is_numeric(fields[field]));
        let numeric: Vec<usize> = numeric.collect();
        let moment = moment_of_row(separator, line);
        let width = match moment {
            Some((_, row)) => side(separator.fields(row).count()),
            None => side(numeric.len()).filter(|_| numeric.len() == fields.len()),
        };
        Self {
            separator,
            fields,
            numeric,
            moment: moment.map(|(moment, _)| moment),
            width,
        }
    }

    /// Returns the number of lines that are needed to decide how the table is arranged. A growing file is read no
    /// further than these lines.
    fn lines_needed(&self, size: Option<FrameSize>) -> u16 {
        match size {
            Some(size) if self.is_row(size) => size.rows() + 1,
            Some(size) if self.numeric.len() == size.cells() + 2 => COMPARED,
            Some(_) => 2,
            None => MAX_FRAME_SIDE + 1,
        }
    }

    /// Returns true if the line is the row of a frame of this size.
    fn is_row(&self, size: FrameSize) -> bool {
        self.width == Some(size.columns()) && size.rows() > 1
    }

    /// Finds the arrangement of the lines that begin with this one, which is line `number`. The first `block` of them
    /// stand together, and an empty line follows if they are `parted`.
    ///
    /// A line is a row if it has as many fields as a frame has columns; or, if no size is given, if an empty line ends
    /// the first block. Otherwise, or if it contains texts, it is a frame.
    fn layout(
        &self,
        number: u64,
        lines: &[Vec<u8>],
        (block, parted): (u16, bool),
        size: Option<FrameSize>,
    ) -> Result<TableLayout, RecordingError> {
        let own = self.width.filter(|_| parted && block > 1);
        let own = FrameSize::of_sides(own, Some(block));
        let (size, lines) = match (size, own) {
            (Some(size), _) if self.is_row(size) => (size, LineLayout::Row { parted }),
            (Some(size), _) => {
                let found = self.frame_fields(size.cells(), number, lines)?;
                let found = found.with_moment(self.separator, &self.fields);
                (size, LineLayout::Frame(found))
            }
            (None, Some(own)) => (own, LineLayout::Row { parted }),
            (None, None) => {
                let numbers = self.numeric.len() as u64;
                return Err(RecordingError::Columns { numbers });
            }
        };
        let start = match lines {
            LineLayout::Row { .. } => self.moment.map(text),
            LineLayout::Frame(_) => lines.start(&self.fields),
        };
        Ok(TableLayout {
            separator: self.separator,
            size,
            start,
            lines,
            note: None,
            unit: None,
        })
    }

    /// Finds which fields of a line are the cells of a frame, its number and its time.
    fn frame_fields(
        &self,
        cells: usize,
        number: u64,
        lines: &[Vec<u8>],
    ) -> Result<FrameFields, RecordingError> {
        let found = self.numeric.len();
        let beside = found.checked_sub(cells);
        let beside = beside.ok_or_else(|| row::count(number, found, cells))?;
        let is_moment = |&field: &usize| moment::read(self.fields[field]).is_some();
        let moment = (0..self.fields.len()).find(is_moment);
        let before = self.numeric.iter().filter(|&&own| Some(own) < moment);
        let (start, label, time) = match (beside, before.count()) {
            (0, _) => (0, None, None),
            // The time is a text.
            (1, 1) => (1, Some(0), None),
            (2, 0) => {
                let lines: Vec<Vec<f64>> = lines.iter().map(|line| self.numbers_in(line)).collect();
                // The last line may be torn.
                let rest = &lines[..lines.len() - usize::from(lines.len() > 2)];
                let fits =
                    |label, time| counts_up(&lines, label, time) || counts_up(rest, label, time);
                match (fits(0, 1), fits(cells, cells + 1)) {
                    (true, false) => (2, Some(0), Some((1, None))),
                    (false, true) => {
                        let unit = Some(TimeUnit::Milliseconds);
                        (0, Some(cells), Some((cells + 1, unit)))
                    }
                    _ => return Err(unclear(number, cells, beside)),
                }
            }
            (1 | 2, _) => return Err(unclear(number, cells, beside)),
            _ => return Err(row::count(number, found, cells)),
        };
        let cells = &self.numeric[start..start + cells];
        if let Some(pair) = cells.windows(2).find(|pair| pair[1] - pair[0] > 1) {
            // A text between two cells belongs neither to them nor beside them.
            let text = pair[0] + 1;
            return Err(row::wrong(number, text + 1, self.fields[text]));
        }
        Ok(FrameFields {
            count: self.fields.len(),
            header: None,
            cells: cells.to_vec(),
            label: label.map(|label| self.numeric[label]),
            time: time.map(|(time, unit)| TimeFields::new(self.numeric[time], unit)),
        })
    }

    /// Returns the numbers of a line in the fields that are numbers in this one; NaN for those that have none.
    fn numbers_in(&self, line: &[u8]) -> Vec<f64> {
        let count = self.fields.len();
        let fields: Vec<&[u8]> = self.separator.fields_of(line, count).take(count).collect();
        let number = |&field: &usize| {
            fields
                .get(field)
                .map_or(f64::NAN, |own| self.separator.number(own))
        };
        self.numeric.iter().map(number).collect()
    }
}

/// Returns true if one field counts up by 1 from line to line, in whole numbers, and another never falls.
fn counts_up(lines: &[Vec<f64>], label: usize, time: usize) -> bool {
    let is_next = |pair: &[Vec<f64>]| {
        pair[1][label] == pair[0][label] + 1.0 && pair[1][time] >= pair[0][time]
    };
    whole(lines[0][label]).is_some() && lines.windows(2).all(is_next)
}

fn unclear(number: u64, cells: usize, beside: usize) -> RecordingError {
    let beside = counted(beside as u64, "number");
    let message = format!(
        "found {beside} besides the {cells} cells, and cannot tell which: add a header line, such as frame,time,r0c0"
    );
    RecordingError::in_line(number, message)
}

/// Returns the fields of the first line of a table without names: with an empty one at the end if the line is a row or
/// a frame of the given size only then.
fn first_fields(separator: Separator, line: &[u8], size: Option<FrameSize>) -> Vec<&[u8]> {
    let counts = size.map(|size| [usize::from(size.columns()), size.cells()]);
    let whole = counts.into_iter().flatten().find_map(|count| {
        let fields: Vec<&[u8]> = separator.fields_of(line, count).collect();
        (fields.len() == count).then_some(fields)
    });
    whole.unwrap_or_else(|| separator.fields(line).collect())
}

/// Continues the first block, of which `read` lines have been read, until there are enough lines or an empty line
/// ends it. Passes the first lines to `take`, for comparison. Returns the number of lines, and whether an empty line
/// ended the block.
fn first_block(
    lines: &mut TextLines<impl BufRead>,
    (read, enough): (usize, u16),
    mut take: impl FnMut(&[u8]),
) -> Result<(u16, bool), RecordingError> {
    let mut block = if read > 1 { 2_u16 } else { 1 };
    while block < enough && lines.advance()? {
        if is_blank(lines.line()) {
            return Ok((block, true));
        }
        if is_comment(lines.line()) {
            continue;
        }
        if block < COMPARED {
            take(lines.line());
        }
        block += 1;
    }
    Ok((block, false))
}
