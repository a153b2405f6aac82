//! An imprint as a numpy array (`numpy.load`): rows × columns, true for an active taxel.
//!
//! An array of `bool` is written. Arrays of two axes and any real numbers are read if their values are 0, 1 and 255.

use std::io::Cursor;
use std::ops::ControlFlow;

use taxel_core::imprint::Imprint;
use taxel_core::sensor::MatrixSize;

use crate::error::ReadError;
use crate::formats::imprint_file::is_active;
use crate::formats::numpy::{self, Number};
use crate::formats::recording::{self, ReadOptions, RecordingEvent};

/// Reads an array as a recording of a single frame.
pub(in crate::formats) fn read(bytes: &[u8]) -> Result<Imprint, ReadError> {
    let (mut found, mut more) = (None, false);
    let options = ReadOptions::default();
    recording::read(Cursor::new(bytes), &options, &mut |event| {
        if let RecordingEvent::Frame(frame) = event {
            more = found.replace(frame.clone()).is_some();
        }
        if more {
            return ControlFlow::Break(());
        }
        ControlFlow::Continue(())
    })?;
    let frame = found.filter(|_| !more);
    let frame = frame.ok_or_else(|| ReadError::new("several frames, expected an imprint"))?;
    let size = MatrixSize::of_sides(frame.columns(), frame.rows()).ok_or_else(|| {
        let found = frame.size().in_words();
        ReadError::new(format!("{found}, expected 1 to 64 of each"))
    })?;
    let mut imprint = Imprint::empty(size);
    let places =
        (0..size.rows()).flat_map(|row| (0..size.columns()).map(move |column| (row, column)));
    for ((row, column), &value) in places.zip(frame.values()) {
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
        wrong(
            &small("|b1", "(65, 1)", &[0; 65]),
            "65 rows of 1, expected 1 to 64 of each",
        );
        wrong(
            &small("|b1", "(2, 1, 1)", &[0; 2]),
            "several frames, expected an imprint",
        );
        for (number, value) in [(&b"\x00\x47"[..], "7"), (b"\0\x7e", "NaN")] {
            let said = format!("row 1, column 1: found {value}, expected 0, 1 or 255");
            wrong(&small("<f2", "(1, 1)", number), &said);
        }
    }
}
