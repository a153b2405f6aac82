//! An imprint as a portable bitmap: plain (`P1`, digits) or raw (`P4`, bits), black for an active taxel.
//!
//! Source: <https://netpbm.sourceforge.net/doc/pbm.html>. A comment runs from `#` to the end of its line; the digits
//! of a plain bitmap need no spaces between them. A file holds one bitmap, of at most 64 × 64. Padding bits in the
//! last byte of a row do not count. In errors, lines and columns count from 1; a column is a byte.
//!
//! Grey images of two shades (`P2`, `P5`) are read, too: [`read`] says which shade is active.

mod pgm;

use std::fmt;

use crate::imprint::Imprint;
use crate::parameter::ParameterError;
use crate::parameter::number::counted;
use crate::sensor::MatrixSize;

/// The error for bytes that are not a bitmap, or not one of an imprint.
#[derive(Clone, Debug, PartialEq, Eq)]
#[non_exhaustive]
pub enum PbmError {
    /// Not one of the four kinds `P1`, `P2`, `P4` and `P5`.
    Magic,
    /// A width or height that is missing, or not from 1 to 64.
    Side {
        /// The line number.
        line: usize,
        /// The byte in the line.
        column: usize,
        /// `width` or `height`.
        what: &'static str,
    },
    /// A byte other than the digits 0 and 1.
    Digit {
        /// The line number.
        line: usize,
        /// The byte in the line.
        column: usize,
        /// The byte that was found.
        byte: u8,
    },
    /// A comment in place of the one space before the bits of a raw bitmap.
    Space {
        /// The line number.
        line: usize,
        /// The byte in the line.
        column: usize,
    },
    /// Too few taxels.
    Short {
        /// The number that was found.
        found: usize,
        /// The number that was expected.
        expected: usize,
        /// The unit of the numbers.
        unit: &'static str,
    },
    /// A brightest shade that is missing, or not from 1 to 65535.
    Maximum {
        /// The line number.
        line: usize,
        /// The byte in the line.
        column: usize,
    },
    /// A shade that is missing, or above the brightest.
    Shade {
        /// The line number.
        line: usize,
        /// The byte in the line.
        column: usize,
    },
    /// A third shade.
    Third {
        /// The row, from 1.
        row: u8,
        /// The column, from 1.
        column: u8,
    },
    /// All shades are equal, and neither black nor the brightest.
    Unclear,
    /// More bytes after the image.
    Long {
        /// The number of bytes.
        found: usize,
    },
}

impl fmt::Display for PbmError {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        match self {
            Self::Magic => f.write_str("expected P1, P4, P2 or P5 at the start"),
            Self::Side { line, column, what } => write!(
                f,
                "line {line}, column {column}: expected the {what}, 1 to 64"
            ),
            Self::Digit { line, column, byte } => write!(
                f,
                "line {line}, column {column}: found byte 0x{byte:02x}, expected 0 or 1"
            ),
            Self::Space { line, column } => write!(
                f,
                "line {line}, column {column}: expected one space or line end before the bits"
            ),
            Self::Short {
                found,
                expected,
                unit,
            } => write!(f, "{unit}: found {found}, expected {expected}"),
            Self::Maximum { line, column } => write!(
                f,
                "line {line}, column {column}: expected the brightest shade, 1 to 65535"
            ),
            Self::Shade { line, column } => write!(
                f,
                "line {line}, column {column}: expected a shade, 0 to the brightest"
            ),
            Self::Third { row, column } => write!(
                f,
                "row {row}, column {column}: a third shade, expected an image with two"
            ),
            Self::Unclear => f.write_str("one shade of grey everywhere, expected two"),
            Self::Long { found } => write!(
                f,
                "found {} after the image, expected one image and no more",
                counted(*found as u64, "byte")
            ),
        }
    }
}

impl std::error::Error for PbmError {}

/// Reads a bitmap, or a grey image of two shades, from any bytes.
///
/// In a bitmap, black is active. In a grey image, the brighter of the two shades is active, as in the masks of other
/// programs; an image that is all black is empty, and one that is all of the brightest shade is full.
///
/// # Errors
/// Returns the first error and its place.
///
/// ```
/// use taxel::formats::pbm::{plain, raw, read};
/// let cup = read(b"P1 # a cup\n3 2\n101\n1 1 1\n")?;
/// assert_eq!(cup.to_string(), "#.#\n###");
/// assert_eq!(plain(&cup), "P1\n3 2\n101\n111\n");
/// assert_eq!(raw(&cup), b"P4\n3 2\n\xa0\xe0");
/// assert_eq!(read(&raw(&cup))?, cup);
/// assert_eq!(read(b"P2 3 2 255  255 0 255  255 255 255")?, cup);
/// # Ok::<(), taxel::formats::pbm::PbmError>(())
/// ```
pub fn read(bytes: &[u8]) -> Result<Imprint, PbmError> {
    let raw = match bytes.get(..2) {
        Some(b"P1" | b"P2") => false,
        Some(b"P4" | b"P5") => true,
        _ => return Err(PbmError::Magic),
    };
    let grey = matches!(bytes.get(1), Some(b'2' | b'5'));
    let mut cursor = Cursor { bytes, at: 2 };
    let one_row = cursor.side("width", |columns| MatrixSize::new(columns, 1))?;
    let size = cursor.side("height", |rows| MatrixSize::new(one_row.columns(), rows))?;
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

/// A position in the bytes of a file.
pub(super) struct Cursor<'a> {
    pub(super) bytes: &'a [u8],
    pub(super) at: usize,
}

impl Cursor<'_> {
    /// Returns the line and column of the position.
    pub(super) fn line_and_column(&self) -> (usize, usize) {
        let before = &self.bytes[..self.at];
        let start = before.iter().rposition(|&byte| byte == b'\n');
        let line = before.split(|&byte| byte == b'\n').count();
        (line, self.at - start.map_or(0, |start| start + 1) + 1)
    }

    /// Skips spaces and comments, and returns the next byte.
    pub(super) fn next(&mut self) -> Option<u8> {
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

    /// Reads a side; `size` makes the size of a matrix from it.
    fn side(
        &mut self,
        what: &'static str,
        size: impl Fn(u8) -> Result<MatrixSize, ParameterError>,
    ) -> Result<MatrixSize, PbmError> {
        let (side, (line, column)) = self.number();
        let side = side.and_then(|side| u8::try_from(side).ok());
        side.and_then(|side| size(side).ok())
            .ok_or(PbmError::Side { line, column, what })
    }

    /// Reads a number that is separated from what is before and after it; returns it with its line and column.
    pub(super) fn number(&mut self) -> (Option<u32>, (usize, usize)) {
        let start = self.at;
        let _ = self.next();
        let place = self.line_and_column();
        let digits = self.bytes[self.at..]
            .iter()
            .take_while(|byte| byte.is_ascii_digit())
            .count();
        let text = str::from_utf8(&self.bytes[self.at..self.at + digits]).ok();
        let number = text.and_then(|text| text.parse().ok());
        let stands_apart = self.at > start;
        self.at += digits;
        let ends = match self.bytes.get(self.at) {
            Some(byte) => byte.is_ascii_whitespace() || *byte == b'#',
            None => true,
        };
        (number.filter(|_| stands_apart && ends), place)
    }

    /// Reads a digit for each taxel; returns the offset after the last.
    fn digits(&mut self, imprint: &mut Imprint) -> Result<usize, PbmError> {
        let expected = usize::from(imprint.columns()) * usize::from(imprint.rows());
        let mut found = 0;
        for row in 0..imprint.rows() {
            for column in 0..imprint.columns() {
                let unit = "taxels";
                let short = PbmError::Short {
                    found,
                    expected,
                    unit,
                };
                let active = match self.next().ok_or(short)? {
                    b'0' => false,
                    b'1' => true,
                    byte => {
                        let (line, column) = self.line_and_column();
                        return Err(PbmError::Digit { line, column, byte });
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
    fn bits(&mut self, imprint: &mut Imprint) -> Result<usize, PbmError> {
        // Exactly one space separates the height from the bits, which may look like spaces.
        if self.bytes.get(self.at) == Some(&b'#') {
            let (line, column) = self.line_and_column();
            return Err(PbmError::Space { line, column });
        }
        let start = (self.at + 1).min(self.bytes.len());
        let width = usize::from(imprint.columns()).div_ceil(8);
        let expected = width * usize::from(imprint.rows());
        let bits = &self.bytes[start..];
        let bits = bits.get(..expected).ok_or(PbmError::Short {
            found: bits.len(),
            expected,
            unit: "bytes of taxels",
        })?;
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
