//! Finds how a table of numbers is arranged: which fields are cells, and what the other fields are.
//!
//! A header names the cells, see [`header`](super::header). Without a header, the rows and columns must be given,
//! unless the table consists of blocks with one row per line. Then all numbers are cells, except that two more may
//! stand beside the cells of a frame, in one of two layouts:
//! ```text
//! 0,0.00,1,2,3,4      number and time before the cells
//! 1,2,3,4,0,50        number and milliseconds behind the cells
//! ```
//! The number counts up by 1 from line to line and the time never falls. Everything else is refused: a wrong guess
//! would shift all cells by one. A timestamp is the time of its frame, unless a column of numbers gives the time; other
//! texts are ignored.

use crate::formats::recording::error::{in_line, unknown_format, unshaped, unsized_line};
use std::io::BufRead;

use taxel_core::frame::{FrameSize, MAX_FRAME_CELLS, MAX_FRAME_SIDE};
use taxel_core::parameter::number::{counted, grouped};

use crate::error::ReadError;
use crate::formats::recording::event::{ReadOptions, RecordingNote};
use crate::formats::recording::size::side;
use crate::formats::recording::table::delimited::TimeFields;
use crate::formats::recording::table::header::{
    MOST_BESIDE, NamedCells, TableHeader, first_line, is_like_next, is_mostly_numeric,
    moment_of_row, wrong_value,
};
use crate::formats::recording::text::{
    self, Field, Separator, TextLines, is_blank, is_comment, text, whole,
};
use crate::formats::recording::time::field_role::{FieldRole, role, roles};
use crate::formats::recording::time::{self, TimeUnit};

pub(super) fn layout(
    input: &mut impl BufRead,
    options: &ReadOptions,
) -> Result<TableLayout, ReadError> {
    layout_or(input, options, |lines, separator, read| {
        of_numbers(lines, separator, read, options)
    })
}

/// Finds the arrangement of a table from its header, or with `unnamed` if it has none: it gets the lines behind those
/// that were read, the separator, and the number of the first line with the lines that were read.
fn layout_or<R: BufRead>(
    input: &mut R,
    options: &ReadOptions,
    unnamed: impl FnOnce(
        &mut TextLines<&mut R>,
        Separator,
        (u64, &[&[u8]]),
    ) -> Result<TableLayout, ReadError>,
) -> Result<TableLayout, ReadError> {
    let mut lines = TextLines::new(input);
    let first = first_line(&mut lines)?;
    let separator = Separator::of(&first);
    let number = lines.number();
    check_width(separator, &first, number)?;
    let fields: Vec<String> = separator.fields(&first).map(text).collect();
    let mut header = TableHeader::new(fields.iter().map(String::as_str).collect(), number);
    let has_words = header
        .names
        .iter()
        .any(|name| !separator.is_numeric(name.as_bytes()));
    // A row of a frame may count up, too.
    let cells = options.size.map(FrameSize::cells);
    let counted = header
        .count_from_0(0)
        .filter(|counted| cells.is_none_or(|cells| cells == *counted));
    let is_header = if has_words {
        moment_of_row(separator, &first).is_none()
    } else {
        counted.is_some()
    };
    if !is_header {
        return unnamed(&mut lines, separator, (number, &[&first]));
    }
    header.units = units_below(&mut lines, &header, separator)?;
    // If words stand below words, it is not a table.
    if !is_mostly_numeric(separator, lines.line()) {
        return Err(unknown_format());
    }
    if has_words && header.units.is_none() && is_like_next(&header, separator, lines.line()) {
        let next = lines.line().to_owned();
        return unnamed(&mut lines, separator, (number, &[&first, &next]));
    }
    if let Some(field) = wrong_value(&header, separator) {
        return Err(text::wrong_field(
            number,
            field + 1,
            header.names[field].as_bytes(),
        ));
    }
    with_header(header, separator, lines.line(), options)
}

/// Refuses a line with too many fields before they take memory.
fn check_width(separator: Separator, line: &[u8], number: u64) -> Result<(), ReadError> {
    let most = MAX_FRAME_CELLS + MOST_BESIDE;
    if separator.fields(line).nth(most).is_none() {
        return Ok(());
    }
    let message = format!(
        "more than {} fields, expected at most {MAX_FRAME_SIDE} × {MAX_FRAME_SIDE} cells and {MOST_BESIDE} beside them",
        grouped(most as u64)
    );
    Err(in_line(number, message))
}

/// Reads up to the first line of values below the names of cells. If the line between them holds words, one field for
/// each name, they are units: returns the line's number and its fields.
fn units_below(
    lines: &mut TextLines<impl BufRead>,
    header: &TableHeader<'_>,
    separator: Separator,
) -> Result<Option<(u64, Vec<String>)>, ReadError> {
    let names = &header.names;
    while lines.advance_to_content()? && is_comment(lines.line()) {}
    let fields = separator.fields_of(lines.line(), names.len());
    let fields: Vec<String> = fields.take(names.len() + 1).map(text).collect();
    // A line of values may contain a timestamp or a label of letters, and all its values may be missing.
    let is_value = |field: &String| {
        matches!(separator.value(field.as_bytes()), Field::Value(_))
            || time::read_moment(field.as_bytes()).is_some()
    };
    let is_word = |(field, name): (&String, &&str)| {
        !separator.is_numeric(field.as_bytes()) && role(name) != Some(FieldRole::Label)
    };
    let are_units = fields.iter().zip(names).any(is_word) && !fields.iter().any(is_value);
    if fields.len() != names.len() || !are_units || header.cells.is_none() {
        return Ok(None);
    }
    let units = (lines.number(), fields);
    while lines.advance_to_content()? && is_comment(lines.line()) {}
    Ok(Some(units))
}

/// Finds the arrangement that a header describes; `first` is the first line of values.
fn with_header(
    mut header: TableHeader<'_>,
    separator: Separator,
    first: &[u8],
    options: &ReadOptions,
) -> Result<TableLayout, ReadError> {
    let (named, number) = (header.cells.take(), header.number);
    let roles = roles(&header.names);
    let (size, cells, note) = named_cells(named, &roles, number, options)?;
    let expected = size.cells();
    if cells.len() != expected {
        return Err(text::wrong_count(number, cells.len(), expected));
    }
    // A line may have a quarter of a million names, so cells are looked up by index.
    let count = roles.len();
    let mut is_cell = vec![false; count];
    for &cell in &cells {
        is_cell[cell] = true;
    }
    let others = || {
        let roles = roles.iter().enumerate();
        roles.filter(|&(field, _)| !is_cell[field])
    };
    let label = others().find(|(_, role)| **role == Some(FieldRole::Label));
    let time = header.time(others());
    let fields: Vec<&[u8]> = separator.fields_of(first, count).take(count).collect();
    let below = header.units.as_ref().map(|(number, _)| *number);
    let found = FrameFields {
        count,
        header: below.or(Some(number)),
        label: label.map(|(field, _)| field),
        time,
        cells,
    };
    let unit = header.unit_of_all(&found.cells).map(str::to_owned);
    let lines = LineLayout::Frame(found.with_moment(separator, &fields));
    Ok(TableLayout {
        separator,
        size,
        note,
        unit,
        start: lines.start(&fields),
        lines,
    })
}

/// The size of a frame, the field of each cell, and a note if something was assumed.
type CellFields = (FrameSize, Vec<usize>, Option<RecordingNote>);

/// Returns the cells of a frame, given those that the names describe and the roles of all fields.
///
/// - Names with rows and columns say everything. Given rows and columns must be the same.
/// - Names that only count are arranged in the given rows and columns, otherwise in a square, which is noted.
/// - With other names, all fields are cells except those at the beginning and the end that have a known role.
fn named_cells(
    named: Option<NamedCells>,
    roles: &[Option<FieldRole>],
    number: u64,
    options: &ReadOptions,
) -> Result<CellFields, ReadError> {
    match named {
        Some(NamedCells::Grid(size, fields)) => match options.size {
            Some(asked) if asked != size => {
                let (rows, columns) = (asked.rows(), asked.columns());
                let named = size.in_words();
                let message = format!("the header names {named} cells, not {rows} of {columns}");
                Err(in_line(number, message))
            }
            _ => Ok((size, fields, None)),
        },
        Some(NamedCells::Counted(start, length)) => {
            let fields = (start..start + length).collect();
            if let Some(size) = options.size {
                return Ok((size, fields, None));
            }
            let side = (1..=MAX_FRAME_SIDE).find(|side| usize::from(*side).pow(2) == length);
            let values = length as u64;
            let size = FrameSize::of_sides(side, side).ok_or(unshaped(values, None))?;
            let side = size.rows();
            Ok((size, fields, Some(RecordingNote::Square { side })))
        }
        Some(NamedCells::Incomplete(size, found)) => {
            let found = counted(found as u64, "cell");
            let (size, cells) = (size.in_words(), size.cells());
            let message = format!("the header names {found}, but {size} have {cells}");
            Err(in_line(number, message))
        }
        None => {
            let leading = roles.iter().take_while(|role| role.is_some()).count();
            let trailing = roles.iter().rev().take_while(|role| role.is_some()).count();
            let end = roles.len().saturating_sub(trailing).max(leading);
            let values = (end - leading) as u64;
            let size = options.size.ok_or(unshaped(values, None))?;
            Ok((size, (leading..end).collect(), None))
        }
    }
}

#[derive(Clone, Debug)]
pub(super) struct TableLayout {
    pub(super) separator: Separator,
    pub(super) size: FrameSize,
    pub(super) lines: LineLayout,
    pub(super) note: Option<RecordingNote>,
    pub(super) unit: Option<String>,
    pub(super) start: Option<String>,
}

#[derive(Clone, Debug)]
pub(super) enum LineLayout {
    Frame(FrameFields),
    Row {
        /// Whether an empty line ends a frame; if not, the next frame begins after the number of rows in a frame.
        parted: bool,
    },
}

#[derive(Clone, Debug)]
pub(super) struct FrameFields {
    pub(super) count: usize,
    pub(super) header: Option<u64>,
    pub(super) cells: Vec<usize>,
    pub(super) label: Option<usize>,
    pub(super) time: Option<TimeFields>,
}

/// The arrangement of the table that a followed file held before it was truncated or replaced; empty at first. The
/// program that writes it may continue without a header, in the middle of a line.
#[derive(Debug, Default)]
pub struct EarlierLayout(pub(super) Option<TableLayout>);

impl LineLayout {
    /// Returns the timestamp in the fields of the first frame, as it is written.
    pub(super) fn start(&self, fields: &[&[u8]]) -> Option<String> {
        let Self::Frame(FrameFields { time, .. }) = self else {
            return None;
        };
        let field = *fields.get((*time)?.field)?;
        time::read_moment(field).map(|_| text(field))
    }
}

impl FrameFields {
    /// Adds a timestamp beside the cells as the time, unless a number gives the time; `fields` are those of the first
    /// line.
    pub(super) fn with_moment(mut self, separator: Separator, fields: &[&[u8]]) -> Self {
        let is_moment = |&field: &usize| {
            fields
                .get(field)
                .copied()
                .and_then(time::read_moment)
                .is_some()
        };
        let is_time = |field: usize| {
            let own = fields.get(field);
            own.is_some_and(|own| separator.is_numeric(own)) || is_moment(&field)
        };
        // A column with the name of a time may hold anything, such as a date without a time of day.
        if !self.time.is_some_and(|time| is_time(time.field)) {
            let moment = (0..fields.len()).find(is_moment);
            // An index of timestamps, which pandas writes without a name, is not a label.
            self.label = self.label.filter(|&label| moment != Some(label));
            let moment = moment.map(|field| TimeFields::new(field, None));
            self.time = moment.or(self.time);
        }
        self
    }
}

const COMPARED: u16 = 8;

/// Finds the arrangement of a table without names. Its first lines are in `read`, which begins in line `number` of
/// the file.
pub(super) fn of_numbers(
    lines: &mut TextLines<impl BufRead>,
    separator: Separator,
    (number, read): (u64, &[&[u8]]),
    options: &ReadOptions,
) -> Result<TableLayout, ReadError> {
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
    numeric: Vec<usize>,
    moment: Option<&'a [u8]>,
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
    ) -> Result<TableLayout, ReadError> {
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
                return Err(unsized_line(numbers));
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

    fn frame_fields(
        &self,
        cells: usize,
        number: u64,
        lines: &[Vec<u8>],
    ) -> Result<FrameFields, ReadError> {
        let found = self.numeric.len();
        let beside = found.checked_sub(cells);
        let beside = beside.ok_or_else(|| text::wrong_count(number, found, cells))?;
        let is_moment = |&field: &usize| time::read_moment(self.fields[field]).is_some();
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
                let found = [&lines[..], rest]
                    .map(|own| [counts_up(own, 0, 1), counts_up(own, cells, cells + 1)]);
                match found.into_iter().find(|own| own.contains(&true)) {
                    Some([true, false]) => (2, Some(0), Some((1, None))),
                    Some([false, true]) => {
                        let unit = Some(TimeUnit::Milliseconds);
                        (0, Some(cells), Some((cells + 1, unit)))
                    }
                    _ => return Err(unclear(number, cells, beside)),
                }
            }
            (1 | 2, _) => return Err(unclear(number, cells, beside)),
            _ => return Err(text::wrong_count(number, found, cells)),
        };
        let cells = &self.numeric[start..start + cells];
        if let Some(pair) = cells.windows(2).find(|pair| pair[1] - pair[0] > 1) {
            // A text between two cells belongs neither to them nor beside them.
            let text = pair[0] + 1;
            return Err(text::wrong_field(number, text + 1, self.fields[text]));
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

/// Returns true if one field counts up by 1 from line to line, in whole numbers, and another never falls and is not
/// the same in all lines.
fn counts_up(lines: &[Vec<f64>], label: usize, time: usize) -> bool {
    let is_next = |pair: &[Vec<f64>]| {
        pair[1][label] == pair[0][label] + 1.0 && pair[1][time] >= pair[0][time]
    };
    let [first, .., last] = lines else {
        return true;
    };
    let rises = last[time] > first[time];
    whole(first[label]).is_some() && rises && lines.windows(2).all(is_next)
}

fn unclear(number: u64, cells: usize, beside: usize) -> ReadError {
    let beside = counted(beside as u64, "number");
    let message = format!(
        "found {beside} besides the {cells} cells, and cannot tell which: add a header line, such as frame,time,r0c0"
    );
    in_line(number, message)
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
) -> Result<(u16, bool), ReadError> {
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
