//! The matrix and the descriptors beside it.
//!
//! ```text
//! layout   places of the taxels        view     draws the taxels
//! update   messages without a page     usable   which keys do something now
//! ```

pub mod layout;

pub mod layers;

pub mod view;

pub mod panel;

pub mod update;
