//! A live stream of frames, read by the readers of recordings behind an input that waits.

use std::io::{self, BufRead};
use std::ops::ControlFlow;

use crate::error::{ReadError, ReadErrorKind};
use crate::formats::recording::event::{ReadOptions, RecordingEvent, RecordingSink};
use crate::formats::recording::format::Format;
use crate::formats::stream::{StreamDecoder, StreamEvent, StreamOptions, StreamRefusal};

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

/// Reads a stream, which may be interrupted: after a connection came back, [`Self::read`] is called again, and the
/// format, the channels and the clock go on. The torn frame is dropped, as is what precedes the first boundary of a
/// stream that was joined anywhere.
#[derive(Debug)]
pub struct StreamReader {
    decoder: StreamDecoder,
}

impl StreamReader {
    /// Prepares for the first byte. Wrong frames are always left out and reported as [`RecordingEvent::Damage`].
    pub fn new(options: &ReadOptions) -> Self {
        let stream = StreamOptions {
            format: options
                .format
                .and_then(|format| format.stream?.parse().ok()),
            size: options.size.or(options.stream_size),
            from_start: !options.is_joined,
        };
        let decoder = StreamDecoder::new(stream);
        Self { decoder }
    }

    /// The format, once it is known.
    pub fn format(&self) -> Option<&'static Format> {
        let found = self.decoder.format()?;
        Format::of_stream(found.name()).ok()
    }

    /// Prepares for the first byte of other content, perhaps in another format: a file was replaced. The channels and
    /// the clock go on.
    pub fn begin_anew(&mut self) {
        self.decoder.begin_anew();
    }

    /// Reads until the input ends, or the consumer wants no more. An end by [`io::ErrorKind::UnexpectedEof`] may have cut
    /// a line, which is then dropped; any other is that of the last line.
    ///
    /// # Errors
    /// If the input cannot be read, has no known format ([`ReadErrorKind::UnknownFormat`]), or does not say how its
    /// values are arranged ([`ReadErrorKind::Unsized`]).
    pub fn read(
        &mut self,
        input: &mut dyn BufRead,
        consumer: &mut RecordingSink<'_>,
    ) -> Result<(), ReadError> {
        loop {
            let mut flow = ControlFlow::Continue(());
            let dropped = self.decoder.counts().dropped;
            let mut sink = |event: StreamEvent<'_>| {
                if flow.is_continue() {
                    flow = consumer(match event {
                        StreamEvent::Channel(info) => RecordingEvent::Channel(info),
                        StreamEvent::Frame(frame) => RecordingEvent::Frame(frame),
                        StreamEvent::Provisional(frame) => RecordingEvent::Provisional(frame),
                        StreamEvent::Withdrawn => RecordingEvent::Withdrawn,
                        StreamEvent::Note(note) => RecordingEvent::Note(note),
                    });
                }
            };
            let ended = match input.fill_buf() {
                Ok([]) => {
                    self.decoder.finish(&mut sink);
                    Some(Ok(()))
                }
                Ok(bytes) => {
                    self.decoder.push(bytes, &mut sink);
                    let count = bytes.len();
                    input.consume(count);
                    None
                }
                Err(error) if error.kind() == io::ErrorKind::Interrupted => None,
                Err(error) => {
                    self.decoder.cut_off(&mut sink);
                    let is_cut = error.kind() == io::ErrorKind::UnexpectedEof;
                    Some(if is_cut { Ok(()) } else { Err(error.into()) })
                }
            };
            let counts = self.decoder.counts();
            for _ in dropped..counts.dropped {
                let error = ReadError::new(counts.reason.as_deref().unwrap_or("garbled"));
                let bytes = counts.sample.as_deref().unwrap_or("").as_bytes();
                let damage = RecordingEvent::Damage {
                    error: &error,
                    bytes,
                };
                if flow.is_continue() {
                    flow = consumer(damage);
                }
            }
            if flow.is_break() {
                return Ok(());
            }
            if let Some(refusal) = self.decoder.counts().refusal() {
                let kind = match refusal {
                    StreamRefusal::Unknown => ReadErrorKind::UnknownFormat,
                    StreamRefusal::Cut => ReadErrorKind::Invalid,
                    _ => ReadErrorKind::Unsized,
                };
                return Err(ReadError::new(refusal.to_string()).of_kind(kind));
            }
            if let Some(ended) = ended {
                self.decoder.restart(&mut |_| ());
                return ended;
            }
        }
    }
}
