//! The form of ranges to sweep.

pub mod state;

pub mod layout;

pub mod view;
