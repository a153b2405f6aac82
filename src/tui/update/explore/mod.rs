//! Exploring all imprints of a shape: from the form of ranges to what was found and back onto the matrix.

mod act;

mod results;

mod told;

pub(super) use act::{act, in_ranges, in_running, put_away};
pub(super) use results::{in_export, in_results};
pub(super) use told::hear;
