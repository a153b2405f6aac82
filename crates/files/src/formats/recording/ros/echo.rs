//! The output of `ros2 topic echo` for a message with an array: as `array('H', [0, 1])`, or as YAML.
//!
//! Messages are separated by `---`. Without `--full-length`, an echo leaves out all elements beyond the first 128,
//! and is refused.
//! ```text
//! layout:
//!   dim:
//!   - label: ''
//!     size: 2
//! data:
//! - 0
//! - 12
//! ---
//! ```
//! Notices of `ros2 topic echo` between messages, for example about a lost message, are skipped. A second list of
//! numbers in a message shows that the `---` between two messages is missing. Values before the
//! offset of a layout (`data_offset`) are not cells. Rows and columns are the first two sizes of the layout, if all
//! others are 1; otherwise they must be given. Source: the output of the program.

use crate::formats::recording::error::{in_field, in_line, unshaped};
use std::io::BufRead;

use taxel_core::frame::{Frame, FrameSize, MAX_FRAME_CELLS};

use crate::error::ReadError;
use crate::formats::recording::event::{ChannelInfo, ReadOptions, RecordingEvent, Sink, Stop};
use crate::formats::recording::size::{StreamSize, arranged, matrix_size};
use crate::formats::recording::text::{self, Field, TextLines};

#[derive(Debug, Default)]
pub(in crate::formats) struct RosMessage {
    pub(super) sizes: Vec<u32>,
    /// The elements, at most [`MOST_VALUES`].
    values: Vec<f64>,
    offset: usize,
    open: bool,
    any: bool,
}

/// The state of a message after a line.
#[derive(Debug, PartialEq)]
pub(in crate::formats) enum RosLine {
    More,
    Whole,
    /// The message was shortened by `ros2 topic echo`.
    Cut,
    /// The field with this number, from 1, is not a number.
    Wrong(usize),
    /// Another list of numbers begins: the end of the message before it is missing.
    Unended,
}

impl RosLine {
    /// Returns what is wrong with a message because of this line, apart from values that are left out.
    pub(in crate::formats) fn mistake(&self) -> Option<&'static str> {
        match self {
            Self::Wrong(_) => Some("found something other than a number"),
            Self::Unended => Some("found another array, expected '---' before it"),
            Self::More | Self::Whole | Self::Cut => None,
        }
    }
}

pub(in crate::formats) const UNENDED: &str = "ends inside a message, expected '---'";

/// The most values of a message that are kept, one more than any frame has.
const MOST_VALUES: usize = MAX_FRAME_CELLS + 1;

/// The most sizes of a layout that are kept: more than any message has, so that endless input does not fill the
/// memory.
const MOST_SIZES: usize = 64;

impl RosMessage {
    pub(in crate::formats) fn clear(&mut self) {
        self.sizes.clear();
        self.values.clear();
        self.offset = 0;
        (self.open, self.any) = (false, false);
    }

    pub(in crate::formats) fn begun(&self) -> bool {
        self.any
    }

    pub(in crate::formats) fn cells(&self) -> &[f64] {
        &self.values[self.offset.min(self.values.len())..]
    }

    /// Returns the rows and columns of the message: the `named` ones if they have as many cells, otherwise its own. If
    /// it has none, the `named` ones are returned even if they do not fit. None if both are missing.
    fn size_with(&self, named: Option<FrameSize>) -> Option<FrameSize> {
        arranged(self.cells().len(), self.size(), named).or(named)
    }

    /// Reads the offset of the layout; a field that is not a number is ignored.
    fn offset_of(&mut self, field: &[u8]) {
        let offset = str::from_utf8(field.trim_ascii()).ok();
        if let Some(offset) = offset.and_then(|offset| offset.parse().ok()) {
            self.offset = offset;
        }
    }

    pub(in crate::formats) fn is_open(&self) -> bool {
        self.open && !self.values.is_empty()
    }

    /// Adds a value; returns false if the field is not a number. YAML writes `.nan`, arrays `nan`.
    fn push(&mut self, field: &[u8]) -> bool {
        let field = field.trim_ascii();
        let value = match text::read_value(field) {
            Field::Value(value) => value,
            _ if field.eq_ignore_ascii_case(b"nan") || field.eq_ignore_ascii_case(b".nan") => {
                f64::NAN
            }
            _ => return false,
        };
        if self.values.len() < MOST_VALUES {
            self.values.push(value);
        }
        true
    }

    pub(in crate::formats) fn line(&mut self, line: &[u8]) -> RosLine {
        let line = line.trim_ascii();
        if line.is_empty() || is_notice(line) {
            return RosLine::More;
        }
        if line == b"---" {
            return if self.any {
                RosLine::Whole
            } else {
                RosLine::More
            };
        }
        self.any = true;
        if let Some(size) = line.strip_prefix(b"size:") {
            if self.sizes.len() < MOST_SIZES {
                self.sizes.extend(whole(size));
            }
            return RosLine::More;
        }
        if let Some(offset) = line.strip_prefix(b"data_offset:") {
            self.offset_of(offset);
            return RosLine::More;
        }
        let bracket = line.iter().position(|&byte| byte == b'[');
        let begins_numbers = |start: usize| {
            let first = line[start + 1..].trim_ascii_start().first();
            first.is_some_and(|byte| byte.is_ascii_digit() || b"+-.".contains(byte))
        };
        if !self.values.is_empty() && (line == b"data:" || bracket.is_some_and(begins_numbers)) {
            return RosLine::Unended;
        }
        if line == b"data:" {
            self.open = true;
            return RosLine::More;
        }
        if let Some(value) = line.strip_prefix(b"- ").filter(|_| self.open) {
            return if self.push(value) {
                RosLine::More
            } else if is_cut(value) && !self.values.is_empty() {
                RosLine::Cut
            } else {
                RosLine::Wrong(1)
            };
        }
        match bracket {
            Some(start) => self.list(&line[start + 1..]),
            None if self.open && line != b"-" => self.list(line),
            None => RosLine::More,
        }
    }

    fn list(&mut self, line: &[u8]) -> RosLine {
        let end = line.iter().position(|&byte| byte == b']');
        self.open = end.is_none();
        let list = &line[..end.unwrap_or(line.len())];
        let is_mark = |byte: &u8| *byte == b',' || byte.is_ascii_whitespace();
        let fields = list.split(is_mark).filter(|field| !field.is_empty());
        self.fields(fields.enumerate())
    }

    /// Adds the values of a list. Dots in place of values mean that it was shortened, but only if all other fields
    /// are numbers: noise has dots, too.
    fn fields<'a>(&mut self, fields: impl Iterator<Item = (usize, &'a [u8])>) -> RosLine {
        let mut state = RosLine::More;
        for (index, field) in fields {
            if is_cut(field) && !self.values.is_empty() {
                state = RosLine::Cut;
            } else if !self.push(field) {
                return RosLine::Wrong(index + 1);
            }
        }
        state
    }

    /// Returns the rows and columns of the layout, if it has these two dimensions.
    pub(in crate::formats) fn size(&self) -> Option<FrameSize> {
        matrix_size(&self.sizes)
    }
}

/// Returns true if a line is a notice of `ros2 topic echo` itself.
fn is_notice(line: &[u8]) -> bool {
    let notices = [&b"A message was lost"[..], b"total count", b"WARNING: "];
    let line = line.trim_ascii_start();
    notices.iter().any(|notice| line.starts_with(notice))
}

/// Removes the notices and empty lines before the first message of a text.
pub(in crate::formats::recording) fn without_notices(mut text: &[u8]) -> &[u8] {
    loop {
        let end = text.iter().position(|&byte| byte == b'\n');
        let (line, rest) = text.split_at(end.map_or(text.len(), |end| end + 1));
        if line.is_empty() || !line.trim_ascii().is_empty() && !is_notice(line) {
            return text;
        }
        text = rest;
    }
}

fn whole(field: &[u8]) -> Option<u32> {
    str::from_utf8(field.trim_ascii()).ok()?.parse().ok()
}

fn is_cut(field: &[u8]) -> bool {
    let is_quote = |byte: &u8| matches!(byte, b'\'' | b'"');
    let mut bytes = field.trim_ascii().iter().filter(|byte| !is_quote(byte));
    bytes.by_ref().take(3).eq(b"...") && bytes.next().is_none()
}

/// Returns true if only `ros2 topic echo` prints such a first line of a message.
pub(in crate::formats) fn begins_message(line: &[u8]) -> bool {
    let starts = [&b"array("[..], b"layout:", b"data:"];
    starts.iter().any(|start| line.starts_with(start))
}

pub(in crate::formats) fn size(
    message: &RosMessage,
    expected: &mut StreamSize,
    named: Option<FrameSize>,
    line: u64,
) -> Result<FrameSize, ReadError> {
    let values = message.cells().len();
    let Some(size) = message.size_with(named) else {
        expected.pass_torn();
        let values = values as u64;
        return Err(unshaped(values, None));
    };
    if values != size.cells() {
        expected.pass_torn();
        return Err(text::wrong_count(line, values, size.cells()));
    }
    let admitted = expected.admit(size);
    admitted.map_err(|message| in_line(line, message))?;
    Ok(size)
}

/// Reads a recording. A message that is wrong anywhere is read up to its end: the next one may be right.
pub(in crate::formats::recording) fn read(
    input: impl BufRead,
    options: &ReadOptions,
    sink: &mut Sink<'_>,
) -> Result<(), Stop> {
    let mut lines = TextLines::new(input);
    let mut message = RosMessage::default();
    let mut frame = Frame::default();
    let mut expected = StreamSize::new(None);
    let mut wrong = None;
    loop {
        let ended = !lines.advance()?;
        let number = lines.number();
        let state = if ended {
            RosLine::Whole
        } else {
            message.line(lines.line())
        };
        let error = match state {
            RosLine::More => continue,
            RosLine::Whole if ended && !message.begun() => return Ok(()),
            RosLine::Whole if message.is_open() && ended => Some(in_line(number + 1, UNENDED)),
            RosLine::Cut => {
                let text = "the echo leaves out values ('...'): record it with --full-length";
                Some(in_line(number, text))
            }
            RosLine::Wrong(column) => {
                let mistake = state.mistake();
                mistake.map(|text| in_field(number, column, text))
            }
            RosLine::Whole | RosLine::Unended => {
                let mistake = state.mistake();
                mistake.map(|text| in_line(number, text))
            }
        };
        wrong = wrong.or(error);
        if !matches!(state, RosLine::Whole) {
            continue;
        }
        let read = match wrong.take() {
            Some(error) => Err(error),
            None => size(&message, &mut expected, options.size, number),
        };
        match read {
            Ok(size) => give(&message, size, &mut frame, sink)?,
            Err(error) => sink.damage(options, error, lines.line())?,
        }
        message.clear();
        if ended {
            return Ok(());
        }
    }
}

fn give(
    message: &RosMessage,
    size: FrameSize,
    frame: &mut Frame,
    sink: &mut Sink<'_>,
) -> Result<(), Stop> {
    if frame.number == 0 {
        let info = ChannelInfo {
            size: Some(size),
            ..ChannelInfo::default()
        };
        sink.event(RecordingEvent::Channel(&info))?;
    }
    frame.reset(size);
    frame.values_mut().copy_from_slice(message.cells());
    sink.event(RecordingEvent::Frame(frame))?;
    frame.number += 1;
    Ok(())
}
