//! The matrix and the descriptors beside it.

pub mod layout;

pub mod view;

pub mod panel;

pub mod update;
