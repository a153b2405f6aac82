//! Defines the command-line arguments for clap, a file for related commands, and reads them into a `Request`.
//!
//! All errors in the arguments themselves are found here, before a file is read or a thread is started.

pub(super) mod help;

pub(super) mod flags;

#[allow(dead_code, reason = "for commands that are still read by hand")]
pub(crate) mod parameters;

pub(super) mod library;

pub(super) mod definitions;

pub(super) mod request;
