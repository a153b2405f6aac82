//! A picture: a stored imprint that is used as a shape, and is moved, zoomed and turned.
//!
//! The union of its active taxels, each a unit square, is the shape. It is placed in three steps. First, the top left
//! corner of its bounding rectangle goes to (`x0`, `y0`). Then everything, including that position, is scaled about
//! the origin of the plane. Last, the picture is turned **counter-clockwise** as seen, about the centre of its scaled
//! bounding rectangle. With angle 0, zoom 1 and its own corner it leaves its own imprint again. Source: the paper's
//! option Picture; the order of the steps is a convention of this project.

use std::sync::Arc;

use crate::geometry::{Pen, Point, Real, Solid, Turn};
use crate::imprint::Imprint;
use crate::parameter::Parameter;
use crate::values::Values;

/// The parameters of a picture, in the order in which forms show them.
pub const PICTURE_PARAMETERS: &[Parameter; 5] = &[
    Parameter::X0,
    Parameter::Y0,
    Parameter::Angle,
    Parameter::ZoomX,
    Parameter::ZoomY,
];

/// A stored imprint and its placement. The values are always finite, and the zooms above 0.
///
/// A picture may carry the name under which its imprint is stored. The name is displayed, but neither compared nor
/// written to files.
#[derive(Clone, Debug)]
pub struct Picture {
    imprint: Imprint,
    pub(crate) values: Values,
    /// The name of the stored imprint; shared, so that moving a picture does not allocate.
    pub(crate) name: Option<Arc<str>>,
}

impl PartialEq for Picture {
    fn eq(&self, other: &Self) -> bool {
        self.imprint == other.imprint && self.values == other.values
    }
}

impl Picture {
    /// Creates a picture that leaves the imprint where it is: at its own corner, with angle 0 and zoom 1.
    pub fn at_home(imprint: Imprint) -> Self {
        let bounds = imprint.bounds();
        let (left, top) = bounds.map_or((0, 0), |bounds| (bounds.left, bounds.top));
        Self {
            imprint,
            values: Values::upright(left.into(), top.into()),
            name: None,
        }
    }

    /// Returns the same picture with the name under which its imprint is stored.
    #[must_use]
    pub fn named(mut self, name: &str) -> Self {
        self.name = Some(name.into());
        self
    }

    /// Returns the stored imprint, without placement.
    pub fn imprint(&self) -> &Imprint {
        &self.imprint
    }

    /// Returns true if a map of the taxels of the bounding rectangle maps active taxels to active ones. It gets the
    /// rectangle's last column and row, and a taxel, all counted from the rectangle's corner.
    fn is_mapped_by(&self, map: impl Fn([u8; 2], [u8; 2]) -> [u8; 2]) -> bool {
        self.imprint.bounds().is_some_and(|bounds| {
            let (left, top) = (bounds.left, bounds.top);
            let last = [bounds.right - left - 1, bounds.bottom - top - 1];
            self.imprint.active().all(|(column, row)| {
                let [column, row] = map(last, [column - left, row - top]);
                self.imprint.get(left + column, top + row)
            })
        })
    }

    /// The number of rotations within a full turn that map the picture onto itself: 4 only with equal zooms.
    pub(crate) fn rotations(&self, equal_zooms: bool) -> u32 {
        if equal_zooms && self.is_mapped_by(|[_, bottom], [x, y]| [bottom - y, x]) {
            4
        } else if self.is_mapped_by(|[right, bottom], [x, y]| [right - x, bottom - y]) {
            2
        } else {
            1
        }
    }

    /// The sum in degrees of two angles at which the picture shows its mirror image, with right and left exchanged;
    /// None if there are none.
    pub(crate) fn mirror(&self) -> Option<u32> {
        if self.is_mapped_by(|[right, _], [x, y]| [right - x, y]) {
            Some(0)
        } else {
            self.is_mapped_by(|[_, bottom], [x, y]| [x, bottom - y])
                .then_some(180)
        }
    }

    /// The sides of the bounding rectangle before zoom and rotation; None for an empty imprint.
    pub(crate) fn box_sides(&self) -> Option<[f64; 2]> {
        let bounds = self.imprint.bounds()?;
        let sides = [bounds.right - bounds.left, bounds.bottom - bounds.top];
        Some(sides.map(f64::from))
    }
}

impl Solid for Picture {
    fn draw<T: Real>(&self, pen: &mut impl Pen<T>) {
        let Some(bounds) = self.imprint.bounds() else {
            return;
        };
        let value = |parameter: Parameter| T::decimal(self.values.of(parameter));
        let [x0, y0, angle, zoom_x, zoom_y] = PICTURE_PARAMETERS.map(value);
        let turn = Turn::clockwise(-angle);
        let size = |from: u8, to: u8| T::whole(i32::from(to - from));
        let half = Point::new(
            size(bounds.left, bounds.right) * T::HALF * zoom_x,
            size(bounds.top, bounds.bottom) * T::HALF * zoom_y,
        );
        let centre = Point::new(x0 * zoom_x, y0 * zoom_y).moved(half);
        let corner = |column: u8, row: u8| {
            let x = size(bounds.left, column) * zoom_x - half.x;
            let y = size(bounds.top, row) * zoom_y - half.y;
            centre.moved(turn.of(Point::new(x, y)))
        };
        // A side between two neighbouring taxels belongs to the boundary if just one of them is active. Runs of such
        // sides on a line are drawn as one edge.
        let word = |row: u8| self.imprint.words().get(usize::from(row)).unwrap_or(&0);
        for row in bounds.top..=bounds.bottom {
            // Row −1 wraps to 255, where no taxel is active.
            let (above, below) = (word(row.wrapping_sub(1)), word(row));
            for (left, right) in runs(below & !above) {
                pen.edge(corner(left, row), corner(right, row));
            }
            for (left, right) in runs(above & !below) {
                pen.edge(corner(right, row), corner(left, row));
            }
        }
        for column in bounds.left..=bounds.right {
            let bit = |row: u8, column: u8| u64::from(self.imprint.get(column, row)) << row;
            let line = |column: u8| bounds.rows().fold(0, |line, row| line | bit(row, column));
            // Likewise column −1.
            let (before, after) = (line(column.wrapping_sub(1)), line(column));
            for (top, bottom) in runs(after & !before) {
                pen.edge(corner(column, bottom), corner(column, top));
            }
            for (top, bottom) in runs(before & !after) {
                pen.edge(corner(column, top), corner(column, bottom));
            }
        }
    }
}

/// Iterates over the runs of ones in a word, each given by its first bit and the bit after its last.
fn runs(mut word: u64) -> impl Iterator<Item = (u8, u8)> {
    std::iter::from_fn(move || {
        if word == 0 {
            return None;
        }
        let first = word.trailing_zeros();
        let end = first + (word >> first).trailing_ones();
        word &= u64::MAX.unbounded_shl(end);
        Some((u8::try_from(first).ok()?, u8::try_from(end).ok()?))
    })
}

#[cfg(test)]
mod tests {
    #[test]
    fn a_picture_turns_about_the_middle_of_its_imprint() -> Result<(), Box<dyn std::error::Error>> {
        use crate::prelude::*;
        let sensor = Sensor::default();
        let bar: Imprint = "###".parse().expect("a row of taxels");
        let turned = Source::from(Picture::at_home(bar))
            .with(Parameter::X0, 5.0, &sensor)?
            .with(Parameter::Y0, 5.0, &sensor)?
            .with(Parameter::Angle, 90.0, &sensor)?;
        let bounds = Plane::new(sensor)
            .touch(&turned)
            .bounds()
            .expect("some are active");
        assert_eq!((bounds.columns(), bounds.rows()), (6..7, 4..7));
        Ok(())
    }
}
