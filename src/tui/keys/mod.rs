//! Keys: their notation, what each of them does in each place, and the user's changes.
//!
//! ```text
//! key            keys and their notation        action         what a user can ask for
//! default_keys   the table of keys by place     keymap         default keys with a user's changes; help
//! ```

pub mod key;

pub mod action;

pub mod default_keys;

pub mod keymap;

pub use key::*;
pub use keymap::*;
