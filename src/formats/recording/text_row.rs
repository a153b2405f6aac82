//! A row of values in a line of text.
//!
//! Whether a field is a value is the reader's to say ([`Field`]): what stands for a cell without a value differs from
//! format to format. The messages are the same in all: `line 7, column 3: found "x", expected a number`.

use crate::formats::framed::too_large;
use crate::formats::recording::error::RecordingError;
use crate::formats::recording::lines::text;
use crate::formats::recording::number;
use crate::frame::LARGEST_VALUE;
use crate::parameter::number::counted;
use crate::quote::shortened;

/// What a field says of its cell.
pub(crate) enum Field {
    /// Its value.
    Value(f64),
    /// That there is none.
    NoCell,
    /// Nothing that can be understood.
    Wrong,
}

/// A number, which may be a cell's value.
pub(crate) fn value(field: &[u8]) -> Field {
    match number::read(field) {
        Some(value) if value.abs() <= LARGEST_VALUE => Field::Value(value),
        _ => Field::Wrong,
    }
}

/// Fills a row of values from the fields of a line. Fields beyond the values must be empty.
///
/// # Errors
/// If a field is wrong, or there are more or fewer than values.
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

/// A line with another number of values.
pub(crate) fn count(line: u64, found: usize, expected: usize) -> RecordingError {
    let found = counted(found as u64, "value");
    RecordingError::in_line(line, format!("found {found}, expected {expected}"))
}

/// A field that is not a value.
pub(crate) fn wrong(line: u64, column: usize, field: &[u8]) -> RecordingError {
    if let Some(value) = number::read(field).filter(|value| value.abs() > LARGEST_VALUE) {
        return RecordingError::in_field(line, column, too_large(value));
    }
    let found = shortened(&text(field));
    RecordingError::in_field(line, column, format!("found {found:?}, expected a number"))
}

/// Whether the lines of a text end in CR alone, as on the first Macintosh computers.
pub(crate) fn is_parted_by_cr(text: &[u8]) -> bool {
    let ends_before = text.iter().rev().skip(1).any(|&byte| byte == b'\r');
    ends_before && !text.contains(&b'\n') && !text.contains(&0)
}
