//! Lines of a text of any length, one at a time in the same memory.
//!
//! Lines end in `\n` or `\r\n`. A byte order mark at the beginning of the text belongs to no line.

use std::io::{self, BufRead};

use crate::formats::recording::error::RecordingError;

/// A frame of 512 × 512 values a line takes less. A longer line is refused, so that one line cannot take all memory.
const LONGEST: usize = 8 << 20;

/// The lines of a text, counted from 1, without their ends and without a byte order mark.
#[derive(Debug)]
pub(crate) struct TextLines<R> {
    /// Where bytes come from.
    input: R,
    /// The line that was read last, without its end.
    line: Vec<u8>,
    /// Its number; 0 before the first.
    number: u64,
}

impl<R: BufRead> TextLines<R> {
    /// Before the first line.
    pub(crate) fn new(input: R) -> Self {
        Self {
            input,
            line: Vec::new(),
            number: 0,
        }
    }

    /// The number of the line that was read last.
    pub(crate) fn number(&self) -> u64 {
        self.number
    }

    /// The line that was read last.
    pub(crate) fn line(&self) -> &[u8] {
        &self.line
    }

    /// Reads the next line; false at the end.
    ///
    /// # Errors
    /// If it cannot be read, or is longer than 8 MiB.
    pub(crate) fn advance(&mut self) -> Result<bool, RecordingError> {
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
            let end = bytes.iter().position(|&byte| byte == b'\n');
            let part = &bytes[..end.unwrap_or(bytes.len())];
            if part.len() > LONGEST - self.line.len() {
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
        if self.number == 1 && self.line.starts_with(b"\xef\xbb\xbf") {
            self.line.drain(..3);
        }
        Ok(true)
    }

    /// Reads the next line that is not blank; false at the end. A line of commas is blank.
    ///
    /// # Errors
    /// As for [`TextLines::advance`].
    pub(crate) fn advance_to_content(&mut self) -> Result<bool, RecordingError> {
        while self.advance()? {
            if !is_blank(&self.line) {
                return Ok(true);
            }
        }
        Ok(false)
    }
}

/// Whether a line has nothing but blanks and commas, which spreadsheet programs pad lines with.
pub(crate) fn is_blank(line: &[u8]) -> bool {
    line.iter()
        .all(|byte| byte.is_ascii_whitespace() || *byte == b',')
}

/// A line without the commas and blanks at its end.
pub(crate) fn unpadded(line: &[u8]) -> &[u8] {
    let is_padding = |byte: &u8| byte.is_ascii_whitespace() || *byte == b',';
    let end = line.iter().rposition(|byte| !is_padding(byte));
    &line[..end.map_or(0, |end| end + 1)]
}

/// A text in UTF-8, or else in Latin-1; for names and units.
pub(crate) fn text(bytes: &[u8]) -> String {
    match str::from_utf8(bytes) {
        Ok(text) => text.to_owned(),
        Err(_) => bytes.iter().map(|&byte| char::from(byte)).collect(),
    }
}
