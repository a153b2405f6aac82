//! Errors of a recording, with their places; and those that ask for more.

use taxel_core::frame::FrameSize;
use taxel_core::parameter::number::counted;

use crate::error::{ReadError, ReadErrorKind};
use crate::formats::recording::format::FORMATS;

pub(super) fn in_line(line: u64, message: impl Into<String>) -> ReadError {
    ReadError::new(message).in_line(line)
}

pub(super) fn in_field(line: u64, column: usize, message: impl Into<String>) -> ReadError {
    in_line(line, message).in_column(column as u64)
}

pub(super) fn known_formats() -> String {
    FORMATS.each_ref().map(|format| format.title).join(", ")
}

/// The error for what has none of the known formats.
pub fn unknown_format() -> ReadError {
    let formats = known_formats();
    ReadError::new(format!(
        "not a recording of a known format: expected {formats}"
    ))
    .of_kind(ReadErrorKind::UnknownFormat)
}

/// The error for a file of another kind, with its article: "an imprint as text".
pub(super) fn foreign(kind: &str) -> ReadError {
    ReadError::new(format!("{kind}, expected {}", known_formats()))
}

/// The error for frames of this number of values whose rows and columns are unknown, though some may be given: then
/// they do not fit.
pub fn unshaped(values: u64, given: Option<FrameSize>) -> ReadError {
    let values = counted(values, "value");
    match given {
        None => ReadError::new(format!(
            "{values} a frame, but its rows and columns are not stated"
        ))
        .of_kind(ReadErrorKind::Unsized),
        Some(size) => ReadError::new(format!(
            "found {values} a frame, expected {}: {}",
            size.cells(),
            size.in_words()
        )),
    }
}
