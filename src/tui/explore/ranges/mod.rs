//! The form of ranges to sweep.
//!
//! ```text
//! state    fields, anchor, the resulting grid, the estimate
//! layout   the lines of the rows
//! view     draws the form, and handles clicks
//! ```

pub mod state;

pub mod layout;

pub mod view;
