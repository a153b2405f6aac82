//! What is where while all imprints of a shape are explored.
//!
//! ```text
//! | 1 imprints  2 statistics  3 histogram  4 map       |
//! | how many poses and imprints                        |
//! | list of imprints       | thumbnails                |
//! | or statistics, or histogram, or                    |
//! | map of x0 and y0       | the pose at its cursor    |
//! ```

mod lines;

pub mod ranges;

pub mod panes;

pub mod imprints;

pub mod statistics;

pub mod map;

pub mod point;
