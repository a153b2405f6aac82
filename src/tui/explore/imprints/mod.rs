//! The list of distinct imprints.

pub mod layout;

pub mod view;
