//! Reads recordings in JSON.
//!
//! ```text
//! cells   the cells of a frame, as a list
//! clock   the time of a frame, under keys of many names
//! lines   an object per frame and line
//! ```

mod cells;

pub(in crate::formats) mod clock;

pub(in crate::formats) mod lines;
