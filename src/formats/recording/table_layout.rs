//! How a table of numbers is arranged: where its cells are, and what else stands in its lines.
//!
//! A header names the cells, see [`cell_names`](super::cell_names). Without one, rows and columns have to be known
//! beforehand, unless the table is in blocks of a row a line; numbers beside the cells are then recognised by how they grow
//! from line to line, see [`unnamed_fields`](super::unnamed_fields). A timestamp is the time of its frame unless a column of
//! numbers gives the time; other texts are ignored.

use std::io::{BufRead, Seek};

use crate::formats::recording::cell_names::{
    FieldRole, NamedCells, cells, rest_of_second, role, roles,
};
use crate::formats::recording::error::RecordingError;
use crate::formats::recording::event::{ReadOptions, RecordingNote};
use crate::formats::recording::frame_time::TimeFields;
use crate::formats::recording::lines::{TextLines, is_blank, text};
use crate::formats::recording::moment;
use crate::formats::recording::separator::Separator;
use crate::formats::recording::side::side;
use crate::formats::recording::text_row;
use crate::formats::recording::unnamed_fields::unnamed_fields;
use crate::frame::MAX_FRAME_SIDE;
use crate::parameter::number::{counted, grouped};

/// Lines that are compared to find what stands beside the cells where nothing names it.
const COMPARED: u16 = 8;

/// The most cells of a frame.
const MOST_CELLS: usize = MAX_FRAME_SIDE as usize * MAX_FRAME_SIDE as usize;

/// The most fields that may stand beside them. A line of more is refused before its fields take memory.
const MOST_BESIDE: usize = 16;

/// How a table is arranged.
#[derive(Debug)]
pub(super) struct TableLayout {
    /// What parts fields, in all lines.
    pub(super) separator: Separator,
    /// Rows and columns of a frame.
    pub(super) shape: (u16, u16),
    /// What a line holds.
    pub(super) lines: LineLayout,
    /// What was assumed, if anything.
    pub(super) note: Option<RecordingNote>,
    /// The timestamp of the first frame as it is written, if lines have one.
    pub(super) start: Option<String>,
}

/// What a line of a table holds.
#[derive(Debug)]
pub(super) enum LineLayout {
    /// A frame.
    Frame(FrameFields),
    /// A row; whether an empty line ends a frame.
    Row {
        /// If not, the next frame begins after as many rows as a frame has.
        parted: bool,
    },
}

/// The fields of a line that is a frame.
#[derive(Debug)]
pub(super) struct FrameFields {
    /// How many fields a line has.
    pub(super) count: usize,
    /// The line with the names.
    pub(super) header: Option<u64>,
    /// The field of each cell, row by row.
    pub(super) cells: Vec<usize>,
    /// The field with what the recording calls the frame.
    pub(super) label: Option<usize>,
    /// The fields with the time.
    pub(super) time: Option<TimeFields>,
}

/// Whether a line is a comment, wherever it stands; or the line in which spreadsheet programs name their separator, `sep=;`.
pub(super) fn is_comment(line: &[u8]) -> bool {
    let line = line.trim_ascii();
    line.starts_with(b"#") || matches!(line, [b's', b'e', b'p', b'=', _])
}

/// Finds out how the table is arranged, from its first lines.
///
/// # Errors
/// [`RecordingError::Unknown`] of what is not a table; [`RecordingError::Shape`] if rows and columns have to be named.
pub(super) fn layout(
    input: &mut (impl BufRead + Seek),
    options: ReadOptions,
) -> Result<TableLayout, RecordingError> {
    let mut lines = TextLines::new(&mut *input);
    let first = first_line(&mut lines)?;
    let separator = Separator::of(&first);
    let number = lines.number();
    if separator
        .fields(&first)
        .nth(MOST_CELLS + MOST_BESIDE)
        .is_some()
    {
        let message = format!(
            "more than {} fields, expected at most {MAX_FRAME_SIDE} × {MAX_FRAME_SIDE} cells and {MOST_BESIDE} beside them",
            grouped((MOST_CELLS + MOST_BESIDE) as u64)
        );
        return Err(RecordingError::in_line(number, message));
    }
    let names: Vec<String> = separator.fields(&first).map(text).collect();
    let names: Vec<&str> = names.iter().map(String::as_str).collect();
    let has_words = names
        .iter()
        .any(|name| !separator.is_numeric(name.as_bytes()));
    // Of an echo of ROS, a line of small values begins so, too, behind its offset.
    let cells = options
        .shape
        .map(|(rows, columns)| usize::from(rows) * usize::from(columns));
    let counted =
        count_from_0(&names).filter(|counted| cells.is_none_or(|cells| cells == *counted));
    let is_header = if has_words {
        moment_of_row(separator, &first).is_none()
    } else {
        counted.is_some() && !is_ramp(&mut lines, separator, &first)?
    };
    // Lines have been read beyond the first one.
    if counted.is_some() {
        input.rewind()?;
        lines = TextLines::new(input);
        first_line(&mut lines)?;
    }
    if !is_header {
        return of_numbers(&mut lines, separator, (number, &[&first]), options);
    }
    while lines.advance_to_content()? && is_comment(lines.line()) {}
    // Words above words are not a table.
    if !is_mostly_numeric(separator, lines.line()) {
        return Err(RecordingError::Unknown);
    }
    if has_words && is_like_next(&names, separator, lines.line()) {
        let next = lines.line().to_owned();
        return of_numbers(&mut lines, separator, (number, &[&first, &next]), options);
    }
    with_header(&names, separator, (number, lines.line()), options)
}

/// The first line that is neither blank nor a comment.
///
/// # Errors
/// [`RecordingError::Unknown`] if there is none.
fn first_line(lines: &mut TextLines<impl BufRead>) -> Result<Vec<u8>, RecordingError> {
    while lines.advance_to_content()? && is_comment(lines.line()) {}
    let first = lines.line();
    if is_blank(first) || is_comment(first) {
        return Err(RecordingError::Unknown);
    }
    Ok(first.to_owned())
}

/// The moment at the beginning of a line of numbers and nothing else, as it is written, and these numbers.
fn moment_of_row(separator: Separator, line: &[u8]) -> Option<(&[u8], &[u8])> {
    let (_, row) = moment::leading(line)?;
    let moment = line[..line.len() - row.len()].trim_ascii();
    let moment = moment.strip_suffix(b",").unwrap_or(moment);
    let moment = moment.strip_suffix(b";").unwrap_or(moment);
    let mut fields = separator.fields(row);
    fields
        .all(|field| separator.is_numeric(field))
        .then_some((moment.trim_ascii(), row))
}

/// Whether a first line 0, 1, 2, … has values, as of a test pattern, and not the names of cells. It has if the next line
/// counts on, if one of the next lines is the same, or if it begins the first of two blocks of as many lines.
fn is_ramp(
    lines: &mut TextLines<impl BufRead>,
    separator: Separator,
    first: &[u8],
) -> Result<bool, RecordingError> {
    let width = separator.fields(first).count();
    let first = separator.numbers(first, width);
    let next: Vec<f64> = first
        .iter()
        .map(|value| value + first.len() as f64)
        .collect();
    let (mut heights, mut height, mut compared) = (Vec::new(), 1_u16, 0_u16);
    while heights.len() < 2 && height < COMPARED {
        let is_end = !lines.advance()?;
        if is_end || is_blank(lines.line()) {
            heights.extend((height > 0).then(|| std::mem::take(&mut height)));
            if is_end {
                break;
            }
        } else if !is_comment(lines.line()) {
            let own = separator.numbers(lines.line(), width + 1);
            if own == first || own == next && compared == 0 {
                return Ok(true);
            }
            height += 1;
            compared += 1;
        }
    }
    Ok(matches!(heights[..], [first, second] if first == second && first > 1))
}

/// How many cells are named, if names are those of cells and nothing else, counted from 0; pandas writes an empty one before
/// them, above its index.
fn count_from_0(names: &[&str]) -> Option<usize> {
    let names = names.strip_prefix(&[""]).unwrap_or(names);
    let all = matches!(cells(names), Some(NamedCells::Counted(0, length)) if length == names.len());
    (names.first() == Some(&"0") && all).then_some(names.len())
}

/// Whether a line with words is a frame like the next line, with a date or a label beside its cells: words and numbers stand
/// in the same fields. Otherwise it has the names of the fields, such as `label,0,1,2,3` above `cup,7,5,9,3`: its numbers
/// count, from 0 or beside a word that is a usual name.
fn is_like_next(names: &[&str], separator: Separator, next: &[u8]) -> bool {
    let next = separator.fields_of(next, names.len());
    let next: Vec<&[u8]> = next.take(names.len() + 1).collect();
    let is_word = |field: &[u8]| !separator.is_numeric(field);
    let mut pairs = names.iter().zip(&next);
    let same = pairs.all(|(own, next)| is_word(own.as_bytes()) == is_word(next));
    if next.len() != names.len() || !same {
        return false;
    }
    let words = || {
        let pairs = names.iter().zip(&next);
        pairs.filter(|(_, next)| is_word(next))
    };
    let repeats = words().all(|(own, next)| own.as_bytes() == *next);
    let is_name = |name: &str| name.starts_with(char::is_alphabetic) && role(name).is_some();
    let is_named = words().any(|(own, _)| is_name(own));
    let numbers = names.len() - words().count();
    let counts = matches!(
        cells(names),
        Some(NamedCells::Counted(start, length)) if length == numbers && (names[start] == "0" || is_named)
    );
    repeats || !counts
}

/// Whether a line has numbers in half of its fields or more.
fn is_mostly_numeric(separator: Separator, line: &[u8]) -> bool {
    let (mut all, mut numeric) = (0, 0);
    for field in separator.fields(line) {
        all += 1;
        numeric += usize::from(separator.is_numeric(field));
    }
    numeric > 0 && 2 * numeric >= all
}

/// The arrangement of a table without names, whose first lines are `read`, the first of them in line `number` of the file.
///
/// A line is a row if it has as many fields as a frame has columns, or if nothing is known beforehand and an empty line
/// ends the first block. Otherwise, and if there are texts in it, it is a frame.
fn of_numbers(
    lines: &mut TextLines<impl BufRead>,
    separator: Separator,
    (number, read): (u64, &[&[u8]]),
    options: ReadOptions,
) -> Result<TableLayout, RecordingError> {
    let fields: Vec<&[u8]> = separator.fields(read[0]).collect();
    let numeric = (0..fields.len()).filter(|&field| separator.is_numeric(fields[field]));
    let numeric: Vec<usize> = numeric.collect();
    let numbers = |line: &[u8]| -> Vec<f64> {
        let all = separator.numbers(line, fields.len());
        let of_field = |&field: &usize| all.get(field).copied().unwrap_or(f64::NAN);
        numeric.iter().map(of_field).collect()
    };
    let values = numeric.len();
    let moment = moment_of_row(separator, read[0]);
    let width = match moment {
        Some((_, row)) => side(separator.fields(row).count()),
        None => side(values).filter(|_| values == fields.len()),
    };
    let enough = lines_needed(options.shape, width, values);
    let mut compared: Vec<Vec<f64>> = read.iter().map(|line| numbers(line)).collect();
    let (mut block, mut parted) = (if read.len() > 1 { 2_u16 } else { 1 }, false);
    while block < enough && lines.advance()? {
        if is_blank(lines.line()) {
            parted = true;
            break;
        }
        if is_comment(lines.line()) {
            continue;
        }
        if block < COMPARED {
            compared.push(numbers(lines.line()));
        }
        block += 1;
    }
    let (shape, lines) = match (options.shape, width) {
        (Some(shape), Some(width)) if width == shape.1 && shape.0 > 1 => {
            (shape, LineLayout::Row { parted })
        }
        (Some(shape), _) => {
            let cells = usize::from(shape.0) * usize::from(shape.1);
            let found = unnamed_fields(cells, number, &compared)?;
            let found = FrameFields {
                count: numeric.len(),
                header: None,
                cells: (found.start..found.start + cells).collect(),
                label: found.label,
                time: found.time,
            };
            let found = found.among(&numeric, &fields, number)?;
            (
                shape,
                LineLayout::Frame(found.with_moment(separator, &fields)),
            )
        }
        (None, Some(width)) if parted && block > 1 => ((block, width), LineLayout::Row { parted }),
        (None, _) => {
            let values = values as u64;
            return Err(RecordingError::Shape { values });
        }
    };
    let start = match lines {
        LineLayout::Row { .. } => moment.map(|(moment, _)| text(moment)),
        LineLayout::Frame(_) => lines.start(&fields),
    };
    Ok(TableLayout {
        separator,
        shape,
        start,
        lines,
        note: None,
    })
}

/// How many lines are needed to decide how a table without names is arranged, given its rows and columns, the width of a row
/// and the numbers in its first line. A growing file is read no further than that.
fn lines_needed(shape: Option<(u16, u16)>, width: Option<u16>, values: usize) -> u16 {
    let cells = |(rows, columns)| usize::from(rows) * usize::from(columns);
    match (shape, width) {
        (Some((rows, columns)), Some(width)) if width == columns && rows > 1 => rows + 1,
        (Some(shape), _) => match values.checked_sub(cells(shape)) {
            Some(1 | 2) => COMPARED,
            _ => 2,
        },
        (None, _) => MAX_FRAME_SIDE + 1,
    }
}

impl LineLayout {
    /// The moment in the fields of the first frame, as it is written.
    fn start(&self, fields: &[&[u8]]) -> Option<String> {
        let Self::Frame(FrameFields { time, .. }) = self else {
            return None;
        };
        let field = *fields.get((*time)?.field)?;
        moment::read(field).is_some().then(|| text(field))
    }
}

impl FrameFields {
    /// These fields, whose first line has such `fields`, with a timestamp beside the cells as the time, unless a number
    /// gives the time.
    fn with_moment(mut self, separator: Separator, fields: &[&[u8]]) -> Self {
        let is_moment =
            |&field: &usize| fields.get(field).copied().and_then(moment::read).is_some();
        let is_time = |field: usize| {
            let own = fields.get(field);
            own.is_some_and(|own| separator.is_numeric(own)) || is_moment(&field)
        };
        // A column of that name may hold anything, such as a date without a clock.
        if !self.time.is_some_and(|time| is_time(time.field)) {
            let moment = (0..fields.len()).find(is_moment);
            let moment = moment.map(|field| TimeFields::new(field, None));
            self.time = moment.or(self.time);
        }
        self
    }

    /// These fields of numbers alone, as fields of lines that have texts, too: the numbers of line `number` are in those of
    /// its `fields` that `numeric` names.
    ///
    /// # Errors
    /// If there is a text among the cells: it is none of them, and none of what stands beside them.
    fn among(
        self,
        numeric: &[usize],
        fields: &[&[u8]],
        number: u64,
    ) -> Result<Self, RecordingError> {
        let cells: Vec<usize> = self.cells.iter().map(|&cell| numeric[cell]).collect();
        if let Some(pair) = cells.windows(2).find(|pair| pair[1] - pair[0] > 1) {
            let text = pair[0] + 1;
            return Err(text_row::wrong(number, text + 1, fields[text]));
        }
        Ok(Self {
            count: fields.len(),
            header: self.header,
            cells,
            label: self.label.map(|label| numeric[label]),
            time: self.time.map(|time| TimeFields {
                field: numeric[time.field],
                ..time
            }),
        })
    }
}

/// The arrangement that the names in line `number` describe, above the first line of values.
///
/// # Errors
/// If the names are those of another number of rows and columns than was asked for.
fn with_header(
    names: &[&str],
    separator: Separator,
    (number, first): (u64, &[u8]),
    options: ReadOptions,
) -> Result<TableLayout, RecordingError> {
    let roles = roles(names);
    let (shape, cells, note) = named_cells(names, &roles, number, options)?;
    let expected = usize::from(shape.0) * usize::from(shape.1);
    if cells.len() != expected {
        return Err(text_row::count(number, cells.len(), expected));
    }
    // A line may have a quarter of a million names.
    let mut is_cell = vec![false; names.len()];
    for &cell in &cells {
        is_cell[cell] = true;
    }
    let others = || {
        let roles = roles.iter().enumerate();
        roles.filter(|&(field, _)| !is_cell[field])
    };
    let label = others().find(|(_, role)| **role == Some(FieldRole::Label));
    let time = others().find_map(|(field, role)| match role {
        Some(FieldRole::Time(unit)) => Some(TimeFields::new(field, *unit)),
        _ => None,
    });
    // Its first column may be either part of a time in two columns.
    let mut in_two = others().filter_map(|(field, role)| match role {
        Some(FieldRole::Time(unit)) => Some(TimeFields {
            field,
            unit: *unit,
            rest: Some(rest_of_second(names, field)?),
        }),
        _ => None,
    });
    let is_part = |of: &TimeFields, field| {
        of.field == field || of.rest.is_some_and(|(rest, _)| rest == field)
    };
    let time = time.map(|first| {
        in_two
            .find(|own| is_part(own, first.field))
            .unwrap_or(first)
    });
    let fields = separator.fields_of(first, names.len());
    let fields: Vec<&[u8]> = fields.take(names.len()).collect();
    let found = FrameFields {
        count: names.len(),
        header: Some(number),
        label: label.map(|(field, _)| field),
        time,
        cells,
    };
    let lines = LineLayout::Frame(found.with_moment(separator, &fields));
    Ok(TableLayout {
        separator,
        shape,
        note,
        start: lines.start(&fields),
        lines,
    })
}

/// Rows and columns, the field of each cell, and what was assumed to find them.
type CellFields = ((u16, u16), Vec<usize>, Option<RecordingNote>);

/// The cells that names describe.
///
/// - Names of rows and columns say all. Rows and columns that are asked for must be the same.
/// - Names that only count are taken as the rows and columns that are asked for, else as a square, which is noted.
/// - Other names: all fields between those at the beginning and at the end which have a known role.
fn named_cells(
    names: &[&str],
    roles: &[Option<FieldRole>],
    number: u64,
    options: ReadOptions,
) -> Result<CellFields, RecordingError> {
    match cells(names) {
        Some(NamedCells::Grid(rows, columns, fields)) => match options.shape {
            Some((asked_rows, asked_columns)) if (asked_rows, asked_columns) != (rows, columns) => {
                let rows = counted(rows, "row");
                let message = format!(
                    "the header names {rows} of {columns} cells, not {asked_rows} of {asked_columns}"
                );
                Err(RecordingError::in_line(number, message))
            }
            _ => Ok(((rows, columns), fields, None)),
        },
        Some(NamedCells::Counted(start, length)) => {
            let fields = (start..start + length).collect();
            if let Some(shape) = options.shape {
                return Ok((shape, fields, None));
            }
            let side = (1..=MAX_FRAME_SIDE).find(|side| usize::from(*side).pow(2) == length);
            let values = length as u64;
            let side = side.ok_or(RecordingError::Shape { values })?;
            Ok(((side, side), fields, Some(RecordingNote::Square { side })))
        }
        Some(NamedCells::Incomplete(rows, columns, found)) => {
            let (found, rows) = (counted(found as u64, "cell"), counted(rows, "row"));
            let message = format!("the header names {found} of {rows} of {columns}");
            Err(RecordingError::in_line(number, message))
        }
        None => {
            let leading = roles.iter().take_while(|role| role.is_some()).count();
            let trailing = roles.iter().rev().take_while(|role| role.is_some()).count();
            let end = names.len().saturating_sub(trailing).max(leading);
            let values = (end - leading) as u64;
            let shape = options.shape.ok_or(RecordingError::Shape { values })?;
            Ok((shape, (leading..end).collect(), None))
        }
    }
}
