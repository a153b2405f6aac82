//! Input in blocks of whole lines.

use std::io::{self, Read};
use std::sync::Arc;

use crate::cli::input::lines::buffers::Buffers;

/// The longest line, in bytes. Longer lines are refused, so that none can use up all memory.
pub(crate) const MAX_LINE: usize = 1 << 20;

/// The number of bytes to read at a time at the start of the input: about a hundred lines, so that several threads
/// share even a short input.
const CHUNK: usize = 1 << 13;

/// The number of bytes to read at a time from a long input. Threads wake each other for every block, so larger blocks
/// save time.
const LARGE_CHUNK: usize = 1 << 15;

/// Blocks grow to at most this fraction of what has been read, 1/32, so that the threads end at about the same time.
const PART: u64 = 32;

#[derive(Debug)]
pub(crate) struct Block {
    /// The lines. Only the last line of the input may lack its line end.
    text: Vec<u8>,
    /// The number of its first line, counted from 1.
    first: u64,
    /// Whether the block stands for one line longer than [`MAX_LINE`], whose bytes were dropped.
    is_long: bool,
}

impl Block {
    pub(crate) fn lines(&self) -> impl Iterator<Item = (u64, Option<&[u8]>)> {
        let text = self.text.strip_suffix(b"\n").unwrap_or(&self.text);
        let lines = text.split(|&byte| byte == b'\n');
        let lines = lines.map(|line| (!self.is_long && line.len() <= MAX_LINE).then_some(line));
        (self.first..).zip(lines)
    }

    pub(crate) fn into_buffer(self) -> Vec<u8> {
        self.text
    }
}

/// Reads blocks. A block holds what one read returned, up to its last line end, so that lines that have arrived do
/// not wait for those that have not.
#[derive(Debug)]
pub(crate) struct BlockReader<R> {
    input: R,
    /// The bytes of the next block that have been read.
    rest: Vec<u8>,
    /// The number of bytes read in all.
    total: u64,
    number: u64,
    is_long: bool,
    buffers: Arc<Buffers>,
}

impl<R: Read> BlockReader<R> {
    pub(crate) fn new(input: R, buffers: Arc<Buffers>) -> Self {
        Self {
            input,
            rest: Vec::new(),
            total: 0,
            number: 1,
            is_long: false,
            buffers,
        }
    }

    pub(crate) fn next_block(&mut self) -> Option<io::Result<Block>> {
        let mut searched = 0;
        loop {
            let new = &self.rest[searched..];
            let end = if self.is_long {
                new.iter().position(|&byte| byte == b'\n')
            } else {
                new.iter().rposition(|&byte| byte == b'\n')
            };
            if let Some(end) = end {
                return Some(Ok(self.cut(searched + end + 1)));
            }
            if self.rest.len() > MAX_LINE {
                self.is_long = true;
            }
            if self.is_long {
                self.rest.clear();
            }
            searched = self.rest.len();
            match self.fill() {
                Err(error) => return Some(Err(error)),
                Ok(0) if self.rest.is_empty() && !self.is_long => return None,
                Ok(0) => return Some(Ok(self.cut(searched))),
                Ok(_) => {}
            }
        }
    }

    fn cut(&mut self, length: usize) -> Block {
        let mut rest = self.buffers.take();
        rest.extend_from_slice(&self.rest[length..]);
        self.rest.truncate(length);
        let mut text = std::mem::replace(&mut self.rest, rest);
        let (first, is_long) = (self.number, std::mem::take(&mut self.is_long));
        if is_long {
            text.clear();
            self.number += 1;
        } else {
            let ends = text.iter().map(|&byte| u64::from(byte == b'\n'));
            self.number += ends.sum::<u64>();
        }
        Block {
            text,
            first,
            is_long,
        }
    }

    fn fill(&mut self) -> io::Result<usize> {
        let old = self.rest.len();
        let part = usize::try_from(self.total / PART).unwrap_or(LARGE_CHUNK);
        self.rest.resize(old + part.clamp(CHUNK, LARGE_CHUNK), 0);
        let read = loop {
            match self.input.read(&mut self.rest[old..]) {
                Err(error) if error.kind() == io::ErrorKind::Interrupted => {}
                read => break read,
            }
        };
        let new = *read.as_ref().unwrap_or(&0);
        self.rest.truncate(old + new);
        self.total += new as u64;
        read
    }
}

#[cfg(test)]
mod tests {
    use std::collections::VecDeque;

    use super::*;

    fn lines(pieces: &[&[u8]]) -> Vec<(u64, Option<Vec<u8>>)> {
        struct Pieces(VecDeque<Vec<u8>>);
        impl Read for Pieces {
            fn read(&mut self, buffer: &mut [u8]) -> io::Result<usize> {
                let Some(mut piece) = self.0.pop_front() else {
                    return Ok(0);
                };
                let length = piece.len().min(buffer.len());
                buffer[..length].copy_from_slice(&piece[..length]);
                let rest = piece.split_off(length);
                if !rest.is_empty() {
                    self.0.push_front(rest);
                }
                Ok(length)
            }
        }
        let pieces = pieces.iter().map(|piece| piece.to_vec()).collect();
        let mut blocks = BlockReader::new(Pieces(pieces), Arc::default());
        let mut lines = Vec::new();
        while let Some(block) = blocks.next_block() {
            let block = block.expect("read");
            let own = block.lines();
            lines.extend(own.map(|(number, line)| (number, line.map(<[u8]>::to_vec))));
        }
        lines
    }

    #[test]
    fn lines_are_numbered_however_they_arrive() {
        let expected = vec![
            (1, Some(b"a".to_vec())),
            (2, Some(Vec::new())),
            (3, Some(b"bc".to_vec())),
        ];
        for pieces in [
            &[&b"a\n\nbc\n"[..]][..],
            &[b"a\n\nbc"],
            &[b"a", b"\n", b"\nb", b"c"],
            &[b"a\n", b"\n", b"bc", b"\n"],
        ] {
            assert_eq!(lines(pieces), expected, "{pieces:?}");
        }
        assert_eq!(lines(&[]), []);
    }

    #[test]
    fn a_line_that_is_too_long_is_skipped() {
        let longest = vec![b'y'; MAX_LINE];
        let longer = vec![b'z'; MAX_LINE + 1];
        let found = lines(&[&longest, b"\n", &longer, b"\na\n", &longer, &longer]);
        let lengths: Vec<_> = found
            .iter()
            .map(|(number, line)| (*number, line.as_ref().map(Vec::len)))
            .collect();
        assert_eq!(
            lengths,
            [(1, Some(MAX_LINE)), (2, None), (3, Some(1)), (4, None)]
        );
    }

    #[test]
    fn blocks_of_a_long_input_are_longer() {
        let mut blocks = BlockReader::new(io::repeat(b'\n'), Arc::default());
        let mut total = 0;
        for _ in 0..1000 {
            let block = blocks.next_block().expect("endless").expect("read");
            let length = block.text.len();
            let part = usize::try_from(total / PART).expect("small");
            assert!((CHUNK..=LARGE_CHUNK.min(part.max(CHUNK))).contains(&length));
            total += length as u64;
        }
        assert!(total > 500 * LARGE_CHUNK as u64, "{total} bytes");
    }
}
