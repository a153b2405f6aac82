//! Work in progress: what it is, and how far.

pub mod state;

pub mod view;
