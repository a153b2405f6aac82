//! Reads text: its lines, the fields of a line, and the numbers in them.
//!
//! ```text
//! number      a number, read fast
//! lines       one line at a time, in the same memory
//! row         the values of a line, with the messages about wrong ones
//! separator   what separates fields; comments, quotes, and words for a missing value
//! ```

pub(super) mod number;

pub(in crate::formats) mod lines;

pub(in crate::formats) mod row;

pub(in crate::formats) mod separator;
