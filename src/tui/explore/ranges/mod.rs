//! The form of ranges to sweep.
//!
//! ```text
//! state    fields, anchor, the grid that they make, the estimate
//! layout   which line a row has
//! view     impl Page for RangesForm
//! ```

pub mod state;

pub mod layout;

pub mod view;
