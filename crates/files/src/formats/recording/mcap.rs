//! MCAP files of ROS 2: arrays, images and tactile states in CDR. A topic is a channel; a sensor of a tactile state is
//! the channel `TOPIC#SENSOR`.
//!
//! The file is read from front to back in the same memory, and a file that was never closed still gives all its whole
//! messages. Its records are read by [`records`](super::records). The time is that of the log, from the first message
//! with a frame on; if it counts from 1970, it gives the start of the recording. Other messages than these are skipped:
//!
//! | message | its frames |
//! |---|---|
//! | `std_msgs/*MultiArray` | a frame; rows and columns from the layout's first two sizes, if all others are 1 |
//! | `sensor_msgs/Image` | a frame; `mono8`, `mono16`, and types of `OpenCV` with one channel, such as `16UC1` and `32FC1` |
//! | `tactile_msgs/TactileState` | for each of its sensors a frame |
//!
//! CDR writes numbers at multiples of their size, counted from the end of a header of four bytes that gives their byte
//! order.
//! ```text
//! 00 01 00 00   header: little endian
//! 05 00 00 00   the length of a text, with its zero
//! 61 62 63 64 00   "abcd", then three bytes of padding before the next word
//! ```
//! Sources: the definitions of these messages; the OMG's DDS-RTPS specification, encapsulation `CDR_BE` and `CDR_LE`.

use std::collections::HashMap;
use std::io::Read;
use std::rc::Rc;

use taxel_core::frame::{Frame, FrameSize, LARGEST_VALUE};
use taxel_core::parameter::number::counted;

use crate::error::ReadError;
use crate::formats::job::too_large;
use crate::formats::numpy::Number;
use crate::formats::recording::event::{ChannelInfo, LONGEST_NAME, Sink, Stop};
use crate::formats::recording::records::{CHANNEL, SCHEMA, each_record};
use crate::formats::recording::size::{arranged, changed, frame_size, matrix_size};
use crate::formats::recording::time;

/// The most topics whose messages could have frames.
const MOST_TOPICS: usize = 4096;

/// The state of the reader: the names in the records so far, and the frame that is being filled.
struct McapState<'a, 'b> {
    /// The schemas so far, by number; None for a schema whose messages have no frames.
    schemas: HashMap<u16, Option<MessageKind>>,
    /// The topics whose messages have frames, by number: the name, and the kind of message.
    topics: HashMap<u16, (Rc<str>, MessageKind)>,
    start: Option<u64>,
    time: u64,
    values: Vec<f64>,
    frame: Frame,
    sink: &'a mut Sink<'b>,
}

pub(crate) fn read(input: &mut dyn Read, sink: &mut Sink<'_>) -> Result<(), Stop> {
    let mut state = McapState {
        schemas: HashMap::new(),
        topics: HashMap::new(),
        start: None,
        time: 0,
        values: Vec::new(),
        frame: Frame::default(),
        sink,
    };
    each_record(input, &mut |kind, record| state.record(kind, record))?;
    if state.start.is_none() {
        let message = "no messages with frames, expected std_msgs/*MultiArray, sensor_msgs/Image or \
                       tactile_msgs/TactileState";
        return Err(ReadError::new(message).into());
    }
    Ok(())
}

/// Splits off a text that follows its length; returns it and the rest.
fn text(bytes: &[u8]) -> Option<(&str, &[u8])> {
    let (length, rest) = bytes.split_first_chunk::<4>()?;
    let length = usize::try_from(u32::from_le_bytes(*length)).ok()?;
    let (text, rest) = rest.split_at_checked(length)?;
    Some((str::from_utf8(text).ok()?, rest))
}

/// Refuses a name that is too long: compressed, thousands of names of many megabytes each take little space in a
/// file.
fn check_name(name: &str) -> Result<(), ReadError> {
    let length = name.len();
    if length > LONGEST_NAME {
        let message = format!("a name of {length} bytes, expected {LONGEST_NAME} at most");
        return Err(ReadError::new(message));
    }
    Ok(())
}

impl McapState<'_, '_> {
    /// Takes a record. A number that was named before keeps its meaning: the summary at the end repeats schemas and
    /// channels.
    fn record(&mut self, kind: u8, record: &[u8]) -> Result<(), Stop> {
        let broken = || ReadError::new("a record is broken");
        let (id, rest) = record.split_first_chunk().ok_or_else(broken)?;
        let id = u16::from_le_bytes(*id);
        match kind {
            SCHEMA => {
                let (name, _) = text(rest).ok_or_else(broken)?;
                let kind = || MessageKind::of(name);
                self.schemas.entry(id).or_insert_with(kind);
            }
            CHANNEL => {
                let fields = || {
                    let (schema, rest) = rest.split_first_chunk()?;
                    let (topic, rest) = text(rest)?;
                    Some((u16::from_le_bytes(*schema), topic, text(rest)?.0))
                };
                let (schema, topic, encoding) = fields().ok_or_else(broken)?;
                let found = self.schemas.get(&schema).copied().flatten();
                let known = self.topics.contains_key(&id);
                if let Some(kind) = found.filter(|_| encoding == "cdr" && !known) {
                    check_name(topic)?;
                    if self.topics.len() == MOST_TOPICS {
                        let message = format!("more than {MOST_TOPICS} topics");
                        return Err(ReadError::new(message).into());
                    }
                    self.topics.insert(id, (topic.into(), kind));
                }
            }
            _ => {
                let (head, data) = rest.split_first_chunk::<20>().ok_or_else(broken)?;
                if let Some((topic, kind)) = self.topics.get(&id).cloned() {
                    self.time = head[4..12].try_into().map_or(0, u64::from_le_bytes);
                    self.message(&topic, kind, data)?;
                }
            }
        }
        Ok(())
    }

    /// Reads the frames of a message.
    fn message(&mut self, topic: &str, kind: MessageKind, data: &[u8]) -> Result<(), Stop> {
        let broken = || ReadError::new(format!("{topic}: a message is broken"));
        self.values.clear();
        let mut cdr = CdrReader::new(data).ok_or_else(broken)?;
        match kind {
            MessageKind::Array(number) => {
                let sizes = cdr.multi_array(number, &mut self.values);
                let sizes = sizes.ok_or_else(broken)?;
                let stated = matrix_size(&sizes);
                let size = arranged(self.values.len(), stated, self.sink.options.size);
                self.give(topic, size)?;
            }
            MessageKind::Image => match cdr.image(&mut self.values).ok_or_else(broken)? {
                ImageFrame::Values(size) => self.give(topic, Some(size))?,
                ImageFrame::OfCamera => {}
            },
            MessageKind::TactileState => {
                let count = cdr.header().and_then(|()| cdr.count(8));
                for _ in 0..count.ok_or_else(broken)? {
                    self.values.clear();
                    let name = cdr.text().ok_or_else(broken)?;
                    let numbers = cdr.numbers(Number::F32, &mut self.values);
                    numbers.ok_or_else(broken)?;
                    self.give(&format!("{topic}#{name}"), None)?;
                }
            }
        }
        Ok(())
    }

    /// Reports the values as a frame of a channel.
    fn give(&mut self, name: &str, size: Option<FrameSize>) -> Result<(), Stop> {
        let found = self.values.len();
        // Rows and columns that are given for one channel need not fit the others.
        let named = self
            .sink
            .options
            .size
            .filter(|asked| asked.cells() == found);
        let size = size.or(named);
        check_name(name)?;
        let start = *self.start.get_or_insert(self.time);
        let channel = self.sink.channel(Some(name), || ChannelInfo {
            size,
            values: Some(found as u64),
            start: date_time(start),
            ..ChannelInfo::default()
        })?;
        let before = self.sink.state.channels[channel].0.size;
        let wrong = match size {
            Some(size) if size.cells() != found => {
                let found = counted(found as u64, "value");
                Some(format!("found {found}, expected {}", size.cells()))
            }
            Some(size) => before
                .filter(|&before| before != size)
                .map(|before| changed(size, before)),
            None => None,
        };
        let mut values = self.values.iter();
        let large = values.find(|value| value.abs() > LARGEST_VALUE);
        let large = large.map(|value| format!("a value is {}", too_large(*value)));
        if let Some(wrong) = wrong.or(large) {
            return Err(ReadError::new(format!("{name}: {wrong}")).into());
        }
        // Without a size, the values can only be counted.
        self.frame.reset(size.unwrap_or(FrameSize::SMALLEST));
        if size.is_some() {
            self.frame.values_mut().copy_from_slice(&self.values);
        }
        #[expect(clippy::cast_precision_loss, reason = "a difference in nanoseconds")]
        let seconds = (i128::from(self.time) - i128::from(start)) as f64 / 1e9;
        self.frame.time = Some(seconds);
        self.sink.frame(channel, &mut self.frame)
    }
}

/// Returns the date and time in UTC, `2024-05-01T12:00:00.125Z`, of a time in nanoseconds since 1970; None up to 2001,
/// since such numbers are hardly dates: they may count from the start of a machine.
fn date_time(nanoseconds: u64) -> Option<String> {
    const LEAST: u64 = 1_000_000_000_000_000_000;
    if nanoseconds < LEAST {
        return None;
    }
    let (seconds, fraction) = (nanoseconds / 1_000_000_000, nanoseconds % 1_000_000_000);
    let (days, clock) = (seconds / 86_400, seconds % 86_400);
    let days = i32::try_from(days).ok()?;
    // A year has 365 or 366 days.
    let mut years = 1970 + days / 366..=1970 + days / 365;
    let year = years.find(|year| time::day(year + 1, 1, 1) > days)?;
    let month = (1..=12).rfind(|&month| time::day(year, month, 1) <= days)?;
    let of_month = days - time::day(year, month, 1) + 1;
    let (hours, minutes, seconds) = (clock / 3600, clock / 60 % 60, clock % 60);
    let fraction = format!(".{fraction:09}");
    let fraction = fraction.trim_end_matches('0').trim_end_matches('.');
    Some(format!(
        "{year}-{month:02}-{of_month:02}T{hours:02}:{minutes:02}:{seconds:02}{fraction}Z"
    ))
}

#[derive(Clone, Copy, Debug, PartialEq)]
enum MessageKind {
    /// A `MultiArray` of numbers of this type.
    Array(Number),
    /// Grey pixels, row by row; rows may be padded.
    Image,
    TactileState,
}

impl MessageKind {
    /// Returns the kind of a schema such as `std_msgs/msg/UInt16MultiArray`; None if its messages have no frames.
    fn of(schema: &str) -> Option<Self> {
        let (package, name) = (schema.split('/').next()?, schema.rsplit('/').next()?);
        match (package, name) {
            ("sensor_msgs", "Image") => Some(Self::Image),
            ("tactile_msgs", "TactileState") => Some(Self::TactileState),
            ("std_msgs", name) => {
                let code = match name.strip_suffix("MultiArray")? {
                    "Int8" => "|i1",
                    "UInt8" | "Byte" | "Char" => "|u1",
                    "Int16" => "<i2",
                    "UInt16" => "<u2",
                    "Int32" => "<i4",
                    "UInt32" => "<u4",
                    "Int64" => "<i8",
                    "UInt64" => "<u8",
                    "Float32" => "<f4",
                    "Float64" => "<f8",
                    _ => return None,
                };
                Number::of(code).map(Self::Array)
            }
            _ => None,
        }
    }
}

enum ImageFrame {
    Values(FrameSize),
    /// Not a frame: an encoding with other than one value per pixel, or an image that is too large.
    OfCamera,
}

/// A reader of a message, field by field; its methods return None if the message ends too early.
struct CdrReader<'a> {
    bytes: &'a [u8],
    at: usize,
    big_endian: bool,
}

impl<'a> CdrReader<'a> {
    /// Reads the header of a message; None if it is in another representation.
    fn new(message: &'a [u8]) -> Option<Self> {
        let (&[0, order @ (0 | 1), ..], bytes) = message.split_first_chunk::<4>()? else {
            return None;
        };
        let (at, big_endian) = (0, order == 0);
        Some(Self {
            bytes,
            at,
            big_endian,
        })
    }

    fn take(&mut self, length: usize, alignment: usize) -> Option<&'a [u8]> {
        let start = self.at.next_multiple_of(alignment);
        let end = start.checked_add(length)?;
        let taken = self.bytes.get(start..end)?;
        self.at = end;
        Some(taken)
    }

    fn word(&mut self) -> Option<u32> {
        let word = Number::U32.in_order(self.big_endian);
        word.whole(self.take(4, 4)?)?.try_into().ok()
    }

    /// Reads the number of elements of a list, each of at least `least` bytes; None if they cannot fit.
    fn count(&mut self, least: usize) -> Option<usize> {
        let count = usize::try_from(self.word()?).ok()?;
        (count.checked_mul(least)? <= self.bytes.len()).then_some(count)
    }

    fn bytes(&mut self) -> Option<&'a [u8]> {
        let length = self.count(1)?;
        self.take(length, 1)
    }

    fn text(&mut self) -> Option<&'a str> {
        let text = self.bytes()?;
        str::from_utf8(text.strip_suffix(&[0]).unwrap_or(text)).ok()
    }

    fn numbers(&mut self, number: Number, values: &mut Vec<f64>) -> Option<()> {
        let size = number.size();
        let count = self.count(size)?;
        // An empty list is not aligned.
        let alignment = if count > 0 { size } else { 1 };
        let bytes = self.take(count.checked_mul(size)?, alignment)?;
        values.extend(number.in_order(self.big_endian).values(bytes));
        Some(())
    }

    /// Reads an array into `values`. Returns the sizes of its layout.
    fn multi_array(&mut self, number: Number, values: &mut Vec<f64>) -> Option<Vec<u32>> {
        let mut sizes = Vec::new();
        for _ in 0..self.count(12)? {
            self.text()?;
            sizes.push(self.word()?);
            self.word()?;
        }
        let offset = usize::try_from(self.word()?).ok()?;
        self.numbers(number, values)?;
        values.drain(..offset.min(values.len()));
        Some(sizes)
    }

    /// Skips a `std_msgs/Header`.
    fn header(&mut self) -> Option<()> {
        self.word()?;
        self.word()?;
        self.text().map(drop)
    }

    /// Reads an image into `values`. `step` is the number of bytes from one row to the next.
    fn image(&mut self, values: &mut Vec<f64>) -> Option<ImageFrame> {
        self.header()?;
        let (height, width) = (self.word()?, self.word()?);
        let code = match self.text()? {
            "mono8" | "8UC1" => "|u1",
            "8SC1" => "|i1",
            "mono16" | "16UC1" => "<u2",
            "16SC1" => "<i2",
            "32SC1" => "<i4",
            "32FC1" => "<f4",
            "64FC1" => "<f8",
            _ => return Some(ImageFrame::OfCamera),
        };
        let number = Number::of(code)?.in_order(self.take(1, 1)? != [0]);
        let step = usize::try_from(self.word()?).ok()?;
        let data = self.bytes()?;
        let Some(frame) = frame_size(width, height) else {
            return Some(ImageFrame::OfCamera);
        };
        let line = usize::from(frame.columns()) * number.size();
        for row in 0..usize::from(frame.rows()) {
            let start = row.checked_mul(step)?;
            let bytes = data.get(start..start.checked_add(line)?)?;
            values.extend(number.values(bytes));
        }
        Some(ImageFrame::Values(frame))
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn nanoseconds_since_1970_are_dates() {
        for text in [
            "2001-09-09T01:46:40Z",
            "2023-11-14T22:13:20.000000001Z",
            "2024-02-29T23:59:59.5Z",
            "2024-12-31T00:00:00Z",
            "2025-01-01T12:30:00.125Z",
        ] {
            let (whole, rest) = text.split_at(19);
            let fraction = rest.trim_matches(['.', 'Z']);
            let fraction: u64 = format!("{fraction:0<9}").parse().expect("a number");
            let seconds = time::read_moment(whole.as_bytes())
                .expect("a moment")
                .seconds;
            #[expect(
                clippy::cast_possible_truncation,
                clippy::cast_sign_loss,
                reason = "whole and after 1970"
            )]
            let nanoseconds = seconds as u64 * 1_000_000_000 + fraction;
            assert_eq!(date_time(nanoseconds).as_deref(), Some(text));
        }
        assert_eq!(date_time(999_999_999_999_999_999), None);
        assert!(date_time(u64::MAX).is_some_and(|text| text.starts_with("2554-07-21T")));
    }

    fn pixels(encoding: &str, data: &[u8]) -> Option<Vec<f64>> {
        let mut message = vec![0, 1, 0, 0];
        let word = |message: &mut Vec<u8>, number: usize| {
            message.resize(message.len().next_multiple_of(4), 0);
            message.extend(u32::try_from(number).expect("small").to_le_bytes());
        };
        let text = |message: &mut Vec<u8>, text: &str| {
            word(message, text.len() + 1);
            message.extend(text.bytes().chain([0]));
        };
        word(&mut message, 0);
        word(&mut message, 0);
        text(&mut message, "pad");
        word(&mut message, 1);
        word(&mut message, 2);
        text(&mut message, encoding);
        message.push(0);
        word(&mut message, data.len());
        word(&mut message, data.len());
        message.extend(data);
        let mut values = Vec::new();
        let found = CdrReader::new(&message)?.image(&mut values)?;
        matches!(found, ImageFrame::Values(size) if size == FrameSize::new(2, 1).expect("an allowed size")).then_some(values)
    }

    #[test]
    fn images_of_one_channel_are_frames() {
        let signed = [0xfe, 0xff, 3, 0];
        for (encoding, data, expected) in [
            ("mono8", vec![254, 3], [254.0, 3.0]),
            ("8SC1", vec![254, 3], [-2.0, 3.0]),
            ("16UC1", signed.to_vec(), [65_534.0, 3.0]),
            ("16SC1", signed.to_vec(), [-2.0, 3.0]),
            (
                "32SC1",
                [(-2_i32).to_le_bytes(), 3_i32.to_le_bytes()].concat(),
                [-2.0, 3.0],
            ),
            (
                "32FC1",
                [0.5_f32.to_le_bytes(), 3_f32.to_le_bytes()].concat(),
                [0.5, 3.0],
            ),
            (
                "64FC1",
                [0.5_f64.to_le_bytes(), 3_f64.to_le_bytes()].concat(),
                [0.5, 3.0],
            ),
        ] {
            assert_eq!(
                pixels(encoding, &data),
                Some(expected.to_vec()),
                "{encoding}"
            );
        }
        assert_eq!(pixels("rgb8", &[0; 6]), None);
    }

    #[test]
    fn words_are_aligned_after_a_text() {
        let message = b"\0\x01\0\0\x05\0\0\0abcd\0\0\0\0\x07\0\0\0";
        let mut cdr = CdrReader::new(message).expect("a header");
        assert_eq!(
            (cdr.text(), cdr.word(), cdr.word()),
            (Some("abcd"), Some(7), None)
        );
        let big = b"\0\0\0\0\0\0\0\x07";
        assert_eq!(CdrReader::new(big).and_then(|mut cdr| cdr.word()), Some(7));
        assert!(CdrReader::new(b"\0\x09\0\0").is_none());
    }

    #[test]
    fn a_count_beyond_the_message_is_refused() {
        let message = |count: u8| [0, 1, 0, 0, count, 0, 0, 0, 9, 0, 8, 0];
        let count = |count| CdrReader::new(&message(count)).and_then(|mut cdr| cdr.count(2));
        assert_eq!([2, 5].map(count), [Some(2), None]);
    }
}
