//! Tests of the project itself: its source keeps the rules of its modules, and its documents say what the program
//! does.

#[cfg(feature = "sweep")]
#[path = "../common/paper.rs"]
mod paper;

mod laws;

mod source;

mod measure;

#[cfg(feature = "sweep")]
mod examples;

#[cfg(feature = "cli")]
#[path = "../common/mod.rs"]
mod common;

#[cfg(feature = "cli")]
#[path = "../common/commands.rs"]
mod commands;

#[cfg(feature = "cli")]
#[path = "../common/skip.rs"]
mod skip;

#[cfg(feature = "cli")]
mod docs;

#[cfg(feature = "cli")]
mod version;
