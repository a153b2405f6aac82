//! Decodes frames with an end: a byte per cell, then `FF`; or `5B`, the cells with escapes, `5D`.
//!
//! The first two frames of the right length decide which of the two it is. Frames of another length are dropped. In a
//! bracketed stream, the bytes between two cells of `FF` may have the right length, too: if there are signs of that,
//! more frames are needed to decide.
//! ```text
//! 00 0C 07 03 FF          cells are 0 to 254; FF ends the frame
//! 5B 00 0C 07 03 5D       cells are 0 to 255; 5B, 5C and 5D among them are 5C 01, 5C 00 and 5C 02
//! ```

use crate::formats::stream::output::StreamOutput;
use crate::frame::{Frame, FrameSize};

/// The byte that ends a frame of the first kind, in which no cell has this value.
const END: u8 = 0xff;
/// The byte that begins a frame of the second kind.
const OPEN: u8 = 0x5b;
/// The byte that ends a frame of the second kind.
const CLOSE: u8 = 0x5d;
/// The byte before the number of a cell that would otherwise begin, end or escape.
const ESCAPE: u8 = 0x5c;

/// The number of frames of the right length that decide the kind.
const SURE: usize = 2;
/// If there are signs of brackets, the number of frames between `FF` that decide against them, in addition to the
/// number of frames between brackets.
const SURE_IN_DOUBT: usize = 4;

/// A way to separate frames.
#[derive(Clone, Copy, Debug, PartialEq)]
enum Framing {
    /// Each frame ends in [`END`].
    Ended,
    /// Each frame is between [`OPEN`] and [`CLOSE`].
    Bracketed,
}

/// The position of a byte in the stream.
#[derive(Clone, Copy, Debug, PartialEq)]
enum BytePosition {
    /// At the beginning of a stream, which may be that of a frame; what is there up to the first end of a frame is
    /// dropped if it is no frame.
    AtStart,
    /// Before the first start or end of a frame; what is there is dropped.
    BeforeFrames,
    /// In a frame.
    InFrame,
    /// Behind the end of a bracketed frame, but not in the next one.
    BetweenFrames,
}

/// A splitter of bytes into frames of one kind.
#[derive(Clone, Debug)]
struct Parts {
    /// The kind of frames.
    framing: Framing,
    /// The number of cells in a frame.
    cells: usize,
    /// The cells of the current frame so far, or the bytes since the end of the last one.
    values: Vec<u8>,
    /// The position of the next byte.
    position: BytePosition,
    /// Whether the last byte was an [`ESCAPE`].
    escaped: bool,
    /// Whether the frame has too many cells or an unknown escape.
    broken: bool,
    /// The number of frames of another length, reported once the kind is decided.
    dropped: u64,
}

/// The state of a frame after a byte.
#[derive(PartialEq)]
enum Part {
    /// The frame continues, or has not begun.
    More,
    /// The frame has ended with all its cells.
    Whole,
    /// The frame has ended with another number of cells, or broken.
    Dropped,
}

impl Parts {
    /// Prepares for the first byte. `from_start` says whether it begins a frame; a bracketed frame shows this itself.
    fn new(framing: Framing, cells: usize, from_start: bool) -> Self {
        Self {
            framing,
            cells,
            values: Vec::new(),
            position: if framing == Framing::Ended && from_start {
                BytePosition::AtStart
            } else {
                BytePosition::BeforeFrames
            },
            escaped: false,
            broken: false,
            dropped: 0,
        }
    }

    /// Takes the next byte.
    fn byte(&mut self, byte: u8) -> Part {
        match self.framing {
            Framing::Ended if byte == END => {
                let before = std::mem::replace(&mut self.position, BytePosition::InFrame);
                let part = self.end(before != BytePosition::BeforeFrames);
                if before == BytePosition::AtStart && part == Part::Dropped {
                    self.values.clear();
                    return Part::More;
                }
                part
            }
            Framing::Ended => self.value(byte),
            Framing::Bracketed => self.bracketed(byte),
        }
    }

    /// Takes the next byte of a bracketed stream. A frame is torn if another one opens before it is closed, or if it is
    /// closed but was not opened.
    fn bracketed(&mut self, byte: u8) -> Part {
        match byte {
            OPEN => {
                (self.position, self.escaped) = (BytePosition::InFrame, false);
                // The frame before it was not closed, or not opened.
                self.end(false)
            }
            CLOSE => {
                self.broken |= std::mem::take(&mut self.escaped);
                let before = std::mem::replace(&mut self.position, BytePosition::BetweenFrames);
                self.end(before == BytePosition::InFrame)
            }
            ESCAPE if self.position == BytePosition::InFrame && !self.escaped => {
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

    /// Adds a cell, or a byte between two frames.
    fn value(&mut self, byte: u8) -> Part {
        // A board may end its frames as lines.
        let is_line_end = self.position == BytePosition::BetweenFrames && b"\r\n".contains(&byte);
        if self.position != BytePosition::BeforeFrames && !is_line_end {
            if self.values.len() < self.cells {
                self.values.push(byte);
            } else {
                self.broken = true;
            }
        }
        Part::More
    }

    /// Returns true if a frame that ended in [`END`] is a sign of brackets: it has another length, or contains the
    /// end of a bracketed frame and the start of the next one.
    fn is_doubtful(&self, part: &Part) -> bool {
        let brackets = || self.values.windows(2).any(|pair| pair == [CLOSE, OPEN]);
        self.framing == Framing::Ended && (*part == Part::Dropped || brackets())
    }

    /// Ends a frame, or bytes that are not a frame. Its values stay until the next byte.
    fn end(&mut self, is_frame: bool) -> Part {
        let is_broken = std::mem::take(&mut self.broken);
        if is_frame && !is_broken && self.values.len() == self.cells {
            Part::Whole
        } else if self.values.is_empty() {
            Part::More
        } else {
            Part::Dropped
        }
    }
}

/// A decoder of frames with an end.
#[derive(Clone, Debug)]
pub(super) struct MatsenseDecoder {
    /// The kinds that are still possible, each with its frames so far.
    candidates: Vec<(Parts, Vec<Vec<u8>>)>,
    /// Whether a frame of the first kind looked like parts of bracketed ones.
    doubted: bool,
    /// The frame that is reported.
    frame: Frame,
}

impl MatsenseDecoder {
    /// Prepares for frames of either kind.
    pub(super) fn new(size: FrameSize, from_start: bool) -> Self {
        let of = |framing| (Parts::new(framing, size.cells(), from_start), Vec::new());
        Self {
            candidates: vec![of(Framing::Ended), of(Framing::Bracketed)],
            doubted: false,
            frame: Frame::new(size),
        }
    }

    /// Decodes bytes.
    pub(super) fn push(&mut self, bytes: &[u8], output: &mut StreamOutput<'_, '_>) {
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
                    parts.dropped += 1;
                } else if part == Part::Whole {
                    give(&mut self.frame, &parts.values, output);
                } else {
                    output.lose(1, &parts.values, None);
                }
                parts.values.clear();
            }
            if let Some(index) = self.sure() {
                self.decide(index, output);
            }
        }
    }

    /// Returns true if the kind has been decided by frames of the right length.
    pub(super) fn is_sure(&self) -> bool {
        self.candidates.len() == 1
    }

    /// Returns true if there was a frame of the right length.
    pub(super) fn has_frames(&self) -> bool {
        let waiting = |(_, frames): &(Parts, Vec<Vec<u8>>)| !frames.is_empty();
        self.is_sure() || self.candidates.iter().any(waiting)
    }

    /// Returns the candidate that has enough frames; None before, and once the kind is decided.
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

    /// Reports the frames that waited for the decision, and forgets the other kind.
    fn decide(&mut self, index: usize, output: &mut StreamOutput<'_, '_>) {
        let (parts, waiting) = self.candidates.swap_remove(index);
        if parts.dropped > 0 {
            output.lose(parts.dropped, b"", None);
        }
        for values in waiting {
            give(&mut self.frame, &values, output);
        }
        self.candidates = vec![(parts, Vec::new())];
    }

    /// Ends the input. If the kind is undecided, it is the one in which frames have the right length.
    pub(super) fn finish(&mut self, output: &mut StreamOutput<'_, '_>) {
        if let [(_, ended), (_, bracketed)] = self.candidates.as_slice() {
            let brackets = !bracketed.is_empty() && (self.doubted || ended.is_empty());
            self.decide(usize::from(brackets), output);
        }
        for (parts, _) in &mut self.candidates {
            if !parts.values.is_empty() && parts.position != BytePosition::AtStart {
                output.lose(1, &parts.values, None);
                parts.values.clear();
            }
        }
    }
}

/// Reports the values as the next frame.
fn give(frame: &mut Frame, values: &[u8], output: &mut StreamOutput<'_, '_>) {
    for (slot, &value) in frame.values_mut().iter_mut().zip(values) {
        *slot = f64::from(value);
    }
    output.frame(frame);
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::formats::stream::event::{StreamCounts, StreamEvent};

    /// Returns the frames in some bytes, and the number of dropped ones.
    fn decoded(bytes: &[u8], size: FrameSize, from_start: bool) -> (Vec<Vec<f64>>, u64) {
        let mut decoder = MatsenseDecoder::new(size, from_start);
        let (mut frames, mut counts) = (Vec::new(), StreamCounts::default());
        let mut sink = |event: StreamEvent<'_>| {
            if let StreamEvent::Frame(frame) = event {
                frames.push(frame.values().to_vec());
            }
        };
        decoder.push(bytes, &mut StreamOutput::new(&mut counts, &mut sink));
        decoder.finish(&mut StreamOutput::new(&mut counts, &mut sink));
        (frames, counts.dropped)
    }

    #[test]
    fn cells_of_255_between_brackets_do_not_end_a_frame() {
        // Two neighbouring cells of 255; and two cells of 255 that, with the escapes, are a frame apart.
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
                let (frames, _) = decoded(
                    &stream[joined..],
                    FrameSize::new(3, 3).expect("an allowed size"),
                    joined == 0,
                );
                let whole = 20 - usize::from(joined > 0);
                assert_eq!(frames, vec![wanted.clone(); whole], "{joined}");
            }
        }
    }

    #[test]
    fn in_frames_that_end_in_ff_brackets_are_cells() {
        // In all frames, and in one frame only.
        let always = b"\x01\x5d\x5b\x04\xff".repeat(9);
        assert_eq!(
            decoded(
                &always,
                FrameSize::new(2, 2).expect("an allowed size"),
                true
            )
            .0
            .len(),
            9
        );
        let once = b"\x01\x5b\x03\x04\xff\x01\x5d\x03\x04\xff";
        assert_eq!(
            decoded(once, FrameSize::new(2, 2).expect("an allowed size"), true)
                .0
                .len(),
            2
        );
        let one = b"\x01\x5b\x03\x04\xff\x01\x5d";
        let wanted = vec![vec![1.0, 91.0, 3.0, 4.0]];
        assert_eq!(
            decoded(one, FrameSize::new(2, 2).expect("an allowed size"), true),
            (wanted, 1)
        );
        // A damaged frame among them is dropped, wherever it is.
        for at in 0..9 {
            let mut stream = always.clone();
            stream.remove(at * 5);
            let (frames, _) = decoded(
                &stream,
                FrameSize::new(2, 2).expect("an allowed size"),
                true,
            );
            assert_eq!(frames.len(), 8, "{at}");
        }
    }

    #[test]
    fn damaged_frames_are_counted_wherever_they_are() {
        let whole = b"\x5b\x01\x02\x03\x04\x5d".to_vec();
        let wanted = vec![vec![1.0, 2.0, 3.0, 4.0]; 3];
        for damaged in [
            &b"\x5b\x01\x5c\x09\x03\x04\x5d"[..],
            b"\x5b\x01\x02\x5d",
            b"\x5b\x01\x02",
        ] {
            for at in 0..3 {
                let mut frames = vec![&whole[..]; 3];
                frames.insert(at, damaged);
                let found = decoded(
                    &frames.concat(),
                    FrameSize::new(2, 2).expect("an allowed size"),
                    false,
                );
                assert_eq!(found, (wanted.clone(), 1), "{damaged:?} {at}");
            }
        }
        // Frames that lack a bracket, and what precedes the first boundary.
        for (between, dropped) in [(&b"\x01\x02\x03\x04\x5d"[..], 1), (b"\x01\x02\x03", 1)] {
            let stream = [between, &whole, between, &whole, &whole].concat();
            let found = decoded(
                &stream,
                FrameSize::new(2, 2).expect("an allowed size"),
                false,
            );
            assert_eq!(found, (wanted.clone(), dropped), "{between:?}");
        }
    }

    #[test]
    fn what_precedes_the_first_end_of_a_frame_is_not_counted() {
        let size = FrameSize::new(2, 2).expect("an allowed size");
        let (whole, wanted) = (b"\x01\x02\x03\x04\xff", vec![1.0, 2.0, 3.0, 4.0]);
        for (start, frames) in [(&b""[..], 3), (b"\x03\x04\xff", 3), (b"hello\r\n", 2)] {
            let stream = [start, &whole.repeat(3)].concat();
            let found = decoded(&stream, size, true);
            assert_eq!(found, (vec![wanted.clone(); frames], 0), "{start:?}");
        }
        assert_eq!(decoded(b"\x03\x04", size, true), (Vec::new(), 0));
        let torn = [whole, whole, &b"\x03\x04\xff"[..]].concat();
        assert_eq!(decoded(&torn, size, true), (vec![wanted; 2], 1));
    }

    #[test]
    fn an_unfinished_escape_damages_its_frame() {
        let (whole, damaged) = (b"\x5b\x01\x02\x03\x04\x5d", b"\x5b\x01\x02\x03\x04\x5c\x5d");
        let stream = [&whole[..], damaged, whole, whole, whole].concat();
        let wanted = vec![vec![1.0, 2.0, 3.0, 4.0]; 4];
        assert_eq!(
            decoded(
                &stream,
                FrameSize::new(2, 2).expect("an allowed size"),
                true
            ),
            (wanted, 1)
        );
    }
}
