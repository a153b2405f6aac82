//! Decodes the bytes of boards: `FlexiTac` and `MatSense`.

use taxel_core::frame::{Frame, FrameSize};

use crate::formats::stream::event::{StreamEvent, StreamOutput};

/// The bytes before each frame.
pub(in crate::formats) const MARKER: [u8; 2] = [0xaa, 0x55];

/// A decoder of `AA 55` and then a byte per cell, without a checksum: these two bytes also occur inside frames.
///
/// So a frame counts only once the marker after it has arrived, or if the input ends exactly with its last byte. If a
/// marker is not in its expected place, the nearest marker that the next one confirms is used. Using the first such
/// marker instead would read frames from their middle. If a stream is joined late, two neighbouring cells may be `AA
/// 55` in every frame: at worst they are taken for the marker until one of them changes.
/// ```text
/// AA 55  00 0C 07 03  AA 55  00 0D …        2 rows of 2 columns, 0 to 255
/// ```
/// Frames have no number and no time; rows and columns must be known. A frame is shown as provisional as soon as its
/// last byte has arrived, so that the live page does not lag a frame behind; it is confirmed or withdrawn by the
/// bytes after it.
#[derive(Debug)]
pub(super) struct FlexitacDecoder {
    size: FrameSize,
    /// The bytes that are not decoded yet: at most a few frames.
    bytes: Vec<u8>,
    start: Start,
    frame: Frame,
}

/// The place where the bytes that are not decoded yet begin.
#[derive(Clone, Copy, Debug, PartialEq)]
enum Start {
    Anywhere,
    /// The first byte of the stream. A marker there cannot be the content of cells.
    Stream,
    Marker {
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

    fn period(&self) -> usize {
        MARKER.len() + self.size.cells()
    }

    fn has_marker(&self, at: usize) -> bool {
        self.bytes.get(at..at + MARKER.len()) == Some(&MARKER[..])
    }

    pub(super) fn push(&mut self, bytes: &[u8], output: &mut StreamOutput<'_, '_>) {
        // Take one piece at a time, so that the buffer stays small however many bytes arrive at once.
        for piece in bytes.chunks(self.period()) {
            self.bytes.extend_from_slice(piece);
            while self.step(false, output) {}
        }
    }

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

const END: u8 = 0xff;
const OPEN: u8 = 0x5b;
const CLOSE: u8 = 0x5d;
/// The byte before the number of a cell that would otherwise begin, end or escape.
const ESCAPE: u8 = 0x5c;

const SURE: usize = 2;
/// If there are signs of brackets, the number of frames between `FF` that decide against them, in addition to the
/// number of frames between brackets.
const SURE_IN_DOUBT: usize = 4;

#[derive(Clone, Copy, Debug, PartialEq)]
enum Framing {
    /// Each frame ends in [`END`].
    Ended,
    /// Each frame is between [`OPEN`] and [`CLOSE`].
    Bracketed,
}

#[derive(Clone, Copy, Debug, PartialEq)]
enum BytePosition {
    /// At the beginning of a stream, which may be that of a frame; what is there up to the first end of a frame is
    /// dropped if it is no frame.
    AtStart,
    /// Before the first start or end of a frame; what is there is dropped.
    BeforeFrames,
    InFrame,
    /// Behind the end of a bracketed frame, but not in the next one.
    BetweenFrames,
}

#[derive(Clone, Debug)]
struct Parts {
    framing: Framing,
    cells: usize,
    /// The cells of the current frame so far, or the bytes since the end of the last one.
    values: Vec<u8>,
    position: BytePosition,
    /// Whether the last byte was an [`ESCAPE`].
    escaped: bool,
    broken: bool,
    dropped: u64,
}

/// The state of a frame after a byte.
#[derive(PartialEq)]
enum Part {
    /// The frame continues, or has not begun.
    More,
    Whole,
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

/// A decoder of frames with an end: a byte per cell, then `FF`; or `5B`, the cells with escapes, `5D`.
///
/// The first two frames of the right length decide which of the two it is. Frames of another length are dropped. In a
/// bracketed stream, the bytes between two cells of `FF` may have the right length, too: if there are signs of that,
/// more frames are needed to decide.
/// ```text
/// 00 0C 07 03 FF          cells are 0 to 254; FF ends the frame
/// 5B 00 0C 07 03 5D       cells are 0 to 255; 5B, 5C and 5D among them are 5C 01, 5C 00 and 5C 02
/// ```
#[derive(Clone, Debug)]
pub(super) struct MatsenseDecoder {
    candidates: Vec<(Parts, Vec<Vec<u8>>)>,
    doubted: bool,
    frame: Frame,
}

impl MatsenseDecoder {
    pub(super) fn new(size: FrameSize, from_start: bool) -> Self {
        let of = |framing| (Parts::new(framing, size.cells(), from_start), Vec::new());
        Self {
            candidates: vec![of(Framing::Ended), of(Framing::Bracketed)],
            doubted: false,
            frame: Frame::new(size),
        }
    }

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

    pub(super) fn is_sure(&self) -> bool {
        self.candidates.len() == 1
    }

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

fn give(frame: &mut Frame, values: &[u8], output: &mut StreamOutput<'_, '_>) {
    for (slot, &value) in frame.values_mut().iter_mut().zip(values) {
        *slot = f64::from(value);
    }
    output.frame(frame);
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::formats::stream::event::StreamCounts;

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
