//! Decodes frames of `AA 55` and then a byte per cell, without a checksum: these two bytes also occur inside frames.
//!
//! So a frame counts only once the marker after it has arrived, or if the input ends exactly with its last byte. If a
//! marker is not in its expected place, the nearest marker that the next one confirms is used. Using the first such
//! marker instead would read frames from their middle. If a stream is joined late, two neighbouring cells may be `AA
//! 55` in every frame: at worst they are taken for the marker until one of them changes.
//! ```text
//! AA 55  00 0C 07 03  AA 55  00 0D …        2 rows of 2 columns, 0 to 255
//! ```
//! Frames have no number and no time; rows and columns must be known. A frame is shown as provisional as soon as its
//! last byte has arrived, so that the live page does not lag a frame behind; it is confirmed or withdrawn by the
//! bytes after it.

use crate::formats::stream::event::StreamEvent;
use crate::formats::stream::output::StreamOutput;
use crate::frame::{Frame, FrameSize};

/// The bytes before each frame.
pub(in crate::formats) const MARKER: [u8; 2] = [0xaa, 0x55];

/// A decoder of frames after markers.
#[derive(Debug)]
pub(super) struct FlexitacDecoder {
    /// The size of a frame.
    size: FrameSize,
    /// The bytes that are not decoded yet: at most a few frames.
    bytes: Vec<u8>,
    /// The place in the stream where these bytes begin.
    start: Start,
    /// The frame that is reported.
    frame: Frame,
}

/// The place where the bytes that are not decoded yet begin.
#[derive(Clone, Copy, Debug, PartialEq)]
enum Start {
    /// Somewhere in a frame.
    Anywhere,
    /// The first byte of the stream. A marker there cannot be the content of cells.
    Stream,
    /// A marker.
    Marker {
        /// Whether the frame after it has been shown already.
        shown: bool,
    },
}

impl FlexitacDecoder {
    /// Creates a decoder for frames of this size. If `from_start` is true, the first byte begins a frame.
    pub(super) fn new(size: FrameSize, from_start: bool) -> Self {
        Self {
            size,
            bytes: Vec::new(),
            start: if from_start {
                Start::Stream
            } else {
                Start::Anywhere
            },
            frame: Frame::new(size),
        }
    }

    /// Returns the number of bytes from one marker to the next.
    fn period(&self) -> usize {
        MARKER.len() + self.size.cells()
    }

    /// Returns true if there is a marker at this position.
    fn has_marker(&self, at: usize) -> bool {
        self.bytes.get(at..at + MARKER.len()) == Some(&MARKER[..])
    }

    /// Decodes bytes.
    pub(super) fn push(&mut self, bytes: &[u8], output: &mut StreamOutput<'_, '_>) {
        // Take one piece at a time, so that the buffer stays small however many bytes arrive at once.
        for piece in bytes.chunks(self.period()) {
            self.bytes.extend_from_slice(piece);
            while self.step(false, output) {}
        }
    }

    /// Ends the input.
    pub(super) fn finish(&mut self, output: &mut StreamOutput<'_, '_>) {
        while self.step(true, output) {}
        if !self.bytes.is_empty() {
            self.withdraw(output);
            if matches!(self.start, Start::Marker { .. }) || output.counts.frames > 0 {
                output.lose(1, &self.bytes, None);
            }
            self.bytes.clear();
        }
    }

    /// Takes one frame, or drops invalid bytes; returns false if more bytes are needed.
    fn step(&mut self, ended: bool, output: &mut StreamOutput<'_, '_>) -> bool {
        let period = self.period();
        if self.start == Start::Stream && self.bytes.len() >= MARKER.len() {
            self.start = if self.has_marker(0) {
                Start::Marker { shown: false }
            } else {
                Start::Anywhere
            };
        }
        if let Start::Marker { shown } = self.start {
            let whole = self.bytes.len() == period;
            if self.has_marker(period) || whole && ended {
                self.fill();
                self.bytes.drain(..period);
                self.start = if ended && self.bytes.is_empty() {
                    Start::Anywhere
                } else {
                    Start::Marker { shown: false }
                };
                output.frame(&mut self.frame);
                return true;
            }
            let waits = whole || self.bytes.len() == period + 1 && self.bytes[period] == MARKER[0];
            if !ended && (waits || self.bytes.len() < period) {
                if whole && !shown {
                    self.fill();
                    self.start = Start::Marker { shown: true };
                    output.provisional(&mut self.frame);
                }
                return false;
            }
            self.withdraw(output);
        }
        self.search(ended, output)
    }

    /// Withdraws a frame that was shown and is invalid.
    fn withdraw(&mut self, output: &mut StreamOutput<'_, '_>) {
        if let Start::Marker { shown } = &mut self.start
            && std::mem::take(shown)
        {
            output.report(StreamEvent::Withdrawn);
        }
    }

    /// Searches for the marker nearest to its expected place that the next one confirms; returns false if more bytes
    /// are needed.
    fn search(&mut self, ended: bool, output: &mut StreamOutput<'_, '_>) -> bool {
        let period = self.period();
        let in_step = matches!(self.start, Start::Marker { .. });
        let due = if in_step { period } else { 0 };
        let reach = due + period;
        // The last position examined is confirmed within these bytes.
        let needed = reach + period + MARKER.len();
        // No marker is nearer than one in the expected place.
        let in_place = self.has_marker(due) && self.has_marker(due + period);
        if self.bytes.len() < needed && !ended && !in_place {
            return false;
        }
        let length = self.bytes.len();
        let first = usize::from(in_step);
        let confirmed = (first..=reach.min(length)).filter(|&at| {
            let next = at + period;
            self.has_marker(at) && (self.has_marker(next) || ended && next == length)
        });
        let mut nearest = confirmed.min_by_key(|at| at.abs_diff(due));
        // If a frame lacks more than half of its bytes, the marker after the next frame is nearer.
        while let Some(at) = nearest
            && at >= first + period
            && self.has_marker(at - period)
        {
            nearest = Some(at - period);
        }
        let (gone, found) = match nearest {
            Some(at) => (at, true),
            None if ended => return false,
            // Without a marker, drop everything that was examined.
            None => (reach.min(length), false),
        };
        if in_step {
            let frames = (gone + period / 2) / period;
            output.lose(frames.max(1) as u64, &self.bytes, None);
        } else if !found && output.counts.frames > 0 {
            output.lose(1, &self.bytes, None);
        }
        self.bytes.drain(..gone);
        self.start = if found {
            Start::Marker { shown: false }
        } else {
            Start::Anywhere
        };
        true
    }

    /// Copies the cells after the marker into the frame.
    fn fill(&mut self) {
        let values = &self.bytes[MARKER.len()..];
        for (slot, &byte) in self.frame.values_mut().iter_mut().zip(values) {
            *slot = f64::from(byte);
        }
    }
}
