//! Numbers in texts, read fast: most are whole and short.
//!
//! The results are bit for bit those of the standard library: a test compares them.

/// Powers of ten that are exact in f64.
const POWERS: [f64; 23] = [
    1e0, 1e1, 1e2, 1e3, 1e4, 1e5, 1e6, 1e7, 1e8, 1e9, 1e10, 1e11, 1e12, 1e13, 1e14, 1e15, 1e16,
    1e17, 1e18, 1e19, 1e20, 1e21, 1e22,
];

/// The most decimal digits of which every number fits into the 53 bits of a float.
const EXACT_DIGITS: usize = 15;

/// Reads a finite decimal without blanks around it, such as `12`, `-0.5` or `+1e-3`; None for anything else.
///
/// A number of at most 15 digits is the quotient of two exact floats, and thus rounded correctly; other numbers are
/// left to the standard library.
pub(in crate::formats::recording) fn read(text: &[u8]) -> Option<f64> {
    let (negative, digits) = match text {
        [b'-', rest @ ..] => (true, rest),
        [b'+', rest @ ..] => (false, rest),
        _ => (false, text),
    };
    if digits.len() > EXACT_DIGITS + 1 {
        return slow(text);
    }
    let (mut whole, mut count, mut decimals, mut point) = (0_u64, 0_usize, 0_usize, false);
    for &byte in digits {
        match byte {
            b'0'..=b'9' => {
                whole = whole * 10 + u64::from(byte - b'0');
                count += 1;
                decimals += usize::from(point);
            }
            b'.' if !point => point = true,
            _ => return slow(text),
        }
    }
    if count == 0 || count > EXACT_DIGITS {
        return slow(text);
    }
    #[expect(clippy::cast_precision_loss, reason = "15 digits are exact")]
    let value = whole as f64 / POWERS[decimals];
    Some(if negative { -value } else { value })
}

/// Reads a number with the standard library, which rounds any number of digits correctly.
fn slow(text: &[u8]) -> Option<f64> {
    // The standard library also accepts words: inf, nan, infinity.
    let is_number = text
        .iter()
        .all(|byte| matches!(byte, b'0'..=b'9' | b'+' | b'-' | b'.' | b'e' | b'E'));
    let value: f64 = str::from_utf8(text)
        .ok()
        .filter(|_| is_number)?
        .parse()
        .ok()?;
    value.is_finite().then_some(value)
}

/// Converts a number without a fraction, as labels are; None for any other, and beyond the whole numbers that a float
/// holds exactly.
#[expect(clippy::cast_possible_truncation, reason = "checked")]
pub(in crate::formats::recording) fn whole(value: f64) -> Option<i64> {
    (value.fract() == 0.0 && value.abs() < 9e15).then_some(value as i64)
}

#[cfg(test)]
mod tests {
    use super::read;

    #[test]
    fn numbers_are_read_as_the_standard_library_reads_them() {
        for text in [
            "0",
            "-0",
            "7",
            "+7",
            "007",
            "1.5",
            "-1.50",
            ".5",
            "5.",
            "1e3",
            "-2.5E-7",
            "123456789012345",
            "1234567890123456",
            "0.1",
            "2674.44",
            "9007199254740993",
            "0.30000000000000004",
            "1e300",
            "179769313486231570000000000000000000000",
        ] {
            let expected: f64 = text.parse().expect("a number");
            let found = read(text.as_bytes()).expect(text);
            assert_eq!(found.to_bits(), expected.to_bits(), "{text}");
        }
        for text in [
            "", "-", ".", "+.", "e", "1e", "1e999", "inf", "nan", "NaN", "1,5", "1 2", "0x10",
            "--1", "1.2.3", "infinity",
        ] {
            assert_eq!(read(text.as_bytes()), None, "{text}");
        }
    }
}
