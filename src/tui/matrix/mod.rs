//! The matrix and the descriptors beside it.

pub mod update;

pub mod view;

pub mod panel;
