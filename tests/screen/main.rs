//! Tests of the screen: in memory, driven by keys and scripts, and of the real program in a pseudo-terminal.

#[path = "../common/array.rs"]
mod array;

#[path = "../common/property.rs"]
mod property;

#[path = "../common/skip.rs"]
mod skip;

#[path = "../common/wait.rs"]
mod wait;

mod session;

mod files;
mod frames;
mod key_lines;
mod keys;

mod library;

mod live;

mod prompt;

mod recognise;

mod screens;

mod scripts;

mod explore;

mod pty;
