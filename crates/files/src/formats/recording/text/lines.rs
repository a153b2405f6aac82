//! The lines of a text of any length, read one at a time into the same memory.
//!
//! Lines end in LF or CR LF. A byte order mark at the beginning of the text is not part of a line, nor are zero bytes
//! there: a file begins with them if it was truncated while a program kept its place in it.

use std::io::{self, BufRead};

use crate::formats::file::BYTE_ORDER_MARK;
use crate::formats::recording::error::RecordingError;

/// The size limit of a line in bytes, more than a frame of 512 × 512 values takes; thus one line cannot fill all
/// memory.
pub(in crate::formats) const LONGEST_LINE: usize = 8 << 20;

/// The lines of a text, counted from 1, without their ends and without a byte order mark.
#[derive(Debug)]
pub(in crate::formats::recording) struct TextLines<R> {
    /// The source of the bytes.
    input: R,
    /// The line that was read last, without its end.
    line: Vec<u8>,
    /// The number of that line; 0 before the first.
    number: u64,
}

impl<R: BufRead> TextLines<R> {
    /// Starts before the first line.
    pub(in crate::formats::recording) fn new(input: R) -> Self {
        Self {
            input,
            line: Vec::new(),
            number: 0,
        }
    }

    /// Returns the number of the line that was read last.
    pub(in crate::formats::recording) fn number(&self) -> u64 {
        self.number
    }

    /// Returns the line that was read last.
    pub(in crate::formats::recording) fn line(&self) -> &[u8] {
        &self.line
    }

    /// Reads the next line; returns false at the end.
    ///
    /// # Errors
    /// Returns an error if the line cannot be read or is longer than 8 MiB.
    pub(in crate::formats::recording) fn advance(&mut self) -> Result<bool, RecordingError> {
        self.line.clear();
        loop {
            let bytes = match self.input.fill_buf() {
                Ok(bytes) => bytes,
                Err(error) if error.kind() == io::ErrorKind::Interrupted => continue,
                Err(error) => return Err(error.into()),
            };
            if bytes.is_empty() {
                if self.line.is_empty() {
                    return Ok(false);
                }
                break;
            }
            if self.number == 0 && self.line.is_empty() && bytes[0] == 0 {
                let zeros = bytes.iter().take_while(|&&byte| byte == 0).count();
                self.input.consume(zeros);
                continue;
            }
            let end = bytes.iter().position(|&byte| byte == b'\n');
            let part = &bytes[..end.unwrap_or(bytes.len())];
            if part.len() > LONGEST_LINE - self.line.len() {
                let message = "longer than 8 MiB, the limit for a line of a recording";
                return Err(RecordingError::in_line(self.number + 1, message));
            }
            self.line.extend_from_slice(part);
            let used = end.map_or(bytes.len(), |end| end + 1);
            self.input.consume(used);
            if end.is_some() {
                break;
            }
        }
        self.number += 1;
        if self.line.last() == Some(&b'\r') {
            self.line.pop();
        }
        if self.number == 1 && self.line.starts_with(BYTE_ORDER_MARK) {
            self.line.drain(..BYTE_ORDER_MARK.len());
        }
        Ok(true)
    }

    /// Reads the next line that is not blank; returns false at the end. A line of commas is blank.
    ///
    /// # Errors
    /// Returns the errors of [`TextLines::advance`].
    pub(in crate::formats::recording) fn advance_to_content(
        &mut self,
    ) -> Result<bool, RecordingError> {
        while self.advance()? {
            if !is_blank(&self.line) {
                return Ok(true);
            }
        }
        Ok(false)
    }
}

/// Returns true if a line has only blanks and commas, with which spreadsheet programs pad lines.
pub(in crate::formats::recording) fn is_blank(line: &[u8]) -> bool {
    line.iter()
        .all(|byte| byte.is_ascii_whitespace() || *byte == b',')
}

/// Removes the commas and blanks at the end of a line.
pub(in crate::formats::recording) fn unpadded(line: &[u8]) -> &[u8] {
    let is_padding = |byte: &u8| byte.is_ascii_whitespace() || *byte == b',';
    let end = line.iter().rposition(|byte| !is_padding(byte));
    &line[..end.map_or(0, |end| end + 1)]
}

/// Decodes a name or a unit: as UTF-8, or as Latin-1 if it is not UTF-8.
pub(in crate::formats::recording) fn text(bytes: &[u8]) -> String {
    match str::from_utf8(bytes) {
        Ok(text) => text.to_owned(),
        Err(_) => bytes.iter().map(|&byte| char::from(byte)).collect(),
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn lines_have_no_ends_and_no_byte_order_mark() {
        let text = &b"\xef\xbb\xbfone\r\n\n\xef\xbb\xbf\n two\r"[..];
        let mut lines = TextLines::new(text);
        let mut found = Vec::new();
        while lines.advance().expect("short lines") {
            found.push((lines.number(), lines.line().to_owned()));
        }
        let expected = [&b"one"[..], b"", b"\xef\xbb\xbf", b" two"];
        let expected: Vec<_> = (1..).zip(expected.map(<[u8]>::to_vec)).collect();
        assert_eq!(found, expected);
    }

    #[test]
    fn a_line_may_have_8_mib() {
        let mut text = vec![b'1'; LONGEST_LINE];
        assert!(TextLines::new(&text[..]).advance().expect("8 MiB"));
        text.push(b'1');
        let error = TextLines::new(&text[..]).advance().expect_err("too long");
        let expected = "line 1: longer than 8 MiB, the limit for a line of a recording";
        assert_eq!(error.to_string(), expected);
    }

    #[test]
    fn padding_is_not_content() {
        let mut lines = TextLines::new(&b" ,,\n\t\nROWS 2,,\n,"[..]);
        assert!(lines.advance_to_content().expect("short lines"));
        assert_eq!(
            (lines.number(), unpadded(lines.line())),
            (3, &b"ROWS 2"[..])
        );
        assert!(!lines.advance_to_content().expect("short lines"));
    }

    #[test]
    fn names_may_be_latin_1() {
        assert_eq!([text(b"\xc2\xb5m"), text(b"\xb5m")], ["µm", "µm"]);
    }
}
