//! Reads the records of an MCAP file, which follow each other, even within chunks.
//!
//! Chunks compressed by LZ4 or Zstandard are decompressed as they are read, by decoders in Rust. The records are read
//! here, since the crate `mcap` needs 18 others, more than this project allows itself. Source:
//! <https://mcap.dev/spec>.
//!
//! Writers may leave out a checksum, which is 0 then. A checksum covers a whole chunk, or everything before the end
//! of the data, so it shows that a message is damaged, but not which one: messages are reported as they are read,
//! then the error.

use std::io::{self, BufReader, Read, Take};

use flate2::CrcReader;
use taxel_core::index::wide;
use taxel_core::quote::shortened_message;

use crate::error::ReadError;
use crate::formats::recording::event::Stop;
use crate::formats::recording::ros::MCAP_MAGIC;

const LARGEST_RECORD: u64 = 1 << 24;

/// The size limit of Zstandard's window in bytes; its usual levels need 8 MiB at most.
const LARGEST_WINDOW: u64 = 16 << 20;

const LARGEST_CHUNK: u64 = 1 << 30;

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

#[derive(Debug)]
pub(super) enum McapRecord<'a> {
    Schema {
        id: u16,
        name: &'a str,
    },
    Channel {
        id: u16,
        schema: u16,
        topic: &'a str,
        encoding: &'a str,
    },
    Message {
        channel: u16,
        time: u64,
        data: &'a [u8],
    },
    LargeMessage {
        channel: u16,
    },
}

impl<'a> McapRecord<'a> {
    /// Reads the fields of a record; None if it is shorter.
    fn of(kind: u8, record: &'a [u8]) -> Option<Self> {
        let (id, rest) = record.split_first_chunk::<2>()?;
        let id = u16::from_le_bytes(*id);
        Some(match kind {
            SCHEMA => Self::Schema {
                id,
                name: text(rest)?.0,
            },
            CHANNEL => {
                let (schema, rest) = rest.split_first_chunk::<2>()?;
                let (topic, rest) = text(rest)?;
                Self::Channel {
                    id,
                    schema: u16::from_le_bytes(*schema),
                    topic,
                    encoding: text(rest)?.0,
                }
            }
            _ => {
                let (_, rest) = rest.split_first_chunk::<4>()?;
                let (time, rest) = rest.split_first_chunk::<8>()?;
                let (_, data) = rest.split_first_chunk::<8>()?;
                Self::Message {
                    channel: id,
                    time: u64::from_le_bytes(*time),
                    data,
                }
            }
        })
    }
}

/// Reads a file, and reports its schemas, channels and messages to `each`.
pub(super) fn each_record(
    input: &mut dyn Read,
    each: &mut dyn FnMut(McapRecord<'_>) -> Result<(), Stop>,
) -> Result<(), Stop> {
    let mut input = SummedInput::new(input);
    let mut reader = RecordReader {
        record: Vec::new(),
        each,
    };
    let read = pass_over(&mut input, MCAP_MAGIC.len() as u64)
        .and_then(|()| reader.records(&mut input, Container::File));
    read.map_err(|error| match error {
        RecordsError::Torn => {
            ReadError::new("the file ends without a footer: it was not closed").into()
        }
        RecordsError::Other(end) => end,
    })
}

struct RecordReader<'a> {
    record: Vec<u8>,
    each: &'a mut dyn FnMut(McapRecord<'_>) -> Result<(), Stop>,
}

type SummedInput<'a> = CrcReader<&'a mut dyn Read>;

#[derive(Clone, Copy, Debug, PartialEq, Eq)]
enum Container {
    File,
    Chunk,
}

#[derive(Debug)]
enum RecordsError {
    /// The bytes end within a record, or the file ends before its footer.
    Torn,
    Other(Stop),
}

impl From<Stop> for RecordsError {
    fn from(end: Stop) -> Self {
        Self::Other(end)
    }
}

impl RecordsError {
    fn damaged(message: impl Into<String>) -> Self {
        Self::Other(ReadError::new(message).into())
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
fn whole(input: &mut dyn Read, bytes: &mut [u8]) -> Result<(), RecordsError> {
    input.read_exact(bytes).map_err(refused)
}

fn refused(error: io::Error) -> RecordsError {
    match error.kind() {
        io::ErrorKind::UnexpectedEof => RecordsError::Torn,
        io::ErrorKind::Other | io::ErrorKind::InvalidData => {
            RecordsError::damaged("a chunk cannot be unpacked")
        }
        _ => RecordsError::Other(error.into()),
    }
}

/// The head of a chunk, before its records.
struct ChunkHead {
    size: u64,
    checksum: u32,
    /// The name of the compression; empty if there is none.
    compression: String,
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

/// Splits off a text that follows its length; returns it and the rest.
fn text(bytes: &[u8]) -> Option<(&str, &[u8])> {
    let (length, rest) = bytes.split_first_chunk::<4>()?;
    let length = usize::try_from(u32::from_le_bytes(*length)).ok()?;
    let (text, rest) = rest.split_at_checked(length)?;
    Some((str::from_utf8(text).ok()?, rest))
}

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

impl RecordReader<'_> {
    fn records(
        &mut self,
        input: &mut SummedInput<'_>,
        within: Container,
    ) -> Result<(), RecordsError> {
        loop {
            let sum = input.crc().sum();
            let mut head = [0; 9];
            if within == Container::Chunk && input.read(&mut head[..1]).map_err(refused)? == 0 {
                return Ok(());
            }
            let known = usize::from(within == Container::Chunk);
            whole(input, &mut head[known..])?;
            let [kind, length @ ..] = head;
            let length = u64::from_le_bytes(length);
            match kind {
                FOOTER if within == Container::File => {
                    pass_over(input, length)?;
                    let mut magic = [0; MCAP_MAGIC.len()];
                    whole(input, &mut magic)?;
                    let is_whole = magic == MCAP_MAGIC;
                    return is_whole.then_some(()).ok_or(RecordsError::Torn);
                }
                CHUNK if within == Container::File => self.chunk(input)?,
                DATA_END if within == Container::File && length == 4 => {
                    let mut stated = [0; 4];
                    whole(input, &mut stated)?;
                    check_sum(u32::from_le_bytes(stated), sum, "the file")?;
                }
                MESSAGE if length > LARGEST_RECORD => {
                    let mut channel = [0; 2];
                    whole(input, &mut channel)?;
                    let channel = u16::from_le_bytes(channel);
                    (self.each)(McapRecord::LargeMessage { channel })?;
                    pass_over(input, length - 2)?;
                }
                SCHEMA | CHANNEL | MESSAGE => self.record(input, kind, length)?,
                _ => pass_over(input, length)?,
            }
        }
    }

    fn record(&mut self, input: &mut dyn Read, kind: u8, length: u64) -> Result<(), RecordsError> {
        if length > LARGEST_RECORD {
            return Err(RecordsError::damaged("a record of more than 16 MiB"));
        }
        self.record.clear();
        let read = input.take(length).read_to_end(&mut self.record);
        if (read.map_err(refused)? as u64) < length {
            return Err(RecordsError::Torn);
        }
        let record = McapRecord::of(kind, &self.record);
        let record = record.ok_or_else(|| RecordsError::damaged("a record is broken"))?;
        Ok((self.each)(record)?)
    }

    fn chunk(&mut self, input: &mut dyn Read) -> Result<(), RecordsError> {
        let head = ChunkHead::read(input)?;
        let mut packed = Read::take(&mut *input, head.length);
        let read = match head.compression.as_str() {
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
        read.map_err(|error| error.within_chunk(packed.limit() == 0))?;
        let left = packed.limit();
        pass_over(&mut packed, left)
    }

    fn unpacked(
        &mut self,
        head: &ChunkHead,
        unpacked: Take<impl Read>,
    ) -> Result<(), RecordsError> {
        let mut unpacked = BufReader::new(unpacked);
        let mut summed = SummedInput::new(&mut unpacked);
        let read = self.records(&mut summed, Container::Chunk);
        let found = summed.crc().sum();
        let is_whole = unpacked.get_ref().limit() == 0;
        read.map_err(|error| error.within_chunk(is_whole))?;
        // A chunk that lacks bytes is torn; the next read reports that.
        if is_whole {
            check_sum(head.checksum, found, "a chunk")?;
        }
        Ok(())
    }
}
