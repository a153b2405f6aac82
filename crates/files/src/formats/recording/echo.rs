//! The text of `ros2 topic echo` for messages with an array: `array('H', [0, 1])`, or YAML, with the stamp of a header as
//! the time. Messages are separated by `---`. Without `--full-length`, an echo leaves out all elements beyond the first
//! 128, and is refused. Source: the output of the program.
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
//! Values before the offset of a layout are not cells. Rows and columns are the first two sizes of the layout, if all
//! others are 1; or those that are given, if they have as many cells.

use std::io::BufRead;

use taxel_core::frame::{Frame, FrameSize, MAX_FRAME_CELLS};

use crate::error::ReadError;
use crate::formats::recording::error::{in_field, in_line, unshaped};
use crate::formats::recording::event::{ChannelInfo, ReadOptions, Sink, Stop};
use crate::formats::recording::size::{arranged, changed, matrix_size};
use crate::formats::recording::text::{TextLines, read_value, wrong_count};
use crate::formats::recording::time::{Time, TimeUnit};

/// The most sizes of a layout that are kept: more than any message has.
const MOST_SIZES: usize = 64;

const CUT: &str = "the echo leaves out values ('...'): run ros2 topic echo with --full-length";

/// Whether a text is an echo: its first line that is no notice begins a message, or a list of numbers that `---` ends.
/// In a stream that was joined anywhere, any line may.
pub(crate) fn sniff(text: &[u8], options: &ReadOptions) -> bool {
    let lines = || {
        let lines = text
            .split(|&byte| byte == b'\n')
            .map(<[u8]>::trim_ascii_end);
        lines.filter(|line| !line.is_empty() && !is_notice(line))
    };
    let begins = |line: &[u8]| {
        [&b"array("[..], b"layout:", b"data:"]
            .iter()
            .any(|start| line.starts_with(start))
    };
    let has_end = lines().any(|line| line == b"---");
    let Some(first) = lines().next() else {
        return false;
    };
    begins(first)
        || has_end && (first.starts_with(b"[") || first == b"header:" || options.is_joined)
        || options.is_joined && lines().skip(1).any(begins)
}

/// Whether a line is a notice of `ros2 topic echo` itself.
fn is_notice(line: &[u8]) -> bool {
    let notices = [&b"A message was lost"[..], b"total count", b"WARNING: "];
    notices
        .iter()
        .any(|notice| line.trim_ascii_start().starts_with(notice))
}

/// A message so far.
#[derive(Debug, Default)]
struct Message {
    sizes: Vec<u32>,
    /// The elements, at most one more than any frame has.
    values: Vec<f64>,
    offset: usize,
    /// The whole seconds of the stamp, and its nanoseconds.
    stamp: [Option<i128>; 2],
    /// Whether the list of values has begun and not ended.
    is_open: bool,
    has_begun: bool,
    /// The first thing that is wrong with it.
    error: Option<ReadError>,
}

impl Message {
    fn cells(&self) -> &[f64] {
        &self.values[self.offset.min(self.values.len())..]
    }

    /// Reads a line that is not the end of the message.
    fn line(&mut self, line: &[u8], number: u64) -> Result<(), ReadError> {
        self.has_begun = true;
        let (key, value) = match line.iter().position(|&byte| byte == b':') {
            Some(colon) => (&line[..colon], line[colon + 1..].trim_ascii()),
            None => (&line[..0], line),
        };
        let whole = || {
            str::from_utf8(value)
                .ok()
                .and_then(|value| value.parse::<u32>().ok())
        };
        let list = value.iter().position(|&byte| byte == b'[');
        let is_first = |byte: &u8| byte.is_ascii_digit() || b"+-.".contains(byte);
        let begins = key == b"data"
            || key.is_empty()
                && list.is_some_and(|list| {
                    let numbers = value[list + 1..].trim_ascii_start();
                    numbers.first().is_none_or(is_first)
                });
        match key {
            b"size" if self.sizes.len() < MOST_SIZES => self.sizes.extend(whole()),
            b"data_offset" => self.offset = whole().map_or(0, |offset| offset as usize),
            b"sec" | b"secs" => self.stamp[0] = self.stamp[0].or(whole().map(i128::from)),
            b"nanosec" | b"nsecs" => self.stamp[1] = self.stamp[1].or(whole().map(i128::from)),
            _ if begins && !self.values.is_empty() => {
                return Err(in_line(
                    number,
                    "found another array, expected '---' before it",
                ));
            }
            _ if begins => {
                self.is_open = true;
                self.list(list.map_or(b"", |list| &value[list + 1..]), number)?;
            }
            _ if self.is_open => self.list(line.strip_prefix(b"- ").unwrap_or(line), number)?,
            _ => {}
        }
        Ok(())
    }

    /// Adds the values of a list, or of a part of one. Dots among numbers say that it was shortened.
    fn list(&mut self, line: &[u8], number: u64) -> Result<(), ReadError> {
        let end = line.iter().position(|&byte| byte == b']');
        self.is_open = end.is_none();
        let fields = line[..end.unwrap_or(line.len())]
            .split(|byte| *byte == b',' || byte.is_ascii_whitespace());
        for (field, column) in fields
            .filter(|field| !field.is_empty() && *field != b"-")
            .zip(1..)
        {
            let value = match read_value(field) {
                Some(value) => value,
                _ if field.eq_ignore_ascii_case(b"nan") || field.eq_ignore_ascii_case(b".nan") => {
                    f64::NAN
                }
                _ if matches!(field, b"..." | b"'...'" | b"\"...\"") && !self.values.is_empty() => {
                    return Err(in_line(number, CUT));
                }
                _ => {
                    return Err(in_field(
                        number,
                        column,
                        "found something other than a number",
                    ));
                }
            };
            if self.values.len() <= MAX_FRAME_CELLS {
                self.values.push(value);
            }
        }
        Ok(())
    }

    /// The rows and columns, which must be those before, if there were any.
    fn size(
        &self,
        given: Option<FrameSize>,
        before: Option<FrameSize>,
        line: u64,
    ) -> Result<FrameSize, ReadError> {
        let cells = self.cells().len();
        let own = arranged(cells, matrix_size(&self.sizes), given).or(given);
        let size = own.ok_or_else(|| unshaped(cells as u64, None))?;
        match before {
            _ if cells != size.cells() => Err(wrong_count(line, cells, size.cells())),
            Some(before) if before != size => Err(in_line(line, changed(size, before))),
            _ => Ok(size),
        }
    }

    fn time(&self) -> Option<Time> {
        let [seconds, rest] = self.stamp;
        let rest = Time::of_whole(rest.unwrap_or(0), TimeUnit::Nanoseconds);
        Some(Time::of_whole(seconds?, TimeUnit::Seconds).plus(rest))
    }
}

/// Reads a recording or a stream. A message that is wrong anywhere is read up to its end: the next one may be right.
pub(crate) fn read(input: &mut dyn BufRead, sink: &mut Sink<'_>) -> Result<(), Stop> {
    let mut lines = TextLines::new(input);
    let mut message = Message::default();
    let mut frame = Frame::default();
    let mut before = None;
    // A stream may be joined inside a message.
    let mut skipping = sink.options.is_joined;
    loop {
        let more = sink.advance(&mut lines)?;
        let number = lines.number + u64::from(!more);
        let line = lines.line().trim_ascii();
        skipping &= !line.starts_with(b"array(");
        if more && line != b"---" {
            if !(line.is_empty() || is_notice(line) || skipping)
                && let Err(error) = message.line(line, number)
            {
                if error.message == CUT {
                    return Err(error.into());
                }
                message.error.get_or_insert(error);
            }
            continue;
        }
        let whole = std::mem::take(&mut message);
        if whole.has_begun && !skipping {
            let torn = "ends inside a message, expected '---'";
            let is_torn =
                !more && (!lines.torn().is_empty() || whole.is_open && !whole.values.is_empty());
            let read = match whole.error.clone() {
                Some(error) => Err(error),
                None if is_torn => Err(in_line(number, torn)),
                None => whole.size(sink.options.size, before, number),
            };
            match read {
                Ok(size) => {
                    before = Some(size);
                    let info = || ChannelInfo::of_size(size);
                    let channel = sink.channel(None, info)?;
                    frame.reset(size);
                    frame.values_mut().copy_from_slice(whole.cells());
                    frame.time = whole.time().map(|time| sink.state.clock.since_first(time));
                    sink.frame(channel, &mut frame)?;
                }
                Err(error) if error.kind == crate::error::ReadErrorKind::Unsized => {
                    return Err(error.into());
                }
                Err(error) => sink.damage(error, lines.line())?,
            }
        }
        skipping = false;
        if !more {
            return Ok(());
        }
    }
}
