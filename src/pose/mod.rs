//! Poses: where a shape lies. Exact decimal ranges an axis, the grid they span, and the index of each pose in it.

pub mod range;

pub(crate) mod boundary;

pub mod grid;

pub(crate) mod symmetry;

pub mod index;
