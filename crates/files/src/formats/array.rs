//! An imprint as a numpy array (`numpy.load`): rows × columns, true for an active taxel.
//!
//! An array of `bool` is written. Two-dimensional arrays of `bool`, whole numbers or floats (even of 16 bits) are
//! read, in either byte order and in C or Fortran order, if their values are 0 and one other number. The format's
//! versions 1 to 3 are read. For the source, see [`crate::formats::npy`].

use taxel_core::imprint::Imprint;
use taxel_core::parameter::number::counted;
use taxel_core::quote::shortened;
use taxel_core::sensor::MatrixSize;

use crate::formats::imprint_file::Mask;
use crate::formats::npy::{self, Dtype, NumberType};

/// The meaning of an array's numbers in an imprint, by their bits: no value has to be computed.
#[derive(Clone, Copy, Debug)]
struct TaxelType {
    number: NumberType,
    /// The bits of infinity, if the type is a float: numbers have smaller bits, apart from the sign, which is the
    /// highest bit.
    infinity: Option<u64>,
    /// The bits of 1, and of 255 if the type has it.
    active: [u64; 2],
}

impl TaxelType {
    fn of(code: &str) -> Option<Self> {
        let number = NumberType::of(code)?;
        let single = |number: f32| u64::from(number.to_bits());
        let (infinity, active) = match number.dtype {
            Dtype::F16 => (Some(0x7c00), [0x3c00, 0x5bf8]),
            Dtype::F32 => (Some(single(f32::INFINITY)), [single(1.0), single(255.0)]),
            Dtype::F64 => (
                Some(f64::INFINITY.to_bits()),
                [1_f64.to_bits(), 255_f64.to_bits()],
            ),
            Dtype::Bool | Dtype::I8 => (None, [1, 1]),
            _ => (None, [1, 255]),
        };
        Some(Self {
            number,
            infinity,
            active,
        })
    }

    /// Returns the bits of a number; None for 0, and an error if it is not finite.
    fn value(&self, bytes: &[u8]) -> Result<Option<u64>, ()> {
        let bits = self.number.word(bytes);
        let Some(infinity) = self.infinity else {
            return Ok((bits != 0).then_some(bits));
        };
        let magnitude = bits & !(1 << (8 * self.number.size() - 1));
        if magnitude >= infinity {
            return Err(());
        }
        Ok((magnitude != 0).then_some(bits))
    }
}

pub(super) fn read(bytes: &[u8]) -> Result<Imprint, String> {
    let header = "not a numpy array: expected a header of version 1 to 3";
    let (header, numbers) = npy::parse(bytes).ok_or(header)?;
    let kind = TaxelType::of(&header.code).ok_or_else(|| {
        let found = shortened(&header.code);
        format!("type {found:?}, expected bool, whole numbers or floats")
    })?;
    let size = match &header.shape[..] {
        [rows, columns] => MatrixSize::of_sides(*columns, *rows),
        _ => None,
    };
    let size = size.ok_or_else(|| {
        let sides = header.shape.iter().take(8).map(ToString::to_string);
        let sides = sides.collect::<Vec<_>>().join(", ");
        format!("shape ({sides}), expected rows and columns, 1 to 64 each")
    })?;
    let width = kind.number.size();
    let expected = size.cells() * width;
    if numbers.len() != expected {
        let found = counted(numbers.len() as u64, "byte");
        return Err(format!("found {found} of numbers, expected {expected}"));
    }
    let mut imprint = Imprint::empty(size);
    let mut mask = Mask::new();
    let (slow, fast) = if header.fortran_order {
        (size.columns(), size.rows())
    } else {
        (size.rows(), size.columns())
    };
    let taxels = (0..slow).flat_map(|outer| (0..fast).map(move |inner| (outer, inner)));
    for ((outer, inner), bytes) in taxels.zip(numbers.chunks(width)) {
        let (column, row) = if header.fortran_order {
            (outer, inner)
        } else {
            (inner, outer)
        };
        let Ok(Ok(active)) = kind.value(bytes).map(|number| mask.take(number)) else {
            return Err(format!(
                "row {}, column {}: expected 0, or the one other value of active taxels",
                row + 1,
                column + 1
            ));
        };
        imprint.set(column, row, active);
    }
    if mask.unclear(&kind.active).is_some() {
        let message = "one value everywhere, expected 0, 1 or 255, or two of which one is 0";
        return Err(message.to_owned());
    }
    Ok(imprint)
}

pub(super) fn write(imprint: &Imprint) -> Vec<u8> {
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
            npy::MAGIC,
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
            ("|u1", vec![255, 0, 255]),
            ("<i2", vec![255, 255, 0, 0, 255, 255]),
            // 1, a negative zero and 1 in halves.
            ("<f2", vec![0x00, 0x3c, 0x00, 0x80, 0x00, 0x3c]),
            (">f2", vec![0x5b, 0xf8, 0x00, 0x00, 0x5b, 0xf8]),
            (
                "<f4",
                row([&0.5_f32.to_le_bytes(), &[0; 4], &0.5_f32.to_le_bytes()]),
            ),
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
    fn errors_say_what_is_wrong() {
        let wrong = |bytes: &[u8], message: &str| {
            assert_eq!(read(bytes), Err(message.to_owned()));
        };
        let small =
            |code: &str, shape: &str, numbers: &[u8]| file(1, &header(code, false, shape), numbers);
        wrong(
            b"",
            "not a numpy array: expected a header of version 1 to 3",
        );
        wrong(
            &file(4, "{}", b""),
            "not a numpy array: expected a header of version 1 to 3",
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
            "found 1 byte of numbers, expected 2",
        );
        let third = "expected 0, or the one other value of active taxels";
        wrong(
            &small("|u1", "(1, 2)", b"\x01\xff"),
            &format!("row 1, column 2: {third}"),
        );
        // Infinity and NaN.
        for high in [0x7c, 0xfc, 0x7e] {
            wrong(
                &small("<f2", "(1, 1)", &[0, high]),
                &format!("row 1, column 1: {third}"),
            );
        }
        wrong(
            &small("|u1", "(1, 2)", b"\x07\x07"),
            "one value everywhere, expected 0, 1 or 255, or two of which one is 0",
        );
        wrong(
            &small("<f16", "(1, 1)", &[0; 16]),
            "type \"<f16\", expected bool, whole numbers or floats",
        );
    }
}
