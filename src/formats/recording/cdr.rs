//! Common data representation, as ROS 2 writes messages: numbers at multiples of their size, counted from behind a
//! header of four bytes that says their byte order.
//! ```text
//! 00 01 00 00   header: little endian
//! 05 00 00 00   the length of a text, with its zero
//! 61 62 63 64 00   "abcd", then three bytes of padding before the next word
//! ```
//! Source: the OMG's DDS-RTPS specification, encapsulation `CDR_BE` and `CDR_LE`.

use crate::formats::npy::NumberType;

/// Reads a message field by field; None where it ends too early.
#[derive(Debug)]
pub(super) struct CdrReader<'a> {
    /// The message behind the header.
    bytes: &'a [u8],
    /// How many of them have been read.
    at: usize,
    /// The byte order that the header names.
    big_endian: bool,
}

impl<'a> CdrReader<'a> {
    /// A message; None if it is in another representation.
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

    /// The next bytes at a multiple of the alignment.
    fn take(&mut self, length: usize, alignment: usize) -> Option<&'a [u8]> {
        let start = self.at.next_multiple_of(alignment);
        let end = start.checked_add(length)?;
        let taken = self.bytes.get(start..end)?;
        self.at = end;
        Some(taken)
    }

    /// A byte.
    pub(super) fn byte(&mut self) -> Option<u8> {
        self.take(1, 1)?.first().copied()
    }

    /// Four bytes as a number.
    pub(super) fn word(&mut self) -> Option<u32> {
        let bytes: [u8; 4] = self.take(4, 4)?.try_into().ok()?;
        Some(if self.big_endian {
            u32::from_be_bytes(bytes)
        } else {
            u32::from_le_bytes(bytes)
        })
    }

    /// The number of elements of a list, each of at least `least` bytes: no more than fit.
    pub(super) fn count(&mut self, least: usize) -> Option<usize> {
        let count = usize::try_from(self.word()?).ok()?;
        (count.checked_mul(least)? <= self.bytes.len()).then_some(count)
    }

    /// A text, without the zero at its end.
    pub(super) fn text(&mut self) -> Option<&'a str> {
        let length = self.count(1)?;
        let text = self.take(length, 1)?;
        str::from_utf8(text.strip_suffix(&[0]).unwrap_or(text)).ok()
    }

    /// A list of bytes.
    pub(super) fn bytes(&mut self) -> Option<&'a [u8]> {
        let length = self.count(1)?;
        self.take(length, 1)
    }

    /// Adds a list of numbers of a kind and size, as of numpy.
    pub(super) fn numbers(&mut self, kind: u8, size: usize, values: &mut Vec<f64>) -> Option<()> {
        let count = self.count(size)?;
        // An empty list is not aligned.
        let alignment = if count > 0 { size } else { 1 };
        let bytes = self.take(count.checked_mul(size)?, alignment)?;
        let number = NumberType::new(kind, size, self.big_endian);
        values.extend(bytes.chunks(size).map(|bytes| number.value(bytes)));
        Some(())
    }
}
