//! Which imprint each position leaves.

pub mod letters;

pub mod layout;

pub mod view;
