//! Keys: their notation, what each of them does in each place, and the user's changes.
//!
//! ```text
//! key            keys and their notation        action         the table of actions
//! keymap         default keys with a user's changes; help
//! ```

pub mod key;

pub mod default_keys;

pub mod action;

pub mod keymap;
