//! An imprint as a portable bitmap of bits (`P4`), black for an active taxel.
//!
//! Source: <https://netpbm.sourceforge.net/doc/pbm.html>. A comment runs from `#` to the end of its line. A file holds
//! one bitmap, of at most 64 × 64. Padding bits in the last byte of a row do not count.

use taxel_core::imprint::Imprint;
use taxel_core::sensor::MatrixSize;

use crate::error::ReadError;

pub(super) fn begins(bytes: &[u8]) -> bool {
    bytes.starts_with(b"P4")
}

pub(super) fn read(bytes: &[u8]) -> Result<Imprint, ReadError> {
    let wrong = |message: &str| ReadError::new(message).of_key("PBM");
    let mut rest = &bytes[2..];
    let sides = number(&mut rest).zip(number(&mut rest));
    let size = sides.and_then(|(columns, rows)| MatrixSize::of_sides(columns, rows));
    let size = size.ok_or_else(|| wrong("expected a width and a height, 1 to 64 each"))?;
    let width = usize::from(size.columns()).div_ceil(8);
    let length = width * usize::from(size.rows());
    // One blank separates the height from the bits, which may look like blanks.
    let bits = match rest {
        [blank, bits @ ..] if blank.is_ascii_whitespace() => bits.split_at_checked(length),
        _ => None,
    };
    let (bits, after) = bits.ok_or_else(|| wrong(&format!("expected {length} bytes of bits")))?;
    if !after_blanks(after).is_empty() {
        return Err(wrong("expected one image and no more"));
    }
    let mut imprint = Imprint::empty(size);
    for (row, bytes) in bits.chunks(width).enumerate() {
        // The leftmost taxel is a byte's highest bit, and a word's lowest.
        let word = bytes.iter().rev().fold(0, |word: u64, byte| {
            word << 8 | u64::from(byte.reverse_bits())
        });
        imprint.set_word(row, word);
    }
    Ok(imprint)
}

/// Takes a number, which blanks or comments separate from what is before it.
fn number(rest: &mut &[u8]) -> Option<u32> {
    let text = after_blanks(rest);
    let is_apart = text.len() < rest.len();
    let end = text.iter().position(|byte| !byte.is_ascii_digit());
    let (digits, after) = text.split_at(end.unwrap_or(text.len()));
    *rest = after;
    let number = str::from_utf8(digits).ok()?.parse().ok();
    number.filter(|_| is_apart)
}

/// Skips blanks and comments.
fn after_blanks(bytes: &[u8]) -> &[u8] {
    let mut rest = bytes.trim_ascii_start();
    while rest.starts_with(b"#") {
        let end = rest.iter().position(|byte| matches!(byte, b'\n' | b'\r'));
        rest = rest[end.unwrap_or(rest.len())..].trim_ascii_start();
    }
    rest
}

pub(super) fn write(imprint: &Imprint) -> Vec<u8> {
    let mut bytes = format!("P4\n{} {}\n", imprint.columns(), imprint.rows()).into_bytes();
    let width = usize::from(imprint.columns()).div_ceil(8);
    for word in imprint.words() {
        let row = word.to_le_bytes();
        bytes.extend(row[..width].iter().map(|byte| byte.reverse_bits()));
    }
    bytes
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn bits_that_look_like_blanks_count_and_padding_does_not() {
        let spaces = read(b"P4 8 2\n\n ").expect("0x0a and 0x20 are rows");
        assert_eq!(spaces.to_string(), "....#.#.\n..#.....");
        let filled = read(b"P4\n1 1\n\xff").expect("seven bits fill the byte up");
        assert_eq!((filled.columns(), filled.count()), (1, 1));
    }

    #[test]
    fn comments_may_stand_between_the_numbers() {
        let read = read(b"P4#a\n# b\n2#c\n#d\n 2\n\x80\x40").map(|cup| cup.to_string());
        assert_eq!(read, Ok("#.\n.#".to_owned()));
    }

    #[test]
    fn a_bitmap_that_is_cut_or_followed_by_more_is_refused() {
        for bytes in [
            &b"P4"[..],
            // Not "P4" and 11 columns: the number is not separated from the "P4".
            b"P411 1 1",
            b"P4\n65 1\n",
            b"P4\n1 # no height\n",
            b"P4\n8 1X\xff",
            b"P4\n8 1#\xff",
            b"P4\n9 2\n\xff\xff\xff",
            b"P4\n9 2",
            b"P4\n8 1\n\xff\xff",
        ] {
            assert!(read(bytes).is_err(), "{bytes:?}");
        }
    }
}
