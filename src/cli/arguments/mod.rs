//! Defines the command-line arguments and reads them.
//!
//! | file | holds |
//! |---|---|
//! | `definitions` | the program: all commands, and the order of their flags |
//! | `touch` | the commands `figure`, `picture`, `describe` and `batch` |
//! | `export` | the command `export`; the file and format of an export |
//! | `kept` | `--save` and `--export` of a touch |
//! | `form` | the form of an answer: JSON or a table, with the pitch |
//! | `sweep` | the commands `sweep` and `merge` |
//! | `model/` | the command `model`, with a file for each subcommand |
//! | `recognise` | the command `recognise` |
//! | `frames`, `watch` | the commands `frames` and `watch`, which share the flags of processing |
//! | `library` | the command `library` |
//! | `program` | `script`, `config`, `completions`, `man` and the screen's own flags |
//! | `flags` | flags that several commands have |
//! | `parameters` | flags made from the table of parameters, and their values |
//! | `groups` | the commands grouped by purpose, as the help lists them |
//! | `help` | the longer texts of the help |
//! | `advice` | tips for arguments that are refused |
//! | `request` | turns what clap has read into a `Request` |
//!
//! All errors in the arguments themselves are found here, before a file is read or a thread is started.

pub(super) mod help;

mod advice;

pub(super) mod parameters;

pub(super) mod program;

pub(super) mod flags;

pub(super) mod touch;

pub(super) mod export;

pub(super) mod kept;

pub(super) mod form;

pub(super) mod sweep;

pub(super) mod library;

pub(super) mod frames;

pub(super) mod watch;

pub(super) mod groups;

pub(super) mod definitions;

pub(super) mod request;

pub(super) mod model;

pub(super) mod recognise;
