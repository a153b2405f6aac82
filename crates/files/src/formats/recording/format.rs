//! The formats of recordings and streams, a row each, and which of them some content has.

use std::io::{BufRead, BufReader, Read, Seek};

use taxel_core::parameter::UnknownName;

use crate::error::{ReadError, ReadErrorKind};
use crate::formats::file::without_mark;
use crate::formats::numpy::MAGIC;
use crate::formats::recording::error::{foreign, unknown_format, unshaped};
use crate::formats::recording::event::{ReadOptions, ReadState, RecordingSink, Sink, Stop};
use crate::formats::recording::json as json_lines;
use crate::formats::recording::numpy;
use crate::formats::recording::records::MCAP_MAGIC;
use crate::formats::recording::{boards, echo, mcap, table, tekscan, xsensor};

/// The most bytes at the beginning that decide the format.
pub(super) const LOOKED_AT: usize = 1 << 16;

const CHUNK: usize = 1 << 16;

/// A format of recordings, or of streams: all that the rest of the program knows of it.
#[derive(Debug)]
pub struct Format {
    /// The name in answers.
    pub name: &'static str,
    /// The name in sentences.
    pub title: &'static str,
    /// The name as a format of streams; None if only a file has this format.
    pub stream: Option<&'static str>,
    /// Whether this is the beginning of such a content. If it `is_all` there is to look at, this is the last question;
    /// otherwise it is asked again with more.
    sniff: fn(&[u8], &ReadOptions, bool) -> bool,
    pub(super) read: Reader,
}

/// How a format is read.
#[derive(Debug)]
pub(super) enum Reader {
    /// Reads bytes as they come: recordings and streams alike. `fill_buf` waits for more; empty is the end, and
    /// [`io::ErrorKind::UnexpectedEof`] an end that may have cut a line.
    Bytes(fn(&mut dyn BufRead, &mut Sink<'_>) -> Result<(), Stop>),
    /// Needs the whole file.
    File(fn(&mut dyn ReadSeek, &mut Sink<'_>) -> Result<(), Stop>),
}

/// A file that is read in any order.
pub(super) trait ReadSeek: BufRead + Seek {}

impl<T: BufRead + Seek> ReadSeek for T {}

/// The formats. What comes first is the most distinctive: a table may look like much else.
pub static FORMATS: [Format; 10] = [
    Format {
        name: "tekscan",
        title: "Tekscan ASCII",
        stream: None,
        sniff: |head, _, _| is_tekscan(head),
        read: Reader::Bytes(tekscan::read),
    },
    Format {
        name: "xsensor",
        title: "XSENSOR CSV",
        stream: None,
        sniff: |head, _, _| is_xsensor(head),
        read: Reader::Bytes(xsensor::read),
    },
    Format {
        name: "npy",
        title: "NPY",
        stream: None,
        sniff: |head, _, _| head.starts_with(MAGIC),
        read: Reader::File(|input, sink| numpy::read_array(input, sink)),
    },
    Format {
        name: "npz",
        title: "NPZ",
        stream: None,
        sniff: |head, _, _| head.starts_with(b"PK\x03\x04") || head.starts_with(b"PK\x05\x06"),
        read: Reader::File(|input, sink| numpy::read_archive(input, sink)),
    },
    Format {
        name: "mcap",
        title: "MCAP",
        stream: None,
        sniff: |head, _, _| head.starts_with(&MCAP_MAGIC),
        read: Reader::File(|input, sink| mcap::read(input, sink)),
    },
    Format {
        name: "jsonl",
        title: "JSON lines",
        stream: Some("jsonl"),
        sniff: |head, options, _| is_json(head, options),
        read: Reader::Bytes(json_lines::read),
    },
    Format {
        name: "ros2",
        title: "ros2 topic echo",
        stream: Some("ros2"),
        sniff: |head, options, _| is_text(head) && echo::sniff(without_mark(head), options),
        read: Reader::Bytes(echo::read),
    },
    Format {
        name: "flexitac",
        title: "FlexiTac",
        stream: Some("flexitac"),
        sniff: boards::is_flexitac,
        read: Reader::Bytes(boards::flexitac),
    },
    Format {
        name: "matsense",
        title: "MatSense",
        stream: Some("matsense"),
        sniff: boards::is_matsense,
        read: Reader::Bytes(boards::matsense),
    },
    Format {
        name: "csv",
        title: "CSV",
        stream: Some("lines"),
        sniff: |head, options, is_all| {
            is_text(head) && table::sniff(without_mark(head), options, is_all)
        },
        read: Reader::Bytes(table::read),
    },
];

impl Format {
    /// The formats of streams, with their names.
    pub fn of_streams() -> impl Iterator<Item = (&'static str, &'static Self)> {
        FORMATS
            .iter()
            .filter_map(|format| format.stream.map(|name| (name, format)))
    }

    /// The format of streams of that name.
    ///
    /// # Errors
    /// If no format of streams has the name.
    pub fn of_stream(name: &str) -> Result<&'static Self, UnknownName> {
        let all: Vec<_> = Self::of_streams().collect();
        UnknownName::unless_found("format", name, &all, |(name, _)| name).map(|(_, format)| format)
    }
}

/// The format of a content that begins like this; None if it has none, or if more is needed to tell.
pub(super) fn format_of_head(
    head: &[u8],
    options: &ReadOptions,
    is_all: bool,
) -> Option<&'static Format> {
    // Bytes that begin anywhere do not show what only a file is.
    let mut formats = FORMATS
        .iter()
        .filter(|format| !options.is_joined || format.stream.is_some());
    formats.find(|format| (format.sniff)(head, options, is_all))
}

/// Returns true if bytes that are neither an imprint nor a shape look like a recording, for the message about them.
/// JSON must contain a frame for this: most JSON is a stored shape with a mistake.
pub fn may_be_recording(bytes: &[u8]) -> bool {
    let head = &bytes[..bytes.len().min(LOOKED_AT)];
    match format_of_head(head, &ReadOptions::default(), true) {
        Some(format) if format.name == "jsonl" => has(head, b"\"frame\""),
        found => found.is_some(),
    }
}

/// The format of a recording, read from the current position of the input.
///
/// # Errors
/// If it has none of the formats, with the kind [`ReadErrorKind::UnknownFormat`] if it may still become one; or if the
/// input cannot be read.
pub fn format_of(input: impl Read, options: &ReadOptions) -> Result<&'static Format, ReadError> {
    let mut head = Vec::new();
    input.take(LOOKED_AT as u64).read_to_end(&mut head)?;
    format_of_head(&head, options, true).ok_or_else(|| refused(&head))
}

/// Reads a recording from its beginning to its end, and reports its events to `consumer`, which may end the reading.
///
/// # Errors
/// If the input cannot be read, is not a recording, is damaged, or does not say how its values are arranged. Whole
/// frames before the damage have been reported.
pub fn read(
    mut input: impl Read + Seek,
    options: &ReadOptions,
    consumer: &mut RecordingSink<'_>,
) -> Result<&'static Format, ReadError> {
    input.rewind()?;
    let format = match options.format {
        Some(format) => format,
        None => format_of(&mut input, options)?,
    };
    input.rewind()?;
    let mut input = BufReader::with_capacity(CHUNK, input);
    let mut state = ReadState::default();
    let state = &mut state;
    let mut sink = Sink {
        consumer,
        state,
        options,
    };
    let read = match format.read {
        Reader::Bytes(read) => read(&mut input, &mut sink),
        Reader::File(read) => read(&mut input, &mut sink),
    };
    Stop::settled(read).map(|()| format)
}

/// The error for a content of no known format.
pub(super) fn refused(head: &[u8]) -> ReadError {
    let text = without_mark(head).trim_ascii();
    if head.starts_with(b"SQLite format 3\0") {
        foreign("an SQLite database: of a ROS 2 bag, ros2 bag convert makes an MCAP file")
    } else if head.is_empty() {
        ReadError::new("empty, expected a recording").of_kind(ReadErrorKind::UnknownFormat)
    } else if !text.is_empty() && text.iter().all(|byte| b"#.\r\n".contains(byte)) {
        foreign("an imprint as text (taxel describe reads it)")
    } else if table::is_column(without_mark(head)) {
        unshaped(1, None)
    } else {
        unknown_format()
    }
}

fn has(text: &[u8], word: &[u8]) -> bool {
    text.windows(word.len()).any(|window| window == word)
}

/// Whether this may be the text of a recording.
fn is_text(head: &[u8]) -> bool {
    let text = without_mark(head);
    !text.contains(&0) && !text.starts_with(b"<")
}

fn lines(text: &[u8]) -> impl Iterator<Item = &[u8]> {
    without_mark(text).split(|&byte| byte == b'\n')
}

fn is_tekscan(head: &[u8]) -> bool {
    let first = lines(head).find(|line| !line.trim_ascii().is_empty());
    is_text(head)
        && (first.is_some_and(|line| line.starts_with(b"DATA_TYPE "))
            || lines(head).any(|line| line.starts_with(b"ASCII_DATA")))
}

fn is_xsensor(head: &[u8]) -> bool {
    let mut lines = lines(head);
    is_text(head)
        && lines.any(|line| xsensor::has_key(line, "FRAME"))
        && lines.any(|line| xsensor::has_key(line, "SENSELS"))
}

/// For rows without keys, or all objects in one list, the reader of JSON lines says what it expected.
fn is_json(head: &[u8], options: &ReadOptions) -> bool {
    let text = without_mark(head).trim_ascii_start();
    let inside = text.strip_prefix(b"[").map(<[u8]>::trim_ascii_start);
    let is_list = inside.is_some_and(|inside| inside.starts_with(b"{"));
    let is_line = || lines(text).skip(1).any(|line| line.starts_with(b"{"));
    !text.contains(&0) && (text.starts_with(b"{") || is_list || options.is_joined && is_line())
}
