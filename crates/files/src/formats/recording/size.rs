//! Numbers of rows and columns, and distances between cells, as files give them.

use crate::formats::recording::error::in_line;
use taxel_core::frame::{FrameSize, MAX_FRAME_SIDE};
use taxel_core::parameter::Parameter;
use taxel_core::parameter::number::to_decimals;
use taxel_core::quote::shortened;
use taxel_core::sensor::Sensor;

use crate::error::ReadError;

/// Returns a number of rows or columns; None if it is 0 or larger than a frame can be.
pub(crate) fn side(length: impl TryInto<u16>) -> Option<u16> {
    let length = length.try_into().ok();
    length.filter(|side| FrameSize::SIDES.contains(side))
}

/// Returns the size of a frame; None if a side is out of range.
pub(crate) fn frame_size<T: TryInto<u16>>(columns: T, rows: T) -> Option<FrameSize> {
    FrameSize::of_sides(side(columns), side(rows))
}

/// Returns the rows and columns of an array with these sizes: the first two, if all others are 1.
pub(crate) fn matrix_size(sizes: &[u32]) -> Option<FrameSize> {
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
pub(super) fn stated(key: &str, mark: char, value: &str, line: u64) -> Result<u16, ReadError> {
    let length: Option<u16> = value.parse().ok();
    length.and_then(side).ok_or_else(|| {
        let found = shortened(value);
        let message = format!("{key}{mark}{found}: expected 1 to {MAX_FRAME_SIDE}");
        in_line(line, message)
    })
}

/// The decimals of a distance in mm: a picometre is smaller than any atom.
const DECIMALS: i32 = 9;

/// Converts a distance between cells in a unit such as `mm`, `Centimeters` or `in.` to mm, rounded to a picometre. None
/// if no unit has this name, if no sensor can have such a pitch, or if nothing is left after rounding.
pub(super) fn pitch_in_mm(length: f64, unit: &str) -> Option<f64> {
    let mm = match unit.to_lowercase().trim_end_matches('.') {
        "mm" | "millimeters" | "millimetres" => length,
        "cm" | "centimeters" | "centimetres" => length * 10.0,
        "m" | "meters" | "metres" => length * 1000.0,
        "in" | "inch" | "inches" => length * 25.4,
        _ => return None,
    };
    let rounded = to_decimals(mm, DECIMALS);
    Sensor::LARGEST.check(Parameter::Pitch, rounded).ok()
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
    fn a_pitch_is_rounded_before_it_is_checked() {
        for (length, unit, expected) in [
            (0.57, "cm", Some(5.7)),
            (0.05, "Inch", Some(1.27)),
            (1.27e-3, "m", Some(1.27)),
            (1.0, "m", Some(1000.0)),
            (1e-9, "mm", Some(1e-9)),
            (1e-13, "m", None),
            (1e308, "Inch", None),
            (1001.0, "mm", None),
            (0.0, "cm", None),
            (-1.0, "mm", None),
            (f64::NAN, "mm", None),
        ] {
            assert_eq!(pitch_in_mm(length, unit), expected, "{length} {unit}");
        }
    }
}
