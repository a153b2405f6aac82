//! The output of a decoder.

use crate::formats::stream::event::{StreamCounts, StreamEvent, StreamSink};
use crate::frame::Frame;

/// The output of a decoder: frames and other events go to the sink, lost frames are counted.
pub(super) struct StreamOutput<'a, 's> {
    /// The counts so far.
    pub(super) counts: &'a mut StreamCounts,
    sink: &'a mut StreamSink<'s>,
}

impl<'a, 's> StreamOutput<'a, 's> {
    pub(super) fn new(counts: &'a mut StreamCounts, sink: &'a mut StreamSink<'s>) -> Self {
        Self { counts, sink }
    }

    /// Reports an event.
    pub(super) fn report(&mut self, event: StreamEvent<'_>) {
        (self.sink)(event);
    }

    /// Reports the next frame, which gets its number.
    pub(super) fn frame(&mut self, frame: &mut Frame) {
        frame.number = self.counts.frames;
        self.numbered(frame);
    }

    /// Reports the next frame, which has its number.
    pub(super) fn numbered(&mut self, frame: &Frame) {
        self.counts.frames += 1;
        self.report(StreamEvent::Frame(frame));
    }

    /// Reports a frame that is to be confirmed or withdrawn. It gets the number of the next frame.
    pub(super) fn provisional(&mut self, frame: &mut Frame) {
        frame.number = self.counts.frames;
        self.report(StreamEvent::Provisional(frame));
    }

    /// Counts lost frames, with a sample and the reason, if it is known.
    pub(super) fn lose(&mut self, frames: u64, sample: &[u8], reason: Option<String>) {
        self.counts.drop_frames(frames, sample);
        self.counts.reason = reason;
    }
}
