//! Tables of numbers: a frame a line, with or without a header and other columns, or a row a line with an empty line
//! between frames.
//!
//! Fields are parted by semicolons (then a comma is the decimal sign), commas, tabs or spaces. An empty field and `NaN`
//! are no cell. How the fields are arranged is found from the first lines; the file is then read from its beginning.

use std::io::{BufRead, Seek};

use crate::formats::recording::cell_names::{FieldRole, NamedCells, cells, role};
use crate::formats::recording::error::RecordingError;
use crate::formats::recording::event::{
    ChannelInfo, ReadOptions, RecordingEvent, RecordingNote, Sink,
};
use crate::formats::recording::lines::{TextLines, is_blank, text};
use crate::formats::recording::text_row::{self, Field};
use crate::frame::{Frame, MAX_FRAME_SIDE};

/// What parts the fields of a line.
#[derive(Clone, Copy, Debug, PartialEq)]
enum Separator {
    Byte(u8),
    Spaces,
}

impl Separator {
    fn of(line: &[u8]) -> Self {
        let marks = *b";,\t";
        let found = marks.into_iter().find(|mark| line.contains(mark));
        found.map_or(Self::Spaces, Self::Byte)
    }

    /// The fields of a line without blanks and quotes around them; an empty one at the end is none.
    fn fields(self, line: &[u8]) -> impl Iterator<Item = &[u8]> {
        let line = line.trim_ascii();
        let line = match self {
            Self::Byte(mark) => line.strip_suffix(&[mark]).unwrap_or(line),
            Self::Spaces => line,
        };
        let is_end = move |byte: &u8| match self {
            Self::Byte(mark) => *byte == mark,
            Self::Spaces => byte.is_ascii_whitespace(),
        };
        let fields = line.split(is_end).map(|field| {
            let field = field.trim_ascii();
            let inner = field
                .strip_prefix(b"\"")
                .and_then(|field| field.strip_suffix(b"\""));
            inner.unwrap_or(field)
        });
        fields.filter(move |field| self != Self::Spaces || !field.is_empty())
    }

    fn value(self, field: &[u8]) -> Field {
        let is_none = field.is_empty()
            || [&b"nan"[..], b"null", b"none", b"na"]
                .iter()
                .any(|none| field.eq_ignore_ascii_case(none));
        if is_none {
            return Field::NoCell;
        }
        let decimal_comma = self == Self::Byte(b';') && field.contains(&b',');
        if !decimal_comma {
            return text_row::value(field);
        }
        let mut pointed = [0; 32];
        match pointed.get_mut(..field.len()) {
            Some(pointed) => {
                pointed.copy_from_slice(field);
                for byte in pointed.iter_mut().filter(|byte| **byte == b',') {
                    *byte = b'.';
                }
                text_row::value(pointed)
            }
            None => Field::Wrong,
        }
    }

    fn is_numeric(self, field: &[u8]) -> bool {
        !matches!(self.value(field), Field::Wrong)
    }
}

/// How a table is arranged.
#[derive(Debug)]
struct TableLayout {
    separator: Separator,
    rows: u16,
    columns: u16,
    lines: LineLayout,
    note: Option<RecordingNote>,
}

#[derive(Debug)]
enum LineLayout {
    /// A line is a frame.
    Frame {
        /// How many fields a line has.
        fields: usize,
        /// The line with the names.
        header: Option<u64>,
        /// The field of each cell.
        cells: Vec<usize>,
        label: Option<usize>,
        time: Option<(usize, f64)>,
    },
    /// A line is a row; whether an empty line ends a frame.
    Row { parted: bool },
}

/// Reads a recording.
pub(super) fn read(
    mut input: impl BufRead + Seek,
    options: ReadOptions,
    sink: &mut Sink<'_>,
) -> Result<(), RecordingError> {
    let layout = layout(&mut TextLines::new(&mut input), options)?;
    input.rewind()?;
    let info = ChannelInfo {
        shape: Some((layout.rows, layout.columns)),
        ..ChannelInfo::default()
    };
    if sink(RecordingEvent::Channel(&info)).is_break() {
        return Ok(());
    }
    if let Some(note) = &layout.note
        && sink(RecordingEvent::Note(note)).is_break()
    {
        return Ok(());
    }
    let mut lines = TextLines::new(input);
    match layout.lines {
        LineLayout::Row { parted } => rows(&mut lines, &layout, parted, sink),
        LineLayout::Frame { .. } => frames(&mut lines, &layout, sink),
    }
}

/// A line of words or comments before the numbers.
fn is_comment(line: &[u8]) -> bool {
    line.trim_ascii_start().starts_with(b"#")
}

/// Finds out how the table is arranged, from its first lines.
fn layout(
    lines: &mut TextLines<impl BufRead>,
    options: ReadOptions,
) -> Result<TableLayout, RecordingError> {
    while lines.advance_to_content()? && is_comment(lines.line()) {}
    let first = lines.line().to_owned();
    if is_blank(&first) || is_comment(&first) {
        return Err(RecordingError::Unknown);
    }
    let separator = Separator::of(&first);
    let names: Vec<String> = separator.fields(&first).map(text).collect();
    let names: Vec<&str> = names.iter().map(String::as_str).collect();
    let is_header = separator
        .fields(&first)
        .any(|field| !separator.is_numeric(field))
        || matches!(cells(&names), Some(NamedCells::Counted(0, length)) if length == names.len());
    if is_header {
        let number = lines.number();
        let layout = with_header(&names, separator, number, options);
        // Words above words are no table.
        let numbers = lines.advance_to_content()? && {
            let (mut all, mut numeric) = (0, 0);
            for field in separator.fields(lines.line()) {
                all += 1;
                numeric += usize::from(separator.is_numeric(field));
            }
            numeric > 0 && 2 * numeric >= all
        };
        return if numbers {
            layout
        } else {
            Err(RecordingError::Unknown)
        };
    }
    let fields = names.len();
    let mut block = 1_u16;
    let mut second = None;
    let mut parted = false;
    while lines.advance()? {
        if is_blank(lines.line()) {
            parted = true;
            break;
        }
        second.get_or_insert_with(|| lines.line().to_owned());
        block += 1;
        if block > MAX_FRAME_SIDE {
            break;
        }
    }
    let arranged = |rows, columns, lines| TableLayout {
        separator,
        rows,
        columns,
        lines,
        note: None,
    };
    let width = u16::try_from(fields)
        .ok()
        .filter(|width| *width <= MAX_FRAME_SIDE);
    match (options.shape, width) {
        (Some((rows, columns)), Some(width)) if width == columns && rows > 1 => {
            Ok(arranged(rows, columns, LineLayout::Row { parted }))
        }
        (Some((rows, columns)), _) => {
            let second: Option<Vec<f64>> = second.map(|line| numbers(separator, &line));
            let first = numbers(separator, &first);
            let lines = without_header((rows, columns), &first, second.as_deref())?;
            Ok(arranged(rows, columns, lines))
        }
        (None, Some(width)) if parted && block > 1 => {
            Ok(arranged(block, width, LineLayout::Row { parted }))
        }
        (None, _) => Err(RecordingError::Shape {
            values: fields as u64,
        }),
    }
}

fn numbers(separator: Separator, line: &[u8]) -> Vec<f64> {
    let value = |field| match separator.value(field) {
        Field::Value(value) => value,
        _ => f64::NAN,
    };
    separator.fields(line).map(value).collect()
}

/// The arrangement that names describe.
fn with_header(
    names: &[&str],
    separator: Separator,
    number: u64,
    options: ReadOptions,
) -> Result<TableLayout, RecordingError> {
    let roles: Vec<Option<FieldRole>> = names.iter().map(|name| role(name)).collect();
    let mut note = None;
    let ((rows, columns), fields) = match (cells(names), options.shape) {
        (Some(NamedCells::Grid(rows, columns, fields)), shape) => {
            if let Some((asked_rows, asked_columns)) = shape.filter(|own| *own != (rows, columns)) {
                let message = format!(
                    "the header names {rows} rows of {columns} cells, not {asked_rows} of {asked_columns}"
                );
                return Err(RecordingError::in_line(number, message));
            }
            ((rows, columns), fields)
        }
        (Some(NamedCells::Counted(start, length)), shape) => {
            let side = (1..=MAX_FRAME_SIDE).find(|side| usize::from(*side).pow(2) == length);
            let shape = match (shape, side) {
                (Some(shape), _) => shape,
                (None, Some(side)) => {
                    note = Some(RecordingNote::Square { side });
                    (side, side)
                }
                (None, None) => {
                    return Err(RecordingError::Shape {
                        values: length as u64,
                    });
                }
            };
            (shape, (start..start + length).collect())
        }
        (None, shape) => {
            let leading = roles.iter().take_while(|role| role.is_some()).count();
            let trailing = roles.iter().rev().take_while(|role| role.is_some()).count();
            let end = names.len().saturating_sub(trailing).max(leading);
            let fields: Vec<usize> = (leading..end).collect();
            let values = fields.len() as u64;
            (shape.ok_or(RecordingError::Shape { values })?, fields)
        }
    };
    if fields.len() != usize::from(rows) * usize::from(columns) {
        return Err(text_row::count(
            number,
            fields.len(),
            usize::from(rows) * usize::from(columns),
        ));
    }
    let others = || {
        roles
            .iter()
            .enumerate()
            .filter(|(field, _)| !fields.contains(field))
    };
    let label = others().find(|(_, role)| **role == Some(FieldRole::Label));
    let time = others().find_map(|(field, role)| match role {
        Some(FieldRole::Time(factor)) => Some((field, *factor)),
        _ => None,
    });
    Ok(TableLayout {
        separator,
        rows,
        columns,
        note,
        lines: LineLayout::Frame {
            fields: names.len(),
            header: Some(number),
            label: label.map(|(field, _)| field),
            time,
            cells: fields,
        },
    })
}

/// The arrangement of lines without names: the cells alone; a number or a time before them, or both; or a number and
/// milliseconds behind them. The part that grows from the first line to the second says which it is.
fn without_header(
    (rows, columns): (u16, u16),
    first: &[f64],
    second: Option<&[f64]>,
) -> Result<LineLayout, RecordingError> {
    let cells = usize::from(rows) * usize::from(columns);
    let arranged = |start: usize, label, time| {
        Ok(LineLayout::Frame {
            fields: first.len(),
            header: None,
            cells: (start..start + cells).collect(),
            label,
            time,
        })
    };
    let growth = |field: usize| match second {
        Some(second) => second
            .get(field)
            .map_or(f64::NAN, |value| value - first[field]),
        None => f64::NAN,
    };
    let alone = second.is_none();
    match first.len().checked_sub(cells) {
        Some(0) => arranged(0, None, None),
        Some(1) if growth(0) == 1.0 => arranged(1, Some(0), None),
        Some(1) if growth(0) > 0.0 || alone => arranged(1, None, Some((0, 1.0))),
        // The offset of a message of ROS.
        Some(1) if first[0] == 0.0 && growth(0) == 0.0 => arranged(1, None, None),
        Some(2) if growth(cells) == 1.0 && growth(cells + 1) >= 0.0 || alone => {
            arranged(0, Some(cells), Some((cells + 1, 1e-3)))
        }
        Some(2) if growth(0) == 1.0 && growth(1) >= 0.0 => arranged(2, Some(0), Some((1, 1.0))),
        Some(2) if growth(1) == 1.0 && growth(0) >= 0.0 => arranged(2, Some(1), Some((0, 1.0))),
        _ => Err(text_row::count(1, first.len(), cells)),
    }
}

/// Reads frames of a line each.
fn frames(
    lines: &mut TextLines<impl BufRead>,
    layout: &TableLayout,
    sink: &mut Sink<'_>,
) -> Result<(), RecordingError> {
    let LineLayout::Frame {
        fields,
        header,
        cells,
        label,
        time,
    } = &layout.lines
    else {
        return Ok(());
    };
    // The slot of each field: that of a cell, or none.
    let mut slots = vec![None; *fields];
    for (slot, &field) in cells.iter().enumerate() {
        slots[field] = Some(slot);
    }
    let mut frame = Frame::new(layout.columns, layout.rows);
    let mut start = None;
    while lines.advance_to_content()? {
        let number = lines.number();
        if *header == Some(number) || is_comment(lines.line()) {
            continue;
        }
        (frame.label, frame.time) = (None, None);
        let values = frame.values_mut();
        let (mut found, mut own_label, mut own_time) = (0, None, None);
        for field in layout.separator.fields(lines.line()) {
            let index = found;
            found += 1;
            let Some(slot) = slots.get(index) else {
                continue;
            };
            match (slot, layout.separator.value(field)) {
                (Some(slot), Field::Value(value)) => values[*slot] = value,
                (Some(slot), Field::NoCell) => values[*slot] = f64::NAN,
                (Some(_), Field::Wrong) => return Err(text_row::wrong(number, found, field)),
                (None, Field::Value(value)) if *label == Some(index) => own_label = whole(value),
                (None, Field::Value(value)) if time.is_some_and(|(own, _)| own == index) => {
                    own_time = Some(value);
                }
                (None, _) => {}
            }
        }
        if found != *fields {
            return Err(text_row::count(number, found, *fields));
        }
        frame.label = own_label;
        if let (Some(time), Some((_, factor))) = (own_time, time) {
            let start = *start.get_or_insert(time);
            frame.time = Some((time - start) * factor);
        }
        if sink(RecordingEvent::Frame(&frame)).is_break() {
            break;
        }
        frame.number += 1;
    }
    Ok(())
}

/// A number without a fraction, as labels are.
#[expect(clippy::cast_possible_truncation, reason = "checked")]
fn whole(value: f64) -> Option<i64> {
    (value.fract() == 0.0 && value.abs() < 9e15).then_some(value as i64)
}

/// Reads frames of several lines.
fn rows(
    lines: &mut TextLines<impl BufRead>,
    layout: &TableLayout,
    parted: bool,
    sink: &mut Sink<'_>,
) -> Result<(), RecordingError> {
    let (rows, columns) = (layout.rows, usize::from(layout.columns));
    let mut frame = Frame::new(layout.columns, rows);
    let mut found = 0;
    let short = |number: u64, found: u16| {
        let message = format!("the frame ends after {found} rows, expected {rows}");
        RecordingError::in_line(number, message)
    };
    loop {
        let ended = !lines.advance()?;
        let number = lines.number();
        if ended || is_blank(lines.line()) {
            if found == rows && parted {
                if sink(RecordingEvent::Frame(&frame)).is_break() {
                    return Ok(());
                }
                frame.number += 1;
                found = 0;
            }
            match (found, ended) {
                (0, true) => return Ok(()),
                (0, false) => continue,
                _ => return Err(short(number + u64::from(ended), found)),
            }
        }
        if is_comment(lines.line()) {
            continue;
        }
        if found == rows {
            let message = format!("another row, expected an empty line after {rows} of them");
            return Err(RecordingError::in_line(number, message));
        }
        let start = usize::from(found) * columns;
        let slots = &mut frame.values_mut()[start..start + columns];
        let mut count = 0;
        for field in layout.separator.fields(lines.line()) {
            count += 1;
            let Some(slot) = slots.get_mut(count - 1) else {
                continue;
            };
            *slot = match layout.separator.value(field) {
                Field::Value(value) => value,
                Field::NoCell => f64::NAN,
                Field::Wrong => return Err(text_row::wrong(number, count, field)),
            };
        }
        if count != columns {
            return Err(text_row::count(number, count, columns));
        }
        found += 1;
        if found == rows && !parted {
            if sink(RecordingEvent::Frame(&frame)).is_break() {
                return Ok(());
            }
            frame.number += 1;
            found = 0;
        }
    }
}
