//! Plane geometry: outlines that bound a shape, and the exact area of what they bound inside each cell of a grid.
//!
//! Frame: that of the sensory plane, x to the right, y **down**, the side of a cell as unit. Angles are degrees.
//! The module knows nothing of sensors, figures or imprints.

pub(crate) mod circle;

pub mod real;

pub mod outline;

mod curve;

mod grid;

mod arcs;

pub mod overlap;
