//! The documents say what the program does, and the examples run.

#[cfg(feature = "sweep")]
#[path = "../common/paper.rs"]
mod paper;

#[cfg(feature = "sweep")]
mod examples;

#[cfg(feature = "cli")]
#[path = "../common/mod.rs"]
mod common;

#[cfg(feature = "cli")]
#[path = "../common/commands.rs"]
mod commands;

#[cfg(feature = "cli")]
mod docs;
