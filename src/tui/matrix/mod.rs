//! The matrix and the descriptors beside it.
//!
//! ```text
//! layout   where the taxels are        view     draws them
//! files    :open and :write
//! update   keys without a page         panel    draws the descriptors
//! ```

pub mod layout;

pub mod layers;

pub mod view;

pub mod panel;

pub mod files;

pub mod update;
