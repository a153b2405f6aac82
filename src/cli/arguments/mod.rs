//! Defines the command-line arguments and reads them.
//!
//! | file | holds |
//! |---|---|
//! | `definitions` | the commands and their flags, for clap |
//! | `program` | the same for `script`, `config`, `completions`, `man` and the screen's own flags |
//! | `flags` | flags that several commands have |
//! | `parameters` | flags made from the table of parameters, and their values |
//! | `frames`, `watch` | the same for `frames` and `watch`, which share the flags of processing |
//! | `model/` | the same for `model`, a file for each subcommand |
//! | `recognise` | the same for `recognise` |
//! | `groups` | the commands by what they are for, as the help lists them |
//! | `help` | the longer texts of the help |
//! | `advice` | what helps where arguments are refused |
//! | `request` | from what clap has read to a `Request` |
//!
//! Everything that can be wrong with the arguments alone is found here, before a file is read or a thread started.

pub(super) mod help;

mod advice;

pub(super) mod parameters;

pub(super) mod program;

pub(super) mod flags;

pub(super) mod frames;

pub(super) mod watch;

pub(super) mod groups;

pub(super) mod definitions;

pub(super) mod request;

pub(super) mod model;

pub(super) mod recognise;
