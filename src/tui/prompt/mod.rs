//! The prompts, which take one line at the foot of the screen: a name to save under, and `:` commands.
//!
//! ```text
//! commands   the table of commands, and completion     view     impl Page for both prompts
//! read       a line becomes a message                  state    the fields, and earlier commands
//! ```

pub mod commands;

pub mod state;

pub mod read;

pub mod update;
