//! An imprint as a portable bitmap: plain (`P1`, digits) or raw (`P4`, bits), black for an active taxel.
//!
//! Source: <https://netpbm.sourceforge.net/doc/pbm.html>. A comment runs from `#` to the end of its line; the digits
//! of a plain bitmap need no spaces between them. A file holds one bitmap, of at most 64 × 64. Padding bits in the
//! last byte of a row do not count. In errors, lines and columns count from 1; a column is a byte.
//!
//! Grey images of two shades (`P2`, `P5`) are read, too: [`read`] says which shade is active.

mod cursor;

mod error;

mod pgm;

use crate::formats::pbm::cursor::Cursor;
use crate::imprint::Imprint;
use crate::sensor::MatrixSize;

pub use crate::formats::pbm::error::PbmError;

/// Reads a bitmap, or a grey image of two shades, from any bytes.
///
/// In a bitmap, black is active. In a grey image, the brighter of the two shades is active, as in the masks of other
/// programs; an image that is all black is empty, and one that is all of the brightest shade is full.
///
/// # Errors
/// Returns the first error and its place.
///
/// ```
/// use taxel_files::formats::pbm::{plain, raw, read};
/// let cup = read(b"P1 # a cup\n3 2\n101\n1 1 1\n")?;
/// assert_eq!(cup.to_string(), "#.#\n###");
/// assert_eq!(plain(&cup), "P1\n3 2\n101\n111\n");
/// assert_eq!(raw(&cup), b"P4\n3 2\n\xa0\xe0");
/// assert_eq!(read(&raw(&cup))?, cup);
/// assert_eq!(read(b"P2 3 2 255  255 0 255  255 255 255")?, cup);
/// # Ok::<(), taxel_files::formats::pbm::PbmError>(())
/// ```
pub fn read(bytes: &[u8]) -> Result<Imprint, PbmError> {
    let raw = match bytes.get(..2) {
        Some(b"P1" | b"P2") => false,
        Some(b"P4" | b"P5") => true,
        _ => return Err(PbmError::Magic),
    };
    let grey = matches!(bytes.get(1), Some(b'2' | b'5'));
    let mut cursor = Cursor { bytes, at: 2 };
    let one_row = cursor.side("width", |columns| MatrixSize::of_sides(columns, 1))?;
    let size = cursor.side("height", |rows| {
        MatrixSize::of_sides(one_row.columns(), rows)
    })?;
    let mut imprint = Imprint::empty(size);
    let end = if grey {
        pgm::shades(&mut cursor, raw, &mut imprint)?
    } else if raw {
        cursor.bits(&mut imprint)?
    } else {
        cursor.digits(&mut imprint)?
    };
    // A line end after the last row is not a second bitmap.
    match bytes[end..].trim_ascii().len() {
        0 => Ok(imprint),
        found => Err(PbmError::Long { found }),
    }
}

/// Returns the plain bitmap, one line per row.
pub fn plain(imprint: &Imprint) -> String {
    let mut text = format!("P1\n{} {}\n", imprint.columns(), imprint.rows());
    for row in 0..imprint.rows() {
        let digit = |column| if imprint.get(column, row) { '1' } else { '0' };
        text.extend((0..imprint.columns()).map(digit));
        text.push('\n');
    }
    text
}

/// Returns the raw bitmap.
pub fn raw(imprint: &Imprint) -> Vec<u8> {
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
    fn errors_name_their_place() {
        let outcome = |bytes: &[u8]| read(bytes).map_err(|error| error.to_string());
        let wrong =
            |bytes: &[u8], message: &str| assert_eq!(outcome(bytes), Err(message.to_owned()));
        wrong(b"", "expected P1, P4, P2 or P5 at the start");
        wrong(
            b"P6\n1 1\n255\n\0\0\0",
            "expected P1, P4, P2 or P5 at the start",
        );
        wrong(b"P1", "line 1, column 3: expected the width, 1 to 64");
        // Not "P1" and 11 columns: the number is not separated from the "P1".
        wrong(b"P111 1 1", "line 1, column 3: expected the width, 1 to 64");
        wrong(
            b"P1\n65 1\n",
            "line 2, column 1: expected the width, 1 to 64",
        );
        wrong(
            b"P1\n1 # no height\n",
            "line 3, column 1: expected the height, 1 to 64",
        );
        wrong(
            b"P4\n1 0\n",
            "line 2, column 3: expected the height, 1 to 64",
        );
        wrong(
            b"P1\n2 2\n1\n0 2",
            "line 4, column 3: found byte 0x32, expected 0 or 1",
        );
        wrong(
            b"P4\n8 1X\xff",
            "line 2, column 3: expected the height, 1 to 64",
        );
        wrong(
            b"P4\n8 1#\xff",
            "line 2, column 4: expected one space or line end before the bits",
        );
        wrong(b"P1\n2 2\n111", "taxels: found 3, expected 4");
        wrong(
            b"P4\n9 2\n\xff\xff\xff",
            "bytes of taxels: found 3, expected 4",
        );
        wrong(b"P4\n9 2", "bytes of taxels: found 0, expected 4");
        wrong(
            b"P4\n8 1\n\xffP4",
            "found 2 bytes after the image, expected one image and no more",
        );
        wrong(
            b"P1\n1 1\n1 # one\n1",
            "found 1 byte after the image, expected one image and no more",
        );
    }

    #[test]
    fn bits_that_look_like_spaces_count_and_padding_does_not() {
        let spaces = read(b"P4 8 2\n\n ").expect("0x0a and 0x20 are rows");
        assert_eq!(spaces.to_string(), "....#.#.\n..#.....");
        let filled = read(b"P4\n1 1\n\xff").expect("seven bits fill the byte up");
        assert_eq!((filled.columns(), filled.count()), (1, 1));
    }

    #[test]
    fn comments_may_stand_anywhere_in_a_plain_bitmap() {
        let text = b"P1#a\n# b\n2#c\n#d\n 2 #e\n1#f\n0 01# g\n# h\n";
        assert_eq!(
            read(text).map(|cup| cup.to_string()),
            Ok("#.\n.#".to_owned())
        );
    }
}
