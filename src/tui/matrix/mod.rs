//! The matrix and the descriptors beside it.
//!
//! ```text
//! layout   where the taxels are        view     draws them
//! update   keys without a page         panel    draws the descriptors
//! ```

pub mod layout;

pub mod layers;

pub mod view;

pub mod panel;

pub mod update;
