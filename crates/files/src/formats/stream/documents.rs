//! Decodes messages in text: JSON lines, and the output of `ros2 topic echo`.
//!
//! Unlike a recording, a stream continues after a line or a message that is wrong, or of another size than earlier
//! ones: it is dropped and counted.

use crate::error::{ReadError, ReadErrorKind};
use taxel_core::frame::{Frame, FrameSize};

use crate::formats::recording::json::{FrameLineError, JsonFrames};
use crate::formats::recording::ros::echo::{self, RosLine, RosMessage};
use crate::formats::recording::size::StreamSize;
use crate::formats::recording::time::FrameClock;
use crate::formats::stream::event::{StreamEvent, StreamOutput, StreamRefusal};

/// A decoder of JSON lines. Its channels and times continue after a gap.
#[derive(Debug)]
pub(super) struct JsonDecoder(JsonFrames);

impl JsonDecoder {
    /// Prepares for a stream; `named` is the size of a frame, if it was given.
    pub(super) fn new(named: Option<FrameSize>) -> Self {
        Self(JsonFrames::new(named))
    }

    /// Prepares for the first line, or the first one after a gap. `clock` is the clock of the source.
    pub(super) fn begin(&mut self, clock: FrameClock) {
        self.0.clock.clock = clock;
        self.0.forget_sizes();
    }

    /// Returns the clock of the source.
    pub(super) fn clock(&self) -> FrameClock {
        self.0.clock.clock
    }

    /// Forgets the key of the time: another file may have another one.
    pub(super) fn forget_key(&mut self) {
        self.0.clock.forget_key();
    }

    pub(super) fn line(&mut self, line: &[u8], output: &mut StreamOutput<'_, '_>) {
        if line.trim_ascii().is_empty() {
            return;
        }
        if let Err(error) = self.0.read(line) {
            let reason = match error {
                FrameLineError::Wrong { message, .. } => Some(message),
                FrameLineError::Shape(values) => {
                    output.counts.unshaped.get_or_insert(values);
                    None
                }
            };
            output.lose(1, line, reason);
            return;
        }
        // A stream has channels as soon as one has a name.
        if self.0.channels.has_names() {
            for info in self.0.channels.take_new() {
                output.report(StreamEvent::Channel(info));
            }
        }
        if let Some(note) = self.0.clock.clock.take_note() {
            output.report(StreamEvent::Note(&note));
        }
        output.numbered(self.0.frame());
    }
}

/// A decoder of `ros2 topic echo` output.
#[derive(Debug)]
pub(super) struct RosDecoder {
    named: Option<FrameSize>,
    size: StreamSize,
    message: RosMessage,
    /// Whether the start of the message was seen; a stream may be joined in the middle of one.
    begun: bool,
    mistake: Option<String>,
    cut: bool,
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
            mistake: None,
            cut: false,
            frame: Frame::default(),
        }
    }

    pub(super) fn line(&mut self, line: &[u8], output: &mut StreamOutput<'_, '_>) {
        // A boundary, or a line with a whole array, begins a message.
        let trimmed = line.trim_ascii();
        self.begun |= trimmed.starts_with(b"array(");
        let state = self.message.line(line);
        match state {
            RosLine::More => {}
            RosLine::Cut => self.cut = true,
            RosLine::Wrong(column) => self.note(state.mistake(), Some(column)),
            RosLine::Unended => self.note(state.mistake(), None),
            RosLine::Whole => self.end(line, output),
        }
        self.begun |= trimmed == b"---";
    }

    /// Keeps the first mistake in the message, and the field in its line, if a single one is wrong.
    fn note(&mut self, mistake: Option<&str>, column: Option<usize>) {
        let text = mistake.map(|text| match column {
            Some(column) => format!("column {column}: {text}"),
            None => text.to_owned(),
        });
        self.mistake = self.mistake.take().or(text);
    }

    /// Ends a message: reports it as a frame, or drops it.
    fn end(&mut self, line: &[u8], output: &mut StreamOutput<'_, '_>) {
        let begun = std::mem::replace(&mut self.begun, true);
        if std::mem::take(&mut self.cut) {
            output.counts.cut |= begun && self.mistake.is_none();
            self.note(Some(&StreamRefusal::Cut.to_string()), None);
        }
        let mistake = self.mistake.take();
        if begun {
            let size = match mistake {
                None => echo::size(&self.message, &mut self.size, self.named, 1),
                Some(mistake) => {
                    self.size.pass_torn();
                    Err(ReadError::new(mistake))
                }
            };
            match size {
                Ok(size) => {
                    self.frame.reset(size);
                    self.frame
                        .values_mut()
                        .copy_from_slice(self.message.cells());
                    output.frame(&mut self.frame);
                }
                Err(error) => {
                    let reason = if error.kind == ReadErrorKind::Unsized {
                        output.counts.unshaped = Some(self.message.cells().len() as u64);
                        None
                    } else {
                        // A stream has no line numbers.
                        Some(error.message)
                    };
                    output.lose(1, line, reason);
                }
            }
        }
        self.message.clear();
    }

    /// Ends the input: a message whose array is closed is whole.
    pub(super) fn finish(&mut self, output: &mut StreamOutput<'_, '_>) {
        if self.message.begun() {
            let is_torn = self.message.is_open() && !self.cut;
            self.note(is_torn.then_some(echo::UNENDED), None);
            self.end(b"", output);
        }
    }
}
