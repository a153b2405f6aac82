//! Finds how a table of numbers is arranged: which fields are cells, and what the other fields are.
//!
//! A header names the cells, see [`cell_names`](super::cell_names). Without a header, the rows and columns must be
//! given, unless the table consists of blocks with one row per line; numbers beside the cells are then recognised by
//! how they grow from line to line, see [`unnamed_fields`](super::unnamed_fields). A timestamp is the time of its
//! frame, unless a column of numbers gives the time; other texts are ignored.

use std::io::{BufRead, Seek};

use crate::formats::recording::error::RecordingError;
use crate::formats::recording::event::{ReadOptions, RecordingNote};
use crate::formats::recording::side::side;
use crate::formats::recording::table::cell_names::NamedCells;
use crate::formats::recording::table::clock::TimeFields;
use crate::formats::recording::table::header::{
    COMPARED, MOST_BESIDE, TableHeader, first_line, is_like_next, is_mostly_numeric, is_ramp,
    moment_of_row, wrong_value,
};
use crate::formats::recording::table::unnamed_fields::{unclear, unnamed_fields};
use crate::formats::recording::text::lines::{TextLines, is_blank, text};
use crate::formats::recording::text::row::{self, Field};
use crate::formats::recording::text::separator::{Separator, is_comment};
use crate::formats::recording::time::field_role::{FieldRole, role, roles};
use crate::formats::recording::time::moment::{self, DecimalCommas};
use crate::frame::{FrameSize, MAX_FRAME_CELLS, MAX_FRAME_SIDE};
use crate::parameter::number::{counted, grouped};

/// The arrangement of a table.
#[derive(Clone, Debug)]
pub(super) struct TableLayout {
    /// The separator between fields, in all lines.
    pub(super) separator: Separator,
    /// The size of a frame.
    pub(super) size: FrameSize,
    /// The content of a line.
    pub(super) lines: LineLayout,
    /// The assumption that was made, if any.
    pub(super) note: Option<RecordingNote>,
    /// The unit of the cells, if a line below their names gives it.
    pub(super) unit: Option<String>,
    /// The timestamp of the first frame as it is written, if lines have a timestamp.
    pub(super) start: Option<String>,
}

/// The content of a line of a table.
#[derive(Clone, Debug)]
pub(super) enum LineLayout {
    /// A frame.
    Frame(FrameFields),
    /// A row of a frame.
    Row {
        /// Whether an empty line ends a frame; if not, the next frame begins after the number of rows in a frame.
        parted: bool,
    },
}

/// The fields of a line that is a frame.
#[derive(Clone, Debug)]
pub(super) struct FrameFields {
    /// The number of fields in a line.
    pub(super) count: usize,
    /// The last line of the header, if there is one.
    pub(super) header: Option<u64>,
    /// The field of each cell, row by row.
    pub(super) cells: Vec<usize>,
    /// The field with the frame's label.
    pub(super) label: Option<usize>,
    /// The fields with the time.
    pub(super) time: Option<TimeFields>,
}

/// The arrangement of the table that a followed file held before it was truncated or replaced; empty at first. The
/// program that writes it may continue without a header, in the middle of a line.
#[derive(Debug, Default)]
pub(crate) struct EarlierLayout(pub(super) Option<TableLayout>);

impl TableLayout {
    /// Returns the arrangement of the lines that continue the table without a header.
    pub(super) fn continued(&self) -> Self {
        let mut continued = self.clone();
        continued.note = None;
        if let LineLayout::Frame(fields) = &mut continued.lines {
            fields.header = None;
        }
        continued
    }
}

/// Finds the arrangement of a table from its first lines.
///
/// # Errors
/// Returns [`RecordingError::Unknown`] if it is not a table, and [`RecordingError::Shape`] or
/// [`RecordingError::Columns`] if rows and columns must be given.
pub(super) fn layout(
    input: &mut (impl BufRead + Seek),
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
    input: &mut (impl BufRead + Seek),
    options: ReadOptions,
) -> Result<TableLayout, RecordingError> {
    layout_or(input, options, |_, _, _| Err(RecordingError::Unknown))
}

/// Finds the arrangement of a table from its header, or with `unnamed` if it has none: it gets the lines behind those
/// that were read, the separator, and the number of the first line with the lines that were read.
fn layout_or<R: BufRead + Seek>(
    input: &mut R,
    options: ReadOptions,
    unnamed: impl FnOnce(
        &mut TextLines<&mut R>,
        Separator,
        (u64, &[&[u8]]),
    ) -> Result<TableLayout, RecordingError>,
) -> Result<TableLayout, RecordingError> {
    let mut lines = TextLines::new(&mut *input);
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
    // In ROS echo output, a line of small values can begin like this, too, after its offset.
    let cells = options.size.map(FrameSize::cells);
    let counted = header
        .count_from_0(0)
        .filter(|counted| cells.is_none_or(|cells| cells == *counted));
    let is_header = if has_words {
        moment_of_row(separator, &first).is_none()
    } else {
        counted.is_some() && !is_ramp(&mut lines, separator, &first)?
    };
    // The test for a ramp has read beyond the first line.
    if counted.is_some() {
        input.rewind()?;
        lines = TextLines::new(input);
        first_line(&mut lines)?;
    }
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

/// Finds the arrangement of a table without names. Its first lines are in `read`, which begins in line `number` of
/// the file.
///
/// If commas separate the fields, the comma in a timestamp may be one of them or a decimal sign: the arrangement that
/// has the right number of fields decides.
fn of_numbers(
    lines: &mut TextLines<impl BufRead>,
    separator: Separator,
    (number, read): (u64, &[&[u8]]),
    options: ReadOptions,
) -> Result<TableLayout, RecordingError> {
    let size = options.size;
    let other = Some(Separator::FieldComma).filter(|_| separator == Separator::Byte(b','));
    let needed = |own| UnnamedFirst::new(own, read[0], size).lines_needed(size);
    let enough = other.map_or(0, needed).max(needed(separator));
    let mut compared: Vec<Vec<u8>> = read.iter().map(|line| line.to_vec()).collect();
    let (block, parted) = first_block(lines, (read.len(), enough), |line| {
        compared.push(line.to_owned());
    })?;
    let mut commas = DecimalCommas::default();
    for line in &compared {
        commas.compare(line);
    }
    let other = other.filter(|_| commas.are_possible());
    let of = |separator| {
        let first = UnnamedFirst::new(separator, read[0], size);
        first.layout(number, &compared, (block, parted), size)
    };
    match (of(separator), other.map(of)) {
        (Ok(plain), Some(Ok(other))) => either(plain, other, number, &compared, size),
        // In a single line, another number may stand beside the cells.
        (Err(_), Some(Ok(other))) if compared.len() > 1 => Ok(other),
        (plain, _) => plain,
    }
}

/// Returns one of two arrangements of the same lines; in the second, a comma is the decimal sign of a timestamp. The
/// second is right if the first takes the number behind the comma for nothing but a time, or if the time that the first
/// finds never changes.
///
/// # Errors
/// Returns an error if both are possible.
fn either(
    plain: TableLayout,
    other: TableLayout,
    number: u64,
    lines: &[Vec<u8>],
    size: Option<FrameSize>,
) -> Result<TableLayout, RecordingError> {
    let (LineLayout::Frame(own), LineLayout::Frame(_)) = (&plain.lines, &other.lines) else {
        let numbers = plain.size.columns().into();
        return size
            .map(|_| plain)
            .ok_or(RecordingError::Columns { numbers });
    };
    let separator = plain.separator;
    let is_still = own.time.is_some_and(|time| {
        let mut times = lines
            .iter()
            .map(|line| separator.fields(line).nth(time.field));
        let first = times.next().flatten();
        first.is_some_and(|first| separator.is_numeric(first)) && times.all(|time| time == first)
    });
    let mut fields = other.separator.fields(&lines[0]);
    let digits = fields.position(|field| field.contains(&b',') && moment::read(field).is_some());
    let digits = digits.map(|moment| moment + 1);
    let is_digits = |field: &usize| Some(*field) == digits;
    if !is_still && own.cells.iter().chain(&own.label).any(is_digits) {
        let fields = separator.fields(&lines[0]);
        let numbers = fields.filter(|field| separator.is_numeric(field));
        let (cells, numbers) = (own.cells.len(), numbers.count());
        return Err(unclear(number, cells, numbers.saturating_sub(cells)));
    }
    Ok(other)
}

/// The first line of a table without names.
struct UnnamedFirst<'a> {
    /// The separator between its fields.
    separator: Separator,
    /// Its fields.
    fields: Vec<&'a [u8]>,
    /// The indices of the numbers among them.
    numeric: Vec<usize>,
    /// The timestamp at its beginning.
    moment: Option<&'a [u8]>,
    /// The number of columns, if it is the row of a frame.
    width: Option<u16>,
}

impl<'a> UnnamedFirst<'a> {
    /// Reads the line; frames have the given size.
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
            Some(size) => match self.numeric.len().checked_sub(size.cells()) {
                Some(1 | 2) => COMPARED,
                _ => 2,
            },
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
    ///
    /// # Errors
    /// Returns an error if the lines do not show which fields are cells, or if rows and columns must be given.
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
                let lines: Vec<Vec<f64>> = lines.iter().map(|line| self.numbers_in(line)).collect();
                let (fields, numeric) = (&self.fields, &self.numeric);
                // Numbers before a timestamp are not cells.
                let moment = (0..fields.len()).find(|&field| moment::read(fields[field]).is_some());
                let before = |&&field: &&usize| moment.is_some_and(|moment| field < moment);
                let before = numeric.iter().filter(before).count();
                let found = FrameFields::unnamed(size, number, (&lines, before))?;
                let found = found.among(numeric, fields, number)?;
                let found = found.with_moment(self.separator, fields);
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

impl LineLayout {
    /// Returns the timestamp in the fields of the first frame, as it is written.
    fn start(&self, fields: &[&[u8]]) -> Option<String> {
        let Self::Frame(FrameFields { time, .. }) = self else {
            return None;
        };
        let field = *fields.get((*time)?.field)?;
        let is_start = moment::read(field).is_some() && !moment::is_duration(field);
        is_start.then(|| text(field))
    }
}

impl FrameFields {
    /// Finds the fields of lines of numbers without names, the first of them in line `number`. The first `before`
    /// numbers of a line are not cells if other numbers follow.
    ///
    /// # Errors
    /// Returns an error if the lines do not show which fields are cells.
    fn unnamed(
        size: FrameSize,
        number: u64,
        (lines, before): (&[Vec<f64>], usize),
    ) -> Result<Self, RecordingError> {
        let cells = size.cells();
        let found = unnamed_fields((cells, before), number, lines)?;
        Ok(Self {
            count: lines[0].len(),
            header: None,
            cells: (found.start..found.start + cells).collect(),
            label: found.label,
            time: found.time,
        })
    }

    /// Adds a timestamp beside the cells as the time, unless a number gives the time; `fields` are those of the first
    /// line.
    fn with_moment(mut self, separator: Separator, fields: &[&[u8]]) -> Self {
        let is_moment =
            |&field: &usize| fields.get(field).copied().and_then(moment::read).is_some();
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

    /// Converts fields that were found among numbers alone to those of lines that also contain texts: `fields` are
    /// those of line `number`, and `numeric` are the indices of the numbers among them.
    ///
    /// # Errors
    /// Returns an error if there is a text between two cells: it belongs neither to them nor beside them.
    fn among(
        self,
        numeric: &[usize],
        fields: &[&[u8]],
        number: u64,
    ) -> Result<Self, RecordingError> {
        let cells: Vec<usize> = self.cells.iter().map(|&cell| numeric[cell]).collect();
        if let Some(pair) = cells.windows(2).find(|pair| pair[1] - pair[0] > 1) {
            let text = pair[0] + 1;
            return Err(row::wrong(number, text + 1, fields[text]));
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
    let fits = |separator: Separator| separator.fields_of(first, count).count() == count;
    // The names say whether a comma is the decimal sign of a timestamp.
    let is_decimal = separator == Separator::Byte(b',') && !fits(separator);
    let decimal = Some(Separator::FieldComma).filter(|&own| is_decimal && fits(own));
    let separator = decimal.unwrap_or(separator);
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
