//! The documents say what the program does, and the examples run.

#[path = "../common/paper.rs"]
mod paper;

mod examples;

#[path = "../common/mod.rs"]
mod common;

#[path = "../common/skip.rs"]
mod skip;

mod docs;
