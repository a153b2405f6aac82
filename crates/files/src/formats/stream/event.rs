//! The formats and options of streams, and the events and counts that a decoder reports.

use crate::formats::recording::unshaped;
use taxel_core::frame::{Frame, FrameSize};
use taxel_core::parameter::named;

use crate::formats::recording::{ChannelInfo, RecordingNote};
use crate::formats::value::{counted, grouped};

/// A format of streams.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash)]
pub enum StreamFormat {
    /// Numbers separated by spaces, tabs, commas or semicolons: one frame per line, or one row per line and an empty
    /// line between frames.
    Lines,
    /// JSON lines: one object per line, as in recordings.
    JsonLines,
    /// The output of `ros2 topic echo`.
    Ros2,
    /// `AA 55`, then a byte per cell.
    Flexitac,
    /// A byte per cell, then `FF`; or `5B`, the bytes with escapes, `5D`.
    Matsense,
}

impl StreamFormat {
    /// All formats.
    pub const ALL: &'static [Self] = &[
        Self::Lines,
        Self::JsonLines,
        Self::Ros2,
        Self::Flexitac,
        Self::Matsense,
    ];

    /// Returns the name in flags and files.
    pub fn name(self) -> &'static str {
        match self {
            Self::Lines => "lines",
            Self::JsonLines => "jsonl",
            Self::Ros2 => "ros2",
            Self::Flexitac => "flexitac",
            Self::Matsense => "matsense",
        }
    }
}

named!(StreamFormat, "format", StreamFormat::ALL);

/// Options for decoding a stream.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Hash)]
pub struct StreamOptions {
    /// The format; detected from the bytes if it is None.
    pub format: Option<StreamFormat>,
    /// The rows and columns of a frame; bytes, and frames of one line each, do not give them.
    pub size: Option<FrameSize>,
    /// Whether the first byte begins a frame: true for a file, false for a serial line that was joined somewhere.
    pub from_start: bool,
}

impl StreamOptions {
    /// Sets the format.
    #[must_use]
    pub fn with_format(mut self, format: StreamFormat) -> Self {
        self.format = Some(format);
        self
    }

    /// Sets the rows and columns of a frame.
    #[must_use]
    pub fn with_size(mut self, size: FrameSize) -> Self {
        self.size = Some(size);
        self
    }

    /// Says that the first byte begins a frame.
    #[must_use]
    pub fn from_start(mut self) -> Self {
        self.from_start = true;
        self
    }
}

/// An event that a decoder reports.
#[derive(Clone, Copy, Debug)]
pub enum StreamEvent<'a> {
    /// A channel, before its first frame; only if the stream names channels.
    Channel(&'a ChannelInfo),
    /// A whole frame; if its format needs it, confirmed by the bytes after it.
    Frame(&'a Frame),
    /// A frame whose last byte has arrived, but not the bytes that confirm it: to be shown, not to be kept.
    Provisional(&'a Frame),
    /// The provisional frame has turned out to be invalid.
    Withdrawn,
    /// An oddity that does not stop the decoder.
    Note(&'a RecordingNote),
}

/// Counts of what has arrived so far.
#[derive(Clone, Debug, Default, PartialEq, Eq)]
pub struct StreamCounts {
    /// The number of bytes.
    pub bytes: u64,
    /// The number of whole frames.
    pub frames: u64,
    /// The number of torn, short, long and garbled frames.
    pub dropped: u64,
    /// The beginning of the last dropped frame, up to 40 characters; None if none of its bytes are known.
    pub sample: Option<String>,
    /// The reason why the last dropped frame is invalid, if the format shows it: JSON lines do, and numbers if a row
    /// has too many or too few of them, or if a single value stands above a frame.
    pub reason: Option<String>,
    /// If rows and columns are missing, the number of values that a frame seems to have; 0 if not even that is known.
    pub unshaped: Option<u64>,
    /// Whether `ros2 topic echo` without `--full-length` shortened messages.
    pub cut: bool,
    /// Whether the beginning of the stream does not show its format: text without a line of numbers.
    pub unknown: bool,
}

/// The most characters of a sample.
const SAMPLE: usize = 40;

impl StreamCounts {
    /// Returns what must be given or changed before any frame can be decoded. None if frames have arrived, or may
    /// still arrive.
    pub fn refusal(&self) -> Option<StreamRefusal> {
        if self.frames > 0 {
            return None;
        }
        match self.unshaped {
            Some(0) if self.unknown => Some(StreamRefusal::Unknown),
            Some(0) => Some(StreamRefusal::Size),
            Some(values) => Some(StreamRefusal::Shape { values }),
            None => self.cut.then_some(StreamRefusal::Cut),
        }
    }

    /// Returns the reason why a stream has come to its end without a frame; None if there was one.
    pub fn no_frame_reason(&self) -> Option<NoFrameReason<'_>> {
        if self.frames > 0 {
            return None;
        }
        Some(match self.refusal() {
            _ if self.bytes == 0 => NoFrameReason::Empty,
            Some(refusal) => NoFrameReason::Refused(refusal),
            None if self.unknown => NoFrameReason::Refused(StreamRefusal::Unknown),
            None => NoFrameReason::Undecoded {
                bytes: self.bytes,
                reason: self.reason.as_deref(),
            },
        })
    }

    pub(crate) fn drop_frames(&mut self, frames: u64, bytes: &[u8]) {
        self.dropped += frames;
        self.reason = None;
        let mut sample = String::new();
        for &byte in bytes.iter().take(SAMPLE) {
            let text = match byte {
                b' '..=b'~' => char::from(byte).to_string(),
                b'\t' => " ".to_owned(),
                _ => format!("\\x{byte:02x}"),
            };
            if sample.len() + text.len() > SAMPLE {
                break;
            }
            sample += &text;
        }
        self.sample = Some(sample).filter(|sample| !sample.is_empty());
    }
}

/// The reason why a stream cannot be decoded.
#[derive(Clone, Copy, Debug, PartialEq, Eq, thiserror::Error)]
pub enum StreamRefusal {
    /// Text without a line of numbers.
    #[error(
        "not a stream of a known format: expected lines of numbers, JSON lines, ros2 topic echo, FlexiTac or MatSense"
    )]
    Unknown,
    /// Bytes that may be values, in frames of any size.
    #[error("the stream does not state the rows and columns of a frame")]
    Size,
    /// Lists of values, in rows of any length.
    #[error("{}", unshaped(*values, None))]
    Shape {
        /// The number of values in a frame.
        values: u64,
    },
    /// Messages of `ros2 topic echo` that leave out values.
    #[error("the echo leaves out values ('...'): run ros2 topic echo with --full-length")]
    Cut,
}

impl StreamRefusal {
    /// Returns true if giving rows and columns would help.
    pub fn is_of_size(self) -> bool {
        matches!(self, Self::Size | Self::Shape { .. })
    }
}

/// The reason why a stream has come to its end without a frame.
#[derive(Clone, Copy, Debug, PartialEq, Eq, thiserror::Error)]
pub enum NoFrameReason<'a> {
    /// There was not a single byte.
    #[error("the source is empty")]
    Empty,
    /// Something must be given or changed before any frame can be decoded.
    #[error(transparent)]
    Refused(StreamRefusal),
    /// There were bytes, but none of them a frame; rows, columns or format may be wrong.
    #[error(
        "{} but no frame{}",
        counted(*bytes, "byte"),
        reason.map_or(String::new(), |reason| format!("; the last one dropped: {reason}"))
    )]
    Undecoded {
        /// The number of bytes.
        bytes: u64,
        /// The reason why the last one was dropped, if the format shows it.
        reason: Option<&'a str>,
    },
}

/// A time in which a stream has brought no frame.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Silence<'a> {
    /// The bytes per second that arrived meanwhile.
    pub bytes_per_second: f64,
    /// The counts so far.
    pub counts: &'a StreamCounts,
    /// Whether the source is a file that was moved or removed, so that no file has its name.
    pub has_vanished: bool,
}

impl Silence<'_> {
    /// Returns the reason for it in words. `has_baud` tells whether the source has a baud rate, which may be wrong.
    pub fn reason(&self, has_baud: bool) -> String {
        let reason = self.reason_of_stream(has_baud);
        if self.has_vanished {
            return format!("{reason}; its file was moved or removed");
        }
        reason
    }

    /// Returns the same, without what has become of a file.
    fn reason_of_stream(&self, has_baud: bool) -> String {
        let counts = self.counts;
        if let Some(refusal) = counts.refusal() {
            return refusal.to_string();
        }
        #[expect(
            clippy::cast_possible_truncation,
            clippy::cast_sign_loss,
            reason = "a rate for a message"
        )]
        // Round up, so that a byte now and then is not shown as 0.
        let rate = grouped(self.bytes_per_second.ceil() as u64);
        match (counts.bytes, self.bytes_per_second > 0.0) {
            (_, true) => {
                let why = match (&counts.reason, has_baud) {
                    (Some(reason), _) => &format!("the last one dropped: {reason}"),
                    (None, true) => "baud, rows, columns or format?",
                    (None, false) => "rows, columns or format?",
                };
                format!("{rate} B/s, none of it a frame; {why}")
            }
            (0, _) => "nothing has come yet; is it sending?".to_owned(),
            _ => "the source has gone silent".to_owned(),
        }
    }
}

/// A function that takes the events of a decoder.
pub type StreamSink<'a> = dyn FnMut(StreamEvent<'_>) + 'a;

/// The output of a decoder: frames and other events go to the sink, lost frames are counted.
pub(super) struct StreamOutput<'a, 's> {
    pub(super) counts: &'a mut StreamCounts,
    sink: &'a mut StreamSink<'s>,
}

impl<'a, 's> StreamOutput<'a, 's> {
    pub(super) fn new(counts: &'a mut StreamCounts, sink: &'a mut StreamSink<'s>) -> Self {
        Self { counts, sink }
    }

    pub(super) fn report(&mut self, event: StreamEvent<'_>) {
        (self.sink)(event);
    }

    pub(super) fn frame(&mut self, frame: &mut Frame) {
        frame.number = self.counts.frames;
        self.numbered(frame);
    }

    pub(super) fn numbered(&mut self, frame: &Frame) {
        self.counts.frames += 1;
        self.report(StreamEvent::Frame(frame));
    }

    /// Reports a frame that is to be confirmed or withdrawn. It gets the number of the next frame.
    pub(super) fn provisional(&mut self, frame: &mut Frame) {
        frame.number = self.counts.frames;
        self.report(StreamEvent::Provisional(frame));
    }

    pub(super) fn lose(&mut self, frames: u64, sample: &[u8], reason: Option<String>) {
        self.counts.drop_frames(frames, sample);
        self.counts.reason = reason;
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_refusal_holds_only_until_the_first_frame() {
        let mut counts = StreamCounts {
            bytes: 9,
            cut: true,
            ..StreamCounts::default()
        };
        assert_eq!(counts.refusal(), Some(StreamRefusal::Cut));
        let reason = |counts: &StreamCounts, bytes_per_second, has_baud| {
            let has_vanished = false;
            let silence = Silence {
                bytes_per_second,
                counts,
                has_vanished,
            };
            silence.reason(has_baud)
        };
        assert_eq!(reason(&counts, 0.0, false), StreamRefusal::Cut.to_string());
        counts.frames = 1;
        assert_eq!(counts.refusal(), None);
        assert_eq!(reason(&counts, 0.0, false), "the source has gone silent");
        counts.reason = Some("row 2 has 1 number, expected 2".to_owned());
        let said =
            "8 B/s, none of it a frame; the last one dropped: row 2 has 1 number, expected 2";
        assert_eq!(reason(&counts, 8.0, true), said);
    }
}
