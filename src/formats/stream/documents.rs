//! Messages in text: a JSON object a line, and what `ros2 topic echo` prints.

use crate::formats::recording::json_lines::FrameLine;
use crate::formats::recording::ros_text::{self, RosLine, RosMessage};
use crate::formats::stream::event::{StreamCounts, StreamEvent, StreamSink};
use crate::frame::Frame;

/// A decoder of JSON lines.
#[derive(Debug)]
pub(super) struct JsonDecoder {
    line: FrameLine,
    start: Option<f64>,
    frame: Frame,
}

impl JsonDecoder {
    pub(super) fn new(shape: Option<(u16, u16)>) -> Self {
        Self {
            line: FrameLine::new(shape),
            start: None,
            frame: Frame::new(1, 1),
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
        match self.line.read(line) {
            Ok(()) => {
                let (rows, columns) = self.line.shape;
                self.frame.reset(columns, rows);
                self.frame.values_mut().copy_from_slice(&self.line.values);
                self.frame.number = counts.frames;
                self.frame.label = self.line.label;
                let time = self.line.time;
                self.frame.time = time.map(|time| time - *self.start.get_or_insert(time));
                counts.frames += 1;
                sink(StreamEvent::Frame(&self.frame));
            }
            Err(error) => {
                counts.unshaped = counts.unshaped.or(error.unshaped());
                counts.drop_frames(1, line);
            }
        }
    }
}

/// A decoder of what `ros2 topic echo` prints.
#[derive(Debug)]
pub(super) struct RosDecoder {
    shape: Option<(u16, u16)>,
    message: RosMessage,
    begun: bool,
    broken: bool,
    frame: Frame,
}

impl RosDecoder {
    pub(super) fn new(shape: Option<(u16, u16)>, from_start: bool) -> Self {
        Self {
            shape,
            message: RosMessage::default(),
            begun: from_start,
            broken: false,
            frame: Frame::new(1, 1),
        }
    }

    /// Decodes a line.
    pub(super) fn line(
        &mut self,
        line: &[u8],
        counts: &mut StreamCounts,
        sink: &mut StreamSink<'_>,
    ) {
        // A boundary, or a line that has a whole array.
        let trimmed = line.trim_ascii();
        let begins = trimmed.starts_with(b"array(") || ros_text::is_layout(trimmed);
        self.begun |= begins;
        match self.message.line(line) {
            RosLine::More => {}
            RosLine::Cut => {
                counts.cut = true;
                self.broken = true;
            }
            RosLine::Wrong(_) => self.broken = true,
            RosLine::Whole => self.end(line, counts, sink),
        }
        self.begun |= trimmed == b"---";
    }

    /// The end of a message.
    fn end(&mut self, line: &[u8], counts: &mut StreamCounts, sink: &mut StreamSink<'_>) {
        let shape = self.message.shape().or(self.shape);
        let values = self.message.values.len();
        let begun = std::mem::replace(&mut self.begun, true);
        let fits =
            |(rows, columns): &(u16, u16)| usize::from(*rows) * usize::from(*columns) == values;
        match shape.filter(fits) {
            _ if !begun => {}
            Some((rows, columns)) if !self.broken => {
                self.frame.reset(columns, rows);
                self.frame
                    .values_mut()
                    .copy_from_slice(&self.message.values);
                self.frame.number = counts.frames;
                counts.frames += 1;
                sink(StreamEvent::Frame(&self.frame));
            }
            _ => {
                if shape.is_none() && !self.broken {
                    counts.unshaped = Some(values as u64);
                }
                counts.drop_frames(1, line);
            }
        }
        self.broken = false;
        self.message.clear();
    }

    /// The end of the input: an array that is closed is whole.
    pub(super) fn finish(&mut self, counts: &mut StreamCounts, sink: &mut StreamSink<'_>) {
        if self.message.begun() {
            self.broken |= self.message.is_open();
            self.end(b"", counts, sink);
        }
    }
}
