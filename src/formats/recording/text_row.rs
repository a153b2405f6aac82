//! A row of values in a line of text.
//!
//! The reader decides whether a field is a value ([`Field`]): formats differ in how they write a cell without a
//! value. The messages are the same in all formats: `line 7, column 3: found "x", expected a number`.

use crate::formats::framed::too_large;
use crate::formats::recording::error::RecordingError;
use crate::formats::recording::lines::text;
use crate::formats::recording::number;
use crate::frame::LARGEST_VALUE;
use crate::parameter::number::counted;
use crate::quote::shortened;

/// The content of a field.
pub(crate) enum Field {
    /// A value.
    Value(f64),
    /// No value: the cell does not exist.
    NoCell,
    /// Anything else.
    Wrong,
}

/// Reads a number that may be the value of a cell.
pub(crate) fn value(field: &[u8]) -> Field {
    match number::read(field) {
        Some(value) if value.abs() <= LARGEST_VALUE => Field::Value(value),
        _ => Field::Wrong,
    }
}

/// Fills a row of values from the fields of a line. Fields beyond the values must be empty.
///
/// # Errors
/// Returns an error if a field is wrong, or if there are more or fewer fields than values.
pub(crate) fn fill<'a>(
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
        *slot = match read(field) {
            Field::Value(value) => value,
            Field::NoCell => f64::NAN,
            Field::Wrong => return Err(wrong(number, found + 1, field)),
        };
    }
    match fields.filter(|(field, _)| !field.is_empty()).last() {
        Some((_, found)) => Err(count(number, found, expected)),
        None => Ok(()),
    }
}

/// Returns the error for a line with another number of values.
pub(crate) fn count(line: u64, found: usize, expected: usize) -> RecordingError {
    let found = counted(found as u64, "value");
    RecordingError::in_line(line, format!("found {found}, expected {expected}"))
}

/// Returns the error for a field that is not a value.
pub(crate) fn wrong(line: u64, column: usize, field: &[u8]) -> RecordingError {
    if let Some(value) = number::read(field).filter(|value| value.abs() > LARGEST_VALUE) {
        return RecordingError::in_field(line, column, too_large(value));
    }
    let found = shortened(&text(field));
    RecordingError::in_field(line, column, format!("found {found:?}, expected a number"))
}

/// Returns true if the lines of a text end in CR alone, as on the first Macintosh computers.
pub(crate) fn is_parted_by_cr(text: &[u8]) -> bool {
    let ends_before = text.iter().rev().skip(1).any(|&byte| byte == b'\r');
    ends_before && !text.contains(&b'\n') && !text.contains(&0)
}
