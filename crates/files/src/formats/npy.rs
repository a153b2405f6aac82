//! Arrays in numpy's file format: a header and the numbers, little-endian, the last axis fastest.
//!
//! Source: <https://numpy.org/doc/stable/reference/generated/numpy.lib.format.html>. Headers are written in
//! version 1.0. Headers of any type and shape are read, in versions 1 to 3, and real numbers of any size in either byte
//! order.

use std::fmt::Write;

pub(super) const MAGIC: &[u8] = b"\x93NUMPY";
const VERSION: &[u8] = &[1, 0];
/// The number of bytes before the text of a header: the last two are its length.
pub(crate) const BEFORE_TEXT: usize = 10;
/// The numbers of an array begin at a multiple of this.
const ALIGNMENT: usize = 64;

/// The type of a number.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash)]
pub enum Dtype {
    /// `bool`, a byte each.
    Bool,
    /// `int8`.
    I8,
    /// `int16`.
    I16,
    /// `int32`.
    I32,
    /// `int64`.
    I64,
    /// `uint8`.
    U8,
    /// `uint16`.
    U16,
    /// `uint32`.
    U32,
    /// `uint64`.
    U64,
    /// `float16`.
    F16,
    /// `float32`.
    F32,
    /// `float64`.
    F64,
}

impl Dtype {
    const ALL: [Self; 12] = [
        Self::Bool,
        Self::I8,
        Self::I16,
        Self::I32,
        Self::I64,
        Self::U8,
        Self::U16,
        Self::U32,
        Self::U64,
        Self::F16,
        Self::F32,
        Self::F64,
    ];

    /// Returns the size of a number in bytes.
    pub const fn width(self) -> usize {
        match self {
            Self::Bool | Self::I8 | Self::U8 => 1,
            Self::I16 | Self::U16 | Self::F16 => 2,
            Self::I32 | Self::U32 | Self::F32 => 4,
            Self::I64 | Self::U64 | Self::F64 => 8,
        }
    }

    fn code(self) -> &'static str {
        match self {
            Self::Bool => "|b1",
            Self::I8 => "|i1",
            Self::I16 => "<i2",
            Self::I32 => "<i4",
            Self::I64 => "<i8",
            Self::U8 => "|u1",
            Self::U16 => "<u2",
            Self::U32 => "<u4",
            Self::U64 => "<u8",
            Self::F16 => "<f2",
            Self::F32 => "<f4",
            Self::F64 => "<f8",
        }
    }
}

/// The type of the numbers in a file that is read, from this program or another.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) struct NumberType {
    /// The type apart from the order of bytes.
    pub(super) dtype: Dtype,
    pub(super) big_endian: bool,
}

impl NumberType {
    /// Returns the type of a code such as `<f4`; None if it is unknown.
    pub(super) fn of(code: &str) -> Option<Self> {
        let (order, kind) = code.split_at_checked(1)?;
        let mut types = Dtype::ALL.into_iter();
        let dtype = types.find(|dtype| &dtype.code()[1..] == kind)?;
        matches!(order, "<" | ">" | "|" | "=").then_some(Self {
            dtype,
            big_endian: order == ">",
        })
    }

    pub(super) fn size(self) -> usize {
        self.dtype.width()
    }

    pub(super) fn word(self, bytes: &[u8]) -> u64 {
        let mut word = [0; 8];
        for (slot, byte) in word.iter_mut().zip(bytes) {
            *slot = *byte;
        }
        if self.big_endian {
            word[..self.size()].reverse();
        }
        u64::from_le_bytes(word)
    }

    /// Returns a whole number; None if the type is a float.
    pub(super) fn whole(self, bytes: &[u8]) -> Option<i128> {
        let word = self.word(bytes);
        let unused = 64 - 8 * self.size();
        match self.dtype {
            Dtype::I8 | Dtype::I16 | Dtype::I32 | Dtype::I64 => {
                Some(i128::from((word << unused).cast_signed() >> unused))
            }
            Dtype::F16 | Dtype::F32 | Dtype::F64 => None,
            _ => Some(i128::from(word)),
        }
    }

    /// Returns the number as a float; a whole number beyond 2^53 becomes the nearest float.
    #[expect(
        clippy::cast_precision_loss,
        clippy::cast_possible_truncation,
        reason = "beyond 2^53 the nearest float; halves and singles are cut to their width"
    )]
    pub(super) fn value(self, bytes: &[u8]) -> f64 {
        if let Some(whole) = self.whole(bytes) {
            return whole as f64;
        }
        let word = self.word(bytes);
        match self.dtype {
            Dtype::F16 => half(word as u16),
            Dtype::F32 => f32::from_bits(word as u32).into(),
            _ => f64::from_bits(word),
        }
    }

    pub(super) fn values(self, bytes: &[u8]) -> impl Iterator<Item = f64> {
        let numbers = bytes.chunks(self.size());
        numbers.map(move |number| self.value(number))
    }
}

/// Returns the value of a half-precision number, IEEE 754's binary16: a sign, five bits of exponent with a bias of
/// 15, and ten bits of fraction. With the smallest exponent there is no leading 1.
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

/// Returns the header of an array of that type and shape: all bytes before its numbers.
///
/// ```
/// use taxel_files::formats::npy::{Dtype, header};
/// let header = header(Dtype::U32, &[360, 100]);
/// assert!(header.starts_with(b"\x93NUMPY\x01\x00\x76\x00{'descr': '<u4', 'fortran_order': False, "));
/// assert_eq!((header.len(), header.last()), (128, Some(&b'\n')));
/// ```
pub fn header<const N: usize>(kind: Dtype, shape: &[u64; N]) -> Vec<u8> {
    // The length of the text takes two bytes; a side takes 22 characters at most.
    const { assert!(N <= 64, "numpy has no more axes") };
    let mut sides = String::new();
    for side in shape {
        // Cannot fail: a String takes everything.
        let _ = write!(sides, "{side}, ");
    }
    // A tuple of one element ends in a comma, a longer one does not.
    let sides = sides.trim_end();
    let sides = if shape.len() > 1 {
        sides.trim_end_matches(',')
    } else {
        sides
    };
    let code = kind.code();
    let text = format!("{{'descr': '{code}', 'fortran_order': False, 'shape': ({sides}), }}");
    let length = (BEFORE_TEXT + text.len() + 1).next_multiple_of(ALIGNMENT);
    header_of(&text, length)
}

/// Returns the header with this text: with spaces behind it, so that it has `length` bytes.
pub(crate) fn header_of(text: &str, length: usize) -> Vec<u8> {
    let width = length.saturating_sub(BEFORE_TEXT + 1);
    let text = format!("{text:<width$}\n");
    let length = &text.len().to_le_bytes()[..2];
    [MAGIC, VERSION, length, text.as_bytes()].concat()
}

/// The header of a file: the type and the arrangement of its numbers.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct Header {
    /// The type of the numbers as numpy writes it, such as `<f8`; for records, the list of their fields, in its
    /// brackets.
    pub code: String,
    /// Whether the first axis is the fastest.
    pub fortran_order: bool,
    /// The lengths of the axes.
    pub shape: Vec<u64>,
}

/// Splits a file into its header and the numbers behind it; None if it is not an array.
///
/// ```
/// use taxel_files::formats::npy::{Dtype, header, parse};
/// let file = [header(Dtype::U8, &[1, 2]), vec![7, 8]].concat();
/// let (header, numbers) = parse(&file).expect("just written");
/// assert_eq!((header.code.as_str(), &header.shape[..], numbers), ("|u1", &[1, 2][..], &[7, 8][..]));
/// ```
pub fn parse(file: &[u8]) -> Option<(Header, &[u8])> {
    let rest = file.strip_prefix(MAGIC)?;
    let (length, rest) = match rest {
        [1, _, low, high, rest @ ..] => (usize::from(u16::from_le_bytes([*low, *high])), rest),
        [2 | 3, _, rest @ ..] => {
            let (length, rest) = rest.split_first_chunk::<4>()?;
            (usize::try_from(u32::from_le_bytes(*length)).ok()?, rest)
        }
        _ => return None,
    };
    let (text, numbers) = rest.split_at_checked(length)?;
    let text = str::from_utf8(text).ok()?.trim();
    Some((dictionary(text)?, numbers))
}

/// Parses the header's three entries in Python's notation, each once, in any order.
fn dictionary(text: &str) -> Option<Header> {
    let mut rest = text.strip_prefix('{')?.strip_suffix('}')?.trim();
    let (mut code, mut fortran_order, mut shape) = (None, None, None);
    while !rest.is_empty() {
        let (key, after) = quoted(rest)?;
        let after = after.trim_start().strip_prefix(':')?.trim_start();
        let fresh;
        (fresh, rest) = match key {
            "descr" => {
                let (text, after) = quoted(after).or_else(|| bracketed(after))?;
                (code.replace(text.to_owned()).is_none(), after)
            }
            "fortran_order" => {
                let (value, after) = match after.strip_prefix("True") {
                    Some(after) => (true, after),
                    None => (false, after.strip_prefix("False")?),
                };
                (fortran_order.replace(value).is_none(), after)
            }
            "shape" => {
                let (sides, after) = after.strip_prefix('(')?.split_once(')')?;
                (shape.replace(tuple(sides)?).is_none(), after)
            }
            _ => return None,
        };
        rest = rest.trim_start();
        // A comma may follow the last entry too.
        rest = match rest.strip_prefix(',') {
            Some(rest) => rest.trim_start(),
            None if rest.is_empty() => rest,
            None => return None,
        };
        if !fresh {
            return None;
        }
    }
    Some(Header {
        code: code?,
        fortran_order: fortran_order?,
        shape: shape?,
    })
}

/// Splits off a text in quotes of either kind, without escapes; returns it and what follows.
fn quoted(text: &str) -> Option<(&str, &str)> {
    let quote = text
        .chars()
        .next()
        .filter(|quote| matches!(quote, '\'' | '"'))?;
    let (inner, after) = text[1..].split_once(quote)?;
    (!inner.contains('\\')).then_some((inner, after))
}

/// Splits off a list in square brackets, with the brackets; returns it and what follows. Names of fields have no
/// brackets.
fn bracketed(text: &str) -> Option<(&str, &str)> {
    let end = text.starts_with('[').then(|| text.find(']'))??;
    Some(text.split_at(end + 1))
}

/// Parses the numbers between the brackets of a tuple; a comma may follow the last.
fn tuple(text: &str) -> Option<Vec<u64>> {
    let text = text.trim();
    let text = text.strip_suffix(',').unwrap_or(text);
    if text.is_empty() {
        return Some(Vec::new());
    }
    let sides = text.split(',').map(|side| side.trim().parse().ok());
    sides.collect()
}

/// Returns the numbers of a file whose header is like one of [`header`] with this type; None for any other file.
pub fn content(file: &[u8], kind: Dtype) -> Option<&[u8]> {
    let rest = file.strip_prefix(MAGIC)?.strip_prefix(VERSION)?;
    let (length, rest) = rest.split_first_chunk::<2>()?;
    let (text, numbers) = rest.split_at_checked(u16::from_le_bytes(*length).into())?;
    let expected = format!("{{'descr': '{}', 'fortran_order': False,", kind.code());
    text.starts_with(expected.as_bytes()).then_some(numbers)
}

/// Returns the numbers of such a file of `uint64`; None for any other file.
pub fn words(file: &[u8]) -> Option<Vec<u64>> {
    let chunks = content(file, Dtype::U64)?.chunks_exact(8);
    if !chunks.remainder().is_empty() {
        return None;
    }
    chunks
        .map(|chunk| Some(u64::from_le_bytes(chunk.try_into().ok()?)))
        .collect()
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_header_has_each_key_once_and_commas_between_them() {
        let parsed = |text: &str| dictionary(text).map(|header| (header.code, header.shape));
        let whole = Some(("<f8".to_owned(), vec![2, 3]));
        for text in [
            "{'descr': '<f8', 'fortran_order': False, 'shape': (2, 3), }",
            "{\"shape\":(2,3,),\"fortran_order\":False,\"descr\":\"<f8\"}",
        ] {
            assert_eq!(parsed(text), whole, "{text}");
        }
        for text in [
            "{'descr': '<f8' 'fortran_order': False, 'shape': (2, 3), }",
            "{'descr': '<f8', 'fortran_order': False, 'shape': (2, 3), 'shape': (3, 2)}",
            "{'descr': '<f8', 'descr': '<f8', 'fortran_order': False, 'shape': (2, 3)}",
            "{'descr': '<f8', 'fortran_order': False}",
            "{'descr': '<f8', 'fortran_order': 0, 'shape': (2, 3)}",
            "{'descr': '<f8', 'fortran_order': False, 'shape': (2, 3), 'more': ''}",
            "{'descr': '<f8', 'fortran_order': False, 'shape': (2, -3)}",
        ] {
            assert_eq!(parsed(text), None, "{text}");
        }
    }
}
