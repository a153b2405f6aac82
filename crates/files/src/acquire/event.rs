//! The options of an acquisition, its reports, and its errors.

use std::io;
use std::ops::{ControlFlow, RangeInclusive};
use std::time::Duration;

use taxel_core::frame::{Frame, FrameSize};

use crate::acquire::followed_file::ReadAnew;
use crate::error::ReadError;
use crate::formats::file::system_reason;
use crate::formats::recording::{ChannelInfo, Column, RecordingFormat, RecordingNote, TimeColumn};
use crate::formats::stream::{Silence, StreamCounts, StreamFormat, StreamOptions};
use crate::formats::value::decimal;

/// The options of an acquisition: how a source is read.
#[derive(Clone, Debug, PartialEq)]
pub struct AcquireOptions {
    /// The format of a stream; None to detect it. If it is given, a file is a stream, not a recording.
    pub format: Option<StreamFormat>,
    /// The format of streams only, if `format` is not given; a file that is a recording is still played as one.
    pub stream_format: Option<StreamFormat>,
    /// The size of frames of streams, and of recordings that do not state it.
    pub size: Option<FrameSize>,
    /// The size of frames of streams only, if `size` is not given; recordings state their own.
    pub stream_size: Option<FrameSize>,
    /// The column of a table with the time.
    pub time_column: Option<TimeColumn>,
    /// The column of a table with the label.
    pub label_column: Option<Column>,
    /// The channel of a recording whose frames are played at its rate; by default the first one. Frames of other
    /// channels are reported at once.
    pub channel: Option<String>,
    /// Bits per second of a serial line; by default 115,200. The program allows 50 to 20,000,000. A line whose driver
    /// refuses the number is not opened.
    pub baud: u32,
    /// Whether taxel tries again each second to open a connection or a serial line that it cannot open at first. One
    /// that was open before is tried again in any case, except with [`Playback::Once`].
    pub waits: bool,
    /// The speed at which the source is read, and what happens at its end.
    pub playback: Playback,
}

/// The speed at which a source is read, and what happens at its end.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub enum Playback {
    /// The source is read as it comes. A recording is played at its own rate, and followed if it grows meanwhile.
    #[default]
    Live,
    /// The source is read to its end as fast as possible. A connection or a serial line ends when the other end closes
    /// it; with other values, it is then opened again.
    Once,
    /// A recording is played at another speed, or repeated without end. A stream is read as it comes.
    Paced {
        /// The speed, relative to the rate of the recording. A speed that is not above 0 counts as 1; at an infinite
        /// speed, frames follow each other without waiting.
        speed: f64,
        /// Whether the recording begins again at its end.
        repeat: bool,
    },
}

impl AcquireOptions {
    /// The allowed bits per second of a serial line.
    pub const BAUDS: RangeInclusive<u32> = 50..=20_000_000;

    /// The options for decoding a stream; `from_start` says whether its first byte begins a frame.
    pub(super) fn for_stream(&self, from_start: bool) -> StreamOptions {
        StreamOptions {
            format: self.format.or(self.stream_format),
            size: self.size.or(self.stream_size),
            from_start,
        }
    }
}

impl Playback {
    /// The allowed speeds, in words for messages.
    pub const SPEEDS: &'static str = "a number above 0, up to 1000000";

    /// Whether a recording may be played at this speed; see [`Self::SPEEDS`].
    pub fn allows(speed: f64) -> bool {
        speed > 0.0 && speed <= 1e6
    }
}

impl Playback {
    /// Returns [`Self::Paced`] with this speed and repetition, or [`Self::Live`] for the speed 1 without repetition.
    pub fn paced(speed: f64, repeat: bool) -> Self {
        if repeat || speed != 1.0 {
            Self::Paced { speed, repeat }
        } else {
            Self::Live
        }
    }

    /// Whether a recording begins again at its end.
    pub fn repeats(self) -> bool {
        matches!(self, Self::Paced { repeat: true, .. })
    }
}

impl Default for AcquireOptions {
    fn default() -> Self {
        Self {
            format: None,
            size: None,
            stream_format: None,
            stream_size: None,
            time_column: None,
            label_column: None,
            channel: None,
            baud: 115_200,
            waits: false,
            playback: Playback::Live,
        }
    }
}

/// A function that takes the reports of an acquisition; `Break` ends it without an error.
pub type AcquireSink<'a> = dyn FnMut(AcquireEvent<'_>) -> ControlFlow<()> + 'a;

/// A report of an acquisition.
#[derive(Clone, Copy, Debug)]
pub enum AcquireEvent<'a> {
    /// A channel of a recording, or of a stream that names channels, before its first frame.
    Channel(&'a ChannelInfo),
    /// A complete frame.
    Frame {
        /// The frame.
        frame: &'a Frame,
        /// The time in seconds: the frame's own, or that of its arrival since the first frame that arrived. None for a
        /// frame without a time of its own that was in a file already, or may have been: standard input or a FIFO that
        /// is read with [`Playback::Once`] may hold one. After a gap, the time keeps growing, even if the source's own
        /// clock restarted; if a recording is repeated, times begin again.
        time: Option<f64>,
    },
    /// A provisional frame: it is shown but not kept until later data confirms it.
    Provisional(&'a Frame),
    /// The provisional frame was invalid.
    Withdrawn,
    /// An oddity of a recording or a stream.
    Note(&'a RecordingNote),
    /// The counts so far. Reported about ten times a second, with or without frames, unless a source is read as fast
    /// as possible.
    Tick(&'a StreamCounts),
    /// There was no frame for at least two seconds, and for three times as long as the source took for the last one
    /// (but a minute is enough). Reported once until the next frame, and again if bytes begin to arrive.
    Silent(Silence<'a>),
    /// The source cannot be opened yet; opening it is tried again each second.
    Absent(&'a io::Error),
    /// The source is lost; opening it is tried again each second.
    Lost(&'a io::Error),
    /// The source is open, after [`Self::Absent`] or [`Self::Lost`].
    Back {
        /// The time spent waiting for it.
        gap: Duration,
    },
    /// A recording begins again.
    Again,
    /// The end of a recording that has grown is reached: from now on frames arrive as they are written. Reported once.
    Follows,
    /// Reading a growing file starts again at its beginning.
    Anew(ReadAnew),
    /// The end of a stream, with its counts.
    Ended(&'a StreamCounts),
}

impl AcquireEvent<'_> {
    /// The words for [`Self::Lost`].
    pub fn lost(error: &io::Error) -> String {
        format!("lost: {}; trying again each second", system_reason(error))
    }

    /// The words for [`Self::Back`].
    pub fn back_after(gap: Duration) -> String {
        format!("back after {} s", decimal(gap.as_secs_f64(), 1))
    }
}

/// The error that ended an acquisition.
#[derive(Debug, thiserror::Error)]
pub enum AcquireError {
    /// The source cannot be opened, or read on.
    #[error("cannot {doing}: {}", system_reason(error))]
    Io {
        /// The operation, in words that follow "cannot".
        doing: &'static str,
        /// The error that the system reports.
        error: io::Error,
    },
    /// The recording is damaged.
    #[error(transparent)]
    Recording(#[from] ReadError),
    /// The source of a stream begins like a recording that only a file can be.
    #[error("a recording ({}), not a stream", format.name())]
    NotStream {
        /// The format of the recording.
        format: RecordingFormat,
    },
}

impl AcquireError {
    pub(super) fn opening(error: io::Error) -> Self {
        let doing = "open";
        Self::Io { doing, error }
    }

    pub(super) fn reading(error: io::Error) -> Self {
        let doing = "read";
        Self::Io { doing, error }
    }
}
