//! Arrays in numpy's file formats: NPY, a header and the numbers, and NPZ, a zip of such files.
//!
//! Headers are written in version 1.0 and numbers little-endian, the last axis fastest. Headers of versions 1 to 3 are
//! read, with numbers of any real type in either byte order and either order of axes, or records of several fields.
//! Source: <https://numpy.org/doc/stable/reference/generated/numpy.lib.format.html>.

pub(crate) mod archive;

pub(super) mod imprint;

use std::io::{ErrorKind, Read};

use serde::Deserialize;
use taxel_core::index::index;

use crate::error::ReadError;

pub(crate) const MAGIC: &[u8] = b"\x93NUMPY";
const VERSION: &[u8] = &[1, 0];
/// The number of bytes before the text of a header: the last two are its length.
pub(crate) const BEFORE_TEXT: usize = 10;
/// The numbers of an array begin at a multiple of this.
const ALIGNMENT: usize = 64;
/// The most bytes of a header's text.
const LONGEST_TEXT: usize = 1 << 20;

/// The type of a real number: `bool`, or a whole number or float of some size.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Number {
    /// The letter of numpy: `b`, `i`, `u` or `f`.
    kind: u8,
    size: u8,
    big_endian: bool,
}

impl Number {
    /// `bool`, a byte each.
    pub const BOOL: Self = Self::new(b'b', 1);
    /// `uint8`.
    pub const U8: Self = Self::new(b'u', 1);
    /// `uint16`.
    pub const U16: Self = Self::new(b'u', 2);
    /// `uint32`.
    pub const U32: Self = Self::new(b'u', 4);
    /// `uint64`.
    pub const U64: Self = Self::new(b'u', 8);
    /// `float32`.
    pub const F32: Self = Self::new(b'f', 4);
    /// `float64`.
    pub const F64: Self = Self::new(b'f', 8);

    const fn new(kind: u8, size: u8) -> Self {
        Self {
            kind,
            size,
            big_endian: false,
        }
    }

    /// The type of a code such as `<f4`; None if it is not that of real numbers.
    pub(crate) fn of(code: &str) -> Option<Self> {
        const KNOWN: [&[u8; 2]; 12] = [
            b"b1", b"i1", b"i2", b"i4", b"i8", b"u1", b"u2", b"u4", b"u8", b"f2", b"f4", b"f8",
        ];
        let &[order, kind, size] = code.as_bytes() else {
            return None;
        };
        (b"<>|=".contains(&order) && KNOWN.contains(&&[kind, size])).then(|| Self {
            kind,
            size: size - b'0',
            big_endian: order == b'>',
        })
    }

    /// The same type in this order of bytes.
    pub(crate) const fn in_order(self, big_endian: bool) -> Self {
        Self { big_endian, ..self }
    }

    fn code(self) -> String {
        let order = match (self.size, self.big_endian) {
            (1, _) => '|',
            (_, false) => '<',
            (_, true) => '>',
        };
        format!("{order}{}{}", char::from(self.kind), self.size)
    }

    /// The size of a number in bytes.
    pub const fn size(self) -> usize {
        self.size as usize
    }

    fn word(self, bytes: &[u8]) -> u64 {
        let mut word = [0; 8];
        for (slot, byte) in word.iter_mut().zip(bytes) {
            *slot = *byte;
        }
        if self.big_endian {
            word[..self.size()].reverse();
        }
        u64::from_le_bytes(word)
    }

    /// A whole number; None if the type is a float.
    pub(crate) fn whole(self, bytes: &[u8]) -> Option<i128> {
        let word = self.word(bytes);
        let unused = 64 - 8 * self.size();
        match self.kind {
            b'i' => Some(i128::from((word << unused).cast_signed() >> unused)),
            b'f' => None,
            _ => Some(i128::from(word)),
        }
    }

    /// The number as a float; a whole number beyond 2^53 becomes the nearest float.
    #[expect(
        clippy::cast_precision_loss,
        clippy::cast_possible_truncation,
        reason = "beyond 2^53 the nearest float; halves and singles are cut to their width"
    )]
    pub(crate) fn value(self, bytes: &[u8]) -> f64 {
        if let Some(whole) = self.whole(bytes) {
            return whole as f64;
        }
        let word = self.word(bytes);
        match self.size {
            2 => half(word as u16),
            4 => f32::from_bits(word as u32).into(),
            _ => f64::from_bits(word),
        }
    }

    pub(crate) fn values(self, bytes: &[u8]) -> impl Iterator<Item = f64> {
        let numbers = bytes.chunks_exact(self.size());
        numbers.map(move |number| self.value(number))
    }
}

/// The value of a half-precision number, IEEE 754's binary16: a sign, five bits of exponent with a bias of 15, and ten
/// bits of fraction. With the smallest exponent there is no leading 1.
fn half(bits: u16) -> f64 {
    let (exponent, fraction) = (i32::from(bits >> 10 & 31), f64::from(bits & 1023));
    let value = match exponent {
        0 => fraction * 2_f64.powi(-24),
        31 if fraction == 0.0 => f64::INFINITY,
        31 => f64::NAN,
        _ => (1024.0 + fraction) * 2_f64.powi(exponent - 25),
    };
    if bits >> 15 == 1 { -value } else { value }
}

/// The header of an array of that type and shape: all bytes before its numbers.
///
/// ```
/// use taxel_files::formats::numpy::{Number, header};
/// let header = header(Number::U32, &[360, 100]);
/// assert!(header.starts_with(b"\x93NUMPY\x01\x00\x76\x00{'descr': '<u4', 'fortran_order': False, "));
/// assert_eq!((header.len(), header.last()), (128, Some(&b'\n')));
/// ```
pub fn header(number: Number, shape: &[u64]) -> Vec<u8> {
    let sides: Vec<String> = shape.iter().map(u64::to_string).collect();
    // A tuple of one element ends in a comma, a longer one does not.
    let end = if sides.len() == 1 { "," } else { "" };
    let (code, sides) = (number.code(), sides.join(", "));
    let text = format!("{{'descr': '{code}', 'fortran_order': False, 'shape': ({sides}{end}), }}");
    let length = (BEFORE_TEXT + text.len() + 1).next_multiple_of(ALIGNMENT);
    header_of(&text, length)
}

/// The header with this text: with spaces behind it, so that it has `length` bytes.
pub(crate) fn header_of(text: &str, length: usize) -> Vec<u8> {
    let width = length.saturating_sub(BEFORE_TEXT + 1);
    let text = format!("{text:<width$}\n");
    let length = &text.len().to_le_bytes()[..2];
    [MAGIC, VERSION, length, text.as_bytes()].concat()
}

/// The header of a file: the type and the arrangement of its numbers.
#[derive(Clone, Debug, PartialEq, Eq, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct Header {
    /// The type of its elements.
    pub descr: Elements,
    /// Whether the first axis is the fastest.
    pub fortran_order: bool,
    /// The lengths of the axes.
    pub shape: Vec<u64>,
}

/// The type of an array's elements.
#[derive(Clone, Debug, PartialEq, Eq, Deserialize)]
#[serde(untagged)]
pub enum Elements {
    /// Numbers, or whatever the code says, such as `<f8`.
    Code(String),
    /// Records.
    Record(Vec<Field>),
}

/// A field of records.
#[derive(Clone, Debug, PartialEq, Eq, Deserialize)]
pub struct Field {
    /// The name; empty for bytes that only fill up a record.
    pub name: String,
    /// The type of its elements.
    pub code: String,
    /// The lengths of its axes, if it has several elements.
    #[serde(default)]
    pub sides: Vec<u64>,
}

impl Field {
    /// The number of its bytes; None if its type has no fixed size.
    pub(crate) fn bytes(&self) -> Option<usize> {
        let kind = self.code.get(1..)?;
        let digits = kind.get(1..)?.split('[').next()?;
        let size: usize = digits.parse().ok()?;
        let size = if kind.starts_with('U') {
            4 * size
        } else {
            size
        };
        let mut sides = self.sides.iter().map(|&side| usize::try_from(side).ok());
        sides.try_fold(size, |product, side| product.checked_mul(side?))
    }
}

impl Header {
    /// Reads a header, after which the numbers follow.
    ///
    /// # Errors
    /// Returns an error if these are not the bytes of an array.
    ///
    /// ```
    /// use taxel_files::formats::numpy::{Elements, Header, Number, header};
    /// let file = [header(Number::U8, &[1, 2]), vec![7, 8]].concat();
    /// let mut rest = &file[..];
    /// let header = Header::read(&mut rest)?;
    /// assert_eq!((header.descr, &header.shape[..]), (Elements::Code("|u1".to_owned()), &[1, 2][..]));
    /// assert_eq!(rest, [7, 8]);
    /// # Ok::<(), taxel_files::ReadError>(())
    /// ```
    pub fn read(input: &mut dyn Read) -> Result<Self, ReadError> {
        let wrong = || ReadError::new("not a numpy array: expected a header of version 1 to 3");
        let mut whole = |length: usize| {
            let mut bytes = vec![0; length];
            match input.read_exact(&mut bytes) {
                Err(error) if error.kind() == ErrorKind::UnexpectedEof => Err(wrong()),
                read => Ok(read.map(|()| bytes)?),
            }
        };
        let length = match whole(8)?.strip_prefix(MAGIC) {
            Some([1, _]) => whole(2)?,
            Some([2 | 3, _]) => whole(4)?,
            _ => return Err(wrong()),
        };
        let length = length.iter().rev();
        let length = length.fold(0, |sum, &byte| sum << 8 | usize::from(byte));
        if length > LONGEST_TEXT {
            return Err(wrong());
        }
        let text = String::from_utf8(whole(length)?).map_err(|_| wrong())?;
        serde_json::from_str(&as_json(text.trim())).map_err(|_| wrong())
    }

    /// The code of its numbers; empty for records.
    pub(crate) fn code(&self) -> &str {
        match &self.descr {
            Elements::Code(code) => code,
            Elements::Record(_) => "",
        }
    }

    /// The type of its numbers; None if its elements are something else.
    pub(crate) fn number(&self) -> Option<Number> {
        Number::of(self.code())
    }

    /// The numbers of an array, of which there are as many as its shape says, with the last axis fastest.
    pub(crate) fn in_order_of_c(&self, bytes: &[u8]) -> Vec<u8> {
        if !self.fortran_order {
            return bytes.to_vec();
        }
        let size = self.number().map_or(1, Number::size);
        let sides: Vec<usize> = self.shape.iter().map(|&side| index(side)).collect();
        let count = bytes.len() / size;
        let mut ordered = Vec::with_capacity(bytes.len());
        for element in 0..count {
            let (mut rest, mut step, mut place) = (element, count, 0);
            for side in sides.iter().rev() {
                step /= side;
                place += rest % side * step;
                rest /= side;
            }
            ordered.extend_from_slice(&bytes[place * size..][..size]);
        }
        ordered
    }

    /// The shape in words, shortened.
    pub(crate) fn shape_in_words(&self) -> String {
        let axes: Vec<String> = self.shape.iter().take(8).map(u64::to_string).collect();
        format!("({})", axes.join(", "))
    }
}

/// A literal of Python, such as the text of a header, as JSON: tuples become lists, and commas after the last element
/// of something are left out.
fn as_json(python: &str) -> String {
    let mut json = String::with_capacity(python.len());
    let mut quote = None;
    for sign in python.chars() {
        match (quote, sign) {
            (Some(own), _) if own == sign => {
                quote = None;
                json.push('"');
            }
            (Some(_), '"') => json.push_str("\\\""),
            (Some(_), _) => json.push(sign),
            (None, '\'' | '"') => {
                quote = Some(sign);
                json.push('"');
            }
            (None, ')' | ']' | '}') => {
                json.truncate(json.strip_suffix(',').map_or(json.len(), str::len));
                json.push(if sign == ')' { ']' } else { sign });
            }
            (None, '(') => json.push('['),
            (None, _) if sign.is_whitespace() => {}
            // True and False.
            (None, _) => json.push(sign.to_ascii_lowercase()),
        }
    }
    json
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_header_has_each_key_once_and_commas_between_them() {
        let parsed = |text: &str| serde_json::from_str::<Header>(&as_json(text)).ok();
        let whole = Header {
            descr: Elements::Code("<f8".to_owned()),
            fortran_order: false,
            shape: vec![2, 3],
        };
        for text in [
            "{'descr': '<f8', 'fortran_order': False, 'shape': (2, 3), }",
            "{\"shape\":(2,3,),\"fortran_order\":False,\"descr\":\"<f8\"}",
        ] {
            assert_eq!(parsed(text).as_ref(), Some(&whole), "{text}");
        }
        for text in [
            "{'descr': '<f8' 'fortran_order': False, 'shape': (2, 3), }",
            "{'descr': '<f8', 'fortran_order': False, 'shape': (2, 3), 'shape': (3, 2)}",
            "{'descr': '<f8', 'descr': '<f8', 'fortran_order': False, 'shape': (2, 3)}",
            "{'descr': '<f8', 'fortran_order': False}",
            "{'descr': '<f8', 'fortran_order': 0, 'shape': (2, 3)}",
            "{'descr': '<f8', 'fortran_order': False, 'shape': (2, 3), 'more': ''}",
            "{'descr': '<f8', 'fortran_order': False, 'shape': (2, -3)}",
            "{'descr': '<f8', 'fortran_order': False, 'shape': (2,, )}",
        ] {
            assert_eq!(parsed(text), None, "{text}");
        }
    }

    #[test]
    fn records_have_fields_of_any_type() {
        let text = "{'descr': [('Time (\"s\")', '<M8[ns]'), ('name', '<U5'), ('', '|V4'), \
                    ('values', '>f4', (4, 5))], 'fortran_order': False, 'shape': (6,), }";
        let header: Header = serde_json::from_str(&as_json(text)).expect("a header");
        let Elements::Record(fields) = header.descr else {
            panic!("no records");
        };
        assert_eq!(fields[0].name, "Time (\"s\")");
        let bytes: Vec<_> = fields.iter().map(Field::bytes).collect();
        assert_eq!(bytes, [8, 20, 4, 80].map(Some));
        let object = Field {
            name: String::new(),
            code: "|O".to_owned(),
            sides: Vec::new(),
        };
        assert_eq!(object.bytes(), None);
    }
}
