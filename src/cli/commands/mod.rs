//! The commands. Each takes its checked arguments and returns its answer as text or bytes, which [`crate::cli::run`]
//! prints; answers that come one by one are written at once. Files that a command writes are complete or do not exist:
//! they get their names last.

#![allow(
    clippy::doc_markdown,
    reason = "the documentation of an argument is its help"
)]

pub(super) mod export;

pub(super) mod figure;

pub(super) mod picture;

pub(super) mod describe;

pub(super) mod batch;

pub(super) mod library;

pub(super) mod sweep;

pub(super) mod merge;

pub(super) mod model;

pub(crate) mod recognise;

pub(crate) mod frame_flags;

pub(super) mod frames;

pub(super) mod watch;

pub(super) mod screen;

pub(super) mod script;

pub(super) mod man;

pub(super) mod config;

pub(super) mod completions;
