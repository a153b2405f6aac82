//! Tables of numbers, with or without names: a frame a line, or a row a line. What is not clear is refused, with the
//! flag that settles it.
//!
//! | rule | |
//! |---|---|
//! | names | the first line with a field that is no number; a line 0, 1, …, n − 1; a comment right above the numbers with a name for each of them |
//! | cells | all columns whose names have numbers: two of them are row and column, one is the place in their order; what else is in the name is the channel. Without names all fields, in order |
//! | size | the given rows and columns; else of the names; else lines in blocks, as many lines as fields, or n² numbers a line |

use std::collections::BTreeMap;
use std::io::BufRead;

use taxel_core::frame::{Frame, FrameSize, Label, MAX_FRAME_CELLS, MAX_FRAME_SIDE};
use taxel_core::parameter::number::counted;
use taxel_core::quote::{did_you_mean, shortened};

use crate::error::{ReadError, ReadErrorKind};
use crate::formats::recording::error::{in_line, unknown_format};
use crate::formats::recording::event::{
    ChannelInfo, Column, ReadOptions, ReadState, RecordingNote, RecordingSink, Sink, Stop,
};
use crate::formats::recording::size::frame_size;
use crate::formats::recording::text::{
    Field, Separator, TextLines, is_blank, is_comment, text, whole, wrong_count, wrong_field,
};
use crate::formats::recording::time::{Moment, TimeUnit, read_moment, time_name};

/// The most fields of a line: cells, and a few beside them.
const MOST_FIELDS: usize = MAX_FRAME_CELLS + 16;

/// The most rows that are waited for until it is clear how a live stream is arranged: more than a sensor has.
const MOST_LIVE_ROWS: usize = 65;

/// The most lines above those that continue a table after an interruption.
const MOST_ABOVE: usize = 8;

/// The most bytes of the lines that are waited for.
const MOST_HELD: usize = 16 << 20;

/// Where a table goes on after an interruption, and where a file continues that was emptied: each line has these
/// fields.
#[derive(Clone, Debug)]
pub(super) struct TableLayout {
    separator: Separator,
    /// The number of fields if they have names: then the last one may be empty. Otherwise 0: a separator at the end is
    /// none.
    expected: usize,
    /// For each field, its channel and the index of its cell; None if it is not a cell.
    slots: Vec<Option<(usize, usize)>>,
    channels: Vec<(Option<String>, FrameSize)>,
    time: Option<(usize, Option<TimeUnit>)>,
    label: Option<usize>,
    /// Whether a line is a row; otherwise it is a frame.
    in_rows: bool,
    /// Whether empty lines or lines of text end the frames in rows.
    is_parted: bool,
}

/// Whether a text begins like a table: with a line of two numbers or more that are at least half of its fields; or with
/// a number, if the rows and columns are given or the name of a single cell is above it.
pub(super) fn sniff(head: &[u8], options: &ReadOptions, is_all: bool) -> bool {
    let end = head.iter().rposition(|&byte| byte == b'\n');
    let whole = if is_all {
        head
    } else {
        &head[..end.unwrap_or(0)]
    };
    // A stream that was joined anywhere begins with the rest of a line.
    let first = whole
        .iter()
        .position(|&byte| byte == b'\n')
        .filter(|_| options.is_joined);
    let whole = match (options.is_joined, first) {
        (true, None) => return false,
        (_, first) => &whole[first.map_or(0, |end| end + 1)..],
    };
    let mut is_named = false;
    whole.split(|&byte| byte == b'\n').any(|line| {
        let (_, line) = bare(line);
        if is_blank(line) || is_comment(line) {
            return false;
        }
        let separator = Separator::of(line);
        let (mut fields, mut numbers, mut filled) = (0, 0, 0);
        for field in separator.fields(line) {
            let is_number = separator.is_numeric(field);
            fields += 1;
            numbers += usize::from(is_number);
            filled += usize::from(is_number && !field.trim_ascii().is_empty());
        }
        // Spreadsheets fill lines of words, and empty ones, with separators.
        let least = if numbers == fields { 1 } else { 2 };
        let is_one = fields == 1 && numbers == 1 && (is_named || options.size.is_some());
        is_named = fields == 1 && is_grid_name(line);
        is_one || numbers > 1 && filled >= least && 2 * numbers >= fields
    })
}

/// Whether all lines are single numbers, which may be anything.
pub(super) fn is_column(head: &[u8]) -> bool {
    let lines = head.split(|&byte| byte == b'\n');
    let mut lines = lines
        .filter(|line| !is_blank(line) && !is_comment(line))
        .peekable();
    let is_number = |line: &[u8]| Separator::Spaces.is_numeric(line.trim_ascii());
    lines.peek().is_some() && lines.all(is_number)
}

fn is_grid_name(line: &[u8]) -> bool {
    let name = str::from_utf8(line.trim_ascii());
    name.is_ok_and(|name| CellName::of(name).is_some_and(|cell| cell.numbers.len() == 2))
}

/// Removes what is no part of the numbers of a line: the time that a serial monitor puts before them, `12:00:01.100 -> `,
/// and brackets around all of them.
fn bare(line: &[u8]) -> (Option<&[u8]>, &[u8]) {
    let clock = line.get(..24).unwrap_or(line);
    let arrow = clock.windows(2).position(|pair| pair == b"->");
    let (time, line) = match arrow.map(|at| (line[..at].trim_ascii(), &line[at + 2..])) {
        Some((time, rest)) if read_moment(time).is_some() => (Some(time), rest),
        _ => (None, line),
    };
    let begins = line.trim_ascii_start().starts_with(b"[");
    let ends = line.trim_ascii_end();
    let ends = ends.strip_suffix(b",").unwrap_or(ends).ends_with(b"]");
    if !begins && !ends {
        return (time, line);
    }
    let is_edge = |byte: &u8| b"[], \t".contains(byte);
    let start = line
        .iter()
        .position(|byte| !b"[ \t".contains(byte))
        .unwrap_or(line.len());
    let end = line
        .iter()
        .rposition(|byte| !is_edge(byte))
        .map_or(start, |end| end + 1);
    let inside = &line[start..end.max(start)];
    let is_nested = inside.iter().any(|byte| b"[]".contains(byte));
    (time, if is_nested { line } else { inside })
}

/// Reads a table.
pub(super) fn read(
    input: &mut dyn BufRead,
    options: &ReadOptions,
    sink: &mut Sink<'_>,
) -> Result<(), Stop> {
    Table {
        lines: TextLines::new(input),
        options,
        sink,
        is_one: false,
        is_inside: options.is_joined,
    }
    .read()
}

/// Reads a text that is known to be a single frame, a row a line.
///
/// # Errors
/// If the text is no table, or larger than a frame; with the kind [`ReadErrorKind::UnknownFormat`] if it has no numbers.
pub fn read_rows(mut text: &[u8], consumer: &mut RecordingSink<'_>) -> Result<(), ReadError> {
    let mut state = ReadState::default();
    let sink = &mut Sink::new(consumer, &mut state);
    let options = &ReadOptions::default();
    let lines = TextLines::new(&mut text as &mut dyn BufRead);
    match (Table {
        lines,
        options,
        sink,
        is_one: true,
        is_inside: options.is_joined,
    })
    .read()
    {
        Ok(()) | Err(Stop::Enough) => Ok(()),
        Err(Stop::Failed(error)) => Err(error),
    }
}

struct Table<'a, 'b> {
    lines: TextLines<&'a mut dyn BufRead>,
    options: &'a ReadOptions,
    sink: &'a mut Sink<'b>,
    /// Whether the whole table is a single frame.
    is_one: bool,
    /// Whether the next line may be inside a frame: the stream was joined there, and no frame has ended since.
    is_inside: bool,
}

/// What a line is.
enum Line<'a> {
    Comment,
    /// An empty line or a line of text, which ends a frame in rows.
    Break,
    /// Fields, and the time before them.
    Fields(Option<&'a [u8]>, &'a [u8]),
}

impl<'a> Line<'a> {
    /// Tells what a line of a table with this number of fields is. A text has another number of fields and no number
    /// in them; between blanks, it begins with a word.
    fn of(line: &'a [u8], separator: Separator, count: usize) -> Self {
        let (time, fields) = bare(line);
        if is_blank(fields) {
            return Self::Break;
        }
        let first = fields.trim_ascii_start().first();
        if first.is_some_and(|byte| byte.is_ascii_digit() || b"+-.".contains(byte)) {
            return Self::Fields(time, fields);
        }
        if is_comment(fields) {
            return Self::Comment;
        }
        let (mut found, mut numbers) = (0, 0);
        for field in separator.fields_of(fields, count) {
            let is_number = separator.is_numeric(field) && !field.is_empty();
            numbers += usize::from(is_number && (found == 0 || separator != Separator::Spaces));
            found += 1;
        }
        if found != count && numbers == 0 {
            Self::Break
        } else {
            Self::Fields(time, fields)
        }
    }
}

/// What the names of the columns say, or that there are none.
struct Columns {
    separator: Separator,
    /// The names; None without a header.
    names: Option<Vec<String>>,
    /// The number of fields in a line.
    count: usize,
    time: Option<(usize, Option<TimeUnit>)>,
    label: Option<usize>,
    sensors: Vec<Sensor>,
    left_out: Vec<usize>,
    /// The rows and columns that are given.
    given: Option<FrameSize>,
}

/// The cells of a channel: their columns in the order of the cells.
struct Sensor {
    name: Option<String>,
    columns: Vec<usize>,
    /// The rows and columns that the names give.
    grid: Option<FrameSize>,
}

impl Table<'_, '_> {
    fn read(mut self) -> Result<(), Stop> {
        // What was joined anywhere begins with the rest of a line.
        if self.options.is_joined {
            self.advance()?;
        }
        let layout = match self.earlier()? {
            Some(layout) => layout,
            None => match self.layout()? {
                Some(layout) => layout,
                None => return Ok(()),
            },
        };
        self.sink.state.layout = Some(layout.clone());
        self.frames(&layout)
    }

    /// Reads the next line; one that is too long is a wrong frame.
    fn advance(&mut self) -> Result<bool, Stop> {
        self.sink.advance(&mut self.lines, self.options)
    }

    /// The layout before an interruption, if one of the next lines continues it: the first ones may be torn, or messages.
    /// A header right above says otherwise.
    fn earlier(&mut self) -> Result<Option<TableLayout>, Stop> {
        let Some(layout) = self.sink.state.layout.clone() else {
            return Ok(None);
        };
        let mut held: Vec<(u64, Vec<u8>)> = Vec::new();
        let (mut header, mut goes_on) = (None, false);
        while held.len() < MOST_ABOVE && !goes_on && self.advance()? {
            let number = self.lines.number();
            let line = self.lines.line();
            let fields = layout.separator.fields_of(bare(line).1, layout.expected);
            let fields: Vec<&[u8]> = fields.collect();
            let is_header = self.is_header(&fields, layout.separator);
            goes_on = !is_header && fields.len() == layout.slots.len();
            if goes_on && header == Some((number - 1, fields.len())) {
                goes_on = false;
                held.push((number, line.to_vec()));
                break;
            }
            header = is_header.then_some((number, fields.len()));
            held.push((number, line.to_vec()));
        }
        let is_empty = held.is_empty();
        for (number, line) in held.into_iter().rev() {
            self.lines.unread(number, line);
        }
        Ok(Some(layout).filter(|_| goes_on || is_empty))
    }

    /// Finds out how the table is arranged. In a live stream, lines that do not fit are dropped until some do; None if
    /// it ends before that.
    fn layout(&mut self) -> Result<Option<TableLayout>, Stop> {
        loop {
            let is_live = self.options.leaves_out;
            let columns = match self.columns() {
                Ok(Some(columns)) => columns,
                Ok(None) if is_live => return Ok(None),
                Ok(None) => return Err(unknown_format().into()),
                Err(Stop::Failed(error)) if is_live && error.kind == ReadErrorKind::Invalid => {
                    self.drop_line(error)?;
                    continue;
                }
                Err(stop) => return Err(stop),
            };
            match self.arranged(&columns) {
                Ok(Some(mut layout)) => {
                    layout.is_parted |= layout.in_rows && self.options.is_joined;
                    self.tell(&columns, &layout)?;
                    let unit = layout.time.and_then(|(_, unit)| unit);
                    self.sink.state.clock.set_unit(unit);
                    return Ok(Some(layout));
                }
                Ok(None) => {}
                Err(Stop::Failed(error)) if is_live && error.kind == ReadErrorKind::Invalid => {
                    self.advance()?;
                    self.drop_line(error)?;
                }
                Err(stop) => return Err(stop),
            }
        }
    }

    fn drop_line(&mut self, error: ReadError) -> Result<(), Stop> {
        let line = self.lines.line().to_vec();
        self.sink.damage(self.options, error, &line)
    }

    /// Arranges the cells of these columns; None if the lines before the next one do not fit it and were dropped.
    fn arranged(&mut self, columns: &Columns) -> Result<Option<TableLayout>, Stop> {
        let given = self.options.size;
        let total: usize = columns
            .sensors
            .iter()
            .map(|sensor| sensor.columns.len())
            .sum();
        let is_single = columns.sensors.len() == 1;
        let number = self.lines.number();
        let mut layout = columns.layout();
        if let Some(size) = given.filter(|size| size.cells() == total) {
            layout.take_as_one(columns, size);
        } else if let Some(size) =
            given.filter(|size| is_single && usize::from(size.columns()) == total)
        {
            layout.take_as_one(columns, size);
            layout.in_rows = true;
        } else if is_single && columns.sensors[0].grid.is_none() && given.is_none() {
            let Some((size, in_rows, is_parted)) = self.look_ahead(columns, total)? else {
                return Ok(None);
            };
            layout.take_as_one(columns, size);
            (layout.in_rows, layout.is_parted) = (in_rows, is_parted);
        } else {
            for (channel, sensor) in columns.sensors.iter().enumerate() {
                let cells = sensor.columns.len();
                let own = given.filter(|size| size.cells() == cells);
                let squared = square(cells, 2).filter(|_| given.is_none());
                let size = own.or(sensor.grid).or(squared);
                layout.channels[channel].1 =
                    size.ok_or_else(|| columns.misfit(cells, given, number))?;
                if let (0, None, None, Some(size)) = (channel, own, sensor.grid, squared) {
                    self.sink
                        .note(&RecordingNote::Square { side: size.rows() })?;
                }
            }
        }
        Ok(Some(layout))
    }

    /// Finds the header, if there is one, up to the first line of numbers, which is read again.
    fn columns(&mut self) -> Result<Option<Columns>, Stop> {
        let mut comment = None;
        let mut above: Option<(u64, Vec<u8>)> = None;
        while self.advance()? {
            let (number, line) = (self.lines.number(), self.lines.line());
            let (_, fields) = bare(line);
            if is_blank(fields) {
                // Names stand right above the numbers; a greeting may not.
                (above, comment, self.is_inside) = (None, None, false);
                continue;
            }
            if is_comment(fields) {
                comment = Some(fields.to_vec());
                continue;
            }
            let separator = Separator::of(fields);
            let above_fields =
                |(_, names): &(u64, Vec<u8>)| separator.fields(bare(names).1).count();
            let expected = above.as_ref().map_or(0, above_fields);
            let found: Vec<&[u8]> = separator
                .fields_of(fields, expected)
                .take(MOST_FIELDS + 1)
                .collect();
            if found.len() > MOST_FIELDS {
                return Err(in_line(
                    number,
                    "more than 262,160 fields, expected at most 512 × 512 cells and 16 beside them",
                )
                .into());
            }
            let has_number = found
                .iter()
                .any(|field| separator.is_numeric(field) && !field.is_empty());
            if expected != found.len() && self.is_header(&found, separator) || !has_number {
                above = Some((number, line.to_vec()));
                continue;
            }
            let names = match &above {
                Some((_, names)) if expected == found.len() => Some(
                    separator
                        .fields_of(bare(names).1, expected)
                        .map(text)
                        .collect(),
                ),
                // A line of text may stand above the first frame, but not a list of words.
                Some((at, words))
                    if expected > 1 && separator != Separator::Spaces
                        || !matches!(Line::of(words, separator, found.len()), Line::Break) =>
                {
                    return Err(above_table(*at, expected, number, found.len()).into());
                }
                _ => comment
                    .as_deref()
                    .and_then(|comment| names_in_comment(comment, separator, found.len())),
            };
            let at = above
                .as_ref()
                .filter(|_| names.is_some())
                .map_or(number, |(at, _)| *at);
            let columns = Columns::new(separator, names, &found, self.options)
                .map_err(|error| error.in_line(at))?;
            let line = line.to_vec();
            self.lines.unread(number, line);
            return Ok(Some(columns));
        }
        Ok(None)
    }

    /// Whether these fields are names: words, beside numbers only if the numbers count up or the words are usual names;
    /// or numbers that count up from 0. A time of day or a date is no word.
    fn is_header(&self, fields: &[&[u8]], separator: Separator) -> bool {
        let chosen = |index: usize| {
            let number = Some(&Column::Number(index + 1));
            self.options.label_column.as_ref() == number
                || self.options.time_column.as_ref().map(|time| &time.column) == number
        };
        let (mut words, mut numbers, mut is_usual) = (0, Vec::new(), true);
        for (index, field) in fields.iter().enumerate() {
            if field.is_empty() || chosen(index) {
                continue;
            }
            match separator.value(field) {
                Field::Value(number) => numbers.push(number),
                Field::Wrong if read_moment(field).is_none() => {
                    words += 1;
                    let name = text(field);
                    is_usual &= time_name(&name).is_some() || is_label(&name);
                }
                _ => return false,
            }
        }
        let counts = |from: f64| {
            numbers
                .iter()
                .zip(0..)
                .all(|(&number, index)| number == from + f64::from(index))
        };
        let many = numbers.len() > 1;
        if words == 0 {
            let others = fields
                .iter()
                .enumerate()
                .filter(|(index, field)| field.is_empty() && *index > 0);
            return many && counts(0.0) && others.count() == 0;
        }
        numbers.is_empty() || is_usual || many && (counts(0.0) || counts(1.0))
    }

    /// Reads lines until it is clear how they are arranged; they are read again. Returns the rows and columns, whether a
    /// line is a row, and whether frames are parted; None if the next line of a live stream has another number of
    /// fields than those before it, which are dropped.
    fn look_ahead(
        &mut self,
        columns: &Columns,
        cells: usize,
    ) -> Result<Option<(FrameSize, bool, bool)>, Stop> {
        let is_live = self.options.leaves_out;
        let most = if is_live {
            MOST_LIVE_ROWS
        } else {
            usize::from(MAX_FRAME_SIDE) + 1
        };
        let mut held: Vec<(u64, Vec<u8>)> = Vec::new();
        // The rows since the last end of a frame, those of the frame before it, and all of them.
        let (mut rows, mut before, mut all, mut bytes) = (0_usize, 0_usize, 0_usize, 0);
        let mut has_ended = false;
        // The rows of a frame, if these are parted.
        let block = loop {
            let is_wide = cells >= most && !self.is_one && all > usize::from(is_live);
            if is_wide || rows >= most || all >= 3 * most || bytes > MOST_HELD {
                break None;
            }
            if !self.advance()? {
                has_ended = true;
                break Some(before).filter(|&before| before > 1 && rows > 0);
            }
            let (number, line) = (self.lines.number(), self.lines.line());
            bytes += line.len();
            let kind = Line::of(line, columns.separator, columns.count);
            let count = match kind {
                Line::Fields(_, fields) => columns
                    .separator
                    .fields_of(fields, columns.expected())
                    .count(),
                _ => columns.count,
            };
            if count != columns.count && is_live && columns.names.is_none() {
                let line = line.to_vec();
                self.lines.unread(number, line);
                self.sink
                    .damage(self.options, wrong_count(number, count, columns.count), b"")?;
                return Ok(None);
            }
            if count != columns.count && !is_live {
                let is_above = all == 1 && columns.names.is_none();
                return Err(if is_above {
                    above_table(held[0].0, columns.count, number, count)
                } else {
                    wrong_count(number, count, columns.count)
                }
                .into());
            }
            let is_row = matches!(kind, Line::Fields(..));
            let is_break = matches!(kind, Line::Break);
            if is_break && std::mem::take(&mut self.is_inside) {
                // What precedes the first end of a frame is the rest of one.
                held.clear();
                (rows, all) = (0, 0);
            }
            // A file is parted if more follows; of a live stream, the first frame may be torn.
            let is_block = if is_live {
                is_break && rows > 1 && rows == before
            } else {
                is_row && rows == 0 && before > 1
            };
            held.push((number, line.to_vec()));
            if is_block {
                break Some(before);
            }
            if is_break && rows > 0 {
                (before, rows) = (rows, 0);
            }
            rows += usize::from(is_row);
            all += usize::from(is_row);
        };
        for (number, line) in held.into_iter().rev() {
            self.lines.unread(number, line);
        }
        let squared = square(cells, if columns.names.is_some() { 2 } else { 3 });
        let is_one = has_ended && (self.is_one || all == cells);
        if let Some(size) = block.and_then(|rows| frame_size(cells, rows)) {
            Ok(Some((size, true, true)))
        } else if let Some(size) = frame_size(cells, all).filter(|_| is_one) {
            Ok(Some((size, true, false)))
        } else if let Some(size) = squared.filter(|_| !self.is_one) {
            let side = size.rows();
            self.sink.note(&RecordingNote::Square { side })?;
            Ok(Some((size, false, false)))
        } else {
            Err(unclear(cells, has_ended.then_some(all)).into())
        }
    }

    /// Notes how the table is read.
    fn tell(&mut self, columns: &Columns, layout: &TableLayout) -> Result<(), Stop> {
        let name = |column: usize| columns.called(column);
        let mut notes = Vec::new();
        if let Some((column, unit)) = layout.time {
            let unit = unit.map_or(String::new(), |unit| format!(", in {}", unit.name()));
            notes.push(format!("times: {}{unit}", name(column)));
        }
        if let Some(column) = layout.label {
            notes.push(format!("labels: {}", name(column)));
        }
        let cells = match (
            &columns.names,
            columns.sensors.iter().all(|sensor| sensor.grid.is_some()),
        ) {
            (None, _) => "all other numbers of a line, in order",
            (Some(_), true) => "by the row and column in their names",
            (Some(_), false) => "in the order of the numbers in their names",
        };
        let lines = match (layout.in_rows, layout.is_parted) {
            (false, _) => "a frame a line",
            (true, false) => "a row a line",
            (true, true) => "a row a line; an empty line or a line of text ends a frame",
        };
        notes.push(format!("cells: {cells}; {lines}"));
        if !columns.left_out.is_empty() {
            let mut names: Vec<String> = columns
                .left_out
                .iter()
                .take(16)
                .map(|&column| name(column))
                .collect();
            if columns.left_out.len() > 16 {
                names.push("…".to_owned());
            }
            notes.push(format!("left out: {}", names.join(", ")));
        }
        notes
            .into_iter()
            .try_for_each(|text| self.sink.note(&RecordingNote::Table { text }))
    }

    fn frames(&mut self, layout: &TableLayout) -> Result<(), Stop> {
        let mut frames: Vec<Frame> = layout
            .channels
            .iter()
            .map(|(_, size)| Frame::new(*size))
            .collect();
        let height = usize::from(frames[0].rows());
        let mut row = 0;
        let mut is_parted = layout.is_parted;
        // What was joined anywhere begins inside a frame.
        let mut skipping = layout.in_rows && self.is_inside;
        let mut start = Start::default();
        loop {
            let more = self.advance()?;
            let number = self.lines.number();
            if !is_blank(self.lines.torn()) {
                let torn = self.lines.torn().to_vec();
                let error = in_line(number + 1, "no line break after it");
                return if skipping {
                    Ok(())
                } else {
                    self.sink.damage(self.options, error, &torn)
                };
            }
            let line = if more {
                Line::of(self.lines.line(), layout.separator, layout.slots.len())
            } else {
                Line::Break
            };
            match line {
                Line::Break if layout.in_rows => {
                    if row == height {
                        self.give(layout, &mut frames, &start)?;
                    } else if row > 0 {
                        let at = number + u64::from(!more);
                        let message = format!(
                            "the frame ends after {}, expected {height}",
                            counted(row as u64, "row")
                        );
                        self.drop_line(in_line(at, message))?;
                    }
                    (row, skipping, is_parted) = (0, false, true);
                }
                Line::Comment | Line::Break => {}
                Line::Fields(..) if skipping => {}
                Line::Fields(time, fields) => {
                    let filled = if row == height && layout.in_rows {
                        Err(in_line(
                            number,
                            format!("another row, expected an empty line after {height} of them"),
                        ))
                    } else {
                        layout.fill(fields, number, row, &mut frames, &mut start, time)
                    };
                    if let Err(error) = filled {
                        self.drop_line(error)?;
                        (row, skipping) = (0, layout.in_rows);
                        continue;
                    }
                    row += 1;
                    if !layout.in_rows || row == height && !is_parted {
                        self.give(layout, &mut frames, &start)?;
                        row = 0;
                    }
                }
            }
            if !more {
                return Ok(());
            }
        }
    }

    fn give(
        &mut self,
        layout: &TableLayout,
        frames: &mut [Frame],
        start: &Start,
    ) -> Result<(), Stop> {
        let clock = &mut self.sink.state.clock;
        let (mut time, mut is_moment, mut unread) = (None, false, None);
        if let Some(field) = &start.time {
            let read = match layout.separator.value(field) {
                Field::Value(value) => Some(clock.number(field, value)),
                Field::NoCell => None,
                Field::Wrong => {
                    let moment: Option<Moment> = read_moment(field);
                    is_moment = moment.is_some();
                    unread = moment.is_none().then(|| shortened(&text(field)));
                    moment.map(|moment| clock.moment(moment))
                }
            };
            time = read.map(|read| clock.since_first(read));
        }
        let assumed = clock.take_note();
        for (index, (frame, (name, size))) in frames.iter_mut().zip(&layout.channels).enumerate() {
            let channel = self.sink.channel(name.as_deref(), || ChannelInfo {
                size: Some(*size),
                start: start
                    .time
                    .as_ref()
                    .filter(|_| is_moment)
                    .map(|time| text(time)),
                ..ChannelInfo::default()
            })?;
            if index == 0 {
                if let Some(note) = &assumed {
                    self.sink.note(note)?;
                }
                if let Some(text) = unread.take() {
                    self.sink.unread_time(channel, text)?;
                }
            }
            frame.time = time;
            frame.label.clone_from(&start.label);
            self.sink.frame(channel, frame)?;
        }
        Ok(())
    }
}

/// The time and the label in the first line of a frame.
#[derive(Default)]
struct Start {
    time: Option<Vec<u8>>,
    label: Option<Label>,
}

impl TableLayout {
    /// Takes all cells as those of one channel.
    fn take_as_one(&mut self, columns: &Columns, size: FrameSize) {
        let name = match &columns.sensors[..] {
            [sensor] => sensor.name.clone(),
            _ => None,
        };
        self.channels = vec![(name, size)];
        let all = columns.sensors.iter().flat_map(|sensor| &sensor.columns);
        for (index, &column) in all.enumerate() {
            self.slots[column] = Some((0, index));
        }
    }

    /// Fills the cells of a line into its row; in the first row of a frame, its time and label, too.
    fn fill(
        &self,
        line: &[u8],
        number: u64,
        row: usize,
        frames: &mut [Frame],
        start: &mut Start,
        time: Option<&[u8]>,
    ) -> Result<(), ReadError> {
        let mut found = 0;
        let offset = if self.in_rows {
            row * usize::from(frames[0].columns())
        } else {
            0
        };
        if row == 0 {
            start.time = time.map(<[u8]>::to_vec);
        }
        for field in self.separator.fields_of(line, self.expected) {
            let column = found;
            found += 1;
            match self.slots.get(column) {
                Some(&Some((channel, index))) => {
                    let cell = self.separator.value(field).cell();
                    frames[channel].values_mut()[offset + index] =
                        cell.ok_or_else(|| self.wrong(number, found, field))?;
                }
                Some(None) if row == 0 => {
                    if self.time.is_some_and(|(time, _)| time == column) {
                        start.time = Some(field.to_vec());
                    } else if self.label == Some(column) {
                        start.label = match self.separator.value(field) {
                            Field::Value(number) => Some(
                                whole(number)
                                    .map_or_else(|| Label::Text(text(field)), Label::Number),
                            ),
                            Field::NoCell => None,
                            Field::Wrong => Some(Label::Text(text(field))),
                        };
                    }
                }
                _ => {}
            }
        }
        if found == self.slots.len() {
            Ok(())
        } else {
            Err(wrong_count(number, found, self.slots.len()))
        }
    }

    /// The error for a text in a cell: it may be a label or a time.
    fn wrong(&self, number: u64, column: usize, field: &[u8]) -> ReadError {
        let mut error = wrong_field(number, column, field);
        if self.time.is_none() && read_moment(field).is_some() {
            error.message += &format!("; if it is the time: --time-column {column}");
        } else if self.label.is_none() && field.first().is_some_and(u8::is_ascii_alphabetic) {
            error.message += &format!("; if it is the label: --label-column {column}");
        }
        error
    }
}

/// The error for lines above a table that are no names.
fn above_table(line: u64, found: usize, below: u64, fields: usize) -> ReadError {
    let found = counted(found as u64, "field");
    in_line(
        line,
        format!(
            "found {found}, but line {below} has {fields}: delete the lines above the table, or begin them with #"
        ),
    )
}

/// The rows and columns of a square with this number of cells, of at least `least` rows.
fn square(cells: usize, least: u16) -> Option<FrameSize> {
    let side = u16::try_from(cells.isqrt()).ok()?;
    let is_square = usize::from(side) * usize::from(side) == cells && side >= least;
    FrameSize::new(side, side).ok().filter(|_| is_square)
}

/// The error for a table whose lines may be frames or rows, with the flags for each.
fn unclear(cells: usize, lines: Option<usize>) -> ReadError {
    let rows = (1..=cells.isqrt())
        .rev()
        .find(|rows| cells.is_multiple_of(*rows))
        .unwrap_or(1);
    let mut message = format!(
        "{} a line, but the rows and columns of a frame are not stated: --rows {rows} --columns {} for a frame a line",
        counted(cells as u64, "number"),
        cells / rows
    );
    if cells <= usize::from(MAX_FRAME_SIDE) {
        let lines = lines.map_or_else(|| "R".to_owned(), |lines| lines.to_string());
        message += &format!(", --rows {lines} --columns {cells} for a row a line");
    }
    message += "; a time or a label among them: --time-column N, --label-column N";
    ReadError::new(message).of_kind(ReadErrorKind::Unsized)
}

/// The names in a comment right above the numbers, if it has as many and they are those of cells.
fn names_in_comment(comment: &[u8], separator: Separator, count: usize) -> Option<Vec<String>> {
    let comment = comment.trim_ascii_start().trim_ascii();
    let start = comment
        .iter()
        .position(|&byte| byte != b'#' && byte != b' ')?;
    let comment = &comment[start..];
    [separator, Separator::of(comment)]
        .into_iter()
        .find_map(|separator| {
            let names: Vec<String> = separator.fields_of(comment, count).map(text).collect();
            let cells = names
                .iter()
                .filter(|name| CellName::of(name).is_some())
                .count();
            (names.len() == count && (cells > 2 || cells == count)).then_some(names)
        })
}

/// The name of a cell: the numbers that say where it is, and the words around them, which say on which sensor.
struct CellName {
    /// The words; `#` in place of the numbers.
    words: Vec<String>,
    /// The row and column, or the place in an order.
    numbers: Vec<u32>,
}

impl CellName {
    /// Splits the last two numbers off a name, or the only one. None if it has none, or one that is too large.
    fn of(name: &str) -> Option<Self> {
        let mut parts: Vec<(bool, String)> = Vec::new();
        for character in name.chars() {
            let is_digit = character.is_ascii_digit();
            match parts.last_mut() {
                Some((kind, part)) if *kind == is_digit => part.push(character),
                _ => parts.push((is_digit, character.into())),
            }
        }
        let mut numbers = Vec::new();
        for (is_number, part) in parts.iter_mut().rev() {
            if *is_number && numbers.len() < 2 {
                numbers.insert(0, part.parse().ok()?);
                "#".clone_into(part);
            }
        }
        let pattern: String = parts.into_iter().map(|(_, part)| part).collect();
        let words: Vec<String> = pattern
            .split(|character: char| !character.is_alphanumeric() && character != '#')
            .filter(|word| !word.is_empty())
            .map(str::to_owned)
            .collect();
        let is_swapped = numbers.len() == 2 && is_column_first(&pattern);
        if is_swapped {
            numbers.swap(0, 1);
        }
        (!numbers.is_empty()).then_some(Self { words, numbers })
    }
}

/// Whether a pattern such as `pad_col#_row#` names the column before the row.
fn is_column_first(pattern: &str) -> bool {
    let word = |text: &str| -> String {
        let end = text.trim_end_matches(|character: char| !character.is_alphabetic());
        let letters: Vec<char> = end
            .chars()
            .rev()
            .take_while(|character| character.is_alphabetic())
            .collect();
        letters.into_iter().rev().collect::<String>().to_lowercase()
    };
    let mut before = pattern.split('#').map(word);
    let (first, second) = (before.next(), before.next());
    first.is_some_and(|word| ["c", "col", "column", "x"].contains(&&*word))
        && second.is_some_and(|word| ["r", "row", "y"].contains(&&*word))
}

impl Columns {
    fn new(
        separator: Separator,
        names: Option<Vec<String>>,
        first: &[&[u8]],
        options: &ReadOptions,
    ) -> Result<Self, ReadError> {
        let count = first.len();
        let find = |column: &Column, flag: &str| -> Result<usize, ReadError> {
            let known = names.as_deref().unwrap_or(&[]);
            match column {
                Column::Number(number) if *number <= count => Ok(*number - 1),
                Column::Number(number) => Err(ReadError::new(format!(
                    "{flag} {number}: the table has {}",
                    counted(count as u64, "column")
                ))),
                Column::Name(name) => known
                    .iter()
                    .position(|own| own.eq_ignore_ascii_case(name))
                    .ok_or_else(|| {
                        let near = did_you_mean(name, known.iter().map(String::as_str));
                        ReadError::new(format!("{flag} {name}: no column has this name{near}"))
                    }),
            }
        };
        let label = options
            .label_column
            .as_ref()
            .map(|column| find(column, "--label-column"))
            .transpose()?;
        let time = match &options.time_column {
            None => None,
            Some(chosen) => {
                let column = find(&chosen.column, "--time-column")?;
                let named = names
                    .as_ref()
                    .and_then(|names| time_name(&names[column]))
                    .flatten();
                Some((column, chosen.unit.or(named)))
            }
        };
        let mut columns = Self {
            separator,
            names,
            count,
            time,
            label,
            sensors: Vec::new(),
            left_out: Vec::new(),
            given: options.size,
        };
        if columns.names.is_some() {
            columns.find_named(first)?;
        } else {
            let beside = |column: &usize| {
                columns.label != Some(*column) && columns.time.map(|time| time.0) != Some(*column)
            };
            let cells = (0..count).filter(beside).collect();
            columns.sensors.push(Sensor {
                name: None,
                columns: cells,
                grid: None,
            });
        }
        Ok(columns)
    }

    /// Finds the time, the label and the cells by their names.
    fn find_named(&mut self, first: &[&[u8]]) -> Result<(), ReadError> {
        let names = self.names.clone().unwrap_or_default();
        if self.time.is_none() {
            let times = || {
                names
                    .iter()
                    .enumerate()
                    .filter_map(|(column, name)| time_name(name).map(|unit| (column, unit)))
            };
            // A date may stand beside the time of day.
            let mut clocks =
                times().filter(|(column, _)| !names[*column].eq_ignore_ascii_case("date"));
            self.time = clocks.next().or_else(|| times().next());
        }
        if self.label.is_none() {
            let column = |label: &&str| {
                names
                    .iter()
                    .position(|name| name.trim().eq_ignore_ascii_case(label))
            };
            self.label = LABELS.iter().find_map(column);
        }
        // The column of each cell, by the words around its numbers, in the order in which they appear.
        let mut groups: Vec<(Vec<String>, CellColumns)> = Vec::new();
        for (column, name) in names.iter().enumerate() {
            let is_beside =
                self.label == Some(column) || self.time.map(|time| time.0) == Some(column);
            // pandas writes its index below an empty name.
            if is_beside || column == 0 && name.is_empty() {
                continue;
            }
            let Some(cell) = CellName::of(name) else {
                self.left_out.push(column);
                continue;
            };
            let known = groups.iter().position(|(words, _)| *words == cell.words);
            let group = known.unwrap_or_else(|| {
                groups.push((cell.words, BTreeMap::new()));
                groups.len() - 1
            });
            if let Some(other) = groups[group].1.insert(cell.numbers, column) {
                return Err(ReadError::new(format!(
                    "two columns for one cell: {} and {}",
                    self.called(other),
                    self.called(column)
                )));
            }
            if groups.len() > MOST_GROUPS {
                return Err(ReadError::new(format!(
                    "more than {MOST_GROUPS} kinds of names"
                )));
            }
        }
        // One or two cells may be a sensor if nothing else is.
        let takes_few = self.given.is_none_or(|size| size.cells() < 3);
        let is_sensor = |(_, cells): &(Vec<String>, CellColumns)| cells.len() > 2;
        let has_sensor = groups.iter().any(is_sensor);
        let (sensors, small): (Vec<_>, Vec<_>) = groups.into_iter().partition(|group| {
            let is_grid = group.1.keys().all(|numbers| numbers.len() == 2);
            is_sensor(group) || !has_sensor && is_grid && takes_few
        });
        self.left_out
            .extend(small.iter().flat_map(|(_, cells)| cells.values()));
        self.left_out
            .retain(|&column| self.separator.is_numeric(first[column]));
        self.left_out.sort_unstable();
        let channels = channel_names(
            &sensors
                .iter()
                .map(|(words, _)| &words[..])
                .collect::<Vec<_>>(),
        );
        for ((_, cells), name) in sensors.into_iter().zip(channels) {
            let grid = match grid(&cells) {
                // The given rows and columns take them in order.
                Err(_) if self.given.is_some_and(|size| size.cells() == cells.len()) => None,
                grid => grid?,
            };
            self.sensors.push(Sensor {
                name,
                columns: cells.into_values().collect(),
                grid,
            });
        }
        if self.sensors.is_empty() {
            return Err(ReadError::new(
                "no three columns have the names of cells, such as s0, s1, s2 or r0c0, r0c1, r0c2; without the line of names, all columns are cells",
            ));
        }
        Ok(())
    }

    /// The name of a column in sentences.
    fn called(&self, column: usize) -> String {
        match self.names.as_ref().and_then(|names| names.get(column)) {
            Some(name) => format!("{:?}", shortened(name)),
            None => format!("column {}", column + 1),
        }
    }

    /// See [`TableLayout::expected`].
    fn expected(&self) -> usize {
        self.names.as_ref().map_or(0, Vec::len)
    }

    fn layout(&self) -> TableLayout {
        let mut slots = vec![None; self.count];
        for (channel, sensor) in self.sensors.iter().enumerate() {
            for (index, &column) in sensor.columns.iter().enumerate() {
                slots[column] = Some((channel, index));
            }
        }
        let channels = self
            .sensors
            .iter()
            .map(|sensor| (sensor.name.clone(), FrameSize::SMALLEST));
        TableLayout {
            separator: self.separator,
            expected: self.expected(),
            slots,
            channels: channels.collect(),
            time: self.time,
            label: self.label,
            in_rows: false,
            is_parted: false,
        }
    }

    /// The error for a number of cells that does not fit the given size, or needs one.
    fn misfit(&self, cells: usize, given: Option<FrameSize>, line: u64) -> ReadError {
        let Some(size) = given else {
            return unclear(cells, None);
        };
        let numbers = counted(cells as u64, "number");
        let expected = format!("{} (or {} for a row)", size.cells(), size.columns());
        let advice = match cells {
            _ if self.names.is_some() => "",
            cells if cells > size.cells() || cells > size.columns().into() && size.rows() > 1 => {
                ": which is the time? --time-column N; a label? --label-column N"
            }
            _ => "",
        };
        in_line(
            line,
            format!("{numbers} a line, expected {expected}{advice}"),
        )
    }
}

/// The columns of cells, by their numbers.
type CellColumns = BTreeMap<Vec<u32>, usize>;

/// The most kinds of names of cells: more than a recording has channels.
const MOST_GROUPS: usize = 256;

const LABELS: [&str; 5] = ["label", "class", "name", "frame", "index"];

pub(super) fn is_label(name: &str) -> bool {
    LABELS
        .iter()
        .any(|label| name.trim().eq_ignore_ascii_case(label))
}

/// The rows and columns that names with two numbers give: there must be a name for each cell.
fn grid(cells: &CellColumns) -> Result<Option<FrameSize>, ReadError> {
    let range = |part: usize| {
        let numbers = cells.keys().filter_map(|numbers| numbers.get(part));
        numbers.clone().min().zip(numbers.max())
    };
    let (Some((top, bottom)), Some((left, right))) = (range(0), range(1)) else {
        return Ok(None);
    };
    let (rows, columns) = (bottom - top + 1, right - left + 1);
    let size = frame_size(columns, rows).filter(|size| size.cells() == cells.len());
    size.map(Some).ok_or_else(|| {
        let found = counted(cells.len() as u64, "column");
        ReadError::new(format!(
            "{found} named by row and column, expected one for each cell of {rows} × {columns}; --rows and --columns take them in order"
        ))
    })
}

/// The names of channels: the words in which the names of their cells differ. A single channel has none.
fn channel_names(sensors: &[&[String]]) -> Vec<Option<String>> {
    let [first, others @ ..] = sensors else {
        return Vec::new();
    };
    if others.is_empty() {
        return vec![None];
    }
    let shortest = sensors.iter().map(|words| words.len()).min().unwrap_or(0);
    let is_common = |at: &dyn Fn(&[String]) -> Option<String>| {
        others.iter().all(|words| at(words) == at(first))
    };
    let start = (0..shortest)
        .take_while(|&index| is_common(&|words| words.get(index).cloned()))
        .count();
    let end = (0..shortest - start)
        .take_while(|&index| is_common(&|words| words.iter().rev().nth(index).cloned()))
        .count();
    let name = |words: &[String]| words.join("_").replace('#', "");
    let mut names: Vec<String> = sensors
        .iter()
        .map(|words| name(&words[start..words.len() - end]))
        .collect();
    let is_unique = |names: &[String]| {
        names
            .iter()
            .enumerate()
            .all(|(index, name)| !names[..index].contains(name))
    };
    if !is_unique(&names) {
        names = sensors.iter().map(|words| words.join("_")).collect();
    }
    names
        .into_iter()
        .map(|name| Some(name).filter(|name| !name.is_empty()))
        .collect()
}
