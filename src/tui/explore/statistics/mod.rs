//! Statistics of every descriptor.

pub mod layout;

pub mod view;
