use crate::geometry::{Moving, Pen, Point, Real, Solid};
use crate::pose::boundary::Boundary;
use crate::source::Source;

/// A shape in a pose of a grid, ready for a touch ([`Plane::touch`](crate::touch::Plane::touch)).
#[derive(Clone, Debug)]
pub struct Placed {
    rotated: Source,
    /// The shape before rotation, and the position of its centre, if the anchor is the centre. Both shapes then have
    /// their corner at the origin.
    centred: Option<(Source, f64, f64)>,
}

impl Placed {
    pub(crate) fn at_corner(rotated: Source) -> Self {
        Self {
            rotated,
            centred: None,
        }
    }

    /// Creates a placed shape with its centre at `centre`. Both given shapes have their corner at the origin.
    pub(crate) fn at_centre(rotated: Source, upright: Source, centre: (f64, f64)) -> Self {
        Self {
            rotated,
            centred: Some((upright, centre.0, centre.1)),
        }
    }
}

impl Solid for Placed {
    fn draw<T: Real>(&self, pen: &mut impl Pen<T>) {
        let Some((upright, x, y)) = &self.centred else {
            return self.rotated.draw(pen);
        };
        let centre = centre::<T>(upright);
        let by = Point::new(T::decimal(*x) - centre.x, T::decimal(*y) - centre.y);
        self.rotated.draw(&mut Moving { by, pen });
    }
}

/// Returns the centre of rotation of a shape that is not rotated, in cells.
pub(crate) fn centre<T: Real>(upright: &Source) -> Point<T> {
    let boundary = Boundary::of(upright);
    match upright {
        Source::Figure(_) => boundary.mean(),
        Source::Picture(_) => boundary.middle(),
    }
}
