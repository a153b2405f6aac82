//! The options of an acquisition, its reports, and the words for what goes wrong.

use std::io;
use std::ops::{ControlFlow, RangeInclusive};
use std::time::Duration;

use taxel_core::frame::{Frame, FrameSize};

use crate::formats::file::system_reason;
use crate::formats::recording::{
    ChannelInfo, Column, Format, ReadOptions, RecordingNote, StreamCounts, TimeColumn,
};
use crate::formats::value::{counted, decimal, grouped};

/// The options of an acquisition: how a source is read.
#[derive(Clone, Debug, Default)]
pub struct AcquireOptions {
    /// The format of a stream; None to detect it. If it is given, a file is a stream, not a recording.
    pub format: Option<&'static Format>,
    /// The format of streams only, if `format` is not given; a file that is a recording is still played as one.
    pub stream_format: Option<&'static Format>,
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
    /// Bits per second of a serial line; by default [`Self::BAUD`]. The program allows 50 to 20,000,000. A line whose driver
    /// refuses the number is not opened.
    pub baud: Option<u32>,
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
    /// The bits per second of a serial line, if nothing else is said.
    pub const BAUD: u32 = 115_200;

    /// The allowed bits per second of a serial line.
    pub const BAUDS: RangeInclusive<u32> = 50..=20_000_000;

    /// The options for reading a recording.
    pub fn of_recording(&self) -> ReadOptions {
        ReadOptions {
            size: self.size,
            time_column: self.time_column.clone(),
            label_column: self.label_column.clone(),
            ..ReadOptions::default()
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

    /// [`Self::Paced`] with this speed and repetition, or [`Self::Live`] for the speed 1 without repetition.
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
        /// is read with [`Playback::Once`] may hold one. If a recording is repeated, times begin again.
        time: Option<f64>,
    },
    /// An oddity of a recording or a stream.
    Note(&'a RecordingNote),
    /// The counts so far. Reported about ten times a second, with or without frames.
    Tick(&'a StreamCounts),
    /// There was no frame for at least two seconds, and for three times as long as the source took for the last one
    /// (but a minute is enough). Reported once until the next frame, and again if bytes begin to arrive.
    Silent {
        /// The counts so far.
        counts: &'a StreamCounts,
        /// The likely reason, in words.
        reason: &'a str,
    },
    /// The source cannot be opened yet; opening it is tried again each second.
    Absent(&'a io::Error),
    /// The source is lost; opening it is tried again each second.
    Lost(&'a io::Error),
    /// The source is open, after [`Self::Absent`] or [`Self::Lost`].
    Back {
        /// The time spent waiting for it.
        gap: Duration,
    },
    /// The end of a recording that has grown is reached: from now on frames arrive as they are written. Reported once.
    Follows,
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

impl StreamCounts {
    /// Why a stream has come to its end without a frame, in words; None if there was one.
    pub fn no_frame(&self) -> Option<String> {
        let last = self.last_dropped().map(|last| format!("; {last}"));
        match (self.frames, self.bytes) {
            (1.., _) => None,
            (_, 0) => Some("the source is empty".to_owned()),
            (_, bytes) => Some(format!(
                "{} but no frame{}",
                counted(bytes, "byte"),
                last.unwrap_or_default()
            )),
        }
    }

    /// Why no frame comes, in words, while this many bytes a second come. A source that `has_baud` may have a wrong one.
    pub(super) fn silence(&self, bytes_per_second: f64, has_baud: bool) -> String {
        if bytes_per_second > 0.0 {
            let guess = if has_baud { "baud, " } else { "" };
            let guess = || format!("{guess}rows, columns or format?");
            let why = self.last_dropped().unwrap_or_else(guess);
            #[expect(
                clippy::cast_possible_truncation,
                clippy::cast_sign_loss,
                reason = "a rate for a message"
            )]
            // Rounded up, so that a byte now and then is not shown as 0.
            let rate = grouped(bytes_per_second.ceil() as u64);
            return format!("{rate} B/s, none of it a frame; {why}");
        }
        let words = match self.bytes {
            0 => "nothing has come yet; is it sending?",
            _ => "the source has gone silent",
        };
        words.to_owned()
    }

    fn last_dropped(&self) -> Option<String> {
        let reason = self.reason.as_ref()?;
        Some(format!("the last one dropped: {reason}"))
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_words_for_a_silence_depend_on_what_came() {
        let mut counts = StreamCounts::default();
        assert_eq!(
            counts.silence(0.0, true),
            "nothing has come yet; is it sending?"
        );
        counts.bytes = 9;
        assert_eq!(counts.silence(0.0, true), "the source has gone silent");
        let said = "8 B/s, none of it a frame; rows, columns or format?";
        assert_eq!(counts.silence(7.5, false), said);
        counts.reason = Some("row 2 has 1 number".to_owned());
        let said = "8 B/s, none of it a frame; the last one dropped: row 2 has 1 number";
        assert_eq!(counts.silence(8.0, true), said);
        let said = "9 bytes but no frame; the last one dropped: row 2 has 1 number";
        assert_eq!(counts.no_frame().as_deref(), Some(said));
    }
}
