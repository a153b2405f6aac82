//! An imprint as a portable bitmap: plain (`P1`, digits) or raw (`P4`, bits), black for an active taxel.
//!
//! Source: <https://netpbm.sourceforge.net/doc/pbm.html>. A comment runs from `#` to the end of its line; the digits
//! of a plain bitmap need no spaces between them. A file holds one bitmap, of at most 64 × 64. Padding bits in the
//! last byte of a row do not count. In errors, a column is a byte.

use taxel_core::imprint::Imprint;
use taxel_core::parameter::number::counted;
use taxel_core::sensor::MatrixSize;

pub(super) fn read(bytes: &[u8]) -> Result<Imprint, String> {
    let raw = bytes.get(1) == Some(&b'4');
    let mut cursor = Cursor { bytes, at: 2 };
    let one_row = cursor.side("width", |columns| MatrixSize::of_sides(columns, 1))?;
    let size = cursor.side("height", |rows| {
        MatrixSize::of_sides(one_row.columns(), rows)
    })?;
    let mut imprint = Imprint::empty(size);
    let end = if raw {
        cursor.bits(&mut imprint)?
    } else {
        cursor.digits(&mut imprint)?
    };
    // A line end after the last row is not a second bitmap.
    match bytes[end..].trim_ascii().len() {
        0 => Ok(imprint),
        found => Err(format!(
            "found {} after the image, expected one image and no more",
            counted(found as u64, "byte")
        )),
    }
}

pub(super) fn plain(imprint: &Imprint) -> String {
    let mut text = format!("P1\n{} {}\n", imprint.columns(), imprint.rows());
    for row in 0..imprint.rows() {
        let digit = |column| if imprint.get(column, row) { '1' } else { '0' };
        text.extend((0..imprint.columns()).map(digit));
        text.push('\n');
    }
    text
}

pub(super) fn raw(imprint: &Imprint) -> Vec<u8> {
    let mut bytes = format!("P4\n{} {}\n", imprint.columns(), imprint.rows()).into_bytes();
    let width = usize::from(imprint.columns()).div_ceil(8);
    for word in imprint.words() {
        let row = word.to_le_bytes();
        bytes.extend(row[..width].iter().map(|byte| byte.reverse_bits()));
    }
    bytes
}

struct Cursor<'a> {
    bytes: &'a [u8],
    at: usize,
}

impl Cursor<'_> {
    /// The message about what is at an offset.
    fn wrong(&self, offset: usize, message: &str) -> String {
        let before = &self.bytes[..offset];
        let start = before.iter().rposition(|&byte| byte == b'\n');
        let line = before.split(|&byte| byte == b'\n').count();
        let column = offset - start.map_or(0, |start| start + 1) + 1;
        format!("line {line}, column {column}: {message}")
    }

    /// Skips spaces and comments, and returns the next byte.
    fn next(&mut self) -> Option<u8> {
        loop {
            match *self.bytes.get(self.at)? {
                b'#' => {
                    let rest = &self.bytes[self.at..];
                    let comment = rest.iter().position(|&byte| matches!(byte, b'\n' | b'\r'));
                    self.at += comment.unwrap_or(rest.len());
                }
                byte if byte.is_ascii_whitespace() => self.at += 1,
                byte => return Some(byte),
            }
        }
    }

    /// Reads a side, a number that is separated from what is before and after it; `size` makes the size of a matrix
    /// from it.
    fn side(
        &mut self,
        what: &str,
        size: impl Fn(u32) -> Option<MatrixSize>,
    ) -> Result<MatrixSize, String> {
        let before = self.at;
        let _ = self.next();
        let start = self.at;
        let digits = self.bytes[start..]
            .iter()
            .take_while(|byte| byte.is_ascii_digit())
            .count();
        let text = str::from_utf8(&self.bytes[start..start + digits]).ok();
        let number = text.and_then(|text| text.parse().ok());
        self.at += digits;
        let ends = match self.bytes.get(self.at) {
            Some(byte) => byte.is_ascii_whitespace() || *byte == b'#',
            None => true,
        };
        number
            .filter(|_| start > before && ends)
            .and_then(size)
            .ok_or_else(|| self.wrong(start, &format!("expected the {what}, 1 to 64")))
    }

    /// Reads a digit for each taxel; returns the offset after the last.
    fn digits(&mut self, imprint: &mut Imprint) -> Result<usize, String> {
        let expected = imprint.size().cells();
        let mut found = 0;
        for row in 0..imprint.rows() {
            for column in 0..imprint.columns() {
                let short = || format!("taxels: found {found}, expected {expected}");
                let active = match self.next().ok_or_else(short)? {
                    b'0' => false,
                    b'1' => true,
                    byte => {
                        let message = format!("found byte 0x{byte:02x}, expected 0 or 1");
                        return Err(self.wrong(self.at, &message));
                    }
                };
                imprint.set(column, row, active);
                found += 1;
                self.at += 1;
            }
        }
        // Comments after the last digit do not begin a second bitmap.
        let _ = self.next();
        Ok(self.at)
    }

    /// Reads bytes of eight taxels, where each row begins a new byte; returns the offset after the last.
    fn bits(&mut self, imprint: &mut Imprint) -> Result<usize, String> {
        // Exactly one space separates the height from the bits, which may look like spaces.
        if self.bytes.get(self.at) == Some(&b'#') {
            return Err(self.wrong(self.at, "expected one space or line end before the bits"));
        }
        let start = (self.at + 1).min(self.bytes.len());
        let width = usize::from(imprint.columns()).div_ceil(8);
        let expected = width * usize::from(imprint.rows());
        let bits = &self.bytes[start..];
        let bits = bits
            .get(..expected)
            .ok_or_else(|| format!("bytes of taxels: found {}, expected {expected}", bits.len()))?;
        for (row, bytes) in bits.chunks(width).enumerate() {
            // The leftmost taxel is a byte's highest bit, and a word's lowest.
            let word = bytes.iter().rev().fold(0, |word: u64, byte| {
                word << 8 | u64::from(byte.reverse_bits())
            });
            imprint.set_word(row, word);
        }
        Ok(start + expected)
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn errors_name_their_place() {
        for (bytes, message) in [
            (&b"P1"[..], "line 1, column 3: expected the width, 1 to 64"),
            // Not "P1" and 11 columns: the number is not separated from the "P1".
            (b"P111 1 1", "line 1, column 3: expected the width, 1 to 64"),
            (
                b"P1\n65 1\n",
                "line 2, column 1: expected the width, 1 to 64",
            ),
            (
                b"P1\n1 # no height\n",
                "line 3, column 1: expected the height, 1 to 64",
            ),
            (
                b"P1\n2 2\n1\n0 2",
                "line 4, column 3: found byte 0x32, expected 0 or 1",
            ),
            (
                b"P4\n8 1X\xff",
                "line 2, column 3: expected the height, 1 to 64",
            ),
            (
                b"P4\n8 1#\xff",
                "line 2, column 4: expected one space or line end before the bits",
            ),
            (b"P1\n2 2\n111", "taxels: found 3, expected 4"),
            (
                b"P4\n9 2\n\xff\xff\xff",
                "bytes of taxels: found 3, expected 4",
            ),
            (b"P4\n9 2", "bytes of taxels: found 0, expected 4"),
            (
                b"P1\n1 1\n1 # one\n1",
                "found 1 byte after the image, expected one image and no more",
            ),
        ] {
            assert_eq!(read(bytes), Err(message.to_owned()));
        }
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
