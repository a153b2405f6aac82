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

pub(super) const MCAP_MAGIC: [u8; 8] = *b"\x89MCAP0\r\n";

const LARGEST_RECORD: u64 = 1 << 24;

/// The size limit of Zstandard's window in bytes; its usual levels need 8 MiB at most.
const LARGEST_WINDOW: u64 = 16 << 20;

const LARGEST_CHUNK: u64 = 1 << 30;

/// The end of the records. The magic number follows.
const FOOTER: u8 = 2;
/// A schema, the type of messages: its number and name.
pub(super) const SCHEMA: u8 = 3;
/// A topic: its number, the number of its schema, its name and its encoding.
pub(super) const CHANNEL: u8 = 4;
/// A message: the number of its channel, its sequence number, the times of logging and publishing, and its data.
const MESSAGE: u8 = 5;
/// A chunk: a head, and records after it.
const CHUNK: u8 = 6;
/// The end of the messages, with the checksum of everything before it.
const DATA_END: u8 = 15;

/// What takes the kind of a record and its bytes.
type Each<'a> = dyn FnMut(u8, &[u8]) -> Result<(), Stop> + 'a;

/// Reads a file, and reports its schemas, channels and messages to `each`.
pub(super) fn each_record(input: &mut dyn Read, each: &mut Each<'_>) -> Result<(), Stop> {
    let mut input = SummedInput::new(input);
    let mut reader = RecordReader {
        record: Vec::new(),
        each,
    };
    let read = pass_over(&mut input, MCAP_MAGIC.len() as u64)
        .and_then(|()| reader.records(&mut input, false));
    let message = "the file ends without a footer: it was not closed";
    in_words(read, TORN, message)
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
    each: &'a mut Each<'a>,
}

type SummedInput<'a> = CrcReader<&'a mut dyn Read>;

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
        return Err(torn());
    }
    Ok(())
}

fn torn() -> Stop {
    io::Error::from(ErrorKind::UnexpectedEof).into()
}

impl RecordReader<'_> {
    /// Reads the records of a file, or of a chunk, in which there are no chunks and no end.
    fn records(&mut self, input: &mut SummedInput<'_>, is_chunk: bool) -> Result<(), Stop> {
        loop {
            let sum = input.crc().sum();
            let mut head = [0; 9];
            if is_chunk && input.read(&mut head[..1])? == 0 {
                return Ok(());
            }
            input.read_exact(&mut head[usize::from(is_chunk)..])?;
            let [kind, length @ ..] = head;
            let length = u64::from_le_bytes(length);
            match kind {
                FOOTER if !is_chunk => {
                    pass_over(input, length)?;
                    let mut magic = [0; MCAP_MAGIC.len()];
                    input.read_exact(&mut magic)?;
                    let is_end = magic == MCAP_MAGIC;
                    return is_end.then_some(()).ok_or_else(torn);
                }
                CHUNK if !is_chunk => self.chunk(input)?,
                DATA_END if !is_chunk && length == 4 => {
                    let mut stated = [0; 4];
                    input.read_exact(&mut stated)?;
                    check_sum(u32::from_le_bytes(stated), sum, "the file")?;
                }
                // A message of that size is the image of a camera.
                MESSAGE if length > LARGEST_RECORD => pass_over(input, length)?,
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
        (self.each)(kind, &self.record)
    }

    fn chunk(&mut self, input: &mut dyn Read) -> Result<(), Stop> {
        // Start, end, size, checksum, length of the compression's name.
        let mut head = [0; 32];
        input.read_exact(&mut head)?;
        let size = head[16..24].try_into().map_or(0, u64::from_le_bytes);
        let word = |at: usize| head[at..at + 4].try_into().map_or(0, u32::from_le_bytes);
        let (checksum, length) = (word(24), word(28));
        let mut compression = vec![0; wide(length.min(40))];
        input.read_exact(&mut compression)?;
        let mut length = [0; 8];
        input.read_exact(&mut length)?;
        let length = u64::from_le_bytes(length);
        if size > LARGEST_CHUNK {
            return Err(ReadError::new("a chunk of more than 1 GiB").into());
        }
        let mut packed = Read::take(&mut *input, length);
        let broken = "a chunk cannot be unpacked";
        let read = match &*String::from_utf8_lossy(&compression) {
            "" => self.unpacked(checksum, Read::take(&mut packed, length)),
            "lz4" => {
                let unpacked = lz4_flex::frame::FrameDecoder::new(&mut packed);
                self.unpacked(checksum, unpacked.take(size))
            }
            "zstd" => {
                let unpacked = ruzstd::decoding::StreamingDecoder::new_with_max_window_size(
                    &mut packed,
                    LARGEST_WINDOW,
                );
                let unpacked = unpacked.map_err(|_| ReadError::new(broken))?;
                self.unpacked(checksum, unpacked.take(size))
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

    fn unpacked(&mut self, checksum: u32, unpacked: Take<impl Read>) -> Result<(), Stop> {
        let mut unpacked = BufReader::new(unpacked);
        let mut summed = SummedInput::new(&mut unpacked);
        let read = self.records(&mut summed, true);
        let found = summed.crc().sum();
        let is_whole = unpacked.get_ref().limit() == 0;
        within(read, is_whole)?;
        // A chunk that lacks bytes is torn; the next read reports that.
        if is_whole {
            check_sum(checksum, found, "a chunk")?;
        }
        Ok(())
    }
}

/// Says what is wrong with the records of a chunk that are torn: if all its bytes were there, the file is not torn.
fn within(read: Result<(), Stop>, is_whole: bool) -> Result<(), Stop> {
    let kinds = if is_whole { TORN } else { &[] };
    in_words(read, kinds, "a record reaches beyond its chunk")
}
