//! Reads text: its lines, the fields of a line, and the numbers in them.
//!
//! Lines end in LF or CR LF. A byte order mark at the beginning of the text is not part of a line.
//! ```text
//! 0;1,5;;3      semicolons: a comma is the decimal sign, and an empty field is no cell
//! 0,1.5,,3      commas, or tabs
//! 0 1.5 nan 3   any number of blanks
//! ```

use crate::formats::recording::error::{in_field, in_line};
use std::io::{self, BufRead};

use taxel_core::frame::LARGEST_VALUE;
use taxel_core::parameter::number::counted;
use taxel_core::quote::shortened;

use crate::error::ReadError;
use crate::formats::file::BYTE_ORDER_MARK;
use crate::formats::job::too_large;

/// Reads a finite decimal without blanks around it, such as `12`, `-0.5` or `+1e-3`; None for anything else.
pub(super) fn read_number(text: &[u8]) -> Option<f64> {
    // The standard library also accepts words: inf, nan, infinity.
    let mut bytes = text.iter();
    let is_number =
        bytes.all(|byte| matches!(byte, b'0'..=b'9' | b'+' | b'-' | b'.' | b'e' | b'E'));
    let text = str::from_utf8(text).ok().filter(|_| is_number)?;
    text.parse().ok().filter(|value: &f64| value.is_finite())
}

/// Converts a number without a fraction, as labels are; None for any other, and beyond the whole numbers that a float
/// holds exactly.
#[expect(clippy::cast_possible_truncation, reason = "checked")]
pub(super) fn whole(value: f64) -> Option<i64> {
    (value.fract() == 0.0 && value.abs() < 9e15).then_some(value as i64)
}

/// The size limit of a line in bytes, more than a frame of 512 × 512 values takes; thus one line cannot fill all
/// memory.
pub(crate) const LONGEST_LINE: usize = 8 << 20;

/// The lines of a text, counted from 1, without their ends and without a byte order mark.
#[derive(Debug)]
pub(super) struct TextLines<R> {
    /// The source of the bytes.
    input: R,
    line: Vec<u8>,
    /// The number of that line; 0 before the first.
    pub(super) number: u64,
    /// The number of the last line that was read from the input.
    read: u64,
    /// Lines that are read again, the next one last.
    ahead: Vec<(u64, Vec<u8>)>,
    /// Whether the input ended by [`io::ErrorKind::UnexpectedEof`], perhaps within a line.
    is_cut: bool,
}

impl<R: BufRead> TextLines<R> {
    /// Starts before the first line.
    pub(super) fn new(input: R) -> Self {
        Self {
            input,
            line: Vec::new(),
            number: 0,
            read: 0,
            ahead: Vec::new(),
            is_cut: false,
        }
    }

    pub(super) fn line(&self) -> &[u8] {
        &self.line
    }

    /// The line with its number, to be given back later.
    pub(super) fn held(&self) -> (u64, Vec<u8>) {
        (self.number, self.line.clone())
    }

    /// Lets lines be read again, in this order.
    pub(super) fn unread(
        &mut self,
        lines: impl IntoIterator<Item = (u64, Vec<u8>), IntoIter: DoubleEndedIterator>,
    ) {
        self.ahead.extend(lines.into_iter().rev());
    }

    /// The rest of a line at which the input was cut off; empty unless it has ended so.
    pub(super) fn torn(&self) -> &[u8] {
        if self.is_cut { &self.line } else { b"" }
    }

    /// Reads the next line; returns false at the end.
    pub(super) fn advance(&mut self) -> Result<bool, ReadError> {
        if let Some((number, line)) = self.ahead.pop() {
            (self.number, self.line) = (number, line);
            return Ok(true);
        }
        if self.is_cut {
            return Ok(false);
        }
        self.line.clear();
        self.number = self.read;
        loop {
            let bytes = match self.input.fill_buf() {
                Ok(bytes) => bytes,
                Err(error) if error.kind() == io::ErrorKind::Interrupted => continue,
                Err(error) if error.kind() == io::ErrorKind::UnexpectedEof => {
                    self.is_cut = true;
                    return Ok(false);
                }
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
            // A longer line is read to its end, so that the next one can be read.
            let room = LONGEST_LINE + 1 - self.line.len();
            self.line.extend_from_slice(&part[..part.len().min(room)]);
            let used = end.map_or(bytes.len(), |end| end + 1);
            self.input.consume(used);
            if end.is_some() {
                break;
            }
        }
        self.read += 1;
        self.number = self.read;
        if self.line.len() > LONGEST_LINE {
            let message = "longer than 8 MiB, the limit for a line of a recording";
            return Err(in_line(self.number, message));
        }
        if self.line.last() == Some(&b'\r') {
            self.line.pop();
        }
        if self.number == 1 && self.line.starts_with(BYTE_ORDER_MARK) {
            self.line.drain(..BYTE_ORDER_MARK.len());
        }
        Ok(true)
    }

    /// Reads the next line that is not blank; returns false at the end. A line of commas is blank.
    pub(super) fn advance_to_content(&mut self) -> Result<bool, ReadError> {
        while self.advance()? {
            if !is_blank(&self.line) {
                return Ok(true);
            }
        }
        Ok(false)
    }
}

pub(super) fn is_blank(line: &[u8]) -> bool {
    line.iter()
        .all(|byte| byte.is_ascii_whitespace() || *byte == b',')
}

pub(super) fn unpadded(line: &[u8]) -> &[u8] {
    let is_padding = |byte: &u8| byte.is_ascii_whitespace() || *byte == b',';
    let end = line.iter().rposition(|byte| !is_padding(byte));
    &line[..end.map_or(0, |end| end + 1)]
}

/// Decodes a name or a unit: as UTF-8, or as Latin-1 if it is not UTF-8.
pub(super) fn text(bytes: &[u8]) -> String {
    match str::from_utf8(bytes) {
        Ok(text) => text.to_owned(),
        Err(_) => bytes.iter().map(|&byte| char::from(byte)).collect(),
    }
}

/// Reads the value of a cell; None for anything that is no number of an allowed size.
pub(super) fn read_value(field: &[u8]) -> Option<f64> {
    read_number(field).filter(|value| value.abs() <= LARGEST_VALUE)
}

/// Fills a row of values from the fields of a line. Fields beyond the values must be empty.
pub(super) fn fill_row<'a>(
    values: &mut [f64],
    fields: impl Iterator<Item = &'a [u8]>,
    number: u64,
    read: impl Fn(&[u8]) -> Option<f64>,
) -> Result<(), ReadError> {
    let expected = values.len();
    let mut fields = fields.zip(1..);
    for (slot, found) in values.iter_mut().zip(0..) {
        let field = fields.next().map(|(field, _)| field);
        let Some(field) = field.filter(|field| !field.is_empty()) else {
            return Err(wrong_count(number, found, expected));
        };
        *slot = read(field).ok_or_else(|| wrong_field(number, found + 1, field))?;
    }
    match fields.filter(|(field, _)| !field.is_empty()).last() {
        Some((_, found)) => Err(wrong_count(number, found, expected)),
        None => Ok(()),
    }
}

pub(super) fn wrong_count(line: u64, found: usize, expected: usize) -> ReadError {
    let found = counted(found as u64, "value");
    in_line(line, format!("found {found}, expected {expected}"))
}

/// Returns the error for a field that is not a value.
pub(super) fn wrong_field(line: u64, column: usize, field: &[u8]) -> ReadError {
    if let Some(read_value) =
        read_number(field).filter(|read_value| read_value.abs() > LARGEST_VALUE)
    {
        return in_field(line, column, too_large(read_value));
    }
    let found = shortened(&text(field));
    in_field(line, column, format!("found {found:?}, expected a number"))
}

/// The words for a cell without a value: those of C, Python, R and databases, of spreadsheets and of pandas.
const NONE: [&[u8]; 8] = [
    b"nan", b"-nan", b"null", b"none", b"na", b"n/a", b"#n/a", b"<na>",
];

/// Returns true if a field says that there is no value. A dash does not: lines of lists begin with one.
pub(super) fn is_none(field: &[u8]) -> bool {
    match field.first() {
        None => true,
        // Most fields are numbers.
        Some(first) if first.is_ascii_digit() => false,
        Some(_) => NONE.iter().any(|none| field.eq_ignore_ascii_case(none)),
    }
}

/// Whether a line is a comment. It begins with `#`; `#N/A` is a cell.
pub(crate) fn is_comment(line: &[u8]) -> bool {
    let line = line.trim_ascii_start();
    let is_cell = |start: &[u8]| start.eq_ignore_ascii_case(b"#n/a");
    line.starts_with(b"#") && !line.get(..4).is_some_and(is_cell)
}

pub(crate) fn unquoted(field: &[u8]) -> &[u8] {
    let field = field.trim_ascii();
    let inner = field
        .strip_prefix(b"\"")
        .and_then(|field| field.strip_suffix(b"\""));
    inner.map_or(field, <[u8]>::trim_ascii)
}

#[derive(Clone, Copy, Debug, PartialEq)]
pub(crate) enum Separator {
    /// A byte; two in succession have an empty field between them.
    Byte(u8),
    /// Any number of blanks; there are no empty fields.
    Spaces,
}

impl Separator {
    /// Returns the separator of a line: the first of semicolon, tab and comma that it has outside quotes, otherwise
    /// blanks. Commas beside tabs separate, unless they are decimal signs.
    pub(super) fn of(line: &[u8]) -> Self {
        let line = line.trim_ascii();
        let has = |mark| Self::Byte(mark).split(line).nth(1).is_some();
        let is_decimal =
            |field: &[u8]| !field.contains(&b',') || Self::Byte(b'\t').is_numeric(field);
        if has(b';') {
            Self::Byte(b';')
        } else if has(b'\t') && Self::Byte(b'\t').split(line).all(is_decimal) {
            Self::Byte(b'\t')
        } else if has(b',') {
            Self::Byte(b',')
        } else {
            Self::Spaces
        }
    }

    /// Splits a line at its separators, and removes blanks and quotes around each part. A separator in quotes is part
    /// of its field; if a quote is not closed, quotes are characters like any other, as in `width in "`.
    pub(super) fn split(self, line: &[u8]) -> impl Iterator<Item = &[u8]> {
        let quotes: usize = line.iter().map(|byte| usize::from(*byte == b'"')).sum();
        let (has_quotes, mut is_quoted) = (quotes > 0 && quotes.is_multiple_of(2), false);
        let is_end = move |byte: &u8| {
            is_quoted ^= has_quotes && *byte == b'"';
            let is_mark = match self {
                Self::Byte(mark) => *byte == mark,
                Self::Spaces => byte.is_ascii_whitespace(),
            };
            is_mark && !is_quoted
        };
        line.split(is_end).map(unquoted)
    }

    /// Returns the fields of a line, without blanks and quotes around them. An empty field at the end is left out, as are
    /// those between tabs at both ends, unless the line has the `expected` number of fields only with them.
    pub(crate) fn fields(self, line: &[u8], expected: usize) -> impl Iterator<Item = &[u8]> {
        let (whole, ended) = (self.without_blanks(line), self.without_ends(line));
        let is_whole = whole.len() > ended.len() && self.split(whole).count() == expected;
        let fields = self.split(if is_whole { whole } else { ended });
        fields.filter(move |field| self != Self::Spaces || !field.is_empty())
    }

    /// Removes the blanks at both ends of a line that are not separators.
    fn without_blanks(self, line: &[u8]) -> &[u8] {
        let is_end = |byte: &u8| !byte.is_ascii_whitespace() || self == Self::Byte(*byte);
        let start = line.iter().position(is_end).unwrap_or(line.len());
        let end = line.iter().rposition(is_end).map_or(start, |end| end + 1);
        &line[start..end]
    }

    fn without_ends(self, line: &[u8]) -> &[u8] {
        let line = line.trim_ascii();
        match self {
            Self::Byte(mark) => line.strip_suffix(&[mark]).unwrap_or(line),
            Self::Spaces => line,
        }
    }

    /// Reads the value of a cell, NaN if there is none; None if the field is anything else. With semicolons or tabs as separators, a comma is the decimal sign.
    pub(crate) fn value(self, field: &[u8]) -> Option<f64> {
        if is_none(field) {
            return Some(f64::NAN);
        }
        match self {
            Self::Byte(b';' | b'\t') => decimal(field),
            _ => read_value(field),
        }
    }

    /// Returns true if a field can be that of a cell: a number, or a word for a missing value.
    pub(super) fn is_numeric(self, field: &[u8]) -> bool {
        self.value(field).is_some()
    }
}

/// Reads a number whose decimal sign may be a comma.
pub(super) fn decimal(field: &[u8]) -> Option<f64> {
    if !field.contains(&b',') {
        return read_value(field);
    }
    let pointed = field
        .iter()
        .map(|&byte| if byte == b',' { b'.' } else { byte });
    read_value(&pointed.collect::<Vec<u8>>())
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn words_and_infinite_numbers_are_no_numbers() {
        for (text, number) in [("-.50", -0.5), ("5.", 5.0), ("+2.5E-7", 2.5e-7)] {
            assert_eq!(read_number(text.as_bytes()), Some(number));
        }
        for text in [
            "", "-", ".", "+.", "e", "1e", "1e999", "inf", "nan", "NaN", "1,5", "1 2", "0x10",
            "--1", "1.2.3", "infinity",
        ] {
            assert_eq!(read_number(text.as_bytes()), None, "{text}");
        }
    }

    #[test]
    fn lines_have_no_ends_and_no_byte_order_mark() {
        let text = &b"\xef\xbb\xbfone\r\n\n\xef\xbb\xbf\n two\r"[..];
        let mut lines = TextLines::new(text);
        let mut found = Vec::new();
        while lines.advance().expect("short lines") {
            found.push((lines.number, lines.line().to_owned()));
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
        assert_eq!((lines.number, unpadded(lines.line())), (3, &b"ROWS 2"[..]));
        assert!(!lines.advance_to_content().expect("short lines"));
    }

    #[test]
    fn names_may_be_latin_1() {
        assert_eq!([text(b"\xc2\xb5m"), text(b"\xb5m")], ["µm", "µm"]);
    }

    fn fields(line: &str) -> (Separator, Vec<&str>) {
        let separator = Separator::of(line.as_bytes());
        let fields = separator.fields(line.as_bytes(), 0);
        let fields = fields.map(|field| str::from_utf8(field).expect("UTF-8"));
        (separator, fields.collect())
    }

    #[test]
    fn the_first_mark_outside_quotes_separates() {
        for (line, mark, expected) in [
            ("1,5;2,5", b';', &["1,5", "2,5"][..]),
            ("\"a;b\",2, 3 ", b',', &["a;b", "2", "3"]),
            ("1\t\t3\t", b'\t', &["1", "", "3"]),
            ("0,5\t1,5", b'\t', &["0,5", "1,5"]),
            ("1,\t2,\t3,4,5", b',', &["1", "2", "3", "4", "5"]),
            ("width in \",2", b',', &["width in \"", "2"]),
        ] {
            let expected = (Separator::Byte(mark), expected.to_vec());
            assert_eq!(fields(line), expected, "{line}");
        }
        assert_eq!(fields(" 1  2 "), (Separator::Spaces, vec!["1", "2"]));
    }

    #[test]
    fn an_empty_field_at_the_end_counts_if_it_is_expected() {
        let count = |expected| Separator::Byte(b',').fields(b"1,2,", expected).count();
        assert_eq!([2, 3, 4].map(count), [2, 3, 2]);
        let count = |expected| {
            let fields = Separator::Byte(b'\t').fields(b" \t1\t\r", expected);
            fields.count()
        };
        assert_eq!([1, 2, 3, 4].map(count), [1, 1, 3, 1]);
    }
}
