//! Detects the format of a recording from its content.
//!
//! The tests go from the most to the least distinctive: magic bytes first, then JSON, then words that only one vendor
//! writes, then ROS, then a table. A `.csv` of XSENSOR or Tekscan would pass for a table, so it is tested before
//! that.

use std::io::{self, BufReader, Read, Seek, SeekFrom};

use crate::error::ReadError;
use crate::formats::file::without_mark;
use crate::formats::numpy;
use crate::formats::recording::error::unknown_format;
use crate::formats::recording::event::{ReadOptions, ReadState, RecordingSink, Sink, Stop};
use crate::formats::recording::format;
use crate::formats::recording::json as json_lines;
use crate::formats::recording::numpy as arrays;
use crate::formats::recording::ros::{MCAP_MAGIC, echo, mcap};
use crate::formats::recording::table;
use crate::formats::recording::vendor::{flexitac, tekscan, xsensor};
use crate::formats::stream::FLEXITAC_MARKER;
use taxel_core::parameter::named;

pub(super) const LOOKED_AT: usize = 1 << 16;

const CHUNK: usize = 1 << 16;

/// Returns the format of a recording, from its first 64 KiB.
pub fn recognised(start: &[u8]) -> Option<RecordingFormat> {
    let format = format::format_of_head(start, &ReadOptions::default(), true)?;
    format.name.parse().ok()
}

/// The format of a recording.
///
/// # Errors
/// If it has none.
pub fn format_of(input: impl Read, options: &ReadOptions) -> Result<RecordingFormat, ReadError> {
    let format = format::format_of(input, options)?;
    format.name.parse().map_err(|_| unknown_format())
}

fn is_bitmap(start: &[u8]) -> bool {
    matches!(start, [b'P', b'1' | b'4', blank, ..] if blank.is_ascii_whitespace())
}

/// Returns the format of a followed file after it was truncated or replaced, reading the input from its current
/// position; before that, it had the format `before`. None if too little has been written yet.
///
/// The same program may go on in the middle of a frame, behind zero bytes, or with a message; a torn line of JSON may
/// look like a table. So the format changes only if the content is clearly another recording.
///
/// # Errors
/// Returns the system's error if the input cannot be read.
#[cfg(unix)]
pub fn format_after(
    input: impl Read,
    before: RecordingFormat,
) -> io::Result<Option<RecordingFormat>> {
    let start = start_of(input)?;
    // The text after the last of them has no end yet.
    let lines = start.split(|&byte| byte == b'\n').skip(1).count();
    Ok(match recognised(&start) {
        Some(own) if own == before || !own.is_text_stream() => Some(own),
        _ if may_hold_frame(&start, before) => Some(before),
        Some(own) => (lines > 1).then_some(own),
        None => (lines > 0 || start.len() == LOOKED_AT).then_some(before),
    })
}

/// Returns true if a frame in this format may begin somewhere in the content. Almost any text may hold a frame of a
/// table, so that is not asked.
#[cfg(unix)]
fn may_hold_frame(content: &[u8], format: RecordingFormat) -> bool {
    let mut lines = content.split(|&byte| byte == b'\n');
    match format {
        RecordingFormat::JsonLines => lines.any(|line| line.starts_with(b"{")),
        RecordingFormat::Ros2 => lines.any(|line| line == b"---" || echo::begins_message(line)),
        RecordingFormat::Flexitac => content.windows(2).any(|pair| pair == [0xaa, 0x55]),
        _ => false,
    }
}

fn start_of(input: impl Read) -> io::Result<Vec<u8>> {
    let mut start = Vec::new();
    input.take(LOOKED_AT as u64).read_to_end(&mut start)?;
    Ok(start)
}

/// The input of a recording. It is read in large pieces through a `dyn` reference, so the readers are compiled only
/// once.
pub trait RecordingInput: Read + Seek {}

impl<T: Read + Seek> RecordingInput for T {}

#[derive(Debug, Default)]
pub struct EarlierLayout;

/// Reads a recording whose format is known, like [`read`]. In a followed file, `earlier` is the arrangement of the
/// table that it held before, and is replaced by the present one.
pub fn read_as(
    format: RecordingFormat,
    input: &mut dyn RecordingInput,
    options: &ReadOptions,
    _earlier: &mut EarlierLayout,
    consumer: &mut RecordingSink<'_>,
) -> Result<(), ReadError> {
    input.seek(SeekFrom::Start(0))?;
    let mut input = BufReader::with_capacity(CHUNK, input);
    let mut state = ReadState::default();
    let sink = &mut Sink::new(consumer, &mut state);
    let read = match format {
        RecordingFormat::Tekscan => tekscan::read(&mut input, sink),
        RecordingFormat::Xsensor => xsensor::read(&mut input, sink),
        RecordingFormat::Npy => arrays::read_array(&mut input, options, sink),
        RecordingFormat::Npz => arrays::read_archive(input, options, sink),
        RecordingFormat::JsonLines => json_lines::read(input, options, sink),
        RecordingFormat::Ros2 => echo::read(input, options, sink),
        RecordingFormat::Csv => table::read(&mut input, options, sink),
        RecordingFormat::Flexitac => flexitac::read(&mut input, options, sink),
        RecordingFormat::Mcap => mcap::read(&mut input, options, sink),
    };
    match read {
        Ok(()) | Err(Stop::Enough) => Ok(()),
        Err(Stop::Failed(error)) => Err(error),
    }
}

/// The first bytes of the formats that have such bytes. An archive without a file begins with its end.
const MAGIC: [(&[u8], RecordingFormat); 5] = [
    (numpy::MAGIC, RecordingFormat::Npy),
    (&MCAP_MAGIC, RecordingFormat::Mcap),
    (&FLEXITAC_MARKER, RecordingFormat::Flexitac),
    (b"PK\x03\x04", RecordingFormat::Npz),
    (b"PK\x05\x06", RecordingFormat::Npz),
];

/// The most bytes that decide by themselves.
#[cfg(unix)]
pub(super) const LONGEST_MAGIC: usize = MCAP_MAGIC.len();

pub(super) fn by_magic(start: &[u8]) -> Option<RecordingFormat> {
    let mut formats = MAGIC.into_iter();
    formats.find_map(|(magic, format)| start.starts_with(magic).then_some(format))
}

/// The words of vendors in the lines so far. The format whose words are complete first counts.
#[derive(Debug, Default)]
pub(super) struct VendorSigns {
    lines: usize,
    has_frame: bool,
}

impl VendorSigns {
    /// Adds the next line, without its end. Returns the format if its words are complete now. `DATA_TYPE` is an ordinary
    /// word, so it counts only at the start of a text, where Tekscan writes it.
    pub(super) fn add(&mut self, line: &[u8]) -> Option<RecordingFormat> {
        let is_blank = line.trim_ascii().is_empty();
        let is_first = self.lines == 0 && !is_blank;
        self.lines += usize::from(!is_blank);
        if line.starts_with(b"ASCII_DATA") || is_first && line.starts_with(b"DATA_TYPE ") {
            return Some(RecordingFormat::Tekscan);
        }
        if self.has_frame && xsensor::has_key(line, "SENSELS") {
            return Some(RecordingFormat::Xsensor);
        }
        self.has_frame |= xsensor::has_key(line, "FRAME");
        None
    }
}

/// The search whether a stream begins like a recording that only a file can be. The stream is examined byte by byte, so
/// the answer does not depend on the pieces in which the bytes arrive, and comes as soon as it is certain.
///
/// - Magic bytes decide once all of them have come.
/// - The words of vendors decide at the end of the line that completes them.
/// - Anything else is decided at the end of the bytes that are looked at, or of the stream, as for a file.
#[cfg(unix)]
#[derive(Debug, Default)]
pub(crate) struct StartSearch {
    /// The bytes so far, at most [`LOOKED_AT`].
    bytes: Vec<u8>,
    seen: usize,
    line: usize,
    /// The words of vendors so far; None as long as there are only blanks.
    signs: Option<VendorSigns>,
}

#[cfg(unix)]
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(crate) enum StartKind {
    /// A stream, as far as the start shows it.
    Stream,
    /// A recording that only a file can be.
    Recording(RecordingFormat),
}

#[cfg(unix)]
impl StartKind {
    /// Returns the kind of a source whose start has this format, or none that is known.
    fn of(format: Option<RecordingFormat>) -> Self {
        match format.filter(|format| !format.can_be_streamed()) {
            Some(format) => Self::Recording(format),
            None => Self::Stream,
        }
    }
}

#[cfg(unix)]
impl StartSearch {
    /// Examines the next bytes. Returns the number of those after which the answer is certain, and the answer; None if
    /// more bytes are needed.
    pub(crate) fn push(&mut self, bytes: &[u8]) -> Option<(usize, StartKind)> {
        let before = self.bytes.len();
        let room = LOOKED_AT - before;
        self.bytes.extend(bytes.iter().take(room));
        while self.seen < self.bytes.len() {
            let rest = &self.bytes[self.seen..];
            self.seen += if self.seen < LONGEST_MAGIC {
                1
            } else {
                let end = rest.iter().position(|&byte| byte == b'\n');
                end.map_or(rest.len(), |end| end + 1)
            };
            if let Some(kind) = self.look() {
                return Some((self.seen - before, kind));
            }
        }
        (self.seen == LOOKED_AT).then(|| (room, self.finish()))
    }

    pub(crate) fn finish(&self) -> StartKind {
        StartKind::of(recognised(&self.bytes))
    }

    /// Looks at the bytes that have been examined, after the last of them.
    fn look(&mut self) -> Option<StartKind> {
        let seen = &self.bytes[..self.seen];
        if self.seen <= LONGEST_MAGIC
            && let Some(format) = by_magic(seen)
        {
            return Some(StartKind::of(Some(format)));
        }
        let line = Some(&seen[self.line..]).filter(|line| line.ends_with(b"\n"))?;
        let line = if self.line == 0 {
            without_mark(line)
        } else {
            line
        };
        self.line = self.seen;
        if line.contains(&0) {
            return Some(StartKind::Stream);
        }
        let signs = match &mut self.signs {
            Some(signs) => signs,
            None => match line.trim_ascii().first()? {
                b'{' | b'<' => return Some(StartKind::Stream),
                _ if is_bitmap(line) => return Some(StartKind::Stream),
                _ => self.signs.insert(VendorSigns::default()),
            },
        };
        signs
            .add(line.strip_suffix(b"\n").unwrap_or(line))
            .map(|format| StartKind::of(Some(format)))
    }
}

/// A format of recordings.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash)]
pub enum RecordingFormat {
    /// Tekscan's ASCII export.
    Tekscan,
    /// XSENSOR's CSV export.
    Xsensor,
    /// Numbers separated by commas, semicolons, tabs or spaces: one frame per line, or one row per line.
    Csv,
    /// A numpy array.
    Npy,
    /// An archive of numpy arrays.
    Npz,
    /// JSON lines: one object per line.
    JsonLines,
    /// The output of `ros2 topic echo`.
    Ros2,
    /// An MCAP file.
    Mcap,
    /// The bytes of a `FlexiTac` board.
    Flexitac,
}

impl RecordingFormat {
    /// All formats.
    pub const ALL: &'static [Self] = &[
        Self::Tekscan,
        Self::Xsensor,
        Self::Csv,
        Self::Npy,
        Self::Npz,
        Self::JsonLines,
        Self::Ros2,
        Self::Mcap,
        Self::Flexitac,
    ];

    /// Returns the name of the format, as it is in answers.
    pub fn name(self) -> &'static str {
        match self {
            Self::Tekscan => "tekscan",
            Self::Xsensor => "xsensor",
            Self::Csv => "csv",
            Self::Npy => "npy",
            Self::Npz => "npz",
            Self::JsonLines => "jsonl",
            Self::Ros2 => "ros2",
            Self::Mcap => "mcap",
            Self::Flexitac => "flexitac",
        }
    }

    #[expect(dead_code)]
    pub(super) fn title(self) -> &'static str {
        match self {
            Self::Tekscan => "Tekscan ASCII",
            Self::Xsensor => "XSENSOR CSV",
            Self::Csv => "CSV",
            Self::Npy => "NPY",
            Self::Npz => "NPZ",
            Self::JsonLines => "JSON lines",
            Self::Ros2 => "ros2 topic echo",
            Self::Mcap => "MCAP",
            Self::Flexitac => "FlexiTac",
        }
    }

    /// Returns true if frames in this format can be a stream, too: they are written one after the other as they are
    /// measured, and can be read as they arrive. A file that they are appended to can be followed.
    pub(crate) fn can_be_streamed(self) -> bool {
        match self {
            Self::Csv | Self::JsonLines | Self::Ros2 | Self::Flexitac => true,
            Self::Tekscan | Self::Xsensor | Self::Npy | Self::Npz | Self::Mcap => false,
        }
    }

    pub(crate) fn is_text_stream(self) -> bool {
        self.can_be_streamed() && self != Self::Flexitac
    }
}

named!(RecordingFormat, "format", RecordingFormat::ALL);
