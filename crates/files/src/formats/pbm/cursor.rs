//! Reads the numbers, digits and bits of a bitmap, from front to back.

use crate::formats::pbm::error::PbmError;
use crate::imprint::Imprint;
use crate::sensor::MatrixSize;

/// A position in the bytes of a file.
pub(super) struct Cursor<'a> {
    pub(super) bytes: &'a [u8],
    pub(super) at: usize,
}

impl Cursor<'_> {
    /// Returns the line and column of an offset, for an error: it counts the lines from the start of the file.
    pub(super) fn line_and_column(&self, offset: usize) -> (usize, usize) {
        let before = &self.bytes[..offset];
        let start = before.iter().rposition(|&byte| byte == b'\n');
        let line = before.split(|&byte| byte == b'\n').count();
        (line, offset - start.map_or(0, |start| start + 1) + 1)
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
    pub(super) fn side(
        &mut self,
        what: &'static str,
        size: impl Fn(u32) -> Option<MatrixSize>,
    ) -> Result<MatrixSize, PbmError> {
        let (side, offset) = self.number();
        side.and_then(size).ok_or_else(|| {
            let (line, column) = self.line_and_column(offset);
            PbmError::Side { line, column, what }
        })
    }

    /// Reads a number that is separated from what is before and after it; returns it and its offset.
    pub(super) fn number(&mut self) -> (Option<u32>, usize) {
        let before = self.at;
        let _ = self.next();
        let start = self.at;
        let digits = self.bytes[start..]
            .iter()
            .take_while(|byte| byte.is_ascii_digit())
            .count();
        let text = str::from_utf8(&self.bytes[start..start + digits]).ok();
        let number = text.and_then(|text| text.parse().ok());
        let stands_apart = start > before;
        self.at += digits;
        let ends = match self.bytes.get(self.at) {
            Some(byte) => byte.is_ascii_whitespace() || *byte == b'#',
            None => true,
        };
        (number.filter(|_| stands_apart && ends), start)
    }

    /// Reads a digit for each taxel; returns the offset after the last.
    pub(super) fn digits(&mut self, imprint: &mut Imprint) -> Result<usize, PbmError> {
        let expected = imprint.size().cells();
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
                        let (line, column) = self.line_and_column(self.at);
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
    pub(super) fn bits(&mut self, imprint: &mut Imprint) -> Result<usize, PbmError> {
        // Exactly one space separates the height from the bits, which may look like spaces.
        if self.bytes.get(self.at) == Some(&b'#') {
            let (line, column) = self.line_and_column(self.at);
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
