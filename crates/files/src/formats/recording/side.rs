//! Numbers of rows and columns as files give them: 1 to [`MAX_FRAME_SIDE`] each.

use crate::formats::recording::error::RecordingError;
use crate::frame::{FrameSize, MAX_FRAME_SIDE};
use crate::quote::shortened;

/// Returns a number of rows or columns; None if it is 0 or larger than a frame can be.
pub(in crate::formats) fn side(length: impl TryInto<u16>) -> Option<u16> {
    let length = length.try_into().ok();
    length.filter(|side| FrameSize::SIDES.contains(side))
}

/// Returns the size of a frame; None if a side is out of range.
pub(in crate::formats) fn frame_size<T: TryInto<u16>>(columns: T, rows: T) -> Option<FrameSize> {
    FrameSize::of_sides(side(columns), side(rows))
}

/// Returns the rows and columns of an array with these sizes: the first two, if all others are 1.
pub(in crate::formats) fn matrix_size(sizes: &[u32]) -> Option<FrameSize> {
    match *sizes {
        [rows, columns, ref rest @ ..] if rest.iter().all(|&size| size == 1) => {
            frame_size(columns, rows)
        }
        _ => None,
    }
}

/// Returns the rows and columns of a message with this number of values: the `named` ones if they have that many
/// cells, otherwise those that the message states. Many programs publish a layout of one row, or none.
pub(super) fn arranged(
    values: usize,
    stated: Option<FrameSize>,
    named: Option<FrameSize>,
) -> Option<FrameSize> {
    named.filter(|named| named.cells() == values).or(stated)
}

/// Returns the message for a frame with other rows and columns than those before it.
pub(super) fn changed(size: FrameSize, before: FrameSize) -> String {
    format!("{} as before", other_than(size, before))
}

/// Returns the message for a frame with other rows and columns than expected.
pub(super) fn other_than(size: FrameSize, expected: FrameSize) -> String {
    format!(
        "found {}, expected {} of {}",
        size.in_words(),
        expected.rows(),
        expected.columns()
    )
}

/// Reads the number of rows or columns that a line states for a key, as `ROWS 28` does; `mark` is the character
/// between them.
///
/// # Errors
/// Returns an error such as `ROWS 0: expected 1 to 512`, with the line.
pub(super) fn stated(key: &str, mark: char, value: &str, line: u64) -> Result<u16, RecordingError> {
    let length: Option<u16> = value.parse().ok();
    length.and_then(side).ok_or_else(|| {
        let found = shortened(value);
        let message = format!("{key}{mark}{found}: expected 1 to {MAX_FRAME_SIDE}");
        RecordingError::in_line(line, message)
    })
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_side_is_1_to_512() {
        assert_eq!([0, 1, 512, 513].map(side), [None, Some(1), Some(512), None]);
        assert_eq!(side(-1), None);
        assert_eq!(frame_size(2, 513), None);
        let error = stated("ROWS", ' ', "0", 3).expect_err("no row");
        assert_eq!(error.to_string(), "line 3: ROWS 0: expected 1 to 512");
    }

    #[test]
    fn a_given_size_that_fits_takes_precedence_over_the_stated_one() {
        let (row, square) = (
            FrameSize::new(4, 1).expect("an allowed size"),
            FrameSize::new(2, 2).expect("an allowed size"),
        );
        assert_eq!(arranged(4, Some(row), Some(square)), Some(square));
        assert_eq!(
            arranged(
                4,
                Some(row),
                Some(FrameSize::new(3, 2).expect("an allowed size"))
            ),
            Some(row)
        );
        assert_eq!(
            changed(row, square),
            "found 1 row of 4, expected 2 of 2 as before"
        );
    }
}
