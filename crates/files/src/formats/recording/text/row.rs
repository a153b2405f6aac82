//! A row of values in a line of text.
//!
//! The reader decides whether a field is a value ([`Field`]): formats differ in how they write a cell without a
//! value. The messages are the same in all formats: `line 7, column 3: found "x", expected a number`.

use crate::formats::job::too_large;
use crate::formats::recording::error::RecordingError;
use crate::formats::recording::text::lines::text;
use crate::formats::recording::text::number;
use crate::frame::LARGEST_VALUE;
use crate::parameter::number::counted;
use crate::quote::shortened;

/// The content of a field.
pub(in crate::formats) enum Field {
    /// A value.
    Value(f64),
    /// No value: the cell does not exist.
    NoCell,
    /// Anything else.
    Wrong,
}

impl Field {
    /// Returns the value of a cell, NaN if there is none; None if the field is anything else.
    pub(in crate::formats) fn cell(self) -> Option<f64> {
        match self {
            Self::Value(value) => Some(value),
            Self::NoCell => Some(f64::NAN),
            Self::Wrong => None,
        }
    }
}

/// Reads a number that may be the value of a cell.
pub(in crate::formats::recording) fn value(field: &[u8]) -> Field {
    match number::read(field) {
        Some(value) if value.abs() <= LARGEST_VALUE => Field::Value(value),
        _ => Field::Wrong,
    }
}

/// Fills a row of values from the fields of a line. Fields beyond the values must be empty.
///
/// # Errors
/// Returns an error if a field is wrong, or if there are more or fewer fields than values.
pub(in crate::formats::recording) fn fill<'a>(
    values: &mut [f64],
    fields: impl Iterator<Item = &'a [u8]>,
    number: u64,
    read: impl Fn(&[u8]) -> Field,
) -> Result<(), RecordingError> {
    let expected = values.len();
    let mut fields = fields.zip(1..);
    for (slot, found) in values.iter_mut().zip(0..) {
        let field = fields.next().map(|(field, _)| field);
        let Some(field) = field.filter(|field| !field.is_empty()) else {
            return Err(count(number, found, expected));
        };
        *slot = read(field)
            .cell()
            .ok_or_else(|| wrong(number, found + 1, field))?;
    }
    match fields.filter(|(field, _)| !field.is_empty()).last() {
        Some((_, found)) => Err(count(number, found, expected)),
        None => Ok(()),
    }
}

/// Returns the error for a line with another number of values.
pub(in crate::formats::recording) fn count(
    line: u64,
    found: usize,
    expected: usize,
) -> RecordingError {
    let found = counted(found as u64, "value");
    RecordingError::in_line(line, format!("found {found}, expected {expected}"))
}

/// Returns the error for a field that is not a value.
pub(in crate::formats::recording) fn wrong(
    line: u64,
    column: usize,
    field: &[u8],
) -> RecordingError {
    if let Some(value) = number::read(field).filter(|value| value.abs() > LARGEST_VALUE) {
        return RecordingError::in_field(line, column, too_large(value));
    }
    let found = shortened(&text(field));
    RecordingError::in_field(line, column, format!("found {found:?}, expected a number"))
}

/// Returns true if the lines of a text end in CR alone, as on the first Macintosh computers.
pub(in crate::formats) fn is_parted_by_cr(text: &[u8]) -> bool {
    let ends_before = text.iter().rev().skip(1).any(|&byte| byte == b'\r');
    ends_before && !text.contains(&b'\n') && !text.contains(&0)
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Returns the values of a line separated by commas, or its error; a dash is no cell.
    fn values(line: &str, count: usize) -> Result<Vec<f64>, String> {
        let mut values = vec![0.0; count];
        let read = |field: &[u8]| match field {
            b"-" => Field::NoCell,
            _ => value(field),
        };
        let fields = line.split(',').map(str::as_bytes);
        let filled = fill(&mut values, fields, 7, read);
        filled.map(|()| values).map_err(|error| error.to_string())
    }

    #[test]
    fn fields_beyond_the_values_are_empty() {
        assert_eq!(values("1,2.5,,", 2), Ok(vec![1.0, 2.5]));
        assert!(values("-,1", 2).expect("values")[0].is_nan());
        for (line, expected) in [
            ("1,,3", "line 7: found 1 value, expected 3"),
            ("1,2,3,,5", "line 7: found 5 values, expected 3"),
            ("1,x,3", "line 7, column 2: found \"x\", expected a number"),
        ] {
            assert_eq!(values(line, 3), Err(expected.to_owned()));
        }
        let error = values("1,1e301,3", 3).expect_err("too large");
        assert!(error.starts_with("line 7, column 2: "), "{error}");
        assert!(!error.contains("expected a number"), "{error}");
    }

    #[test]
    fn cr_alone_may_end_lines() {
        assert!(is_parted_by_cr(b"1\r2"));
        // The file may go on with LF.
        assert!(!is_parted_by_cr(b"1 2\r"));
        assert!(!is_parted_by_cr(b"1\r2\n"));
    }
}
