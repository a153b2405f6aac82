//! Frames of a byte per cell, as boards send them, in files and streams.
//!
//! | board | a frame is | |
//! |---|---|---|
//! | `FlexiTac` | `AA 55`, cells | the marker also occurs inside frames, and there is no checksum |
//! | `MatSense` | cells, `FF` | cells are 0 to 254 |
//! | `MatSense` | `5B`, cells, `5D` | `5C 00`, `5C 01`, `5C 02` stand for the cells `5C`, `5B`, `5D` |

use std::io::{self, BufRead};
use std::mem;

use taxel_core::frame::{Frame, FrameSize};
use taxel_core::parameter::number::counted;

use crate::error::{ReadError, ReadErrorKind};
use crate::formats::recording::event::{ChannelInfo, ReadOptions, RecordingNote, Sink, Stop};

/// The bytes before each frame of a `FlexiTac`.
const MARKER: [u8; 2] = [0xaa, 0x55];

/// Whether bytes begin like those of a `FlexiTac`, or three markers in succession are a frame apart.
pub(super) fn is_flexitac(head: &[u8], options: &ReadOptions, _: bool) -> bool {
    let has_marker = |at: usize| head[at..].starts_with(&MARKER);
    let is_apart = |size: FrameSize| {
        let period = MARKER.len() + size.cells();
        let last = head.len().saturating_sub(2 * period);
        (0..last).any(|at| (0..3).all(|frame| has_marker(at + frame * period)))
    };
    has_marker(0) && !options.is_joined || options.size.is_some_and(is_apart)
}

/// The size of a frame, which bytes do not state.
fn size(options: &ReadOptions) -> Result<FrameSize, ReadError> {
    let message = "the rows and columns of a frame of bytes are not stated";
    let unsized_bytes = || ReadError::new(message).of_kind(ReadErrorKind::Unsized);
    options.size.ok_or_else(unsized_bytes)
}

/// Whether these are frames of a `MatSense`; text has brackets, too.
pub(super) fn is_matsense(head: &[u8], options: &ReadOptions, is_all: bool) -> bool {
    let is_text = str::from_utf8(head).map_or_else(|error| error.error_len().is_none(), |_| true);
    let has_control = head.iter().any(|byte| *byte < b'\t');
    let size = options.size.filter(|_| !is_text || has_control);
    size.is_some_and(|size| framing(head, size.cells(), options, is_all).is_some())
}

/// Reads the frames of a `FlexiTac`.
pub(super) fn flexitac(input: &mut dyn BufRead, sink: &mut Sink<'_>) -> Result<(), Stop> {
    let options = sink.options;
    let size = size(options)?;
    let mut frames = MarkedFrames {
        board: Board::new(size, sink)?,
        bytes: Vec::new(),
        start: if options.is_joined {
            Start::Anywhere
        } else {
            Start::Stream
        },
        has_frames: false,
    };
    let period = frames.period();
    loop {
        // A piece at a time, so that the buffer stays small however many bytes arrive at once.
        let ended = take_bytes(input, period, &mut frames.bytes)?;
        while frames.step(ended)? {}
        if ended {
            return frames.finish();
        }
    }
}

/// Appends at most `most` of the bytes that have come. Returns true at the end of the input.
pub(super) fn take_bytes(
    input: &mut dyn BufRead,
    most: usize,
    bytes: &mut Vec<u8>,
) -> Result<bool, ReadError> {
    loop {
        let count = match input.fill_buf() {
            Ok(found) => {
                let found = &found[..found.len().min(most)];
                bytes.extend_from_slice(found);
                found.len()
            }
            Err(error) if error.kind() == io::ErrorKind::Interrupted => continue,
            Err(error) if error.kind() == io::ErrorKind::UnexpectedEof => 0,
            Err(error) => return Err(error.into()),
        };
        input.consume(count);
        return Ok(count == 0);
    }
}

/// What gives the frames of a board, and counts those that are none.
struct Board<'a, 'b> {
    sink: &'a mut Sink<'b>,
    channel: usize,
    frame: Frame,
    garbled: u64,
}

impl<'a, 'b> Board<'a, 'b> {
    fn new(size: FrameSize, sink: &'a mut Sink<'b>) -> Result<Self, Stop> {
        let channel = sink.channel(None, || ChannelInfo::of_size(size))?;
        let (frame, garbled) = (Frame::new(size), 0);
        Ok(Self {
            sink,
            channel,
            frame,
            garbled,
        })
    }

    fn give(&mut self, cells: &[u8]) -> Result<(), Stop> {
        for (slot, &byte) in self.frame.values_mut().iter_mut().zip(cells) {
            *slot = f64::from(byte);
        }
        self.sink.frame(self.channel, &mut self.frame)
    }

    /// Counts frames that are none. Without a checksum, a file cannot be refused for them.
    fn lose(&mut self, frames: u64, bytes: &[u8], message: &str) -> Result<(), Stop> {
        self.garbled += frames;
        if self.sink.options.leaves_out {
            for _ in 0..frames {
                self.sink.damage(ReadError::new(message), bytes)?;
            }
        }
        Ok(())
    }

    fn finish(&mut self) -> Result<(), Stop> {
        if self.garbled > 0 && !self.sink.options.leaves_out {
            let frames = counted(self.garbled, "frame");
            let text = format!("{frames} dropped (torn, short, long or garbled)");
            self.sink.note(&RecordingNote::Oddity(text))?;
        }
        Ok(())
    }
}

/// Frames after markers. A frame counts once the marker after it has come, or if the input ends with its last byte. If a
/// marker is not where it was due, the nearest one that the next confirms is taken: the first one would give frames from
/// the middle of others.
struct MarkedFrames<'a, 'b> {
    board: Board<'a, 'b>,
    /// The bytes that are not read yet: at most a few frames.
    bytes: Vec<u8>,
    start: Start,
    has_frames: bool,
}

/// The place where the bytes that are not read yet begin.
#[derive(Clone, Copy, Debug, PartialEq)]
enum Start {
    Anywhere,
    /// The first byte of the stream. A marker there cannot be the content of cells.
    Stream,
    Marker,
}

const GARBLED: &str = "no marker AA 55 where it was due";

impl MarkedFrames<'_, '_> {
    fn period(&self) -> usize {
        MARKER.len() + self.board.frame.size().cells()
    }

    fn has_marker(&self, at: usize) -> bool {
        self.bytes.get(at..at + MARKER.len()) == Some(&MARKER[..])
    }

    fn finish(mut self) -> Result<(), Stop> {
        if !self.bytes.is_empty() && (self.start == Start::Marker || self.has_frames) {
            self.board.lose(1, &self.bytes, "ends inside a frame")?;
        }
        self.board.finish()
    }

    /// Takes one frame, or drops bytes that are none; returns false if more bytes are needed.
    fn step(&mut self, ended: bool) -> Result<bool, Stop> {
        let period = self.period();
        if self.start == Start::Stream && self.bytes.len() >= MARKER.len() {
            self.start = if self.has_marker(0) {
                Start::Marker
            } else {
                Start::Anywhere
            };
        }
        if self.start == Start::Marker {
            let whole = self.bytes.len() == period;
            if self.has_marker(period) || whole && ended {
                self.board.give(&self.bytes[MARKER.len()..period])?;
                self.has_frames = true;
                self.bytes.drain(..period);
                self.start = if ended && self.bytes.is_empty() {
                    Start::Anywhere
                } else {
                    Start::Marker
                };
                return Ok(true);
            }
            let waits = whole || self.bytes.len() == period + 1 && self.bytes[period] == MARKER[0];
            if !ended && (waits || self.bytes.len() < period) {
                return Ok(false);
            }
        }
        self.search(ended)
    }

    /// Searches for the marker nearest to where it was due that the next one confirms; returns false if more bytes are
    /// needed.
    fn search(&mut self, ended: bool) -> Result<bool, Stop> {
        let period = self.period();
        let in_step = self.start == Start::Marker;
        let due = if in_step { period } else { 0 };
        let reach = due + period;
        // The last position is confirmed within these bytes; no marker is nearer than one where it was due.
        let needed = reach + period + MARKER.len();
        let in_place = self.has_marker(due) && self.has_marker(due + period);
        if self.bytes.len() < needed && !ended && !in_place {
            return Ok(false);
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
        let gone = match nearest {
            Some(at) => at,
            None if ended => return Ok(false),
            None => reach.min(length),
        };
        if in_step {
            let frames = (gone + period / 2) / period;
            self.board.lose(
                frames.max(1) as u64,
                &self.bytes[..gone.min(length)],
                GARBLED,
            )?;
        } else if nearest.is_none() && self.has_frames {
            self.board.lose(1, &self.bytes, GARBLED)?;
        }
        self.bytes.drain(..gone);
        self.start = match nearest {
            Some(_) => Start::Marker,
            None => Start::Anywhere,
        };
        Ok(true)
    }
}

/// The bytes that open, escape and close a bracketed frame, and the cells that escapes with these numbers stand for.
const OPEN: u8 = 0x5b;
const ESCAPE: u8 = 0x5c;
const CLOSE: u8 = 0x5d;
const ESCAPED: [u8; 3] = [ESCAPE, OPEN, CLOSE];

/// The byte that ends a frame without brackets.
const END: u8 = 0xff;

/// Whether the frames of a stream of this many cells are in brackets, from its first bytes; None if more are needed. The
/// bytes between two cells of `FF` in a bracketed stream may have the right number by chance.
fn framing(head: &[u8], cells: usize, options: &ReadOptions, is_all: bool) -> Option<bool> {
    let whole = |is_bracketed| {
        let mut frame = SplitFrame::new(is_bracketed, cells, options);
        head.iter()
            .filter(|&&byte| matches!(frame.take(byte), Part::Whole(_)))
            .count()
    };
    let (ended, bracketed) = (whole(false), whole(true));
    let enough = if is_all { 1 } else { 2 };
    if bracketed >= enough && bracketed >= ended {
        Some(true)
    } else if ended >= enough && (bracketed == 0 || ended > 4) {
        Some(false)
    } else {
        None
    }
}

/// Reads the frames of a `MatSense`, in the framing that its first bytes show.
pub(super) fn matsense(input: &mut dyn BufRead, sink: &mut Sink<'_>) -> Result<(), Stop> {
    let options = sink.options;
    let size = size(options)?;
    let cells = size.cells();
    let (mut bytes, mut ended) = (Vec::new(), false);
    // As many bytes as 64 frames have show it, or nothing does.
    let most = 128 * (cells + 2);
    let found = loop {
        let is_all = ended || bytes.len() >= most;
        match framing(&bytes, cells, options, is_all) {
            None if !is_all => ended = take_bytes(input, most, &mut bytes)?,
            found => break found.unwrap_or(false),
        }
    };
    let mut board = Board::new(size, sink)?;
    let mut frame = SplitFrame::new(found, cells, options);
    loop {
        for &byte in &bytes {
            match frame.take(byte) {
                Part::More => {}
                Part::Whole(bytes) => board.give(&bytes)?,
                Part::Torn { bytes, found } => {
                    let found = counted(found as u64, "byte");
                    let message = format!("a frame of {found}, expected {cells}");
                    board.lose(1, &bytes, &message)?;
                }
            }
        }
        if ended {
            return board.finish();
        }
        bytes.clear();
        ended = take_bytes(input, most, &mut bytes)?;
    }
}

/// What a byte makes of a frame.
enum Part {
    More,
    Whole(Vec<u8>),
    Torn { bytes: Vec<u8>, found: usize },
}

/// A frame between an end and the next one.
#[expect(
    clippy::struct_excessive_bools,
    reason = "a byte means what all of them say"
)]
#[derive(Default)]
struct SplitFrame {
    is_bracketed: bool,
    cells: usize,
    /// The cells of the frame so far, at most as many as it has; a wrong escape is none.
    values: Vec<u8>,
    found: usize,
    /// Whether an end or a beginning has come: what precedes it may be the rest of a frame.
    is_synced: bool,
    is_inside: bool,
    is_escaped: bool,
}

impl SplitFrame {
    fn new(is_bracketed: bool, cells: usize, options: &ReadOptions) -> Self {
        Self {
            is_bracketed,
            cells,
            is_inside: !is_bracketed && !options.is_joined,
            ..Self::default()
        }
    }

    fn take(&mut self, byte: u8) -> Part {
        let opens = self.is_bracketed && byte == OPEN;
        if opens || byte == if self.is_bracketed { CLOSE } else { END } {
            let begins = opens || !self.is_bracketed;
            let is_whole = mem::replace(&mut self.is_inside, begins)
                && !self.is_escaped
                && !opens
                && self.found == self.cells;
            self.is_escaped = false;
            let is_synced = mem::replace(&mut self.is_synced, true);
            let (bytes, found) = (mem::take(&mut self.values), mem::take(&mut self.found));
            return if is_whole && bytes.len() == found {
                Part::Whole(bytes)
            } else if is_synced && found > 0 {
                Part::Torn { bytes, found }
            } else {
                Part::More
            };
        }
        let value = if mem::take(&mut self.is_escaped) {
            ESCAPED.get(usize::from(byte)).copied()
        } else if self.is_bracketed && self.is_inside && byte == ESCAPE {
            self.is_escaped = true;
            return Part::More;
        } else if !self.is_inside && b"\r\n".contains(&byte) {
            // A board may end its frames as lines.
            return Part::More;
        } else {
            Some(byte)
        };
        self.found += 1;
        if self.values.len() < self.cells {
            self.values.extend(value);
        }
        Part::More
    }
}
