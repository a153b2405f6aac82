//! The screen: a terminal program over the same core as the command line.
//!
//! The way of one keystroke:
//! ```text
//! terminal   bytes -> Key
//! remap      lookup(context, key) -> Message       one table: context, keys, message, help
//! update     update(&mut App, Message) -> Effect   the only writer
//! effect     perform(Effect) -> Message            the only one that touches the world; then update again
//! view       view(&App, &mut Frame)                reads only; one pane per file
//! ```
//! A [`script::Session`] replaces the first line by text and the terminal by a buffer; the middle is the same code.

pub mod keys;

pub mod widget;

pub mod app;

pub mod matrix;

pub mod form;

pub mod shapes;

pub mod prompt;

pub mod explore;

pub mod runtime;

pub mod terminal;

pub mod script;
