//! A live stream of frames, read by the readers of recordings behind an input that waits.

use std::io::{BufRead, Read};

use crate::error::{ReadError, ReadErrorKind};
use crate::formats::recording::boards::take_bytes;
use crate::formats::recording::event::{
    ReadOptions, ReadState, RecordingEvent, RecordingSink, Sink, Stop,
};
use crate::formats::recording::format::{Format, LOOKED_AT, Reader, format_of_head, refused};

/// The counts of a stream, made from its events by whoever takes them.
#[derive(Clone, Debug, Default, PartialEq, Eq)]
pub struct StreamCounts {
    /// The number of bytes; set by whoever reads them.
    pub bytes: u64,
    /// The number of whole frames.
    pub frames: u64,
    /// The number of torn, short, long and garbled frames.
    pub dropped: u64,
    /// The beginning of the last dropped frame, up to 40 characters; None if none of its bytes are known.
    pub sample: Option<String>,
    /// The reason why the last dropped frame is invalid.
    pub reason: Option<String>,
}

/// The most characters of a sample.
const SAMPLE: usize = 40;

impl StreamCounts {
    /// Counts a frame, or one that was dropped.
    pub fn note(&mut self, event: &RecordingEvent<'_>) {
        match event {
            RecordingEvent::Frame(_) => self.frames += 1,
            RecordingEvent::Damage { error, bytes } => {
                self.dropped += 1;
                self.reason = Some(error.to_string());
                if !bytes.is_empty() {
                    let bytes = &bytes[..bytes.len().min(SAMPLE)];
                    let text: String = bytes.escape_ascii().map(char::from).collect();
                    self.sample = Some(text.chars().take(SAMPLE).collect());
                }
            }
            _ => {}
        }
    }
}

/// Reads a stream with the readers of recordings. It may be interrupted: after a connection came back, [`Self::read`] is
/// called again, and the format, the channels and the clock go on. The torn frame is dropped, as is what precedes the
/// first boundary of a stream that was joined anywhere.
#[derive(Debug)]
pub struct StreamReader {
    options: ReadOptions,
    /// Once it is known.
    format: Option<&'static Format>,
    state: ReadState,
    is_joined: bool,
}

/// The bytes after which the format is looked for again, if no line ends before.
const STEP: usize = 64;

/// The first bytes, after each of which the format is looked for.
const MARKERS: usize = 16;

/// The lines after each of which the format is looked for.
const MOST_LINES: usize = 64;

impl StreamReader {
    /// Prepares for the first byte of a stream. Wrong frames are always left out and reported as
    /// [`RecordingEvent::Damage`]; a channel without a name is reported only beside others.
    pub fn new(options: &ReadOptions) -> Self {
        let mut reader = Self::of_recording(options);
        reader.state.hides_unnamed = true;
        reader
    }

    /// Prepares for a recording that grows: like a stream, but each channel is reported.
    pub fn of_recording(options: &ReadOptions) -> Self {
        let options = ReadOptions {
            leaves_out: true,
            ..options.clone()
        };
        Self {
            format: options.format,
            is_joined: options.is_joined,
            state: ReadState::default(),
            options,
        }
    }

    /// Reads until the input ends, or the consumer wants no more. An end by [`ErrorKind::UnexpectedEof`](std::io::ErrorKind) may have cut
    /// a line, which is then dropped; any other is that of the last line. At its end, the input must go on to end so.
    ///
    /// # Errors
    /// If the input cannot be read, has no known format ([`ReadErrorKind::UnknownFormat`]) or one that only a file has,
    /// or does not say how its values are arranged ([`ReadErrorKind::Unsized`]).
    pub fn read(
        &mut self,
        input: &mut dyn BufRead,
        consumer: &mut RecordingSink<'_>,
    ) -> Result<(), ReadError> {
        let is_joined = std::mem::replace(&mut self.is_joined, true);
        let options = ReadOptions {
            is_joined,
            ..self.options.clone()
        };
        let mut head = Vec::new();
        let format = match self.format {
            Some(format) => format,
            None => match look(input, &options, &mut head)? {
                Some(format) => *self.format.insert(format),
                None => return Ok(()),
            },
        };
        let (state, options) = (&mut self.state, &options);
        let sink = &mut Sink {
            consumer,
            state,
            options,
        };
        let mut input = head.as_slice().chain(input);
        let read = match format.read {
            Reader::Bytes(read) if format.stream.is_some() => read(&mut input, sink),
            _ => {
                let name = format.name;
                return Err(ReadError::new(format!(
                    "a recording ({name}), not a stream; save it to a file, then type taxel frames FILE"
                )));
            }
        };
        Stop::settled(read)
    }
}

/// Takes the first bytes of a stream until they show its format, which does not depend on the pieces in which they come;
/// None if there are none.
fn look(
    input: &mut dyn BufRead,
    options: &ReadOptions,
    head: &mut Vec<u8>,
) -> Result<Option<&'static Format>, ReadError> {
    let (mut seen, mut tried, mut lines) = (0, 0, 0);
    loop {
        let has_ended = take_bytes(input, usize::MAX, head)?;
        let is_all = has_ended || head.len() >= LOOKED_AT;
        for at in seen + 1..=head.len().min(LOOKED_AT) {
            let is_line = head[at - 1] == b'\n' && lines < MOST_LINES;
            // The same steps however far the pieces reach. Markers decide at once.
            if at <= MARKERS || is_line || at >= tried + STEP.max(tried / 8) {
                (tried, lines) = (at, lines + usize::from(is_line));
                if let Some(format) = format_of_head(&head[..at], options, false) {
                    return Ok(Some(format));
                }
            }
        }
        seen = head.len();
        if is_all {
            let head = &head[..head.len().min(LOOKED_AT)];
            let is_binary = str::from_utf8(head).is_err_and(|error| error.error_len().is_some());
            return match format_of_head(head, options, true) {
                Some(format) => Ok(Some(format)),
                None if head.is_empty() || options.is_joined && has_ended => Ok(None),
                None if options.size.is_none() && is_binary => {
                    let message =
                        "bytes of no known format; those of a board do not state their size";
                    Err(ReadError::new(message).of_kind(ReadErrorKind::Unsized))
                }
                None => Err(refused(head)),
            };
        }
    }
}
