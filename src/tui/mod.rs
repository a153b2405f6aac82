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

pub mod key;

pub mod document;

pub mod purpose;

pub mod exploring;

pub mod message;

pub mod text_field;

pub mod columns;

pub mod binding;

pub mod keymap;

pub mod action;

pub mod remap;

pub mod theme;

pub mod form;

pub mod form_dialog;

pub mod list;

pub mod name_dialog;

pub mod commands;

pub mod command_dialog;

pub mod explore;

pub mod dialog;

pub mod app;

pub mod command;

pub mod layout;

pub mod explore_layout;

pub mod hit;

pub mod request;

pub mod update;

pub mod effect;

pub mod view;

pub mod terminal;

pub mod script;
