//! The screen: a terminal program over the same core as the command line.
//!
//! The path of a keystroke:
//! ```text
//! terminal   bytes -> Key
//! keys       lookup(context, key) -> Message       one table of actions, one of default keys
//! app        update(&mut App, Message)             all changes of the state
//! jobs       disk, read, run(closure) -> Answer    threads; an answer is a closure over the state, too
//! app        view(&App, &mut Frame)                reads the state and draws it
//! ```
//! A [`script::Session`] replaces the terminal by text and a buffer; everything between is the same code.

#![allow(
    clippy::missing_errors_doc,
    reason = "the screen is no library: its messages say what is wrong"
)]
#![expect(
    clippy::trivially_copy_pass_by_ref,
    reason = "a theme is borrowed like all that views draw with, however small it is"
)]

pub mod keys;

pub mod widget;

pub mod app;

pub mod explain;

pub mod help;

pub mod compare;

pub mod grid;

pub mod matrix;

pub mod form;

pub(crate) mod library;

pub(crate) mod list;

pub mod prompt;

pub mod explore;

pub mod recognise;

pub mod live;

pub mod jobs;

pub(crate) mod files;

pub mod terminal;

pub mod script;
