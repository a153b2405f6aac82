//! The matrix and the descriptors beside it.
//!
//! ```text
//! layout   places of the taxels        view     draws the taxels
//! rulers   numbers and scroll arrows   layers   outline, rectangle, CG and CD
//! files    :open, :write and :export   panel    draws the descriptors
//! update   messages without a page     usable   which keys do something now
//! ```

pub mod layout;

pub(in crate::tui) mod rulers;

pub mod layers;

pub mod view;

pub mod panel;

pub mod files;

pub mod usable;

pub mod update;
