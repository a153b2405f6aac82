//! The search in help and in the history: a prompt at the bottom of the list, which follows with every character
//! typed.
//!
//! ```text
//! Search: undo   1 of 3          which match is in sight, of how many
//! Search: unod   no match        the list stays where it was
//! ```

pub mod page;

pub mod update;
