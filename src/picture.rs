//! A picture: a stored imprint as a shape of its own, moved, zoomed and turned.
//!
//! Its active taxels are unit squares, and their union is the shape. The top left corner of its bounding rectangle
//! goes to (`x0`, `y0`); then everything, that position included, is scaled about the origin of the plane; then it is
//! turned **counter-clockwise** as seen about the centre of its scaled bounding rectangle. Angle 0 and zoom 1 at its
//! own corner give the same imprint again. Source: the paper's option Picture; its order is a convention of this
//! project.

use std::sync::Arc;

use crate::geometry::{Pen, Point, Real, Solid, Turn};
use crate::imprint::Imprint;
use crate::parameter::{Parameter, ParameterError};

/// The parameters of a picture, in the order of forms.
pub const PICTURE_PARAMETERS: [Parameter; 5] = [
    Parameter::X0,
    Parameter::Y0,
    Parameter::Angle,
    Parameter::ZoomX,
    Parameter::ZoomY,
];

/// A stored imprint and where it goes. Its values are always finite, its zooms above 0.
///
/// It may know the name that its imprint is stored under. That is a remark: it is shown, but neither compared nor
/// written to files.
#[derive(Clone, Debug)]
pub struct Picture {
    imprint: Imprint,
    values: [f64; PICTURE_PARAMETERS.len()],
    /// Shared, so that a picture is moved about without allocating.
    name: Option<Arc<str>>,
}

impl PartialEq for Picture {
    fn eq(&self, other: &Self) -> bool {
        self.imprint == other.imprint && self.values == other.values
    }
}

impl Picture {
    /// The imprint where it is: its own corner, angle 0, zoom 1.
    pub fn at_home(imprint: Imprint) -> Self {
        let (left, top) = imprint
            .bounds()
            .map_or((0, 0), |bounds| (bounds.left, bounds.top));
        Self {
            imprint,
            values: [f64::from(left), f64::from(top), 0.0, 1.0, 1.0],
            name: None,
        }
    }

    /// The same picture with the name that its imprint is stored under.
    #[must_use]
    pub fn named(self, name: &str) -> Self {
        Self {
            name: Some(name.into()),
            ..self
        }
    }

    /// A picture for a sensor whose larger side is `side`, its values asked for one by one.
    ///
    /// # Errors
    /// The first value that is missing or out of range.
    pub fn new(
        imprint: Imprint,
        side: u8,
        mut value: impl FnMut(Parameter) -> Option<f64>,
    ) -> Result<Self, ParameterError> {
        let mut picture = Self::at_home(imprint);
        for parameter in PICTURE_PARAMETERS {
            let missing = ParameterError::Missing {
                parameter,
                range: parameter.range(side),
            };
            picture = picture.with(parameter, value(parameter).ok_or(missing)?, side)?;
        }
        Ok(picture)
    }

    /// The same picture with one value changed; `value` in the parameter's unit. Unchanged by a parameter that it does not have,
    /// whose value is checked all the same.
    ///
    /// # Errors
    /// Where the value is out of range on a sensor whose larger side is `side`.
    pub fn with(
        mut self,
        parameter: Parameter,
        value: f64,
        side: u8,
    ) -> Result<Self, ParameterError> {
        let value = parameter.check(value, side)?;
        if let Some(index) = PICTURE_PARAMETERS.iter().position(|&own| own == parameter) {
            self.values[index] = value;
        }
        Ok(self)
    }

    /// One of its values; none of a parameter that it does not have.
    pub fn get(&self, parameter: Parameter) -> Option<f64> {
        PICTURE_PARAMETERS
            .iter()
            .position(|&own| own == parameter)
            .map(|index| self.values[index])
    }

    /// The imprint that is moved.
    pub fn imprint(&self) -> &Imprint {
        &self.imprint
    }
}

impl Solid for Picture {
    fn draw<T: Real>(&self, pen: &mut impl Pen<T>) {
        let Some(bounds) = self.imprint.bounds() else {
            return;
        };
        let [x0, y0, angle, zoom_x, zoom_y] = self.values.map(T::decimal);
        let turn = Turn::clockwise(-angle);
        let size = |from: u8, to: u8| T::whole(i32::from(to - from));
        let half = Point::new(
            size(bounds.left, bounds.right) * T::HALF * zoom_x,
            size(bounds.top, bounds.bottom) * T::HALF * zoom_y,
        );
        let centre = Point::new(x0 * zoom_x, y0 * zoom_y).moved(half);
        let place = |column: u8, row: u8| {
            let x = size(bounds.left, column) * zoom_x - half.x;
            let y = size(bounds.top, row) * zoom_y - half.y;
            centre.moved(turn.of(Point::new(x, y)))
        };
        // A side between two rows or two columns is boundary where just one of the two taxels is active. Runs of
        // such sides in a line are drawn as one edge.
        let word = |row: i32| {
            usize::try_from(row)
                .ok()
                .and_then(|row| self.imprint.words().get(row))
                .unwrap_or(&0)
        };
        for row in bounds.top..=bounds.bottom {
            let (above, below) = (*word(i32::from(row) - 1), *word(i32::from(row)));
            for (left, right) in runs(below & !above) {
                pen.edge(place(left, row), place(right, row));
            }
            for (left, right) in runs(above & !below) {
                pen.edge(place(right, row), place(left, row));
            }
        }
        for column in bounds.left..=bounds.right {
            let bit = |row: u8, column: u8| u64::from(self.imprint.get(column, row)) << row;
            let line = |column: u8| bounds.rows().fold(0, |line, row| line | bit(row, column));
            // Column −1 wraps to 255, where no taxel is.
            let (before, after) = (line(column.wrapping_sub(1)), line(column));
            for (top, bottom) in runs(after & !before) {
                pen.edge(place(column, bottom), place(column, top));
            }
            for (top, bottom) in runs(before & !after) {
                pen.edge(place(column, top), place(column, bottom));
            }
        }
    }
}

/// The runs of ones in a word, each by its first bit and the one past its last.
fn runs(mut word: u64) -> impl Iterator<Item = (u8, u8)> {
    std::iter::from_fn(move || {
        if word == 0 {
            return None;
        }
        let first = word.trailing_zeros();
        let end = first + (word >> first).trailing_ones();
        word &= u64::MAX.checked_shl(end).unwrap_or(0);
        Some((u8::try_from(first).ok()?, u8::try_from(end).ok()?))
    })
}

impl std::fmt::Display for Picture {
    /// Where the picture was put, in one line.
    fn fmt(&self, f: &mut std::fmt::Formatter<'_>) -> std::fmt::Result {
        let text = |index: usize| PICTURE_PARAMETERS[index].format(self.values[index]);
        f.write_str("picture")?;
        if let Some(name) = &self.name {
            write!(f, " of {name}")?;
        }
        write!(
            f,
            " at {}, {}, {}°, zoom {} x {}",
            text(0),
            text(1),
            text(2),
            text(3),
            text(4)
        )
    }
}
