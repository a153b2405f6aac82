//! The separator of a table's fields, and the content of its fields.
//!
//! ```text
//! 0;1,5;;3      semicolons: a comma is the decimal sign, and an empty field is no cell
//! 0,1.5,,3      commas, or tabs
//! 0 1.5 nan 3   any number of blanks
//! 0 1.5 N/A 3
//! ```

use crate::formats::recording::text::row::{self, Field};
use crate::formats::table::named_separator;

/// The words for a cell without a value: those of C, Python, R and databases, of spreadsheets and of pandas.
const NONE: [&[u8]; 8] = [
    b"nan", b"-nan", b"null", b"none", b"na", b"n/a", b"#n/a", b"<na>",
];

/// Returns true if a field says that there is no value. A dash does not: lines of lists begin with one.
pub(in crate::formats::recording) fn is_none(field: &[u8]) -> bool {
    match field.first() {
        None => true,
        // Most fields are numbers.
        Some(first) if first.is_ascii_digit() => false,
        Some(_) => NONE.iter().any(|none| field.eq_ignore_ascii_case(none)),
    }
}

/// Returns true if a line is skipped wherever it is: a comment, or the line in which spreadsheet programs name the
/// separator, `sep=;`. A comment begins with `#`, with `//`, or with `%` before a blank or another `%`. Otherwise a `%`
/// may belong to a name, as in `%time` of ROS; and `#N/A` is a cell.
pub(in crate::formats) fn is_comment(line: &[u8]) -> bool {
    let line = line.trim_ascii();
    let begins = |word: &[u8]| {
        let start = line.get(..word.len());
        start.is_some_and(|start| start.eq_ignore_ascii_case(word))
    };
    match line {
        [b'#', ..] => !begins(b"#n/a"),
        [b'/', b'/', ..] | [b'%'] => true,
        [b'%', next, ..] => next.is_ascii_whitespace() || *next == b'%',
        [b's' | b'S' | b'"', ..] => named_separator(line).is_some(),
        _ => false,
    }
}

/// Removes the blanks and quotes around a field.
pub(in crate::formats) fn unquoted(field: &[u8]) -> &[u8] {
    let field = field.trim_ascii();
    let inner = field
        .strip_prefix(b"\"")
        .and_then(|field| field.strip_suffix(b"\""));
    inner.map_or(field, <[u8]>::trim_ascii)
}

/// The bytes that separate fields, the first one that a line has before the others; without any of them, blanks do.
///
/// Recordings and streams are read line by line, and docs/sensors.md promises this order. The table of an imprint is
/// short and read as a whole, so it is separated by what its last line has, where names cannot mislead: see
/// [`table`](crate::formats::table).
pub(in crate::formats) const SEPARATORS: [u8; 3] = *b";,\t";

/// The separator between the fields of a line.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(in crate::formats) enum Separator {
    /// A byte; two in succession have an empty field between them.
    Byte(u8),
    /// Any number of blanks; there are no empty fields.
    Spaces,
}

impl Separator {
    /// Returns the separator of a line: the first of [`SEPARATORS`] that occurs outside quotes, otherwise blanks.
    pub(in crate::formats::recording) fn of(line: &[u8]) -> Self {
        let found = SEPARATORS
            .into_iter()
            .find(|&mark| Self::Byte(mark).split(line).nth(1).is_some());
        found.map_or(Self::Spaces, Self::Byte)
    }

    /// Splits a line at its separators, and removes blanks and quotes around each part. A separator in quotes is part
    /// of its field; if a quote is not closed, quotes are characters like any other, as in `width in "`.
    pub(in crate::formats::recording) fn split(self, line: &[u8]) -> impl Iterator<Item = &[u8]> {
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

    /// Returns the fields of a line like [`Self::fields`]. If the line has the `expected` number of fields only when
    /// the empty ones at its ends count, they count.
    pub(in crate::formats::recording) fn fields_of(
        self,
        line: &[u8],
        expected: usize,
    ) -> impl Iterator<Item = &[u8]> {
        let (whole, ended) = (self.without_blanks(line), self.without_ends(line));
        let is_whole = whole.len() > ended.len() && self.split(whole).count() == expected;
        self.split_into_fields(if is_whole { whole } else { ended })
    }

    /// Returns the fields of a line, without blanks and quotes around them; an empty field at the end is left out, as
    /// are those between tabs at both ends.
    pub(in crate::formats) fn fields(self, line: &[u8]) -> impl Iterator<Item = &[u8]> {
        self.split_into_fields(self.without_ends(line))
    }

    fn split_into_fields(self, line: &[u8]) -> impl Iterator<Item = &[u8]> {
        let fields = self.split(line);
        fields.filter(move |field| self != Self::Spaces || !field.is_empty())
    }

    /// Removes the blanks at both ends of a line that are not separators.
    fn without_blanks(self, line: &[u8]) -> &[u8] {
        let is_end = |byte: &u8| !byte.is_ascii_whitespace() || self == Self::Byte(*byte);
        let start = line.iter().position(is_end).unwrap_or(line.len());
        let end = line.iter().rposition(is_end).map_or(start, |end| end + 1);
        &line[start..end]
    }

    /// Removes all blanks at both ends of a line, and a separator at its end.
    fn without_ends(self, line: &[u8]) -> &[u8] {
        let line = line.trim_ascii();
        match self {
            Self::Byte(mark) => line.strip_suffix(&[mark]).unwrap_or(line),
            Self::Spaces => line,
        }
    }

    /// Reads the content of a field. With semicolons as separators, a comma is the decimal sign.
    pub(in crate::formats) fn value(self, field: &[u8]) -> Field {
        if is_none(field) {
            return Field::NoCell;
        }
        match self {
            Self::Byte(b';') => decimal(field),
            _ => row::value(field),
        }
    }

    /// Returns true if a field can be that of a cell: a number, or a word for a missing value.
    pub(in crate::formats::recording) fn is_numeric(self, field: &[u8]) -> bool {
        !matches!(self.value(field), Field::Wrong)
    }

    /// Returns the number in a field; NaN if there is none.
    pub(in crate::formats::recording) fn number(self, field: &[u8]) -> f64 {
        self.value(field).cell().unwrap_or(f64::NAN)
    }
}

/// Reads a number whose decimal sign may be a comma; with a comma, it has at most 32 characters.
pub(in crate::formats::recording) fn decimal(field: &[u8]) -> Field {
    if !field.contains(&b',') {
        return row::value(field);
    }
    let mut pointed = [0; 32];
    let Some(pointed) = pointed.get_mut(..field.len()) else {
        return Field::Wrong;
    };
    for (slot, &byte) in pointed.iter_mut().zip(field) {
        *slot = if byte == b',' { b'.' } else { byte };
    }
    row::value(pointed)
}

#[cfg(test)]
mod tests {
    use super::*;

    fn fields(line: &str) -> (Separator, Vec<&str>) {
        let separator = Separator::of(line.as_bytes());
        let fields = separator.fields(line.as_bytes());
        let fields = fields.map(|field| str::from_utf8(field).expect("UTF-8"));
        (separator, fields.collect())
    }

    #[test]
    fn the_first_mark_outside_quotes_separates() {
        for (line, mark, expected) in [
            ("1,5;2,5", b';', &["1,5", "2,5"][..]),
            ("\"a;b\",2, 3 ", b',', &["a;b", "2", "3"]),
            ("1\t\t3\t", b'\t', &["1", "", "3"]),
            ("width in \",2", b',', &["width in \"", "2"]),
        ] {
            let expected = (Separator::Byte(mark), expected.to_vec());
            assert_eq!(fields(line), expected, "{line}");
        }
        assert_eq!(fields(" 1  2 "), (Separator::Spaces, vec!["1", "2"]));
    }

    #[test]
    fn an_empty_field_at_the_end_counts_if_it_is_expected() {
        let count = |expected| Separator::Byte(b',').fields_of(b"1,2,", expected).count();
        assert_eq!([2, 3, 4].map(count), [2, 3, 2]);
        let count = |expected| {
            let fields = Separator::Byte(b'\t').fields_of(b" \t1\t\r", expected);
            fields.count()
        };
        assert_eq!([1, 2, 3, 4].map(count), [1, 1, 3, 1]);
    }

    #[test]
    fn a_comma_is_the_decimal_sign_between_semicolons() {
        let number = |mark, field: &str| match Separator::Byte(mark).value(field.as_bytes()) {
            Field::Value(value) => Some(value),
            Field::NoCell | Field::Wrong => None,
        };
        assert_eq!(number(b';', "1,5"), Some(1.5));
        assert_eq!(number(b'\t', "1,5"), None);
        for none in ["", "NaN", "#N/A", "<NA>"] {
            assert!(is_none(none.as_bytes()), "{none}");
        }
        assert!(!is_none(b"-"));
    }

    #[test]
    fn comments_and_separator_lines_are_skipped() {
        for line in ["# a", "// a", "%", "%% a", "% a", "sep=;", "\"sep=,\""] {
            assert!(is_comment(line.as_bytes()), "{line}");
        }
        for line in ["#N/A,1", "%time,1", "/ 1", "seconds"] {
            assert!(!is_comment(line.as_bytes()), "{line}");
        }
    }
}
