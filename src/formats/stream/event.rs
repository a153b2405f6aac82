//! What a stream may be, what is known of it beforehand, and what its decoder reports.

use crate::formats::recording::{ChannelInfo, RecordingError};
use crate::formats::value::grouped;
use crate::frame::Frame;
use crate::parameter::named;

/// The formats of streams.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash)]
#[non_exhaustive]
pub enum StreamFormat {
    /// Numbers parted by spaces, tabs, commas or semicolons: a frame a line, or a row a line and an empty line between frames.
    Lines,
    /// A JSON object a line, as of recordings.
    JsonLines,
    /// What `ros2 topic echo` prints.
    Ros2,
    /// `AA 55`, then a byte a cell.
    Flexitac,
    /// A byte a cell, then `FF`; or `5B`, the bytes with escapes, `5D`.
    Matsense,
}

impl StreamFormat {
    /// All of them by their names in flags and files.
    pub const NAMES: [(&'static str, Self); 5] = [
        ("lines", Self::Lines),
        ("jsonl", Self::JsonLines),
        ("ros2", Self::Ros2),
        ("flexitac", Self::Flexitac),
        ("matsense", Self::Matsense),
    ];

    /// Its name.
    pub fn name(self) -> &'static str {
        let found = Self::NAMES.iter().find(|(_, own)| *own == self);
        found.map_or("unknown", |(name, _)| name)
    }

    /// The one of that name.
    pub fn from_name(name: &str) -> Option<Self> {
        let found = Self::NAMES.iter().find(|(own, _)| *own == name);
        found.map(|(_, format)| *format)
    }
}

named!(
    StreamFormat,
    "format",
    &StreamFormat::NAMES.map(|(_, format)| format)
);

/// What is known of a stream beforehand.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Hash)]
#[non_exhaustive]
pub struct StreamOptions {
    /// Its format; found by looking where there is none.
    pub format: Option<StreamFormat>,
    /// Rows and columns; bytes and frames of a line each do not say them.
    pub shape: Option<(u16, u16)>,
    /// Whether the first byte begins a frame: of a file, but not of a line that was plugged in somewhere.
    pub from_start: bool,
}

impl StreamOptions {
    /// With a format.
    #[must_use]
    pub fn with_format(mut self, format: StreamFormat) -> Self {
        self.format = Some(format);
        self
    }

    /// With rows and columns.
    #[must_use]
    pub fn with_shape(mut self, rows: u16, columns: u16) -> Self {
        self.shape = Some((rows, columns));
        self
    }

    /// With a first byte that begins a frame.
    #[must_use]
    pub fn from_start(mut self) -> Self {
        self.from_start = true;
        self
    }
}

/// What a decoder reports.
#[derive(Clone, Copy, Debug)]
#[non_exhaustive]
pub enum StreamEvent<'a> {
    /// A channel, before its first frame; only if the stream names channels.
    Channel(&'a ChannelInfo),
    /// A whole frame, confirmed by what follows it where its format needs that.
    Frame(&'a Frame),
    /// A frame whose last byte is here, though what follows it is not: to be shown, not to be kept.
    Provisional(&'a Frame),
    /// The provisional frame was invalid.
    Withdrawn,
}

/// What has come so far.
#[derive(Clone, Debug, Default, PartialEq, Eq)]
#[non_exhaustive]
pub struct StreamCounts {
    /// Bytes.
    pub bytes: u64,
    /// Whole frames.
    pub frames: u64,
    /// Torn, short, long and garbled ones.
    pub dropped: u64,
    /// What the last of these looked like, up to 40 characters; None if nothing of it came.
    pub sample: Option<String>,
    /// Why the last of these is not a frame, where the format can tell: JSON lines, and numbers if rows and columns were named.
    pub reason: Option<String>,
    /// What is missing to decode the stream at all: how many values a frame seems to have, without rows and columns.
    pub unshaped: Option<u64>,
    /// Whether messages were cut by `ros2 topic echo` without `--full-length`.
    pub cut: bool,
    /// Whether nothing at its beginning tells its format: text without a line of numbers.
    pub unknown: bool,
}

/// The most bytes of a sample.
const SAMPLE: usize = 40;

impl StreamCounts {
    /// What has to be stated, or asked for, before any frame can be decoded. None where frames have come, or may come.
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

    /// Why no frame may have come for some time, given the bytes a second that came meanwhile.
    pub fn silence(&self, bytes_per_second: f64) -> String {
        if let Some(refusal) = self.refusal() {
            return refusal.to_string();
        }
        #[expect(
            clippy::cast_possible_truncation,
            clippy::cast_sign_loss,
            reason = "a rate for a message"
        )]
        // A byte now and then is not none.
        let rate = grouped(bytes_per_second.ceil() as u64);
        match (self.bytes, bytes_per_second > 0.0) {
            (_, true) => format!("{rate} B/s, none of it a frame; baud, rows, columns or format?"),
            (0, _) => "nothing has come yet; is it sending?".to_owned(),
            _ => "the source has gone silent".to_owned(),
        }
    }

    /// Counts dropped frames.
    pub(super) fn drop_frames(&mut self, frames: u64, bytes: &[u8]) {
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

/// Why a stream cannot be decoded as it comes.
#[derive(Clone, Copy, Debug, PartialEq, Eq, thiserror::Error)]
#[non_exhaustive]
pub enum StreamRefusal {
    /// Text without a line of numbers.
    #[error(
        "not a stream of a known format: expected lines of numbers, JSON lines, ros2 topic echo, FlexiTac or MatSense; --format \
         names one"
    )]
    Unknown,
    /// Bytes that may be values, in frames of any size.
    #[error(
        "the stream does not state the size of a frame; give --rows and --columns, and --format if it is text"
    )]
    Size,
    /// Lists of values, in rows of any length.
    #[error("{}", RecordingError::Shape { values: *values })]
    Shape {
        /// How many values a frame has.
        values: u64,
    },
    /// `ros2 topic echo` leaves out values.
    #[error("the echo leaves out values ('...'): run ros2 topic echo with --full-length")]
    Cut,
}

impl StreamRefusal {
    /// Whether rows and columns would help.
    pub fn is_of_size(self) -> bool {
        matches!(self, Self::Size | Self::Shape { .. })
    }
}

/// Takes what a decoder reports.
pub type StreamSink<'a> = dyn FnMut(StreamEvent<'_>) + 'a;

#[cfg(test)]
mod tests {
    use super::*;

    /// An echo that left out values once may have been started anew since.
    #[test]
    fn what_was_missing_matters_only_until_a_frame_comes() {
        let mut counts = StreamCounts {
            bytes: 9,
            cut: true,
            ..StreamCounts::default()
        };
        assert_eq!(counts.refusal(), Some(StreamRefusal::Cut));
        assert_eq!(counts.silence(0.0), StreamRefusal::Cut.to_string());
        counts.frames = 1;
        assert_eq!(counts.refusal(), None);
        assert_eq!(counts.silence(0.0), "the source has gone silent");
    }
}
