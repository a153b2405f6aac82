//! Numbers of rows and columns, as files state them: 1 to [`MAX_FRAME_SIDE`] each.

use crate::formats::recording::error::RecordingError;
use crate::frame::MAX_FRAME_SIDE;
use crate::parameter::number::counted;
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

/// Rows and columns of a message with this number of values: those that were named, if they have as many cells, otherwise those
/// that it states. Many programs publish a layout of one row, or none.
pub(crate) fn arranged(
    values: usize,
    stated: Option<(u16, u16)>,
    named: Option<(u16, u16)>,
) -> Option<(u16, u16)> {
    let cells = |(rows, columns): (u16, u16)| usize::from(rows) * usize::from(columns);
    let fits = named.filter(|&named| cells(named) == values);
    fits.or(stated)
}

/// That a frame has other rows and columns than those before it.
pub(super) fn changed((rows, columns): (u16, u16), before: (u16, u16)) -> String {
    let found = counted(rows, "row");
    let (before_rows, before_columns) = before;
    format!("found {found} of {columns}, expected {before_rows} of {before_columns} as before")
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
