//! Reads the records of an MCAP file, which follow each other, even within chunks.
//!
//! Chunks compressed by LZ4 or Zstandard are decompressed as they are read, by decoders in Rust. The records are read
//! here, since the crate `mcap` needs 18 others, more than this project allows itself. Source:
//! <https://mcap.dev/spec>.
//!
//! Writers may leave out a checksum, which is 0 then. A checksum covers a whole chunk, or everything before the end
//! of the data, so it shows that a message is damaged, but not which one: messages are reported as they are read,
//! then the error.

use std::io::{self, BufReader, ErrorKind, Read, Take};

use flate2::CrcReader;
use taxel_core::index::{index, wide};
use taxel_core::quote::shortened_message;

use crate::error::{ReadError, ReadErrorKind};
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
    in_words(
        read,
        TORN,
        "the file ends without a footer: it was not closed",
    )
}

/// The errors of bytes that end within a record, or before the footer.
const TORN: &[ErrorKind] = &[ErrorKind::UnexpectedEof];

/// The errors of unpacking.
const PACKED: &[ErrorKind] = &[ErrorKind::Other, ErrorKind::InvalidData];

/// Says what an error of one of these kinds means.
fn in_words(read: Result<(), Stop>, kinds: &[ErrorKind], message: &str) -> Result<(), Stop> {
    read.map_err(|stop| match stop {
        Stop::Failed(ReadError {
            kind: ReadErrorKind::Io(kind),
            ..
        }) if kinds.contains(&kind) => ReadError::new(message).into(),
        stop => stop,
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

/// The head of a chunk, before its records.
struct ChunkHead {
    size: u64,
    checksum: u32,
    /// The name of the compression; empty if there is none.
    compression: String,
    length: u64,
}

impl ChunkHead {
    fn read(input: &mut dyn Read) -> Result<Self, ReadError> {
        // Start, end, size, checksum, length of the compression's name.
        let mut head = [0; 32];
        input.read_exact(&mut head)?;
        let size = head[16..24].try_into().map_or(0, u64::from_le_bytes);
        let word = |at: usize| head[at..at + 4].try_into().map_or(0, u32::from_le_bytes);
        let (checksum, length) = (word(24), word(28));
        let mut name = vec![0; wide(length.min(40))];
        input.read_exact(&mut name)?;
        let mut records = [0; 8];
        input.read_exact(&mut records)?;
        let compression = String::from_utf8_lossy(&name).into_owned();
        if size > LARGEST_CHUNK {
            return Err(ReadError::new("a chunk of more than 1 GiB"));
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

fn check_sum(stated: u32, found: u32, of: &str) -> Result<(), ReadError> {
    if stated == 0 || stated == found {
        return Ok(());
    }
    let message = format!("the checksum of {of} does not hold, so a message in it is damaged");
    Err(ReadError::new(message))
}

/// Skips `length` bytes.
fn pass_over(input: &mut dyn Read, length: u64) -> Result<(), Stop> {
    if io::copy(&mut Read::take(input, length), &mut io::sink())? < length {
        return Err(io::Error::from(ErrorKind::UnexpectedEof).into());
    }
    Ok(())
}

impl RecordReader<'_> {
    fn records(&mut self, input: &mut SummedInput<'_>, within: Container) -> Result<(), Stop> {
        loop {
            let sum = input.crc().sum();
            let mut head = [0; 9];
            if within == Container::Chunk && input.read(&mut head[..1])? == 0 {
                return Ok(());
            }
            let known = usize::from(within == Container::Chunk);
            input.read_exact(&mut head[known..])?;
            let [kind, length @ ..] = head;
            let length = u64::from_le_bytes(length);
            match kind {
                FOOTER if within == Container::File => {
                    pass_over(input, length)?;
                    let mut magic = [0; MCAP_MAGIC.len()];
                    input.read_exact(&mut magic)?;
                    return match magic {
                        MCAP_MAGIC => Ok(()),
                        _ => Err(io::Error::from(ErrorKind::UnexpectedEof).into()),
                    };
                }
                CHUNK if within == Container::File => self.chunk(input)?,
                DATA_END if within == Container::File && length == 4 => {
                    let mut stated = [0; 4];
                    input.read_exact(&mut stated)?;
                    check_sum(u32::from_le_bytes(stated), sum, "the file")?;
                }
                MESSAGE if length > LARGEST_RECORD => {
                    let mut channel = [0; 2];
                    input.read_exact(&mut channel)?;
                    let channel = u16::from_le_bytes(channel);
                    (self.each)(McapRecord::LargeMessage { channel })?;
                    pass_over(input, length - 2)?;
                }
                SCHEMA | CHANNEL | MESSAGE => self.record(input, kind, length)?,
                _ => pass_over(input, length)?,
            }
        }
    }

    fn record(&mut self, input: &mut dyn Read, kind: u8, length: u64) -> Result<(), Stop> {
        if length > LARGEST_RECORD {
            return Err(ReadError::new("a record of more than 16 MiB").into());
        }
        self.record.resize(index(length), 0);
        input.read_exact(&mut self.record)?;
        let record = McapRecord::of(kind, &self.record);
        (self.each)(record.ok_or_else(|| ReadError::new("a record is broken"))?)
    }

    fn chunk(&mut self, input: &mut dyn Read) -> Result<(), Stop> {
        let head = ChunkHead::read(input)?;
        let mut packed = Read::take(&mut *input, head.length);
        let broken = "a chunk cannot be unpacked";
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
                let unpacked = unpacked.map_err(|_| ReadError::new(broken))?;
                self.unpacked(&head, unpacked.take(head.size))
            }
            other => {
                let message =
                    format!("chunks are compressed with {other:?}, expected lz4, zstd or none");
                return Err(ReadError::new(shortened_message(&message)).into());
            }
        };
        let left = packed.limit();
        in_words(within(read, left == 0), PACKED, broken)?;
        pass_over(&mut packed, left)
    }

    fn unpacked(&mut self, head: &ChunkHead, unpacked: Take<impl Read>) -> Result<(), Stop> {
        let mut unpacked = BufReader::new(unpacked);
        let mut summed = SummedInput::new(&mut unpacked);
        let read = self.records(&mut summed, Container::Chunk);
        let found = summed.crc().sum();
        let is_whole = unpacked.get_ref().limit() == 0;
        within(read, is_whole)?;
        // A chunk that lacks bytes is torn; the next read reports that.
        if is_whole {
            check_sum(head.checksum, found, "a chunk")?;
        }
        Ok(())
    }
}

/// Says what is wrong with the records of a chunk that are torn: if all its bytes were there, the file is not torn.
fn within(read: Result<(), Stop>, is_whole: bool) -> Result<(), Stop> {
    let kinds = if is_whole { TORN } else { &[] };
    in_words(read, kinds, "a record reaches beyond its chunk")
}
