//! The form of ranges to sweep.
//!
//! ```text
//! state    fields, anchor, the resulting grid, the estimate
//! view     draws the form, and handles clicks
//! ```

pub mod state;

pub mod view;
