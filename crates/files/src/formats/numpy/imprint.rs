//! An imprint as a numpy array (`numpy.load`): rows × columns, true for an active taxel.
//!
//! An array of `bool` is written. Arrays of two axes and any real numbers are read if their values are 0, 1 and 255.

use taxel_core::imprint::Imprint;
use taxel_core::parameter::number::counted;
use taxel_core::quote::shortened;
use taxel_core::sensor::MatrixSize;

use crate::error::ReadError;
use crate::formats::imprint_file::is_active;
use crate::formats::numpy::{self, Header, Number};

pub(in crate::formats) fn read(mut bytes: &[u8]) -> Result<Imprint, ReadError> {
    let header = Header::read(&mut bytes)?;
    let number = header.number().ok_or_else(|| {
        let found = match header.code() {
            "" => "records".to_owned(),
            code => shortened(code),
        };
        ReadError::new(format!(
            "type {found:?}, expected bool, whole numbers or floats"
        ))
    })?;
    let size = match header.shape[..] {
        [rows, columns] => MatrixSize::of_sides(columns, rows),
        _ => None,
    };
    let size = size.ok_or_else(|| {
        let shape = header.shape_in_words();
        ReadError::new(format!(
            "shape {shape}, expected rows and columns, 1 to 64 each"
        ))
    })?;
    let expected = size.cells() * number.size();
    if bytes.len() != expected {
        let found = counted(bytes.len() as u64, "byte");
        return Err(ReadError::new(format!(
            "found {found} of numbers, expected {expected}"
        )));
    }
    let mut imprint = Imprint::empty(size);
    let places =
        (0..size.rows()).flat_map(|row| (0..size.columns()).map(move |column| (row, column)));
    for ((row, column), value) in places.zip(number.values(&header.in_order_of_c(bytes))) {
        let active = is_active(value).ok_or_else(|| {
            let place = format!("row {}, column {}", row + 1, column + 1);
            ReadError::new(format!("{place}: found {value}, expected 0, 1 or 255"))
        })?;
        imprint.set(column, row, active);
    }
    Ok(imprint)
}

pub(in crate::formats) fn write(imprint: &Imprint) -> Vec<u8> {
    let shape = [imprint.rows(), imprint.columns()].map(u64::from);
    let mut file = numpy::header(Number::BOOL, &shape);
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
            numpy::MAGIC,
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
            ("<i2", vec![255, 0, 0, 0, 255, 0]),
            // 1, a negative zero and 1 in halves.
            ("<f2", vec![0x00, 0x3c, 0x00, 0x80, 0x00, 0x3c]),
            (">f2", vec![0x5b, 0xf8, 0x00, 0x00, 0x5b, 0xf8]),
            (
                "<f4",
                row([&255_f32.to_le_bytes(), &[0; 4], &255_f32.to_le_bytes()]),
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
            assert_eq!(
                read(bytes).map_err(|error| error.message),
                Err(message.to_owned())
            );
        };
        let small =
            |code: &str, shape: &str, numbers: &[u8]| file(1, &header(code, false, shape), numbers);
        let version = "not a numpy array: expected a header of version 1 to 3";
        wrong(b"", version);
        wrong(&file(4, "{}", b""), version);
        for code in ["<U1", "<f16"] {
            let expected = format!("type {code:?}, expected bool, whole numbers or floats");
            wrong(&small(code, "(1, 1)", b"1"), &expected);
        }
        for shape in ["(3)", "(65, 1)", "(18446744073709551615, 1)"] {
            let expected = format!("shape {shape}, expected rows and columns, 1 to 64 each");
            wrong(&small("|b1", &shape.replace("(3)", "(3,)"), b""), &expected);
        }
        let short = "found 1 byte of numbers, expected 2";
        wrong(&small("|b1", "(1, 2)", b"\x01"), short);
        for (number, value) in [
            (&b"\x07\0"[..], "7"),
            // Infinity and NaN in halves.
            (b"\0\x7c", "inf"),
            (b"\0\x7e", "NaN"),
        ] {
            let code = if value == "7" { "<u2" } else { "<f2" };
            wrong(
                &small(code, "(1, 1)", number),
                &format!("row 1, column 1: found {value}, expected 0, 1 or 255"),
            );
        }
    }
}
