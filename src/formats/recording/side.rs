//! Numbers of rows and columns, as files state them: 1 to [`MAX_FRAME_SIDE`] each.

use crate::formats::recording::error::RecordingError;
use crate::frame::MAX_FRAME_SIDE;
use crate::quote::shortened;

/// A number of rows or columns; None of 0, and of what no frame has.
pub(crate) fn side(length: impl TryInto<u16>) -> Option<u16> {
    let length = length.try_into().ok();
    length.filter(|side| (1..=MAX_FRAME_SIDE).contains(side))
}

/// Rows and columns; None if either exceeds the largest side of a frame.
pub(crate) fn shape<T: TryInto<u16>>(rows: T, columns: T) -> Option<(u16, u16)> {
    side(rows).zip(side(columns))
}

/// The number that a line states for a key, as `ROWS 28` does; `mark` is what stands between.
///
/// # Errors
/// `ROWS 0: expected 1 to 512`, with the line.
pub(super) fn stated(key: &str, mark: char, value: &str, line: u64) -> Result<u16, RecordingError> {
    let length: Option<u16> = value.parse().ok();
    length.and_then(side).ok_or_else(|| {
        let found = shortened(value);
        let message = format!("{key}{mark}{found}: expected 1 to {MAX_FRAME_SIDE}");
        RecordingError::in_line(line, message)
    })
}
