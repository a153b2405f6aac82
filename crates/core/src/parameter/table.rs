//! The table of parameters.

use std::fmt;

use crate::parameter::error::named;
use crate::parameter::number;

/// A quantity that a user can set.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash, PartialOrd, Ord)]
pub enum Parameter {
    /// Half of an ellipse's extent along x, before rotation.
    RadiusX,
    /// Half of an ellipse's extent along y, before rotation.
    RadiusY,
    /// A rectangle's side along x, before rotation.
    Length,
    /// A rectangle's side along y, before rotation.
    Width,
    /// The side of a triangle, pentagon, hexagon, heptagon or octagon.
    Side,
    /// The smallest x of the bounding rectangle before rotation.
    X0,
    /// The smallest y of the bounding rectangle before rotation.
    Y0,
    /// The rotation in degrees, as seen: clockwise for a figure, counter-clockwise for a picture.
    Angle,
    /// The distance from the outer outline to the outline of the hole.
    Thickness,
    /// The scale along x, of a picture and its position.
    ZoomX,
    /// The scale along y, of a picture and its position.
    ZoomY,
    /// The number of columns of the sensor.
    Columns,
    /// The number of rows of the sensor.
    Rows,
    /// The share of a cell that must be covered for its taxel to be active.
    Threshold,
    /// The side of a cell in mm.
    Pitch,
}

impl Parameter {
    fn name(self) -> &'static str {
        self.row().key
    }

    /// Returns the row of the parameter in [`PARAMETERS`].
    pub const fn row(self) -> &'static ParameterRow {
        &PARAMETERS[self as usize]
    }

    /// Returns the name of the parameter's flag, without dashes in front: the key with `-` for `_` and without a unit.
    pub fn flag(self) -> String {
        self.key_without_unit().replace('_', "-")
    }

    /// Returns the key without a unit, as in the settings file.
    pub fn key_without_unit(self) -> &'static str {
        let key = self.row().key;
        key.strip_suffix("_mm").unwrap_or(key)
    }

    /// Returns the parameter with a flag, given without dashes in front; None if there is none.
    pub fn from_flag(flag: &str) -> Option<Self> {
        let mut parameters = PARAMETERS.iter().map(|row| row.parameter);
        parameters.find(|own| own.flag() == flag)
    }

    /// Formats a value as a form shows it: with the form's decimals, or with all of its own if it has more.
    pub fn format(self, value: f64) -> String {
        let usual = format!("{value:.*}", usize::from(self.decimals_at(value)));
        let exact = usual.parse::<f64>().is_ok_and(|read| read == value);
        if exact { usual } else { number::short(value) }
    }

    /// Returns the number of decimals that a form shows of a value like this one, and steps by.
    pub(crate) fn decimals_at(self, value: f64) -> u8 {
        match self.row().decimals {
            Some(count) => count,
            None if value.abs() < 10.0 => 2,
            None => 1,
        }
    }
}

/// The unit of a parameter.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash)]
pub enum Unit {
    /// Sides of a cell.
    Cells,
    /// Degrees of arc.
    Degrees,
    /// A pure number.
    Ratio,
    /// A number of taxels.
    Taxels,
    /// Millimetres.
    Millimetres,
}

impl Unit {
    /// Returns the name of the unit; empty for a pure number.
    pub fn name(self) -> &'static str {
        match self {
            Self::Cells => "cells",
            Self::Degrees => "degrees",
            Self::Ratio => "",
            Self::Taxels => "taxels",
            Self::Millimetres => "mm",
        }
    }

    /// Returns a number, or a range of numbers, followed by the unit.
    pub fn after(self, number: &str) -> String {
        match self {
            Self::Degrees => format!("{number}°"),
            Self::Ratio => number.to_owned(),
            _ => format!("{number} {}", self.name()),
        }
    }
}

/// A row of [`PARAMETERS`].
#[derive(Clone, Copy, Debug)]
pub struct ParameterRow {
    /// The parameter.
    pub parameter: Parameter,
    /// The name in files. For the flag, see [`Parameter::flag`].
    pub key: &'static str,
    /// The name on the screen.
    pub label: &'static str,
    /// The name in the one-line summary of a shape.
    pub short: &'static str,
    /// The unit.
    pub unit: Unit,
    /// The value in a new form, if the sensor is large enough for it.
    pub default: f64,
    /// The meaning, in one line for help texts.
    pub meaning: &'static str,
    pub(super) low: Bound,
    pub(super) high: Bound,
    /// The decimals that a form shows; None as in the paper: two below 10, one from there on.
    pub(super) decimals: Option<u8>,
}

named!(
    Parameter,
    "parameter",
    &PARAMETERS.each_ref().map(|row| row.parameter)
);

impl ParameterRow {
    /// Returns the range on a sensor with this larger side. It is the same wherever a value comes from.
    pub(crate) fn range(&self, side: u8) -> Range {
        // The number of a bound, and whether that number itself is allowed.
        let bound = |bound: Bound| match bound {
            Bound::At(value) => (value, true),
            Bound::Beyond(value) => (value, false),
            Bound::Side(factor) => (factor * f64::from(side), true),
        };
        let ((low, with_low), (high, with_high)) = (bound(self.low), bound(self.high));
        Range {
            low,
            high,
            with_low,
            with_high,
        }
    }
}

/// The range of a length of a figure: above 0, up to the larger side of the sensor.
const LENGTH: ParameterRow = ParameterRow {
    parameter: Parameter::Side,
    key: "side",
    label: "Side",
    short: "side",
    unit: Unit::Cells,
    default: 4.0,
    meaning: "side of the regular polygon",
    low: Bound::Beyond(0.0),
    high: Bound::Side(1.0),
    decimals: None,
};

/// The range of a position, which may lie left of or above the sensor.
const POSITION: ParameterRow = ParameterRow {
    default: 4.0,
    low: Bound::Side(-1.0),
    ..LENGTH
};

/// The range of a scale. At the upper bound, one taxel becomes as large as the largest sensor.
const ZOOM: ParameterRow = ParameterRow {
    unit: Unit::Ratio,
    default: 1.0,
    high: Bound::At(64.0),
    ..LENGTH
};

/// The range of the number of columns or rows.
const COUNT: ParameterRow = ParameterRow {
    unit: Unit::Taxels,
    default: 16.0,
    low: Bound::At(1.0),
    high: Bound::At(64.0),
    decimals: Some(0),
    ..LENGTH
};

/// The table of parameters, in the order of forms and of [`Parameter`].
pub const PARAMETERS: &[ParameterRow; 15] = &[
    ParameterRow {
        parameter: Parameter::RadiusX,
        key: "radius_x",
        label: "Radius x",
        short: "rx",
        meaning: "half of the ellipse's width, before rotation",
        ..LENGTH
    },
    ParameterRow {
        parameter: Parameter::RadiusY,
        key: "radius_y",
        label: "Radius y",
        short: "ry",
        meaning: "half of the ellipse's height, before rotation",
        ..LENGTH
    },
    ParameterRow {
        parameter: Parameter::Length,
        key: "length",
        label: "Length",
        short: "length",
        default: 6.0,
        meaning: "the rectangle's side along x, before rotation",
        ..LENGTH
    },
    ParameterRow {
        parameter: Parameter::Width,
        key: "width",
        label: "Width",
        short: "width",
        default: 3.0,
        meaning: "the rectangle's side along y, before rotation",
        ..LENGTH
    },
    LENGTH,
    ParameterRow {
        parameter: Parameter::X0,
        key: "x0",
        label: "x0",
        short: "x0",
        meaning: "left edge of the bounding rectangle, before rotation",
        ..POSITION
    },
    ParameterRow {
        parameter: Parameter::Y0,
        key: "y0",
        label: "y0",
        short: "y0",
        meaning: "top edge of the bounding rectangle, before rotation; y runs down",
        ..POSITION
    },
    ParameterRow {
        parameter: Parameter::Angle,
        key: "angle",
        label: "Angle",
        short: "angle",
        unit: Unit::Degrees,
        default: 0.0,
        meaning: "rotation about the centre: figures clockwise, pictures counter-clockwise",
        low: Bound::At(0.0),
        high: Bound::Beyond(360.0),
        decimals: Some(0),
    },
    ParameterRow {
        parameter: Parameter::Thickness,
        key: "thickness",
        label: "Thickness",
        short: "thickness",
        default: 1.0,
        meaning: "distance from the outline to that of the hole; solid without it",
        ..LENGTH
    },
    ParameterRow {
        parameter: Parameter::ZoomX,
        key: "zoom_x",
        label: "Zoom x",
        short: "zoom x",
        meaning: "scale along x, of the picture and of its corner x0",
        ..ZOOM
    },
    ParameterRow {
        parameter: Parameter::ZoomY,
        key: "zoom_y",
        label: "Zoom y",
        short: "zoom y",
        meaning: "scale along y, of the picture and of its corner y0",
        ..ZOOM
    },
    ParameterRow {
        parameter: Parameter::Columns,
        key: "columns",
        label: "Columns",
        short: "columns",
        meaning: "columns of the sensor",
        ..COUNT
    },
    ParameterRow {
        parameter: Parameter::Rows,
        key: "rows",
        label: "Rows",
        short: "rows",
        meaning: "rows of the sensor",
        ..COUNT
    },
    ParameterRow {
        parameter: Parameter::Threshold,
        key: "threshold",
        label: "Threshold",
        short: "threshold",
        unit: Unit::Ratio,
        default: 0.5,
        meaning: "covered share of a cell that makes its taxel active",
        high: Bound::At(1.0),
        decimals: Some(3),
        ..LENGTH
    },
    ParameterRow {
        parameter: Parameter::Pitch,
        key: "pitch_mm",
        label: "Pitch",
        short: "pitch",
        unit: Unit::Millimetres,
        default: 1.0,
        meaning: "side of a cell",
        high: Bound::At(1000.0),
        decimals: Some(3),
        ..LENGTH
    },
];

#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) enum Bound {
    At(f64),
    /// Only numbers beyond the bound are allowed.
    Beyond(f64),
    /// The bound is this factor times the larger side of the sensor, and is allowed.
    Side(f64),
}

/// The numbers that a parameter allows. Written as "above 0, up to 16".
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Range {
    low: f64,
    high: f64,
    with_low: bool,
    with_high: bool,
}

impl Range {
    /// Returns true if a number is allowed. NaN and the infinities never are.
    pub fn contains(&self, value: f64) -> bool {
        (value > self.low || self.with_low && value == self.low)
            && (value < self.high || self.with_high && value == self.high)
    }

    /// Returns the message that names the bound that excludes a number: "is below -16", "is not above 0". The number
    /// must not be in the range.
    pub(super) fn missed_by(&self, value: f64) -> String {
        let Self { low, high, .. } = self;
        if value.is_nan() {
            "is not a number".to_owned()
        } else if self.with_low && value < *low {
            format!("is below {low}")
        } else if !self.with_low && value <= *low {
            format!("is not above {low}")
        } else if self.with_high {
            format!("is above {high}")
        } else {
            format!("is not below {high}")
        }
    }

    /// The number nearest to `value`, at least a step from a bound that is not allowed itself.
    pub(crate) fn nearest(&self, value: f64, step: f64) -> f64 {
        let low = if self.with_low {
            self.low
        } else {
            self.low + step
        };
        let high = if self.with_high {
            self.high
        } else {
            self.high - step
        };
        value.min(high).max(low)
    }
}

impl fmt::Display for Range {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        let Self { low, high, .. } = self;
        let (above, to) = match (self.with_low, self.with_high) {
            (true, true) => ("", " to "),
            (true, false) => ("", " to below "),
            (false, true) => ("above ", ", up to "),
            (false, false) => ("above ", ", below "),
        };
        write!(f, "{above}{low}{to}{high}")
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn every_parameter_is_found_by_its_own_flag_and_stands_at_its_own_row() {
        for (index, row) in PARAMETERS.iter().enumerate() {
            assert_eq!(row.parameter as usize, index, "{}", row.key);
            let flag = row.parameter.flag();
            assert_eq!(Parameter::from_flag(&flag), Some(row.parameter), "{flag}");
        }
        assert_eq!(Parameter::Pitch.flag(), "pitch");
    }

    #[test]
    fn a_value_is_written_with_the_decimals_of_forms_or_all_of_its_own() {
        assert_eq!(Parameter::from_flag("radius-x"), Some(Parameter::RadiusX));
        assert_eq!(Parameter::from_flag("radius_x"), None);
        assert_eq!(Parameter::X0.format(1.5), "1.50");
        assert_eq!(Parameter::X0.format(10.0), "10.0");
        assert_eq!(Parameter::X0.format(1.2345), "1.2345");
        assert_eq!(Unit::Cells.after("-16 to 16"), "-16 to 16 cells");
        assert_eq!(Unit::Degrees.after("0 to below 360"), "0 to below 360°");
        assert_eq!(Unit::Ratio.after("0.5"), "0.5");
    }
}
