//! The matrix and the descriptors beside it.
//!
//! ```text
//! view     draws the taxels            layers   lines over them
//! panel    the descriptors             update   messages without a page
//! ```

pub mod layers;

pub mod view;

pub mod panel;

pub mod update;
