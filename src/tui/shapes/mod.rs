//! The list of stored shapes.

pub mod purpose;

pub mod state;

pub mod view;
