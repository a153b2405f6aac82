//! Bytes with an end: a byte a cell, then `FF`; or `5B`, the cells with escapes, `5D`.
//!
//! The first two frames of the right length decide which of the two it is. Frames of another length are dropped. Bytes
//! between two `FF` that are cells of a bracketed stream may have the right length, too: where there are signs of that,
//! more frames are waited for.
//! ```text
//! 00 0C 07 03 FF          cells are 0 to 254; FF ends the frame
//! 5B 00 0C 07 03 5D       cells are 0 to 255; 5B, 5C and 5D among them are 5C 01, 5C 00 and 5C 02
//! ```

use crate::formats::stream::event::{StreamCounts, StreamEvent, StreamSink};
use crate::frame::Frame;

/// Ends a frame of the first format; no cell has this value there.
const END: u8 = 0xff;
/// Begins a frame of the second format.
const OPEN: u8 = 0x5b;
/// Ends it.
const CLOSE: u8 = 0x5d;
/// Stands before the number of a byte that would otherwise begin, end or escape.
const ESCAPE: u8 = 0x5c;

/// Frames of the right length that decide the format.
const SURE: usize = 2;
/// Frames between `FF` that decide it against signs of brackets, beyond those between brackets.
const SURE_IN_DOUBT: usize = 4;

/// How frames are parted.
#[derive(Clone, Copy, Debug, PartialEq)]
enum Framing {
    /// By [`END`].
    Ended,
    /// By [`OPEN`] and [`CLOSE`].
    Bracketed,
}

/// Parts bytes into frames of one format.
#[derive(Clone, Debug)]
struct Parts {
    /// The format.
    framing: Framing,
    /// How many cells a frame has.
    cells: usize,
    /// The cells so far.
    values: Vec<u8>,
    /// Inside of a frame.
    inside: bool,
    /// Behind an [`ESCAPE`].
    escaped: bool,
    /// Whether the frame has more cells or an unknown escape.
    broken: bool,
    /// Frames of another length, counted as soon as the format is known.
    dropped: u64,
}

/// What a byte makes of a frame.
#[derive(PartialEq)]
enum Part {
    /// It goes on, or has not begun.
    More,
    /// It has all of its cells.
    Whole,
    /// It ended with another number of cells, or broken.
    Dropped,
}

impl Parts {
    /// `from_start`: whether the first byte begins a frame. A bracketed one says so itself.
    fn new(framing: Framing, cells: usize, from_start: bool) -> Self {
        Self {
            framing,
            cells,
            values: Vec::new(),
            inside: framing == Framing::Ended && from_start,
            escaped: false,
            broken: false,
            dropped: 0,
        }
    }

    /// Takes the next byte.
    fn byte(&mut self, byte: u8) -> Part {
        match self.framing {
            Framing::Ended if byte == END => {
                let inside = std::mem::replace(&mut self.inside, true);
                self.end(inside)
            }
            Framing::Ended => self.value(byte),
            Framing::Bracketed => self.bracketed(byte),
        }
    }

    /// The same for a frame between brackets. One that is opened again before it was closed is torn.
    fn bracketed(&mut self, byte: u8) -> Part {
        match byte {
            OPEN => {
                // A frame that was not closed.
                let torn = self.inside && !self.values.is_empty();
                self.values.clear();
                (self.inside, self.escaped, self.broken) = (true, false, false);
                if torn { Part::Dropped } else { Part::More }
            }
            CLOSE => {
                self.broken |= self.escaped;
                let inside = std::mem::replace(&mut self.inside, false);
                self.end(inside)
            }
            ESCAPE if self.inside && !self.escaped => {
                self.escaped = true;
                Part::More
            }
            _ if std::mem::take(&mut self.escaped) => match byte {
                0 => self.value(ESCAPE),
                1 => self.value(OPEN),
                2 => self.value(CLOSE),
                _ => {
                    self.broken = true;
                    Part::More
                }
            },
            _ => self.value(byte),
        }
    }

    /// Adds a cell, if the beginning of the frame was seen.
    fn value(&mut self, byte: u8) -> Part {
        if self.inside {
            if self.values.len() < self.cells {
                self.values.push(byte);
            } else {
                self.broken = true;
            }
        }
        Part::More
    }

    /// Whether a frame between [`END`] looks as if the stream had brackets: it has another length, or the end of a
    /// bracketed frame and the beginning of the next inside.
    fn is_doubtful(&self, part: &Part) -> bool {
        let brackets = || self.values.windows(2).any(|pair| pair == [CLOSE, OPEN]);
        self.framing == Framing::Ended && (*part == Part::Dropped || brackets())
    }

    /// The values stay until the next byte.
    fn end(&mut self, inside: bool) -> Part {
        let whole = !std::mem::take(&mut self.broken) && self.values.len() == self.cells;
        let is_empty = self.values.is_empty();
        match (inside, whole) {
            (true, true) => Part::Whole,
            (true, false) if !is_empty => Part::Dropped,
            _ => Part::More,
        }
    }
}

/// A decoder of frames with an end.
#[derive(Clone, Debug)]
pub(super) struct MatsenseDecoder {
    /// Those that it may still be.
    candidates: Vec<(Parts, Vec<Vec<u8>>)>,
    /// Whether a frame of the first format looked like parts of bracketed ones.
    doubted: bool,
    /// The frame that is given.
    frame: Frame,
}

impl MatsenseDecoder {
    /// Either format is still possible.
    pub(super) fn new((rows, columns): (u16, u16), from_start: bool) -> Self {
        let cells = usize::from(rows) * usize::from(columns);
        let of = |framing| (Parts::new(framing, cells, from_start), Vec::new());
        Self {
            candidates: vec![of(Framing::Ended), of(Framing::Bracketed)],
            doubted: false,
            frame: Frame::new(columns, rows),
        }
    }

    /// Decodes bytes.
    pub(super) fn push(
        &mut self,
        bytes: &[u8],
        counts: &mut StreamCounts,
        sink: &mut StreamSink<'_>,
    ) {
        for &byte in bytes {
            let undecided = self.candidates.len() > 1;
            for (parts, waiting) in &mut self.candidates {
                let part = parts.byte(byte);
                if part == Part::More {
                    continue;
                }
                self.doubted |= undecided && parts.is_doubtful(&part);
                if undecided && part == Part::Whole {
                    waiting.push(parts.values.clone());
                } else if undecided {
                    parts.dropped += u64::from(!waiting.is_empty());
                } else if part == Part::Whole {
                    give(&mut self.frame, &parts.values, counts, sink);
                } else {
                    counts.drop_frames(1, &parts.values);
                }
                parts.values.clear();
            }
            if let Some(index) = self.sure() {
                self.decide(index, counts, sink);
            }
        }
    }

    /// Whether frames of the right length have decided which format it is.
    pub(super) fn is_sure(&self) -> bool {
        self.candidates.len() == 1
    }

    /// Whether there was a frame of the right length.
    pub(super) fn has_frames(&self) -> bool {
        let waiting = |(_, frames): &(Parts, Vec<Vec<u8>>)| !frames.is_empty();
        self.is_sure() || self.candidates.iter().any(waiting)
    }

    /// The candidate that has frames enough; None before, and once it is decided.
    fn sure(&self) -> Option<usize> {
        let [(_, ended), (_, bracketed)] = self.candidates.as_slice() else {
            return None;
        };
        let enough = if self.doubted {
            SURE_IN_DOUBT + bracketed.len()
        } else {
            SURE
        };
        if bracketed.len() >= SURE {
            return Some(1);
        }
        (ended.len() >= enough).then_some(0)
    }

    /// Gives the frames that were waiting for the decision, and forgets the other format.
    fn decide(&mut self, index: usize, counts: &mut StreamCounts, sink: &mut StreamSink<'_>) {
        let (parts, waiting) = self.candidates.swap_remove(index);
        if parts.dropped > 0 {
            counts.drop_frames(parts.dropped, b"");
        }
        for values in waiting {
            give(&mut self.frame, &values, counts, sink);
        }
        self.candidates = vec![(parts, Vec::new())];
    }

    /// The end of the input: of a single frame the format is that in which it has the right length.
    pub(super) fn finish(&mut self, counts: &mut StreamCounts, sink: &mut StreamSink<'_>) {
        if let [(_, ended), (_, bracketed)] = self.candidates.as_slice() {
            let brackets = !bracketed.is_empty() && (self.doubted || ended.is_empty());
            self.decide(usize::from(brackets), counts, sink);
        }
        for (parts, _) in &mut self.candidates {
            if parts.inside && !parts.values.is_empty() {
                counts.drop_frames(1, &parts.values);
                parts.values.clear();
            }
        }
    }
}

/// Gives the values as the next frame.
fn give(frame: &mut Frame, values: &[u8], counts: &mut StreamCounts, sink: &mut StreamSink<'_>) {
    for (slot, &value) in frame.values_mut().iter_mut().zip(values) {
        *slot = f64::from(value);
    }
    frame.number = counts.frames;
    counts.frames += 1;
    sink(StreamEvent::Frame(frame));
}

#[cfg(test)]
mod tests {
    use super::*;

    /// The frames of bytes, and how many were dropped.
    fn decoded(bytes: &[u8], shape: (u16, u16), from_start: bool) -> (Vec<Vec<f64>>, u64) {
        let mut decoder = MatsenseDecoder::new(shape, from_start);
        let (mut frames, mut counts) = (Vec::new(), StreamCounts::default());
        let mut sink = |event: StreamEvent<'_>| {
            if let StreamEvent::Frame(frame) = event {
                frames.push(frame.values().to_vec());
            }
        };
        decoder.push(bytes, &mut counts, &mut sink);
        decoder.finish(&mut counts, &mut sink);
        (frames, counts.dropped)
    }

    #[test]
    fn bright_cells_between_brackets_end_no_frame() {
        // Two neighbours of 255; and two of 255 that are a frame apart by their escapes.
        let neighbours: &[u8] = b"\x5b\x01\x02\x03\x04\xff\xff\x05\x06\x07\x5d";
        let escapes: &[u8] = b"\x5b\xff\x02\x5c\x00\x04\x05\x5c\x01\x06\x07\xff\x5d";
        let wanted = [
            [1, 2, 3, 4, 255, 255, 5, 6, 7],
            [255, 2, 0x5c, 4, 5, 0x5b, 6, 7, 255],
        ];
        for (frame, wanted) in [neighbours, escapes].into_iter().zip(wanted) {
            let wanted = wanted.map(f64::from).to_vec();
            let stream = frame.repeat(20);
            for joined in 0..frame.len() {
                let (frames, _) = decoded(&stream[joined..], (3, 3), joined == 0);
                let whole = 20 - usize::from(joined > 0);
                assert_eq!(frames, vec![wanted.clone(); whole], "{joined}");
            }
        }
    }

    #[test]
    fn cells_that_look_like_brackets_are_cells_of_ended_frames() {
        // The same in all frames, and in one of them only.
        let always = b"\x01\x5d\x5b\x04\xff".repeat(9);
        assert_eq!(decoded(&always, (2, 2), true).0.len(), 9);
        let once = b"\x01\x5b\x03\x04\xff\x01\x5d\x03\x04\xff";
        assert_eq!(decoded(once, (2, 2), true).0.len(), 2);
        let one = b"\x01\x5b\x03\x04\xff\x01\x5d";
        let wanted = vec![vec![1.0, 91.0, 3.0, 4.0]];
        assert_eq!(decoded(one, (2, 2), true), (wanted, 1));
        // A damaged frame among them is dropped, wherever it is.
        for at in 0..9 {
            let mut stream = always.clone();
            stream.remove(at * 5);
            let (frames, _) = decoded(&stream, (2, 2), true);
            assert_eq!(frames.len(), 8, "{at}");
        }
    }

    #[test]
    fn an_escape_of_nothing_damages_its_frame() {
        let (whole, damaged) = (b"\x5b\x01\x02\x03\x04\x5d", b"\x5b\x01\x02\x03\x04\x5c\x5d");
        let stream = [&whole[..], damaged, whole, whole, whole].concat();
        let wanted = vec![vec![1.0, 2.0, 3.0, 4.0]; 4];
        assert_eq!(decoded(&stream, (2, 2), true), (wanted, 1));
    }
}
