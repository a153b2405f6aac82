//! The library on the screen: acts on it, and the list of its shapes.

pub(crate) mod library;

pub(crate) mod list;
