//! Plane geometry: outlines that bound a shape, and the exact area that they enclose in each cell of a grid.
//!
//! Coordinates are those of the sensory plane: x to the right, y **down**, in sides of a cell. Angles are in degrees.
//! This room knows nothing about sensors, figures or imprints.
//!
//! A shape is any type that implements [`Solid`]: it draws its boundary with a [`Pen`], in numbers of any precision
//! ([`Real`]).

mod real;

mod outline;

mod ellipse;

mod overlap;

pub use outline::{Ellipse, Extent, Pen, Point, Side, Solid, Turn};
pub(crate) use outline::{MOST_CORNERS, Moving, RegularPolygon};
pub use overlap::cell_area;
pub(crate) use overlap::{Drawn, Overlap, row_areas};
pub(crate) use real::nearest;
pub use real::{Double, Real};
