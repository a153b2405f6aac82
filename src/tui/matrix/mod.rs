//! The matrix and the descriptors beside it.
//!
//! ```text
//! layout   where the taxels are        view     draws them
//! rulers   numbers, and what is hidden  layers   outline, rectangle, CG and CD
//! files    :open and :write
//! update   keys without a page         panel    draws the descriptors
//! ```

pub mod layout;

mod rulers;

pub mod layers;

pub mod view;

pub mod panel;

pub mod files;

pub mod update;
