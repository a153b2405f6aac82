//! Finds the arrangement of a table without a header: from the number of fields in a line, from empty lines, and from
//! how the numbers grow from line to line, see [`unnamed_fields`](super::unnamed_fields).

use std::io::BufRead;

use crate::formats::recording::error::RecordingError;
use crate::formats::recording::event::ReadOptions;
use crate::formats::recording::side::side;
use crate::formats::recording::table::arrangement::{FrameFields, LineLayout, TableLayout};
use crate::formats::recording::table::clock::TimeFields;
use crate::formats::recording::table::header::{COMPARED, moment_of_row};
use crate::formats::recording::table::unnamed_fields::{unclear, unnamed_fields};
use crate::formats::recording::text::lines::{TextLines, is_blank, text};
use crate::formats::recording::text::row;
use crate::formats::recording::text::separator::{Separator, is_comment};
use crate::formats::recording::time::moment::{self, DecimalCommas};
use crate::frame::{FrameSize, MAX_FRAME_SIDE};

/// Finds the arrangement of a table without names. Its first lines are in `read`, which begins in line `number` of
/// the file.
///
/// If commas separate the fields, the comma in a timestamp may be one of them or a decimal sign: the arrangement that
/// has the right number of fields decides.
pub(super) fn of_numbers(
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
