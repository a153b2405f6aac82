//! Decodes messages in text: JSON lines, and the output of `ros2 topic echo`.
//!
//! Unlike a recording, a stream continues after a line or a message that is wrong, or of another size than earlier
//! ones: it is dropped and counted.

use crate::formats::recording::ChannelInfo;
use crate::formats::recording::MOST_CHANNELS;
use crate::formats::recording::json::clock::JsonClock;
use crate::formats::recording::json::lines::FrameLine;
use crate::formats::recording::ros::echo::{self, RosLine, RosMessage};
use crate::formats::recording::side::arranged;
use crate::formats::recording::stream_size::StreamSize;
use crate::formats::recording::time::frame_clock::FrameClock;
use crate::formats::stream::event::{StreamCounts, StreamEvent, StreamSink};
use crate::frame::{Frame, FrameSize};

/// The channels of a stream of JSON lines. After a gap they pass to the next decoder.
#[derive(Debug, Default)]
pub(super) struct JsonChannels {
    channels: Vec<JsonChannel>,
    /// The clock that reads the times of lines.
    pub(super) clock: JsonClock,
    /// Whether the channels have been reported, which happens as soon as one has a name.
    reported: bool,
}

/// One of several sensors.
#[derive(Debug)]
struct JsonChannel {
    /// The channel as its first frame described it.
    info: ChannelInfo,
    /// The rows and columns of its frames.
    size: StreamSize,
    /// The number of its frames.
    frames: u64,
}

impl JsonChannels {
    /// Returns the index of a line's channel, adding and reporting it if it is new; None if there are too many.
    fn of(
        &mut self,
        line: &FrameLine,
        named: Option<FrameSize>,
        sink: &mut StreamSink<'_>,
    ) -> Option<usize> {
        let mut channels = self.channels.iter();
        let known = channels.position(|channel| channel.info.name == line.channel);
        if known.is_some() {
            return known;
        }
        if self.channels.len() == MOST_CHANNELS {
            return None;
        }
        self.channels.push(JsonChannel {
            info: line.channel_info(),
            size: StreamSize::new(named),
            frames: 0,
        });
        let index = self.channels.len() - 1;
        let first = if self.reported { index } else { 0 };
        self.reported |= line.channel.is_some();
        if self.reported {
            for channel in &self.channels[first..] {
                sink(StreamEvent::Channel(&channel.info));
            }
        }
        Some(index)
    }
}

/// A decoder of JSON lines.
#[derive(Debug)]
pub(super) struct JsonDecoder {
    /// The line that was read last.
    line: FrameLine,
    /// The size of all frames, if it was given.
    named: Option<FrameSize>,
    /// The channels so far.
    pub(super) channels: JsonChannels,
    /// The frame made of the line.
    frame: Frame,
}

impl JsonDecoder {
    /// Prepares for a stream; `named` is the size of a frame, if it was given.
    pub(super) fn new(
        named: Option<FrameSize>,
        mut channels: JsonChannels,
        clock: FrameClock,
    ) -> Self {
        channels.clock.clock = clock;
        // The sensors may have been reconfigured.
        for channel in &mut channels.channels {
            channel.size = StreamSize::new(named);
        }
        Self {
            line: FrameLine::new(named),
            named,
            channels,
            frame: Frame::default(),
        }
    }

    /// Decodes a line.
    pub(super) fn line(
        &mut self,
        line: &[u8],
        counts: &mut StreamCounts,
        sink: &mut StreamSink<'_>,
    ) {
        if line.trim_ascii().is_empty() {
            return;
        }
        if let Err(error) = self.line.read(line, &mut self.channels.clock) {
            for channel in &mut self.channels.channels {
                channel.size.pass_torn();
            }
            counts.unshaped = counts.unshaped.or(error.unshaped());
            counts.drop_frames(1, line);
            counts.reason = error.reason();
            return;
        }
        let Some(index) = self.channels.of(&self.line, self.named, sink) else {
            counts.drop_frames(1, line);
            counts.reason = Some(format!("more than {MOST_CHANNELS} channels"));
            return;
        };
        let channel = &mut self.channels.channels[index];
        if !channel.size.admits(self.line.size) {
            counts.drop_frames(1, line);
            return;
        }
        self.frame.reset(self.line.size);
        self.frame.values_mut().copy_from_slice(&self.line.values);
        self.frame.channel = index;
        self.frame.number = channel.frames;
        self.frame.label = self.line.label;
        let time = self.line.time;
        let clock = &mut self.channels.clock.clock;
        self.frame.time = time.map(|time| clock.since_first(time));
        if let Some(note) = clock.take_note() {
            sink(StreamEvent::Note(&note));
        }
        channel.frames += 1;
        counts.frames += 1;
        sink(StreamEvent::Frame(&self.frame));
    }
}

/// A decoder of `ros2 topic echo` output.
#[derive(Debug)]
pub(super) struct RosDecoder {
    /// The given rows and columns, for messages that do not have them.
    named: Option<FrameSize>,
    /// The rows and columns of all frames.
    size: StreamSize,
    /// The message so far.
    message: RosMessage,
    /// Whether the start of the message was seen; a stream may be joined in the middle of one.
    begun: bool,
    /// Whether anything in the message is wrong.
    broken: bool,
    /// Whether values are left out of the message.
    cut: bool,
    /// The frame made of the message.
    frame: Frame,
}

impl RosDecoder {
    pub(super) fn new(named: Option<FrameSize>, from_start: bool) -> Self {
        Self {
            named,
            // Messages that give their size may have another one than the given size.
            size: StreamSize::new(None),
            message: RosMessage::default(),
            begun: from_start,
            broken: false,
            cut: false,
            frame: Frame::default(),
        }
    }

    /// Decodes a line.
    pub(super) fn line(
        &mut self,
        line: &[u8],
        counts: &mut StreamCounts,
        sink: &mut StreamSink<'_>,
    ) {
        // A boundary, or a line with a whole array, begins a message.
        let trimmed = line.trim_ascii();
        let begins = trimmed.starts_with(b"array(")
            || echo::is_csv(trimmed)
            || echo::is_csv_without_dimensions(trimmed) && !self.message.is_open();
        self.begun |= begins;
        match self.message.line(line) {
            RosLine::More => {}
            RosLine::Cut => {
                self.cut = true;
                // A message of a single line has no other end.
                if echo::is_csv(trimmed) {
                    self.end(line, counts, sink);
                }
            }
            RosLine::Wrong(_) => self.broken = true,
            RosLine::Whole => self.end(line, counts, sink),
        }
        self.begun |= trimmed == b"---";
    }

    /// Ends a message: reports it as a frame, or drops it.
    fn end(&mut self, line: &[u8], counts: &mut StreamCounts, sink: &mut StreamSink<'_>) {
        let values = self.message.cells().len();
        let size = arranged(values, self.message.size(), self.named).or(self.named);
        let begun = std::mem::replace(&mut self.begun, true);
        if std::mem::take(&mut self.cut) {
            counts.cut |= begun && !self.broken;
            self.broken = true;
        }
        match size.filter(|size| size.cells() == values) {
            _ if !begun => {}
            Some(size) if !self.broken && !self.size.admits(size) => {
                counts.drop_frames(1, line);
            }
            Some(size) if !self.broken => {
                self.frame.reset(size);
                self.frame
                    .values_mut()
                    .copy_from_slice(self.message.cells());
                self.frame.number = counts.frames;
                counts.frames += 1;
                sink(StreamEvent::Frame(&self.frame));
            }
            _ => {
                self.size.pass_torn();
                if size.is_none() && !self.broken {
                    counts.unshaped = Some(values as u64);
                }
                counts.drop_frames(1, line);
            }
        }
        self.broken = false;
        self.message.clear();
    }

    /// Ends the input: a message whose array is closed is whole.
    pub(super) fn finish(&mut self, counts: &mut StreamCounts, sink: &mut StreamSink<'_>) {
        if self.message.begun() {
            self.broken |= self.message.is_open() && !self.cut;
            self.end(b"", counts, sink);
        }
    }
}
