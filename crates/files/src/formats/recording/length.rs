//! Distances between cells as files give them: a number and a unit.

use crate::parameter::Parameter;
use crate::parameter::number::to_decimals;
use crate::sensor::Sensor;

/// The decimals of a distance in mm: a picometre is smaller than any atom.
const DECIMALS: i32 = 9;

/// A unit of length.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(in crate::formats::recording) enum LengthUnit {
    Micrometres,
    Millimetres,
    Centimetres,
    Metres,
    Inches,
}

impl LengthUnit {
    /// Returns the unit that a text names, such as `mm`, `Centimeters` or `in.`.
    pub(in crate::formats::recording) fn of_name(text: &str) -> Option<Self> {
        let name = text.to_lowercase();
        match name.trim_end_matches('.') {
            // The micro sign and the Greek letter look the same.
            "um" | "\u{b5}m" | "\u{3bc}m" | "micrometers" | "micrometres" | "microns" => {
                Some(Self::Micrometres)
            }
            "mm" | "millimeters" | "millimetres" => Some(Self::Millimetres),
            "cm" | "centimeters" | "centimetres" => Some(Self::Centimetres),
            "m" | "meters" | "metres" => Some(Self::Metres),
            "in" | "inch" | "inches" => Some(Self::Inches),
            _ => None,
        }
    }

    /// Converts a distance between cells from this unit to mm, rounded to a picometre. None if no sensor can have
    /// such a pitch, or if nothing is left after rounding.
    pub(in crate::formats::recording) fn pitch_in_mm(self, length: f64) -> Option<f64> {
        let mm = match self {
            Self::Micrometres => length / 1000.0,
            Self::Millimetres => length,
            Self::Centimetres => length * 10.0,
            Self::Metres => length * 1000.0,
            Self::Inches => length * 25.4,
        };
        let rounded = to_decimals(mm, DECIMALS);
        Sensor::LARGEST.check(Parameter::Pitch, rounded).ok()
    }
}

/// Returns the distances along x and along y, each rounded and checked; None if one of them is unknown or cannot be a
/// pitch.
pub(in crate::formats::recording) fn pitches_in_mm(
    distances: [Option<f64>; 2],
    unit: LengthUnit,
) -> Option<[f64; 2]> {
    let [x, y] = distances.map(|distance| unit.pitch_in_mm(distance?));
    Some([x?, y?])
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_pitch_is_rounded_before_it_is_checked() {
        for (length, unit, expected) in [
            (0.57, LengthUnit::Centimetres, Some(5.7)),
            (0.05, LengthUnit::Inches, Some(1.27)),
            (1270.0, LengthUnit::Micrometres, Some(1.27)),
            (1.27e-3, LengthUnit::Metres, Some(1.27)),
            (1.0, LengthUnit::Metres, Some(1000.0)),
            (1e-9, LengthUnit::Millimetres, Some(1e-9)),
            (1e-13, LengthUnit::Metres, None),
            (1e308, LengthUnit::Inches, None),
            (1001.0, LengthUnit::Millimetres, None),
            (0.0, LengthUnit::Centimetres, None),
            (-1.0, LengthUnit::Millimetres, None),
            (f64::NAN, LengthUnit::Millimetres, None),
        ] {
            assert_eq!(unit.pitch_in_mm(length), expected, "{length} {unit:?}");
        }
    }
}
