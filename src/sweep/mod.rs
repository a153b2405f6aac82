//! Every pose of a grid: runs of equal imprints, an atlas of the distinct ones, statistics of their descriptors.
//!
//! What the paper wanted and could only sample: "almost all possible imprints" of a shape. A sweep does not touch
//! pose by pose; it finds where along a range of positions the imprint changes, and is identical to touching all
//! the same. No I/O, no panics.

pub mod range;

mod boundary;

pub mod grid;

mod symmetry;

mod mirror;

pub mod plan;

mod layout;

mod census;

mod exact;

mod span;

mod polygon;

mod arc;

mod oval;

mod settle;

mod track;

mod ellipse;

mod events;

mod mark;

mod images;

mod runs;

pub mod quantity;

mod canonical;

pub mod atlas;

mod sums;

mod table;

mod spread;

pub mod statistics;

mod ideal;

pub mod survey;

pub mod place;

pub mod window;

pub mod sample;

pub mod order;

pub mod histogram;

pub mod parts;
