//! The prompts, which take one line at the foot of the screen: a name to save under, and `:` commands.
//!
//! ```text
//! commands   what may be typed, and its completion
//! state      the fields, and earlier commands          update   their messages
//! ```

pub mod commands;

pub mod state;

pub mod update;
