//! Poses: where a shape lies. Exact decimal ranges an axis, the grid they span, and the index of each pose in it.

mod range;

mod boundary;

mod grid;

mod symmetry;

mod index;

pub(crate) use boundary::Boundary;
pub use grid::{Anchor, GridError, MAX_POSES, Placed, Pose, PoseGrid, PoseIndex, Ranges};
pub use range::{DecimalRange, MAX_VALUES, RangeError};
pub(crate) use symmetry::period;
