//! Help: the list of the keys that work in a place, as they are currently set. It can be searched:
//! [`crate::tui::search`].

pub mod page;

pub mod update;
