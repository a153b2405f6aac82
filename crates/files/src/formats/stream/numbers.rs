//! Reads the numbers of a line, fast enough for any sensor.

use crate::formats::recording::text::separator::{SEPARATORS, Separator, unquoted};

/// The most digits of a number that is read here; longer ones are left to the general reader.
const FAST_DIGITS: usize = 9;

/// Appends the numbers of a line to `values`. They are separated as in a table: by the first of [`SEPARATORS`] that
/// the line contains, with or without blanks, otherwise by blanks. With semicolons, a comma is the decimal sign.
/// Quotes around a number are ignored. An empty field and words such as `nan` mean that there is no cell; a separator
/// at the end of the line is ignored, as are tabs at both ends. Returns None if there is anything else, or more than
/// `most` numbers.
pub(super) fn read(line: &[u8], values: &mut Vec<f64>, most: usize) -> Option<()> {
    let mut marks = SEPARATORS.into_iter();
    let mark = marks.find(|mark| line.contains(mark)).unwrap_or(b'\t');
    let line = if mark == b'\t' {
        line.trim_ascii()
    } else {
        line
    };
    let is_separator = |byte: u8| byte == mark || matches!(byte, b' ' | b'\t' | b'\r');
    let first = values.len();
    let mut at = 0;
    loop {
        let mut marks = 0;
        while let Some(&byte) = line.get(at).filter(|byte| is_separator(**byte)) {
            marks += usize::from(byte == mark);
            at += 1;
        }
        let is_end = at == line.len();
        let empty = match values.len() > first {
            true => marks.saturating_sub(1),
            false if is_end => 0,
            false => marks,
        };
        let room = most - (values.len() - first);
        if empty + usize::from(!is_end) > room {
            return None;
        }
        values.extend(std::iter::repeat_n(f64::NAN, empty));
        if is_end {
            return Some(());
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
        if line.get(at).is_none_or(|&byte| is_separator(byte)) {
            values.push(f64::from(whole));
            continue;
        }
        while line.get(at).is_some_and(|&byte| !is_separator(byte)) {
            at += 1;
        }
        let field = unquoted(&line[start..at]);
        values.push(Separator::Byte(mark).value(field).cell()?);
    }
}

#[cfg(test)]
mod tests {
    use super::read;

    #[test]
    fn numbers_of_all_kinds_are_read() {
        let mut values = Vec::new();
        let line = b" 12, 7\t-3.5 0 1234567890123 1e3,5 6\r";
        assert_eq!(read(line, &mut values, 8), Some(()));
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

    #[test]
    fn with_semicolons_a_comma_is_the_decimal_sign_and_an_empty_field_is_not_a_cell() {
        for (line, expected) in [
            ("0,5;1,5", "[0.5, 1.5]"),
            ("1;2;", "[1.0, 2.0]"),
            ("1,,2", "[1.0, NaN, 2.0]"),
            (",1 , , 2,,", "[NaN, 1.0, NaN, 2.0, NaN]"),
            ("1 null\tNA none", "[1.0, NaN, NaN, NaN]"),
            ("1\t\t2", "[1.0, NaN, 2.0]"),
            ("\t1 \t 2  3\t\t\r", "[1.0, 2.0, 3.0]"),
            ("1,\t\t2", "[1.0, 2.0]"),
            ("#N/A 1 N/A -nan", "[NaN, 1.0, NaN, NaN]"),
            (" , ,, ", "[]"),
            ("\"1\",\"2.5\",\"\",3", "[1.0, 2.5, NaN, 3.0]"),
            ("\"1,5\";2", "[1.5, 2.0]"),
        ] {
            let mut values = Vec::new();
            assert_eq!(read(line.as_bytes(), &mut values, 5), Some(()), "{line}");
            assert_eq!(format!("{values:?}"), expected, "{line}");
        }
        // An item of a list.
        assert_eq!(read(b"- 12", &mut Vec::new(), 5), None);
        let mut values = vec![7.0];
        assert_eq!(read(b"1,,2", &mut values, 2), None);
    }
}
