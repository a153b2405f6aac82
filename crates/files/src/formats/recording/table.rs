//! Tables of numbers, with or without names: a frame a line, or a row a line. What is not clear is refused, with the
//! flag that settles it.
//!
//! | rule | |
//! |---|---|
//! | names | the first line with a field that is no number; a line 0, 1, …, n − 1; a comment right above the numbers with a name for each of them |
//! | cells | all columns whose names have numbers: two of them are row and column, one is the place in their order; what else is in the name is the channel. Without names all fields, in order |
//! | size | the given rows and columns; else of the names; else lines in blocks, as many lines as fields, or n² numbers a line |

use std::collections::{BTreeMap, HashSet};
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
    Separator, TextLines, is_blank, is_comment, is_none, text, whole, wrong_count, wrong_field,
};
use crate::formats::recording::time::{TimeUnit, read_moment, time_name};

/// The most fields of a line: cells, and a few beside them.
const MOST_FIELDS: usize = MAX_FRAME_CELLS + 16;

/// The most rows that are waited for until it is clear how a live stream is arranged: more than a sensor has.
const MOST_LIVE_ROWS: usize = 65;

/// The most bytes of the lines that are waited for.
const MOST_HELD: usize = 16 << 20;

/// How a table is arranged: of each field, what it is. An interrupted stream goes on with it.
#[derive(Clone, Debug)]
pub(super) struct TableLayout {
    separator: Separator,
    /// The names of the fields; None without a header.
    names: Option<Vec<String>>,
    uses: Vec<Use>,
    time_unit: Option<TimeUnit>,
    channels: Vec<Channel>,
    /// The order of the cells, in words.
    order: &'static str,
    /// Whether a line is a row; otherwise it is a frame.
    in_rows: bool,
    /// Whether empty lines or lines of text end the frames in rows.
    is_parted: bool,
}

/// What a field is.
#[derive(Clone, Copy, Debug, PartialEq)]
enum Use {
    Cell {
        channel: usize,
        index: usize,
    },
    Time,
    Label,
    /// A number that is none of these.
    LeftOut,
    Nothing,
}

#[derive(Clone, Debug)]
struct Channel {
    name: Option<String>,
    cells: usize,
    /// The rows and columns; None until something gives them.
    size: Option<FrameSize>,
}

/// Whether a text begins like a table: with a line of two numbers or more that are at least half of its fields; or with
/// a number, if the rows and columns are given.
pub(super) fn sniff(head: &[u8], options: &ReadOptions, is_all: bool) -> bool {
    let end = head.iter().rposition(|&byte| byte == b'\n').unwrap_or(0);
    let whole = if is_all { head } else { &head[..end] };
    let lines = whole.split(|&byte| byte == b'\n');
    // A stream that was joined anywhere begins with the rest of a line.
    lines.skip(usize::from(options.is_joined)).any(|line| {
        let (_, line) = bare(line);
        if is_blank(line) || is_comment(line) {
            return false;
        }
        let separator = Separator::of(line);
        let (mut fields, mut numbers, mut filled) = (0, 0, 0);
        for field in separator.fields(line, 0) {
            let is_number = separator.is_numeric(field);
            fields += 1;
            numbers += usize::from(is_number);
            filled += usize::from(is_number && !field.trim_ascii().is_empty());
        }
        // Spreadsheets fill lines of words, and empty ones, with separators.
        let least = if numbers == fields { 1 } else { 2 };
        let is_one = fields == 1 && numbers == 1 && options.size.is_some();
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

/// Removes what is no part of the numbers of a line: the time that a serial monitor puts before them, `12:00:01.100 -> `,
/// and brackets around all of them.
fn bare(line: &[u8]) -> (Option<&[u8]>, &[u8]) {
    let clock = line.get(..24).unwrap_or(line);
    let arrow = clock.windows(2).position(|pair| pair == b"->");
    let (time, line) = match arrow.map(|at| (line[..at].trim_ascii(), &line[at + 2..])) {
        Some((time, rest)) if read_moment(time).is_some() => (Some(time), rest),
        _ => (None, line),
    };
    let ends = line.trim_ascii_end();
    let ends = ends.strip_suffix(b",").unwrap_or(ends).ends_with(b"]");
    if !ends && !line.trim_ascii_start().starts_with(b"[") {
        return (time, line);
    }
    let mut inside = line;
    while let [b'[' | b' ' | b'\t', rest @ ..] = inside {
        inside = rest;
    }
    while let [rest @ .., b'[' | b']' | b',' | b' ' | b'\t'] = inside {
        inside = rest;
    }
    let is_nested = inside.iter().any(|byte| b"[]".contains(byte));
    (time, if is_nested { line } else { inside })
}

/// Reads a table.
pub(super) fn read(input: &mut dyn BufRead, sink: &mut Sink<'_>) -> Result<(), Stop> {
    let is_inside = sink.options.is_joined;
    let mut table = Table {
        lines: TextLines::new(input),
        sink,
        is_one: false,
        is_inside,
    };
    table.read()
}

/// Reads a text that is known to be a single frame, a row a line.
///
/// # Errors
/// If the text is no table, or larger than a frame; with the kind [`ReadErrorKind::UnknownFormat`] if it has no numbers.
pub fn read_rows(mut text: &[u8], consumer: &mut RecordingSink<'_>) -> Result<(), ReadError> {
    let (state, options) = (&mut ReadState::default(), &ReadOptions::default());
    let mut table = Table {
        lines: TextLines::new(&mut text as &mut dyn BufRead),
        sink: &mut Sink {
            consumer,
            state,
            options,
        },
        is_one: true,
        is_inside: false,
    };
    Stop::settled(table.read())
}

struct Table<'a, 'b> {
    lines: TextLines<&'a mut dyn BufRead>,
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
        for field in separator.fields(fields, count) {
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

impl Table<'_, '_> {
    fn read(&mut self) -> Result<(), Stop> {
        // What was joined anywhere begins with the rest of a line.
        if self.sink.options.is_joined {
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
        self.sink.advance(&mut self.lines)
    }

    /// The layout before an interruption, unless a header comes again.
    fn earlier(&mut self) -> Result<Option<TableLayout>, Stop> {
        let Some(layout) = self.sink.state.layout.clone() else {
            return Ok(None);
        };
        if !self.advance()? {
            return Ok(Some(layout));
        }
        let (number, line) = self.lines.held();
        let fields: Vec<&[u8]> = layout.fields(bare(&line).1).collect();
        let begins_anew = fields.len() > 1 && self.is_header(&fields, layout.separator);
        self.lines.unread([(number, line)]);
        Ok(Some(layout).filter(|_| !begins_anew))
    }

    /// Finds out how the table is arranged; the lines of its numbers are read again. In a live stream, lines that do not
    /// fit are dropped until some do; None if it ends before that.
    fn layout(&mut self) -> Result<Option<TableLayout>, Stop> {
        let is_live = self.sink.options.leaves_out;
        loop {
            let mut layout = None;
            let found = self.columns().and_then(|columns| match columns {
                Some(columns) => self.arranged(layout.insert(columns)),
                None => Ok(false),
            });
            match (found, layout) {
                (Ok(true), Some(mut layout)) => {
                    layout.is_parted |= layout.in_rows && self.sink.options.is_joined;
                    self.tell(&layout)?;
                    self.sink.state.clock.unit = layout.time_unit;
                    return Ok(Some(layout));
                }
                (Ok(_), Some(_)) => {}
                (Ok(_), None) if is_live => return Ok(None),
                (Ok(_), None) => return Err(unknown_format().into()),
                (Err(Stop::Failed(error)), _)
                    if is_live && error.kind == ReadErrorKind::Invalid =>
                {
                    self.drop_line(error)?;
                }
                (Err(stop), _) => return Err(stop),
            }
        }
    }

    fn drop_line(&mut self, error: ReadError) -> Result<(), Stop> {
        self.sink.damage(error, self.lines.line())
    }

    /// Finds the header, if there is one, up to the first line of numbers.
    fn columns(&mut self) -> Result<Option<TableLayout>, Stop> {
        let mut comment = None;
        let mut above: Option<(u64, Vec<u8>)> = None;
        while self.advance()? {
            let (number, line) = (self.lines.number, self.lines.line());
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
            let expected = match &above {
                Some((_, names)) => separator.fields(bare(names).1, 0).count(),
                None => 0,
            };
            let found = separator.fields(fields, expected);
            let found: Vec<&[u8]> = found.take(MOST_FIELDS + 1).collect();
            if found.len() > MOST_FIELDS {
                let message =
                    "more than 262,160 fields, expected at most 512 × 512 cells and 16 beside them";
                return Err(in_line(number, message).into());
            }
            let is_number = |field: &&[u8]| separator.is_numeric(field) && !field.is_empty();
            if expected != found.len() && self.is_header(&found, separator)
                || !found.iter().any(is_number)
            {
                above = Some(self.lines.held());
                continue;
            }
            let (names, at) = match &above {
                Some((at, names)) if expected == found.len() => {
                    let names = separator.fields(bare(names).1, expected);
                    (Some(names.map(text).collect()), *at)
                }
                // A line of text may stand above the first frame, but not a list of words.
                Some((at, words))
                    if expected > 1 && separator != Separator::Spaces
                        || !matches!(Line::of(words, separator, found.len()), Line::Break) =>
                {
                    return Err(above_table(*at, expected, number, found.len()).into());
                }
                _ => {
                    let names = |comment| names_in_comment(comment, separator, found.len());
                    let names = comment.as_deref().and_then(names);
                    let at = above.as_ref().filter(|_| names.is_some());
                    (names, at.map_or(number, |(at, _)| *at))
                }
            };
            let layout = TableLayout::new(separator, names, &found, self.sink.options);
            return Ok(Some(layout.map_err(|error| error.in_line(at))?));
        }
        Ok(None)
    }

    /// Arranges the cells, with the first line of numbers, which is read again. Returns false if the lines before the next
    /// one do not fit it and were dropped.
    fn arranged(&mut self, layout: &mut TableLayout) -> Result<bool, Stop> {
        let given = self.sink.options.size;
        let total: usize = layout.channels.iter().map(|channel| channel.cells).sum();
        let is_single = layout.channels.len() == 1;
        let is_row = |size: &FrameSize| is_single && usize::from(size.columns()) == total;
        if let Some(size) = given.filter(|size| size.cells() == total || is_row(size)) {
            layout.in_rows = size.cells() != total;
            layout.take_as_one(size);
        } else if is_single && given.is_none() && layout.channels[0].size.is_none() {
            self.lines.unread([self.lines.held()]);
            return self.look_ahead(layout, total);
        } else {
            for (index, channel) in layout.channels.iter_mut().enumerate() {
                let own = given.filter(|size| size.cells() == channel.cells);
                let own = own.or(channel.size);
                let squared = square(channel.cells, 2).filter(|_| given.is_none());
                let Some(size) = own.or(squared) else {
                    let (cells, is_named) = (channel.cells, layout.names.is_some());
                    return Err(misfit(cells, given, self.lines.number, is_named).into());
                };
                channel.size = Some(size);
                if index == 0 && own.is_none() {
                    self.sink.note(&RecordingNote::square(size.rows()))?;
                }
            }
        }
        self.lines.unread([self.lines.held()]);
        Ok(true)
    }

    /// Whether these fields are names: words, beside numbers only if the numbers count up or the words are usual names;
    /// or numbers that count up from 0. A time of day or a date is no word.
    fn is_header(&self, fields: &[&[u8]], separator: Separator) -> bool {
        let chosen = |index: usize| {
            let number = Some(&Column::Number(index + 1));
            self.sink.options.label_column.as_ref() == number
                || self
                    .sink
                    .options
                    .time_column
                    .as_ref()
                    .map(|time| &time.column)
                    == number
        };
        let (mut words, mut numbers, mut is_usual) = (0, Vec::new(), true);
        for (index, field) in fields.iter().enumerate() {
            if field.is_empty() || chosen(index) {
                continue;
            }
            match separator.value(field) {
                Some(number) if !number.is_nan() => numbers.push(number),
                None if read_moment(field).is_none() => {
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
            return many && counts(0.0) && !fields[1..].iter().any(|field| field.is_empty());
        }
        numbers.is_empty() || is_usual || many && (counts(0.0) || counts(1.0))
    }

    /// Reads lines until it is clear how they are arranged; they are read again. Returns false if the next line of a live
    /// stream has another number of fields than those before it, which are dropped.
    fn look_ahead(&mut self, layout: &mut TableLayout, cells: usize) -> Result<bool, Stop> {
        let (is_live, is_named) = (self.sink.options.leaves_out, layout.names.is_some());
        let most = if is_live {
            MOST_LIVE_ROWS
        } else {
            usize::from(MAX_FRAME_SIDE) + 1
        };
        let mut held: Vec<(u64, Vec<u8>)> = Vec::new();
        // The rows since the last end of a frame, those of the frame before it, and all of them.
        let (mut rows, mut before, mut all, mut bytes) = (0_usize, 0_usize, 0_usize, 0);
        // The rows of a frame, if these are parted.
        let (mut block, mut has_ended) = (None, false);
        while block.is_none() {
            let is_wide = cells >= most && !self.is_one && all > usize::from(is_live);
            if is_wide || rows >= most || all >= 3 * most || bytes > MOST_HELD {
                break;
            }
            if !self.advance()? {
                has_ended = true;
                block = Some(before).filter(|&before| before > 1 && rows > 0);
                break;
            }
            let (number, line) = self.lines.held();
            let expected = layout.uses.len();
            let (is_row, is_break, count) = match Line::of(&line, layout.separator, expected) {
                Line::Fields(_, fields) => (true, false, layout.fields(fields).count()),
                Line::Break => (false, true, expected),
                Line::Comment => (false, false, expected),
            };
            if count != expected && !(is_live && is_named) {
                if is_live {
                    self.lines.unread([(number, line)]);
                } else if all == 1 && !is_named {
                    return Err(above_table(held[0].0, expected, number, count).into());
                }
                self.sink
                    .damage(wrong_count(number, count, expected), b"")?;
                return Ok(false);
            }
            if is_break && std::mem::take(&mut self.is_inside) {
                // What precedes the first end of a frame is the rest of one.
                held.clear();
                (rows, all) = (0, 0);
            }
            bytes += line.len();
            held.push((number, line));
            // A file is parted if more follows; of a live stream, the first frame may be torn.
            let is_block = if is_live {
                is_break && rows > 1 && rows == before
            } else {
                is_row && rows == 0 && before > 1
            };
            block = is_block.then_some(before);
            if is_break && rows > 0 {
                (before, rows) = (rows, 0);
            }
            rows += usize::from(is_row);
            all += usize::from(is_row);
        }
        self.lines.unread(held);
        let squared = square(cells, if is_named { 2 } else { 3 }).filter(|_| !self.is_one);
        let is_one = has_ended && (self.is_one || all == cells);
        if let Some(size) = block.and_then(|rows| frame_size(cells, rows)) {
            layout.take_as_one(size);
            (layout.in_rows, layout.is_parted) = (true, true);
        } else if let Some(size) = frame_size(cells, all).filter(|_| is_one) {
            layout.take_as_one(size);
            layout.in_rows = true;
        } else if let Some(size) = squared {
            layout.take_as_one(size);
            self.sink.note(&RecordingNote::square(size.rows()))?;
        } else {
            return Err(unclear(cells, has_ended.then_some(all)).into());
        }
        Ok(true)
    }

    /// Notes how the table is read.
    fn tell(&mut self, layout: &TableLayout) -> Result<(), Stop> {
        let names = |wanted: Use| -> Vec<String> {
            let columns = (0..layout.uses.len()).filter(|&column| layout.uses[column] == wanted);
            let called = |column: usize| match &layout.names {
                Some(names) => format!("{:?}", shortened(&names[column])),
                None => format!("column {}", column + 1),
            };
            columns.map(called).collect()
        };
        let mut notes = Vec::new();
        for time in names(Use::Time) {
            let unit = layout.time_unit.map(|unit| format!(", in {}", unit.name()));
            notes.push(format!("times: {time}{}", unit.unwrap_or_default()));
        }
        for label in names(Use::Label) {
            notes.push(format!("labels: {label}"));
        }
        let lines = match (layout.in_rows, layout.is_parted) {
            (false, _) => "a frame a line",
            (true, false) => "a row a line",
            (true, true) => "a row a line; an empty line or a line of text ends a frame",
        };
        notes.push(format!("cells: {}; {lines}", layout.order));
        let mut left_out = names(Use::LeftOut);
        if left_out.len() > 16 {
            left_out.truncate(16);
            left_out.push("…".to_owned());
        }
        if !left_out.is_empty() {
            notes.push(format!("left out: {}", left_out.join(", ")));
        }
        notes
            .into_iter()
            .try_for_each(|text| self.sink.note(&RecordingNote::Reading(text)))
    }

    fn frames(&mut self, layout: &TableLayout) -> Result<(), Stop> {
        let sizes = layout.channels.iter().filter_map(|channel| channel.size);
        let mut taken = Taken {
            frames: sizes.map(Frame::new).collect(),
            time: None,
            label: None,
        };
        let height = usize::from(taken.frames[0].rows());
        let mut row = 0;
        let mut is_parted = layout.is_parted;
        // What was joined anywhere begins inside a frame.
        let mut skipping = layout.in_rows && self.is_inside;
        loop {
            let more = self.advance()?;
            let number = self.lines.number;
            if !is_blank(self.lines.torn()) {
                let error = in_line(number + 1, "no line break after it");
                return if skipping {
                    Ok(())
                } else {
                    self.drop_line(error)
                };
            }
            let line = if more {
                Line::of(self.lines.line(), layout.separator, layout.uses.len())
            } else {
                Line::Break
            };
            match line {
                Line::Break if layout.in_rows => {
                    if row == height {
                        self.give(layout, &mut taken)?;
                    } else if row > 0 {
                        let rows = counted(row as u64, "row");
                        let message = format!("the frame ends after {rows}, expected {height}");
                        self.drop_line(in_line(number + u64::from(!more), message))?;
                    }
                    (row, skipping, is_parted) = (0, false, true);
                }
                Line::Comment | Line::Break => {}
                Line::Fields(..) if skipping => {}
                Line::Fields(time, fields) => {
                    if row == 0 {
                        taken.time = time.map(<[u8]>::to_vec);
                    }
                    let filled = if row == height && layout.in_rows {
                        let message =
                            format!("another row, expected an empty line after {height} of them");
                        Err(in_line(number, message))
                    } else {
                        layout.fill(fields, number, row, &mut taken)
                    };
                    if let Err(error) = filled {
                        self.drop_line(error)?;
                        (row, skipping) = (0, layout.in_rows);
                        continue;
                    }
                    row += 1;
                    if !layout.in_rows || row == height && !is_parted {
                        self.give(layout, &mut taken)?;
                        row = 0;
                    }
                }
            }
            if !more {
                return Ok(());
            }
        }
    }

    fn give(&mut self, layout: &TableLayout, taken: &mut Taken) -> Result<(), Stop> {
        let clock = &mut self.sink.state.clock;
        let (mut read, mut start, mut unread) = (None, None, None);
        if let Some(field) = &taken.time {
            match (layout.separator.value(field), read_moment(field)) {
                (Some(value), _) if value.is_nan() => {}
                (Some(value), _) => read = Some(clock.number(field, value)),
                (None, Some(moment)) => {
                    read = Some(clock.moment(moment));
                    start = Some(text(field));
                }
                (None, None) => unread = Some(shortened(&text(field))),
            }
        }
        let time = read.map(|read| clock.since_first(read));
        for (frame, own) in taken.frames.iter_mut().zip(&layout.channels) {
            let channel = self.sink.channel(own.name.as_deref(), || ChannelInfo {
                size: own.size,
                start: start.clone(),
                ..ChannelInfo::default()
            })?;
            if let Some(text) = unread.take() {
                self.sink.unread_time(channel, &text)?;
            }
            frame.time = time;
            frame.label.clone_from(&taken.label);
            self.sink.frame(channel, frame)?;
        }
        Ok(())
    }
}

/// The frames that are being filled, one a channel, with the time and the label in the first line.
struct Taken {
    frames: Vec<Frame>,
    time: Option<Vec<u8>>,
    label: Option<Label>,
}

impl TableLayout {
    fn new(
        separator: Separator,
        names: Option<Vec<String>>,
        first: &[&[u8]],
        options: &ReadOptions,
    ) -> Result<Self, ReadError> {
        let known = names.as_deref().unwrap_or(&[]);
        let find = |column: &Column, flag: &str| match column {
            Column::Number(number) if *number <= first.len() => Ok(*number - 1),
            Column::Number(number) => {
                let columns = counted(first.len() as u64, "column");
                let message = format!("{flag} {number}: the table has {columns}");
                Err(ReadError::new(message))
            }
            Column::Name(name) => {
                let found = known.iter().position(|own| own.eq_ignore_ascii_case(name));
                found.ok_or_else(|| {
                    let near = did_you_mean(name, known.iter().map(String::as_str));
                    ReadError::new(format!("{flag} {name}: no column has this name{near}"))
                })
            }
        };
        let label = match &options.label_column {
            Some(chosen) => Some(find(chosen, "--label-column")?),
            None => LABELS.iter().find_map(|label| {
                let mut names = known.iter();
                names.position(|name| name.trim().eq_ignore_ascii_case(label))
            }),
        };
        let times = known.iter().map(|name| time_name(name));
        let mut times = times.enumerate().filter_map(|(at, unit)| Some((at, unit?)));
        let time = match &options.time_column {
            Some(chosen) => {
                let column = find(&chosen.column, "--time-column")?;
                let named = times.find(|(at, _)| *at == column);
                Some((column, chosen.unit.or(named.and_then(|(_, unit)| unit))))
            }
            // A date may stand beside the time of day.
            None => times.min_by_key(|(at, _)| known[*at].eq_ignore_ascii_case("date")),
        };
        let mut layout = Self {
            separator,
            names: None,
            uses: vec![Use::Nothing; first.len()],
            time_unit: time.and_then(|(_, unit)| unit),
            channels: Vec::new(),
            order: "all other numbers of a line, in order",
            in_rows: false,
            is_parted: false,
        };
        if let Some((time, _)) = time {
            layout.uses[time] = Use::Time;
        }
        // A chosen label may have the name of a time.
        if let Some(label) = label
            && (options.label_column.is_some() || layout.uses[label] == Use::Nothing)
        {
            layout.uses[label] = Use::Label;
        }
        if let Some(names) = &names {
            layout.find_cells(names, first, options.size)?;
        } else {
            let mut cells = 0;
            for field in layout.uses.iter_mut().filter(|own| **own == Use::Nothing) {
                let (channel, index) = (0, cells);
                *field = Use::Cell { channel, index };
                cells += 1;
            }
            let (name, size) = (None, None);
            layout.channels.push(Channel { name, cells, size });
        }
        layout.names = names;
        Ok(layout)
    }

    /// Finds the cells by their names.
    fn find_cells(
        &mut self,
        names: &[String],
        first: &[&[u8]],
        given: Option<FrameSize>,
    ) -> Result<(), ReadError> {
        // The column of each cell, by the words around its numbers, in the order in which they appear.
        let mut groups: Vec<(Vec<String>, CellColumns)> = Vec::new();
        for (column, name) in names.iter().enumerate() {
            // pandas writes its index below an empty name.
            if self.uses[column] != Use::Nothing || column == 0 && name.is_empty() {
                continue;
            }
            if self.separator.is_numeric(first[column]) {
                self.uses[column] = Use::LeftOut;
            }
            let Some(cell) = CellName::of(name) else {
                continue;
            };
            let known = groups.iter().position(|(words, _)| *words == cell.words);
            let group = known.unwrap_or_else(|| {
                groups.push((cell.words, BTreeMap::new()));
                groups.len() - 1
            });
            if let Some(other) = groups[group].1.insert(cell.numbers, column) {
                let [other, name] = [&names[other], name].map(|name| shortened(name));
                let message = format!("two columns for one cell: {other:?} and {name:?}");
                return Err(ReadError::new(message));
            }
            if groups.len() > MOST_GROUPS {
                let message = format!("more than {MOST_GROUPS} kinds of names");
                return Err(ReadError::new(message));
            }
        }
        // One or two cells may be a sensor if nothing else is.
        let takes_few = given.is_none_or(|size| size.cells() < 3)
            && groups.iter().all(|(_, cells)| cells.len() < 3);
        groups.retain(|(_, cells)| {
            let is_grid = cells.keys().all(|numbers| numbers.len() == 2);
            cells.len() > 2 || takes_few && is_grid
        });
        if groups.is_empty() {
            let message = "no three columns have the names of cells, such as s0, s1, s2 or r0c0, r0c1, r0c2; without the line of names, all columns are cells";
            return Err(ReadError::new(message));
        }
        let words: Vec<&[String]> = groups.iter().map(|(words, _)| &words[..]).collect();
        let channels = channel_names(&words).into_iter().enumerate();
        for ((channel, name), (_, cells)) in channels.zip(&groups) {
            let size = match grid(cells) {
                // The given rows and columns take them in order.
                Err(_) if given.is_some_and(|size| size.cells() == cells.len()) => None,
                grid => grid?,
            };
            for (index, &column) in cells.values().enumerate() {
                self.uses[column] = Use::Cell { channel, index };
            }
            let cells = cells.len();
            self.channels.push(Channel { name, cells, size });
        }
        self.order = if self.channels.iter().all(|channel| channel.size.is_some()) {
            "by the row and column in their names"
        } else {
            "in the order of the numbers in their names"
        };
        Ok(())
    }

    /// The fields of a line. If they have names, the last one may be empty; otherwise a separator at the end is none.
    fn fields<'a>(&self, line: &'a [u8]) -> impl Iterator<Item = &'a [u8]> + use<'a> {
        let expected = self.names.as_ref().map_or(0, Vec::len);
        self.separator.fields(line, expected)
    }

    /// Takes all cells as those of one channel.
    fn take_as_one(&mut self, size: FrameSize) {
        let cells = |channel: usize| self.channels[..channel].iter().map(|own| own.cells).sum();
        let starts: Vec<usize> = (0..self.channels.len()).map(cells).collect();
        for field in &mut self.uses {
            if let Use::Cell { channel, index } = field {
                *index += starts[*channel];
                *channel = 0;
            }
        }
        let name = self.channels[0].name.take().filter(|_| starts.len() == 1);
        self.channels = vec![Channel {
            name,
            cells: size.cells(),
            size: Some(size),
        }];
    }

    /// Fills the cells of a line into its row; in the first row of a frame, its time and label, too.
    fn fill(
        &self,
        line: &[u8],
        number: u64,
        row: usize,
        taken: &mut Taken,
    ) -> Result<(), ReadError> {
        let width = usize::from(taken.frames[0].columns());
        let offset = if self.in_rows { row * width } else { 0 };
        let mut found = 0;
        for field in self.fields(line) {
            let own = self.uses.get(found);
            found += 1;
            match own {
                Some(&Use::Cell { channel, index }) => {
                    let cell = self.separator.value(field);
                    taken.frames[channel].values_mut()[offset + index] =
                        cell.ok_or_else(|| self.wrong(number, found, field))?;
                }
                Some(Use::Time) if row == 0 => taken.time = Some(field.to_vec()),
                Some(Use::Label) if row == 0 => {
                    let number = self.separator.value(field).and_then(whole);
                    let is_none = is_none(field);
                    let label = || Label::Text(text(field));
                    let label = number.map_or_else(label, Label::Number);
                    taken.label = Some(label).filter(|_| !is_none);
                }
                _ => {}
            }
        }
        if found == self.uses.len() {
            Ok(())
        } else {
            Err(wrong_count(number, found, self.uses.len()))
        }
    }

    /// The error for a text in a cell: it may be a label or a time.
    fn wrong(&self, number: u64, column: usize, field: &[u8]) -> ReadError {
        let mut error = wrong_field(number, column, field);
        if !self.uses.contains(&Use::Time) && read_moment(field).is_some() {
            error.message += &format!("; if it is the time: --time-column {column}");
        } else if !self.uses.contains(&Use::Label)
            && field.first().is_some_and(u8::is_ascii_alphabetic)
        {
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

/// The error for a number of cells that does not fit the given size, or needs one.
fn misfit(cells: usize, given: Option<FrameSize>, line: u64, is_named: bool) -> ReadError {
    let Some(size) = given else {
        return unclear(cells, None);
    };
    let (all, row) = (size.cells(), usize::from(size.columns()));
    let advice = if !is_named && (cells > all || cells > row && size.rows() > 1) {
        ": which is the time? --time-column N; a label? --label-column N"
    } else {
        ""
    };
    let numbers = counted(cells as u64, "number");
    let message = format!("{numbers} a line, expected {all} (or {row} for a row){advice}");
    in_line(line, message)
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
    let mut comment = comment.trim_ascii();
    while let [b'#' | b' ', rest @ ..] = comment {
        comment = rest;
    }
    let separators = [separator, Separator::of(comment)].into_iter();
    let names = separators.map(|own| own.fields(comment, count).map(text).collect());
    names.into_iter().find(|names: &Vec<String>| {
        let cells = names.iter().filter(|name| CellName::of(name).is_some());
        let cells = cells.count();
        names.len() == count && (cells > 2 || cells == count)
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
        let runs = name.rsplit(|character: char| !character.is_ascii_digit());
        let (mut pattern, mut numbers) = (name.to_owned(), Vec::new());
        for run in runs.filter(|run| !run.is_empty()).take(2) {
            numbers.insert(0, run.parse().ok()?);
            let at = pattern.rfind(run)?;
            pattern.replace_range(at..at + run.len(), "#");
        }
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
    let word = |text: &str| {
        let mut words = text.rsplit(|character: char| !character.is_alphabetic());
        let word = words.find(|word| !word.is_empty());
        word.unwrap_or_default().to_lowercase()
    };
    let words: Vec<String> = pattern.split('#').map(word).collect();
    ["c", "col", "column", "x"].contains(&&*words[0])
        && words
            .get(1)
            .is_some_and(|word| ["r", "row", "y"].contains(&&**word))
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
    if sensors.len() == 1 {
        return vec![None];
    }
    let shortest = sensors.iter().map(|words| words.len()).min().unwrap_or(0);
    let are_equal = |word: &dyn Fn(&[String]) -> String| {
        let mut pairs = sensors.windows(2);
        pairs.all(|pair| word(pair[0]) == word(pair[1]))
    };
    let is_start = |at: &usize| are_equal(&|words| words[*at].clone());
    let is_end = |at: &usize| are_equal(&|words| words[words.len() - 1 - at].clone());
    let start = (0..shortest).take_while(is_start).count();
    let end = (0..shortest - start).take_while(is_end).count();
    let own = |words: &&[String]| words[start..words.len() - end].join("_").replace('#', "");
    let mut names: Vec<String> = sensors.iter().map(own).collect();
    if names.iter().collect::<HashSet<_>>().len() < names.len() {
        names = sensors.iter().map(|words| words.join("_")).collect();
    }
    let some = |name: String| Some(name).filter(|name| !name.is_empty());
    names.into_iter().map(some).collect()
}
