//! The numbers of a line, read as fast as a sensor may send them.

use crate::formats::recording::number;
use crate::frame::LARGEST_VALUE;

/// More digits than these are left to the general reader.
const FAST_DIGITS: usize = 9;

/// Spaces, tabs, commas, semicolons, and the carriage return before a line's end.
fn is_separator(byte: u8) -> bool {
    matches!(byte, b' ' | b'\t' | b',' | b'\r' | b';')
}

/// Adds the numbers of a line, parted by spaces, tabs, commas or semicolons; `nan` stands for no cell. None if there is
/// anything else, or more than `most`.
pub(super) fn read(line: &[u8], values: &mut Vec<f64>, most: usize) -> Option<()> {
    let mut at = 0;
    let mut count = 0;
    loop {
        while line.get(at).is_some_and(|&byte| is_separator(byte)) {
            at += 1;
        }
        let start = at;
        let mut whole = 0_u32;
        while let Some(digit) = line.get(at).map(|byte| byte.wrapping_sub(b'0')) {
            if digit > 9 || at - start == FAST_DIGITS {
                break;
            }
            whole = whole * 10 + u32::from(digit);
            at += 1;
        }
        let ended = line.get(at).is_none_or(|&byte| is_separator(byte));
        if ended && at == start {
            return Some(());
        }
        count += 1;
        if count > most {
            return None;
        }
        if ended {
            values.push(f64::from(whole));
            continue;
        }
        while line.get(at).is_some_and(|&byte| !is_separator(byte)) {
            at += 1;
        }
        let word = &line[start..at];
        let value = match number::read(word) {
            None if word.eq_ignore_ascii_case(b"nan") => f64::NAN,
            value => value.filter(|value| value.abs() <= LARGEST_VALUE)?,
        };
        values.push(value);
    }
}

#[cfg(test)]
mod tests {
    use super::read;

    #[test]
    fn numbers_of_all_kinds_are_read() {
        let mut values = Vec::new();
        let line = b" 12, 7\t-3.5 0 1234567890123 1e3,5;6\r";
        assert_eq!(read(line, &mut values, 9), Some(()));
        assert_eq!(
            values,
            [12.0, 7.0, -3.5, 0.0, 1_234_567_890_123.0, 1000.0, 5.0, 6.0]
        );
        for line in [&b"1 2x"[..], b"x", b"1 2 3", b"1e999", b"--1"] {
            values.clear();
            assert_eq!(read(line, &mut values, 2), None, "{line:?}");
        }
        values.clear();
        assert_eq!(read(b"nan", &mut values, 1), Some(()));
        assert!(values[0].is_nan());
    }
}
