//! The ranges of a grid in words: `x0 5:5.99:0.01 cells, y0 5:5.99:0.01 cells, angle 0:359:1°`.

use crate::pose::{Axis, Ranges};

pub(crate) fn ranges_in_words(axes: impl Iterator<Item = Axis>, ranges: &Ranges) -> String {
    let words = axes.map(|axis| {
        let unit = axis.parameter().row().unit;
        format!("{} {}", axis.name(), unit.after(&ranges[axis].to_string()))
    });
    words.collect::<Vec<_>>().join(", ")
}
