//! The list of stored shapes.

pub mod state;

pub mod layout;

pub mod view;

pub mod update;
