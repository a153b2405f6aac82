//! Keys: their notation, what each of them does in each place, and the user's changes.
//!
//! ```text
//! key            keys and their notation        action         the table of actions
//! binding        the table of places            default_keys   the keys of the actions in each place
//! keymap         default keys with a user's changes; help
//! ```

pub mod key;

pub mod binding;

pub mod default_keys;

pub mod action;

pub mod keymap;
