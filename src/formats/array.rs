//! An imprint as an array of numpy (`numpy.load`): rows × columns, true for an active taxel.
//!
//! Written is `bool`. Read are two-dimensional arrays of `bool`, whole numbers or floats of either byte order, in C or
//! Fortran order, whose values are 0 and 1, of the format's versions 1 to 3. Source: that of [`crate::formats::npy`].

use std::fmt;

use crate::formats::npy;
use crate::formats::npy::Dtype;
use crate::imprint::Imprint;
use crate::quote::shortened;
use crate::sensor::MAX_SIDE;

/// Why bytes are no array of an imprint.
#[derive(Clone, Debug, PartialEq, Eq)]
#[non_exhaustive]
pub enum ArrayError {
    /// Not the start of an array's file, or its header is broken.
    Header,
    /// Numbers of another type.
    Type {
        /// As numpy writes it.
        found: String,
    },
    /// Another number of axes, or an axis too long.
    Shape {
        /// The lengths of the first axes.
        found: Vec<u64>,
    },
    /// More or fewer numbers than the header says.
    Length {
        /// How many there are.
        found: usize,
        /// How many there should be.
        expected: usize,
    },
    /// Something else than 0 or 1.
    Value {
        /// Counted from 1.
        row: u8,
        /// Counted from 1.
        column: u8,
    },
}

impl fmt::Display for ArrayError {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        match self {
            Self::Header => f.write_str("no header of a numpy array, version 1 to 3"),
            Self::Type { found } => {
                write!(f, "type {found:?}, expected bool, whole numbers or floats")
            }
            Self::Shape { found } => write!(
                f,
                "shape ({}), expected rows and columns, 1 to 64 each",
                sides(found)
            ),
            Self::Length { found, expected } => {
                write!(f, "found {found} bytes of numbers, expected {expected}")
            }
            Self::Value { row, column } => write!(f, "row {row}, column {column}: expected 0 or 1"),
        }
    }
}

impl std::error::Error for ArrayError {}

fn sides(found: &[u64]) -> String {
    let sides: Vec<String> = found.iter().map(ToString::to_string).collect();
    sides.join(", ")
}

/// What the numbers of an array are, and how to read one.
#[derive(Clone, Copy, Debug)]
struct Type {
    /// Bytes of a number.
    size: usize,
    /// The bytes of 1, as they stand in the file.
    one: [u8; 8],
    /// The bytes of a negative zero, where there is one.
    negative_zero: Option<[u8; 8]>,
}

impl Type {
    fn of(code: &str) -> Option<Self> {
        let mut letters = code.chars();
        let order = letters.next()?;
        let (kind, size) = match letters.as_str() {
            "b1" => ('b', 1),
            "f4" => ('f', 4),
            "f8" => ('f', 8),
            other => {
                let size = other.strip_prefix(['i', 'u'])?;
                (
                    'i',
                    ["1", "2", "4", "8"]
                        .iter()
                        .position(|own| *own == size)
                        .map(|n| 1 << n)?,
                )
            }
        };
        if !matches!(order, '<' | '>' | '|' | '=') {
            return None;
        }
        let bytes = |number: u64| {
            // The number's own bytes first, whatever comes after them.
            let mut bytes = number.to_le_bytes();
            if order == '>' {
                bytes[..size].reverse();
            }
            bytes
        };
        let (one, negative_zero) = match (kind, size) {
            ('f', 4) => (1_f32.to_bits().into(), Some((-0_f32).to_bits().into())),
            ('f', _) => (1_f64.to_bits(), Some((-0_f64).to_bits())),
            _ => (1, None),
        };
        Some(Self {
            size,
            one: bytes(one),
            negative_zero: negative_zero.map(bytes),
        })
    }

    /// Whether the bytes of a number stand for an active taxel; none of what is neither 0 nor 1.
    fn value(&self, bytes: &[u8]) -> Option<bool> {
        let is = |number: &[u8; 8]| bytes == &number[..self.size];
        let zero = is(&[0; 8]) || self.negative_zero.as_ref().is_some_and(is);
        (zero || is(&self.one)).then_some(!zero)
    }
}

/// Reads any bytes.
///
/// # Errors
/// What is wrong first, and where.
///
/// ```
/// use taxel::formats::array::{read, write};
/// use taxel::prelude::*;
/// let cup: Imprint = "#.#\n###".parse().unwrap();
/// let file = write(&cup);
/// assert!(file[10..].starts_with(b"{'descr': '|b1', 'fortran_order': False, 'shape': (2, 3), }"));
/// assert_eq!(read(&file), Ok(cup));
/// ```
pub fn read(bytes: &[u8]) -> Result<Imprint, ArrayError> {
    let (header, numbers) = npy::parse(bytes).ok_or(ArrayError::Header)?;
    let kind = Type::of(&header.code).ok_or_else(|| ArrayError::Type {
        found: shortened(&header.code),
    })?;
    let side = |length: &u64| u8::try_from(*length).ok();
    let side = |length: &u64| side(length).filter(|side| (1..=MAX_SIDE).contains(side));
    let (rows, columns) = match &header.shape[..] {
        [rows, columns] => side(rows).zip(side(columns)),
        _ => None,
    }
    .ok_or_else(|| ArrayError::Shape {
        found: header.shape.iter().copied().take(8).collect(),
    })?;
    let expected = usize::from(rows) * usize::from(columns) * kind.size;
    if numbers.len() != expected {
        let found = numbers.len();
        return Err(ArrayError::Length { found, expected });
    }
    let mut imprint = Imprint::empty(columns, rows);
    let (slow, fast) = if header.fortran_order {
        (columns, rows)
    } else {
        (rows, columns)
    };
    let taxels = (0..slow).flat_map(|outer| (0..fast).map(move |inner| (outer, inner)));
    for ((outer, inner), bytes) in taxels.zip(numbers.chunks(kind.size)) {
        let (column, row) = if header.fortran_order {
            (outer, inner)
        } else {
            (inner, outer)
        };
        let active = kind.value(bytes).ok_or(ArrayError::Value {
            row: row + 1,
            column: column + 1,
        })?;
        imprint.set(column, row, active);
    }
    Ok(imprint)
}

/// The file.
pub fn write(imprint: &Imprint) -> Vec<u8> {
    let shape = [imprint.rows(), imprint.columns()].map(u64::from);
    let mut file = npy::header(Dtype::Bool, &shape);
    for row in 0..imprint.rows() {
        file.extend((0..imprint.columns()).map(|column| u8::from(imprint.get(column, row))));
    }
    file
}

#[cfg(test)]
mod tests {
    use super::*;

    fn file(version: u8, text: &str, numbers: &[u8]) -> Vec<u8> {
        let length = u32::try_from(text.len()).expect("short").to_le_bytes();
        let length = if version == 1 { &length[..2] } else { &length };
        [
            b"\x93NUMPY",
            &[version, 0][..],
            length,
            text.as_bytes(),
            numbers,
        ]
        .concat()
    }

    fn header(code: &str, fortran: bool, shape: &str) -> String {
        let fortran = if fortran { "True" } else { "False" };
        format!("{{'descr': '{code}', 'fortran_order': {fortran}, 'shape': {shape}, }}\n")
    }

    #[test]
    fn every_type_and_order_is_read() {
        let row = |bytes: [&[u8]; 3]| bytes.concat();
        let one = 1_f32.to_le_bytes();
        for (code, numbers) in [
            ("|b1", vec![1, 0, 1]),
            ("|i1", vec![1, 0, 1]),
            ("<u2", vec![1, 0, 0, 0, 1, 0]),
            (">i2", vec![0, 1, 0, 0, 0, 1]),
            ("<f4", row([&one, &(-0_f32).to_le_bytes(), &one])),
            (
                ">f8",
                row([1_f64, 0.0, 1.0]
                    .map(f64::to_be_bytes)
                    .each_ref()
                    .map(|bytes| &bytes[..])),
            ),
            (
                "<i8",
                row([1_i64, 0, 1]
                    .map(i64::to_le_bytes)
                    .each_ref()
                    .map(|bytes| &bytes[..])),
            ),
        ] {
            for version in 1..=3 {
                let file = file(version, &header(code, false, "(1, 3)"), &numbers);
                assert_eq!(
                    read(&file).map(|cup| cup.to_string()),
                    Ok("#.#".to_owned()),
                    "{code}"
                );
            }
        }
        let columns = file(1, &header("|u1", true, "(2, 3)"), &[1, 1, 0, 1, 1, 1]);
        assert_eq!(
            read(&columns).map(|cup| cup.to_string()),
            Ok("#.#\n###".to_owned())
        );
    }

    #[test]
    fn what_is_wrong_is_told() {
        let wrong = |bytes: &[u8], message: &str| {
            let told = read(bytes).map_err(|error| error.to_string());
            assert_eq!(told, Err(message.to_owned()));
        };
        let small =
            |code: &str, shape: &str, numbers: &[u8]| file(1, &header(code, false, shape), numbers);
        wrong(b"", "no header of a numpy array, version 1 to 3");
        wrong(
            &file(4, "{}", b""),
            "no header of a numpy array, version 1 to 3",
        );
        wrong(
            &small("<U1", "(1, 1)", b"1"),
            "type \"<U1\", expected bool, whole numbers or floats",
        );
        wrong(
            &small("|b1", "(3,)", &[1, 0, 1]),
            "shape (3), expected rows and columns, 1 to 64 each",
        );
        wrong(
            &small("|b1", "(65, 1)", &[0; 65]),
            "shape (65, 1), expected rows and columns, 1 to 64 each",
        );
        wrong(
            &small("|b1", "(18446744073709551615, 1)", b""),
            "shape (18446744073709551615, 1), expected rows and columns, 1 to 64 each",
        );
        wrong(
            &small("|b1", "(1, 2)", b"\x01"),
            "found 1 bytes of numbers, expected 2",
        );
        wrong(
            &small("|u1", "(1, 2)", b"\x01\xff"),
            "row 1, column 2: expected 0 or 1",
        );
    }
}
