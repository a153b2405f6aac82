//! How often each value of a descriptor occurs.

pub mod view;
