//! Finds out whether a stream begins like a recording that only a file can be. The stream is examined byte by byte, so
//! the answer does not depend on the pieces in which the bytes arrive, and comes as soon as it is certain.
//!
//! - Magic bytes decide once all of them have come.
//! - The words of vendors decide at the end of the line that completes them.
//! - Anything else is decided at the end of the bytes that are looked at, or of the stream, as for a file.

use crate::formats::file::without_mark;
use crate::formats::recording::detect::{LOOKED_AT, is_bitmap, recognised};
use crate::formats::recording::format::RecordingFormat;
use crate::formats::recording::signs::{LONGEST_MAGIC, VendorSigns, by_magic};

/// The search in the first bytes of a stream. When more bytes arrive, it continues where it was.
#[derive(Debug, Default)]
pub(crate) struct StartSearch {
    /// The bytes so far, at most [`LOOKED_AT`].
    bytes: Vec<u8>,
    /// The number of bytes that have been examined.
    seen: usize,
    /// The start of the unfinished line.
    line: usize,
    /// The words of vendors so far; None as long as there are only blanks.
    signs: Option<VendorSigns>,
}

/// The answer of a search.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(crate) enum StartKind {
    /// A stream, as far as the start shows it.
    Stream,
    /// A recording that only a file can be.
    Recording(RecordingFormat),
}

impl StartKind {
    /// Returns the kind of a source whose start has this format, or none that is known.
    fn of(format: Option<RecordingFormat>) -> Self {
        match format.filter(|format| !format.can_be_streamed()) {
            Some(format) => Self::Recording(format),
            None => Self::Stream,
        }
    }
}

impl StartSearch {
    /// Examines the next bytes. Returns the number of those after which the answer is certain, and the answer; None if
    /// more bytes are needed.
    pub(crate) fn push(&mut self, bytes: &[u8]) -> Option<(usize, StartKind)> {
        let before = self.bytes.len();
        let room = LOOKED_AT - before;
        self.bytes.extend(bytes.iter().take(room));
        while self.seen < self.bytes.len() {
            let rest = &self.bytes[self.seen..];
            self.seen += if self.seen < LONGEST_MAGIC {
                1
            } else {
                let end = rest.iter().position(|&byte| byte == b'\n');
                end.map_or(rest.len(), |end| end + 1)
            };
            if let Some(kind) = self.look() {
                return Some((self.seen - before, kind));
            }
        }
        (self.seen == LOOKED_AT).then(|| (room, self.finish()))
    }

    /// Returns the answer for a stream that ends here.
    pub(crate) fn finish(&self) -> StartKind {
        StartKind::of(recognised(&self.bytes))
    }

    /// Looks at the bytes that have been examined, after the last of them.
    fn look(&mut self) -> Option<StartKind> {
        let seen = &self.bytes[..self.seen];
        if self.seen <= LONGEST_MAGIC
            && let Some(format) = by_magic(seen)
        {
            return Some(StartKind::of(Some(format)));
        }
        let line = Some(&seen[self.line..]).filter(|line| line.ends_with(b"\n"))?;
        let line = if self.line == 0 {
            without_mark(line)
        } else {
            line
        };
        self.line = self.seen;
        if line.contains(&0) {
            return Some(StartKind::Stream);
        }
        let signs = match &mut self.signs {
            Some(signs) => signs,
            None => match line.trim_ascii().first()? {
                b'{' | b'<' => return Some(StartKind::Stream),
                _ if is_bitmap(line) => return Some(StartKind::Stream),
                _ => self.signs.insert(VendorSigns::default()),
            },
        };
        signs
            .add(line.strip_suffix(b"\n").unwrap_or(line))
            .map(|format| StartKind::of(Some(format)))
    }
}
