//! Poses: the positions and orientations of a shape.
//!
//! Each of the five axes (x0, y0, angle, and two zooms for pictures) has an exact range of decimals. Together the
//! ranges span a grid, whose poses are numbered.

mod axis;
mod default_ranges;
mod grid;
mod range;
mod symmetry;

pub use axis::{Anchor, Axis, PerAxis, Pose, PoseIndex, Ranges};
pub use default_ranges::{
    GivenRanges, Reach, SensorSides, check_given, default_ranges, figure_ranges,
};
pub(crate) use grid::Boundary;
pub use grid::{GridError, MAX_POSES, Placed, PoseGrid};
pub(crate) use range::ONE;
pub use range::{DecimalRange, MAX_VALUES, RangeError};
pub(crate) use symmetry::{AngleClasses, exact_period, period};
