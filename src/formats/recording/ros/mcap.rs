//! MCAP files of ROS 2: arrays, images and tactile states in CDR. A topic is a channel; of a tactile state, each
//! sensor is a channel.
//!
//! Records follow each other, even within chunks, so the file is read from front to back in the same memory, and a
//! file that was never closed still gives all its whole messages. Chunks compressed by LZ4 or Zstandard are
//! decompressed as they are read, by decoders in Rust. The records are read here, since the crate `mcap` needs 18
//! others, more than this project allows itself. Source: <https://mcap.dev/spec>.
//!
//! The messages that have frames are listed in [`message`](super::message); other messages are skipped. A
//! sensor of a tactile state is the channel `TOPIC#SENSOR`. The time is that of the log, from the first message with
//! a frame on.
//!
//! Writers may leave out a checksum, which is 0 then. A checksum covers a whole chunk, or everything before the end
//! of the data, so it shows that a message is damaged, but not which one: messages are reported as they are read,
//! then the error.
//!
//! The file is long because records, chunks and messages are read in one pass, each inside the one before.

use std::collections::HashMap;
use std::io::{self, BufRead, BufReader, Read, Take};
use std::rc::Rc;

use flate2::CrcReader;

use crate::formats::framed::too_large;
use crate::formats::recording::error::RecordingError;
use crate::formats::recording::event::{
    ChannelInfo, LONGEST_NAME, MOST_CHANNELS, ReadOptions, RecordingEvent, Sink,
};
use crate::formats::recording::ros::cdr::CdrReader;
use crate::formats::recording::ros::message::{
    ImageFrame, MessageKind, header, image, multi_array,
};
use crate::formats::recording::side::{arranged, changed, matrix_size};
use crate::frame::{Frame, FrameSize, LARGEST_VALUE};
use crate::index::wide;
use crate::parameter::number::counted;
use crate::quote::shortened_message;

/// The magic number: at the start, where it has been recognised already, and at the end.
const MAGIC: [u8; 8] = *b"\x89MCAP0\r\n";

/// The size limit of a message with a frame, in bytes.
const LARGEST_RECORD: u64 = 1 << 24;

/// The size limit of Zstandard's window in bytes; its usual levels need 8 MiB at most.
const LARGEST_WINDOW: u64 = 16 << 20;

/// The size limit of a decompressed chunk, in bytes.
const LARGEST_CHUNK: u64 = 1 << 30;

/// The most topics whose messages could have frames.
const MOST_TOPICS: usize = 4096;

/// The end of the records. The magic number follows.
const FOOTER: u8 = 2;
/// A schema, the type of messages: its number and name.
const SCHEMA: u8 = 3;
/// A topic: its number, the number of its schema, its name and its encoding.
const CHANNEL: u8 = 4;
/// A message: the number of its channel, its sequence number, the times of logging and publishing, and its data.
const MESSAGE: u8 = 5;
/// A chunk: a head, and records after it.
const CHUNK: u8 = 6;
/// The end of the messages, with the checksum of everything before it.
const DATA_END: u8 = 15;

/// A channel that has been reported.
struct GivenChannel {
    /// The topic, with the sensor of a tactile state after `#`.
    name: String,
    /// The size of its frames, if it is known.
    size: Option<FrameSize>,
    /// The number of its frames so far.
    frames: u64,
}

/// The state of the reader: the names in the records so far, and the frame that is being filled.
struct McapState<'a, 'b> {
    /// The given rows and columns, for messages that do not have them.
    options: ReadOptions,
    /// The schemas so far, by number; None for a schema whose messages have no frames.
    schemas: HashMap<u16, Option<MessageKind>>,
    /// The topics whose messages have frames, by number: the name, and the kind of message.
    topics: HashMap<u16, (Rc<str>, MessageKind)>,
    /// The channels that have been reported.
    given: Vec<GivenChannel>,
    /// The time of the first message with a frame, in nanoseconds.
    start: Option<u64>,
    /// The time of the current message, in nanoseconds.
    time: u64,
    /// The cells of the current message.
    values: Vec<f64>,
    /// The frame made of these cells.
    frame: Frame,
    /// The current record.
    record: Vec<u8>,
    /// The receiver of channels and frames.
    sink: &'a mut Sink<'b>,
}

/// Reads a recording.
///
/// # Errors
/// Returns an error if the file was not closed, after all whole messages; if a record or a message is broken; or if
/// no message has frames.
pub(in crate::formats::recording) fn read(
    input: &mut impl BufRead,
    options: ReadOptions,
    sink: &mut Sink<'_>,
) -> Result<(), RecordingError> {
    let mut state = McapState {
        options,
        schemas: HashMap::new(),
        topics: HashMap::new(),
        given: Vec::new(),
        start: None,
        time: 0,
        values: Vec::new(),
        frame: Frame::default(),
        record: Vec::new(),
        sink,
    };
    let mut input = SummedInput::new(input);
    pass_over(&mut input, MAGIC.len() as u64)?;
    let ended = state.records(&mut input, Container::File)?;
    if state.given.is_empty() && ended == Ended::AtFooter {
        return Err(RecordingError::damaged(
            "no messages with frames, expected std_msgs/*MultiArray, sensor_msgs/Image or tactile_msgs/TactileState",
        ));
    }
    Ok(())
}

/// An input of records that computes the checksum of the bytes read.
type SummedInput<'a> = CrcReader<&'a mut dyn Read>;

/// The container of records.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
enum Container {
    /// The file, which ends with its footer.
    File,
    /// A chunk.
    Chunk,
}

/// The reason why no more records follow.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
enum Ended {
    /// The footer of the file was reached.
    AtFooter,
    /// The end of the chunk was reached.
    OfChunk,
    /// The sink wants no more.
    ByReader,
}

/// The reason why no more records can be read.
#[derive(Debug)]
enum RecordsError {
    /// The bytes end within a record, or the file ends before its footer.
    Torn,
    /// Any other error.
    Other(RecordingError),
}

impl From<RecordingError> for RecordsError {
    fn from(error: RecordingError) -> Self {
        Self::Other(error)
    }
}

impl From<RecordsError> for RecordingError {
    fn from(error: RecordsError) -> Self {
        match error {
            RecordsError::Torn => {
                Self::damaged("the file ends without a footer: it was not closed")
            }
            RecordsError::Other(error) => error,
        }
    }
}

impl RecordsError {
    /// Returns the error for damage other than a premature end.
    fn damaged(message: impl Into<String>) -> Self {
        RecordingError::damaged(message).into()
    }

    /// Converts an error among the records of a chunk: if all bytes of the chunk were there, the file is not torn.
    fn within_chunk(self, is_whole: bool) -> Self {
        match self {
            Self::Torn if is_whole => Self::damaged("a record reaches beyond its chunk"),
            error => error,
        }
    }
}

/// Fills all of `bytes`.
///
/// # Errors
/// Returns [`RecordsError::Torn`] if there are fewer.
fn whole(input: &mut dyn Read, bytes: &mut [u8]) -> Result<(), RecordsError> {
    input.read_exact(bytes).map_err(refused)
}

/// Converts the error of a reader, which is the file itself or the decoder of a chunk.
fn refused(error: io::Error) -> RecordsError {
    match error.kind() {
        io::ErrorKind::UnexpectedEof => RecordsError::Torn,
        io::ErrorKind::Other | io::ErrorKind::InvalidData => {
            RecordsError::damaged("a chunk cannot be unpacked")
        }
        _ => RecordingError::Io(error).into(),
    }
}

/// The head of a chunk, before its records.
struct ChunkHead {
    /// The number of bytes of its decompressed records.
    size: u64,
    /// The checksum of its decompressed records.
    checksum: u32,
    /// The name of the compression; empty if there is none.
    compression: String,
    /// The number of bytes that the records take in the file.
    length: u64,
}

impl ChunkHead {
    fn read(input: &mut dyn Read) -> Result<Self, RecordsError> {
        // Start, end, size, checksum, length of the compression's name.
        let mut head = [0; 32];
        whole(input, &mut head)?;
        let size = head[16..24].try_into().map_or(0, u64::from_le_bytes);
        let word = |at: usize| head[at..at + 4].try_into().map_or(0, u32::from_le_bytes);
        let (checksum, length) = (word(24), word(28));
        let mut name = vec![0; wide(length.min(40))];
        whole(input, &mut name)?;
        let mut records = [0; 8];
        whole(input, &mut records)?;
        let compression = String::from_utf8_lossy(&name).into_owned();
        if size > LARGEST_CHUNK {
            return Err(RecordsError::damaged("a chunk of more than 1 GiB"));
        }
        Ok(Self {
            size,
            checksum,
            compression,
            length: u64::from_le_bytes(records),
        })
    }
}

/// Refuses a name that is too long: compressed, thousands of names of many megabytes each take little space in a
/// file.
fn check_name(name: &str) -> Result<(), RecordingError> {
    if name.len() > LONGEST_NAME {
        let message = format!(
            "a name of {} bytes, expected {LONGEST_NAME} at most",
            name.len()
        );
        return Err(RecordingError::damaged(message));
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

/// Compares the stated checksum of some bytes with the one found.
///
/// # Errors
/// Returns an error if they differ. A stated checksum of 0 was not computed, so it is not an error.
fn check_sum(stated: u32, found: u32, of: &str) -> Result<(), RecordsError> {
    if stated == 0 || stated == found {
        return Ok(());
    }
    let message = format!("the checksum of {of} does not hold, so a message in it is damaged");
    Err(RecordsError::damaged(message))
}

/// Skips `length` bytes.
fn pass_over(input: &mut dyn Read, length: u64) -> Result<(), RecordsError> {
    let passed = io::copy(&mut Read::take(input, length), &mut io::sink()).map_err(refused)?;
    if passed < length {
        Err(RecordsError::Torn)
    } else {
        Ok(())
    }
}

impl McapState<'_, '_> {
    /// Reads records, up to the footer or the end of a chunk.
    fn records(
        &mut self,
        input: &mut SummedInput<'_>,
        within: Container,
    ) -> Result<Ended, RecordsError> {
        loop {
            let sum = input.crc().sum();
            let mut head = [0; 9];
            if within == Container::Chunk && input.read(&mut head[..1]).map_err(refused)? == 0 {
                return Ok(Ended::OfChunk);
            }
            let known = usize::from(within == Container::Chunk);
            whole(input, &mut head[known..])?;
            let [kind, length @ ..] = head;
            let length = u64::from_le_bytes(length);
            match kind {
                FOOTER if within == Container::File => {
                    pass_over(input, length)?;
                    let mut magic = [0; MAGIC.len()];
                    whole(input, &mut magic)?;
                    let is_whole = magic == MAGIC;
                    return is_whole
                        .then_some(Ended::AtFooter)
                        .ok_or(RecordsError::Torn);
                }
                CHUNK if within == Container::File => {
                    if self.chunk(input)? == Ended::ByReader {
                        return Ok(Ended::ByReader);
                    }
                }
                DATA_END if within == Container::File && length == 4 => {
                    let mut stated = [0; 4];
                    whole(input, &mut stated)?;
                    check_sum(u32::from_le_bytes(stated), sum, "the file")?;
                }
                MESSAGE if length > LARGEST_RECORD => self.pass_large(input, length)?,
                SCHEMA | CHANNEL | MESSAGE => {
                    if length > LARGEST_RECORD {
                        return Err(RecordsError::damaged("a record of more than 16 MiB"));
                    }
                    let mut record = std::mem::take(&mut self.record);
                    record.clear();
                    let read = Read::take(&mut *input, length)
                        .read_to_end(&mut record)
                        .map_err(refused)?;
                    if (read as u64) < length {
                        return Err(RecordsError::Torn);
                    }
                    let is_enough = self.record(kind, &record)?;
                    self.record = record;
                    if is_enough {
                        return Ok(Ended::ByReader);
                    }
                }
                _ => pass_over(input, length)?,
            }
        }
    }

    /// Skips a message that is too large to be read, unless it has frames. An image of that size is not a frame.
    ///
    /// # Errors
    /// Returns an error if the message has frames.
    fn pass_large(&mut self, input: &mut dyn Read, length: u64) -> Result<(), RecordsError> {
        let mut id = [0; 2];
        whole(input, &mut id)?;
        match self.topics.get(&u16::from_le_bytes(id)) {
            None | Some((_, MessageKind::Image)) => pass_over(input, length - 2),
            Some((topic, _)) => Err(RecordsError::damaged(format!(
                "{topic}: a message of more than 16 MiB"
            ))),
        }
    }

    /// Reads the records of a chunk, decompressing them on the way.
    fn chunk(&mut self, input: &mut dyn Read) -> Result<Ended, RecordsError> {
        let head = ChunkHead::read(input)?;
        let mut packed = Read::take(&mut *input, head.length);
        let ended = match head.compression.as_str() {
            "" => self.unpacked(&head, Read::take(&mut packed, head.length)),
            "lz4" => {
                let unpacked = lz4_flex::frame::FrameDecoder::new(&mut packed);
                self.unpacked(&head, unpacked.take(head.size))
            }
            "zstd" => {
                let unpacked = ruzstd::decoding::StreamingDecoder::new_with_max_window_size(
                    &mut packed,
                    LARGEST_WINDOW,
                );
                let unpacked =
                    unpacked.map_err(|_| RecordsError::damaged("a chunk cannot be unpacked"))?;
                self.unpacked(&head, unpacked.take(head.size))
            }
            other => {
                let message =
                    format!("chunks are compressed with {other:?}, expected lz4, zstd or none");
                return Err(RecordsError::damaged(shortened_message(&message)));
            }
        };
        let ended = ended.map_err(|error| error.within_chunk(packed.limit() == 0))?;
        if ended == Ended::OfChunk {
            let left = packed.limit();
            pass_over(&mut packed, left)?;
        }
        Ok(ended)
    }

    /// Reads the records of a chunk from its decoder, which gives as many bytes as the chunk states.
    fn unpacked(
        &mut self,
        head: &ChunkHead,
        unpacked: Take<impl Read>,
    ) -> Result<Ended, RecordsError> {
        let mut unpacked = BufReader::new(unpacked);
        let mut summed = SummedInput::new(&mut unpacked);
        let ended = self.records(&mut summed, Container::Chunk);
        let found = summed.crc().sum();
        let is_whole = unpacked.get_ref().limit() == 0;
        let ended = ended.map_err(|error| error.within_chunk(is_whole))?;
        // A chunk that lacks bytes is torn; the next read reports that.
        if ended == Ended::OfChunk && is_whole {
            check_sum(head.checksum, found, "a chunk")?;
        }
        Ok(ended)
    }

    /// Reads a record; returns true if the sink wants no more. A number that was named before keeps its meaning: the
    /// summary at the end repeats schemas and channels.
    ///
    /// # Errors
    /// Returns an error if the record is shorter than its fields.
    fn record(&mut self, kind: u8, record: &[u8]) -> Result<bool, RecordingError> {
        let broken = || RecordingError::damaged("a record is broken");
        let (id, rest) = record.split_first_chunk::<2>().ok_or_else(broken)?;
        let id = u16::from_le_bytes(*id);
        match kind {
            SCHEMA => {
                let (name, _) = text(rest).ok_or_else(broken)?;
                let kind = MessageKind::of(name);
                self.schemas.entry(id).or_insert(kind);
            }
            CHANNEL => {
                let (schema, rest) = rest.split_first_chunk::<2>().ok_or_else(broken)?;
                let schema = u16::from_le_bytes(*schema);
                let (topic, rest) = text(rest).ok_or_else(broken)?;
                let (encoding, _) = text(rest).ok_or_else(broken)?;
                let found = self.schemas.get(&schema).copied().flatten();
                let known = self.topics.contains_key(&id);
                if let Some(kind) = found.filter(|_| encoding == "cdr" && !known) {
                    check_name(topic)?;
                    if self.topics.len() == MOST_TOPICS {
                        return Err(RecordingError::damaged(format!(
                            "more than {MOST_TOPICS} topics"
                        )));
                    }
                    self.topics.insert(id, (topic.into(), kind));
                }
            }
            _ => {
                let (_, rest) = rest.split_first_chunk::<4>().ok_or_else(broken)?;
                let (time, rest) = rest.split_first_chunk::<8>().ok_or_else(broken)?;
                let (_, data) = rest.split_first_chunk::<8>().ok_or_else(broken)?;
                if let Some((topic, kind)) = self.topics.get(&id).cloned() {
                    let time = u64::from_le_bytes(*time);
                    let message = self.message(&topic, kind, time, data);
                    return message.ok_or_else(|| {
                        RecordingError::damaged(format!("{topic}: a message is broken"))
                    })?;
                }
            }
        }
        Ok(false)
    }

    /// Reads a message; None if it is broken.
    fn message(
        &mut self,
        topic: &str,
        kind: MessageKind,
        time: u64,
        data: &[u8],
    ) -> Option<Result<bool, RecordingError>> {
        self.time = time;
        let mut cdr = CdrReader::new(data)?;
        match kind {
            MessageKind::Array(kind, size) => {
                let sizes = multi_array(&mut cdr, kind, size, &mut self.values)?;
                let stated = matrix_size(&sizes);
                let size = arranged(self.values.len(), stated, self.options.size);
                Some(self.give(topic, size))
            }
            MessageKind::Image => match image(&mut cdr, &mut self.values)? {
                ImageFrame::Values(size) => Some(self.give(topic, Some(size))),
                ImageFrame::OfCamera => Some(Ok(false)),
            },
            MessageKind::TactileState => {
                header(&mut cdr)?;
                for _ in 0..cdr.count(8)? {
                    let name = format!("{topic}#{}", cdr.text()?);
                    self.values.clear();
                    cdr.numbers(b'f', 4, &mut self.values)?;
                    match self.give(&name, None) {
                        Ok(false) => {}
                        ended => return Some(ended),
                    }
                }
                Some(Ok(false))
            }
        }
    }

    /// Reports the values as a frame of a channel; returns true if the sink wants no more.
    ///
    /// # Errors
    /// Returns an error if there are too many channels, if a message has another number of values than its layout or
    /// another size than earlier ones of its channel, or if a value is infinite.
    fn give(&mut self, name: &str, size: Option<FrameSize>) -> Result<bool, RecordingError> {
        let found = self.values.len();
        // Rows and columns that are given for one channel need not fit the others.
        let named = self.options.size.filter(|asked| asked.cells() == found);
        let size = size.or(named);
        let channel = match self.given.iter().position(|own| own.name == name) {
            Some(channel) => channel,
            None if self.given.len() == MOST_CHANNELS => {
                let message = format!("more than {MOST_CHANNELS} channels");
                return Err(RecordingError::damaged(message));
            }
            None => {
                check_name(name)?;
                let info = ChannelInfo {
                    name: Some(name.to_owned()),
                    size,
                    values: Some(found as u64),
                    ..ChannelInfo::default()
                };
                self.given.push(GivenChannel {
                    name: name.to_owned(),
                    size,
                    frames: 0,
                });
                if (self.sink)(RecordingEvent::Channel(&info)).is_break() {
                    return Ok(true);
                }
                self.given.len() - 1
            }
        };
        let start = *self.start.get_or_insert(self.time);
        #[expect(clippy::cast_precision_loss, reason = "a difference in nanoseconds")]
        let seconds = (i128::from(self.time) - i128::from(start)) as f64 / 1e9;
        self.frame.time = Some(seconds);
        self.frame.channel = channel;
        self.frame.number = self.given[channel].frames;
        self.fill(name, size, self.given[channel].size)?;
        let mut values = self.values.iter();
        if let Some(value) = values.find(|value| value.abs() > LARGEST_VALUE) {
            let message = format!("{name}: a value is {}", too_large(*value));
            return Err(RecordingError::damaged(message));
        }
        self.given[channel].frames += 1;
        Ok((self.sink)(RecordingEvent::Frame(&self.frame)).is_break())
    }

    /// Fills the frame with the values; `before` is the size of the channel's first frame.
    ///
    /// # Errors
    /// Returns an error if the number of values differs from the layout, or the size from `before`.
    fn fill(
        &mut self,
        name: &str,
        size: Option<FrameSize>,
        before: Option<FrameSize>,
    ) -> Result<(), RecordingError> {
        let found = self.values.len();
        match size {
            Some(size) if size.cells() == found => {
                if let Some(before) = before.filter(|&before| before != size) {
                    let message = format!("{name}: {}", changed(size, before));
                    return Err(RecordingError::damaged(message));
                }
                self.frame.reset(size);
                self.frame.values_mut().copy_from_slice(&self.values);
            }
            Some(size) => {
                let message = format!(
                    "{name}: found {}, expected {}",
                    counted(found as u64, "value"),
                    size.cells()
                );
                return Err(RecordingError::damaged(message));
            }
            // The values can only be counted: rows and columns must be given.
            None => self.frame.reset(FrameSize::SMALLEST),
        }
        Ok(())
    }
}
