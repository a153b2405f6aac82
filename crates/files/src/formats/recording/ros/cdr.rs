//! Reads the common data representation, in which ROS 2 writes messages: numbers at multiples of their size, counted
//! from the end of a header of four bytes that gives their byte order.
//! ```text
//! 00 01 00 00   header: little endian
//! 05 00 00 00   the length of a text, with its zero
//! 61 62 63 64 00   "abcd", then three bytes of padding before the next word
//! ```
//! Source: the OMG's DDS-RTPS specification, encapsulation `CDR_BE` and `CDR_LE`.

use crate::formats::npy::{Dtype, NumberType};

/// A reader of a message, field by field; its methods return None if the message ends too early.
#[derive(Debug)]
pub(super) struct CdrReader<'a> {
    /// The message after the header.
    bytes: &'a [u8],
    /// The number of bytes that have been read.
    at: usize,
    /// Whether the header says that the highest byte comes first.
    big_endian: bool,
}

impl<'a> CdrReader<'a> {
    /// Reads the header of a message; None if it is in another representation.
    pub(super) fn new(message: &'a [u8]) -> Option<Self> {
        let (head, bytes) = message.split_first_chunk::<4>()?;
        let big_endian = match head {
            [0, 0, ..] => true,
            [0, 1, ..] => false,
            _ => return None,
        };
        Some(Self {
            bytes,
            at: 0,
            big_endian,
        })
    }

    /// Reads the next bytes at a multiple of the alignment.
    fn take(&mut self, length: usize, alignment: usize) -> Option<&'a [u8]> {
        let start = self.at.next_multiple_of(alignment);
        let end = start.checked_add(length)?;
        let taken = self.bytes.get(start..end)?;
        self.at = end;
        Some(taken)
    }

    /// Reads a byte.
    pub(super) fn byte(&mut self) -> Option<u8> {
        self.take(1, 1)?.first().copied()
    }

    /// Reads four bytes as a number.
    pub(super) fn word(&mut self) -> Option<u32> {
        let bytes: [u8; 4] = self.take(4, 4)?.try_into().ok()?;
        Some(if self.big_endian {
            u32::from_be_bytes(bytes)
        } else {
            u32::from_le_bytes(bytes)
        })
    }

    /// Reads the number of elements of a list, each of at least `least` bytes; None if they cannot fit.
    pub(super) fn count(&mut self, least: usize) -> Option<usize> {
        let count = usize::try_from(self.word()?).ok()?;
        (count.checked_mul(least)? <= self.bytes.len()).then_some(count)
    }

    /// Reads a text, without the zero at its end.
    pub(super) fn text(&mut self) -> Option<&'a str> {
        let length = self.count(1)?;
        let text = self.take(length, 1)?;
        str::from_utf8(text.strip_suffix(&[0]).unwrap_or(text)).ok()
    }

    /// Reads a list of bytes.
    pub(super) fn bytes(&mut self) -> Option<&'a [u8]> {
        let length = self.count(1)?;
        self.take(length, 1)
    }

    /// Appends a list of numbers.
    pub(super) fn numbers(&mut self, dtype: Dtype, values: &mut Vec<f64>) -> Option<()> {
        let size = dtype.width();
        let count = self.count(size)?;
        // An empty list is not aligned.
        let alignment = if count > 0 { size } else { 1 };
        let bytes = self.take(count.checked_mul(size)?, alignment)?;
        let big_endian = self.big_endian;
        values.extend(NumberType { dtype, big_endian }.values(bytes));
        Some(())
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn words_are_aligned_after_a_text() {
        let message = b"\0\x01\0\0\x05\0\0\0abcd\0\0\0\0\x07\0\0\0";
        let mut cdr = CdrReader::new(message).expect("a header");
        assert_eq!(
            (cdr.text(), cdr.word(), cdr.word()),
            (Some("abcd"), Some(7), None)
        );
        let big = b"\0\0\0\0\0\0\0\x07";
        assert_eq!(CdrReader::new(big).and_then(|mut cdr| cdr.word()), Some(7));
        assert!(CdrReader::new(b"\0\x09\0\0").is_none());
    }

    #[test]
    fn a_count_beyond_the_message_is_refused() {
        let message = |count: u8| [0, 1, 0, 0, count, 0, 0, 0, 9, 0, 8, 0];
        let count = |count| CdrReader::new(&message(count)).and_then(|mut cdr| cdr.count(2));
        assert_eq!([2, 5].map(count), [Some(2), None]);
    }
}
