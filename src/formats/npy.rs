//! Arrays as numpy reads them: a header and the numbers, little-endian, the last axis fastest.
//!
//! Format version 1.0 of <https://numpy.org/doc/stable/reference/generated/numpy.lib.format.html>. Written are unsigned
//! whole numbers and `f64`; read are one-dimensional or flat arrays of the same.

use std::fmt::Write;

const MAGIC: &[u8] = b"\x93NUMPY\x01\x00";
/// The numbers of an array begin at a multiple of this.
const ALIGNMENT: usize = 64;

/// What an array is made of.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Kind {
    /// `uint8`.
    U8,
    /// `uint16`.
    U16,
    /// `uint32`.
    U32,
    /// `uint64`.
    U64,
    /// `float64`.
    F64,
}

impl Kind {
    fn code(self) -> &'static str {
        match self {
            Self::U8 => "|u1",
            Self::U16 => "<u2",
            Self::U32 => "<u4",
            Self::U64 => "<u8",
            Self::F64 => "<f8",
        }
    }
}

/// What stands before the numbers of an array of that shape.
///
/// ```
/// use taxel::formats::npy::{Kind, header};
/// let header = header(Kind::U32, &[360, 100]);
/// assert!(header.starts_with(b"\x93NUMPY\x01\x00\x76\x00{'descr': '<u4', 'fortran_order': False, 'shape': (360, 100), }"));
/// assert_eq!((header.len(), header.last()), (128, Some(&b'\n')));
/// ```
pub fn header(kind: Kind, shape: &[u64]) -> Vec<u8> {
    let mut sides = String::new();
    for side in shape {
        // Cannot fail: a String takes everything.
        let _ = write!(sides, "{side}, ");
    }
    // A tuple of one keeps its comma, one of several has none at its end.
    let sides = sides.trim_end();
    let sides = if shape.len() > 1 {
        sides.trim_end_matches(',')
    } else {
        sides
    };
    let code = kind.code();
    let mut text = format!("{{'descr': '{code}', 'fortran_order': False, 'shape': ({sides}), }}");
    let start = MAGIC.len() + 2;
    while !(start + text.len() + 1).is_multiple_of(ALIGNMENT) {
        text.push(' ');
    }
    text.push('\n');
    let mut header = MAGIC.to_vec();
    // Shapes of a few sides: far below the 65535 that fit.
    header.extend(u16::try_from(text.len()).unwrap_or(u16::MAX).to_le_bytes());
    header.extend(text.as_bytes());
    header
}

/// The numbers of a file that [`header`] could have begun, with its kind; none of anything else.
pub fn content(file: &[u8], kind: Kind) -> Option<&[u8]> {
    let rest = file.strip_prefix(MAGIC)?;
    let (length, rest) = rest.split_first_chunk::<2>()?;
    let (text, numbers) = rest.split_at_checked(u16::from_le_bytes(*length).into())?;
    let expected = format!("{{'descr': '{}', 'fortran_order': False,", kind.code());
    text.starts_with(expected.as_bytes()).then_some(numbers)
}

/// The same as whole numbers.
pub fn words(file: &[u8]) -> Option<Vec<u64>> {
    let chunks = content(file, Kind::U64)?.chunks_exact(8);
    if !chunks.remainder().is_empty() {
        return None;
    }
    chunks
        .map(|chunk| Some(u64::from_le_bytes(chunk.try_into().ok()?)))
        .collect()
}
