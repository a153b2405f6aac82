//! Finds how a table of numbers is arranged: which fields are cells, and what the other fields are.
//!
//! A header names the cells, see [`cell_names`](super::cell_names). Without a header, the rows and columns must be
//! given, unless the table consists of blocks with one row per line, see [`unnamed`](super::unnamed). A timestamp is the
//! time of its frame, unless a column of numbers gives the time; other texts are ignored.

use std::io::BufRead;

use crate::formats::recording::error::RecordingError;
use crate::formats::recording::event::{ReadOptions, RecordingNote};
use crate::formats::recording::table::arrangement::{FrameFields, LineLayout, TableLayout};
use crate::formats::recording::table::cell_names::NamedCells;
use crate::formats::recording::table::header::{
    MOST_BESIDE, TableHeader, first_line, is_like_next, is_mostly_numeric, moment_of_row,
    wrong_value,
};
use crate::formats::recording::table::unnamed::of_numbers;
use crate::formats::recording::text::lines::{TextLines, text};
use crate::formats::recording::text::row::{self, Field};
use crate::formats::recording::text::separator::{Separator, is_comment};
use crate::formats::recording::time::field_role::{FieldRole, role, roles};
use crate::formats::recording::time::moment;
use crate::frame::{FrameSize, MAX_FRAME_CELLS, MAX_FRAME_SIDE};
use crate::parameter::number::{counted, grouped};

/// Finds the arrangement of a table from its first lines.
///
/// # Errors
/// Returns [`RecordingError::Unknown`] if it is not a table, and [`RecordingError::Shape`] or
/// [`RecordingError::Columns`] if rows and columns must be given.
pub(super) fn layout(
    input: &mut impl BufRead,
    options: ReadOptions,
) -> Result<TableLayout, RecordingError> {
    layout_or(input, options, |lines, separator, read| {
        of_numbers(lines, separator, read, options)
    })
}

/// Finds the arrangement of a table with a header.
///
/// # Errors
/// Returns the errors of [`layout`], and [`RecordingError::Unknown`] if there is no header.
pub(super) fn layout_with_header(
    input: &mut impl BufRead,
    options: ReadOptions,
) -> Result<TableLayout, RecordingError> {
    layout_or(input, options, |_, _, _| Err(RecordingError::Unknown))
}

/// Finds the arrangement of a table from its header, or with `unnamed` if it has none: it gets the lines behind those
/// that were read, the separator, and the number of the first line with the lines that were read.
fn layout_or<R: BufRead>(
    input: &mut R,
    options: ReadOptions,
    unnamed: impl FnOnce(
        &mut TextLines<&mut R>,
        Separator,
        (u64, &[&[u8]]),
    ) -> Result<TableLayout, RecordingError>,
) -> Result<TableLayout, RecordingError> {
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
        return Err(RecordingError::Unknown);
    }
    if has_words && header.units.is_none() && is_like_next(&header, separator, lines.line()) {
        let next = lines.line().to_owned();
        return unnamed(&mut lines, separator, (number, &[&first, &next]));
    }
    if let Some(field) = wrong_value(&header, separator) {
        return Err(row::wrong(
            number,
            field + 1,
            header.names[field].as_bytes(),
        ));
    }
    with_header(header, separator, lines.line(), options)
}

/// Refuses a line with too many fields before they take memory.
fn check_width(separator: Separator, line: &[u8], number: u64) -> Result<(), RecordingError> {
    let most = MAX_FRAME_CELLS + MOST_BESIDE;
    if separator.fields(line).nth(most).is_none() {
        return Ok(());
    }
    let message = format!(
        "more than {} fields, expected at most {MAX_FRAME_SIDE} × {MAX_FRAME_SIDE} cells and {MOST_BESIDE} beside them",
        grouped(most as u64)
    );
    Err(RecordingError::in_line(number, message))
}

/// Reads up to the first line of values below the names of cells. If the line between them holds words, one field for
/// each name, they are units: returns the line's number and its fields.
fn units_below(
    lines: &mut TextLines<impl BufRead>,
    header: &TableHeader<'_>,
    separator: Separator,
) -> Result<Option<(u64, Vec<String>)>, RecordingError> {
    let names = &header.names;
    while lines.advance_to_content()? && is_comment(lines.line()) {}
    let fields = separator.fields_of(lines.line(), names.len());
    let fields: Vec<String> = fields.take(names.len() + 1).map(text).collect();
    // A line of values may contain a timestamp or a label of letters, and all its values may be missing.
    let is_value = |field: &String| {
        matches!(separator.value(field.as_bytes()), Field::Value(_))
            || moment::read(field.as_bytes()).is_some()
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
///
/// # Errors
/// Returns an error if the names are those of another number of rows and columns than the given one.
fn with_header(
    mut header: TableHeader<'_>,
    separator: Separator,
    first: &[u8],
    options: ReadOptions,
) -> Result<TableLayout, RecordingError> {
    let (named, number) = (header.cells.take(), header.number);
    let roles = roles(&header.names);
    let (size, cells, note) = named_cells(named, &roles, number, options)?;
    let expected = size.cells();
    if cells.len() != expected {
        return Err(row::count(number, cells.len(), expected));
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
    options: ReadOptions,
) -> Result<CellFields, RecordingError> {
    match named {
        Some(NamedCells::Grid(size, fields)) => match options.size {
            Some(asked) if asked != size => {
                let (rows, columns) = (asked.rows(), asked.columns());
                let named = size.in_words();
                let message = format!("the header names {named} cells, not {rows} of {columns}");
                Err(RecordingError::in_line(number, message))
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
            let size = FrameSize::of_sides(side, side).ok_or(RecordingError::Shape { values })?;
            let side = size.rows();
            Ok((size, fields, Some(RecordingNote::Square { side })))
        }
        Some(NamedCells::Incomplete(size, found)) => {
            let found = counted(found as u64, "cell");
            let (size, cells) = (size.in_words(), size.cells());
            let message = format!("the header names {found}, but {size} have {cells}");
            Err(RecordingError::in_line(number, message))
        }
        None => {
            let leading = roles.iter().take_while(|role| role.is_some()).count();
            let trailing = roles.iter().rev().take_while(|role| role.is_some()).count();
            let end = roles.len().saturating_sub(trailing).max(leading);
            let values = (end - leading) as u64;
            let size = options.size.ok_or(RecordingError::Shape { values })?;
            Ok((size, (leading..end).collect(), None))
        }
    }
}
