//! The state of the program, what changes it, and the screen as a whole.
//!
//! ```text
//! document   the document on the matrix, and its reading   history: all its states
//! message    what a key means                          worker_event: what workers report
//! library    requests to the library, and its answers
//! page       the trait of pages                        dialog: the table of pages
//! line_prompt  pages that are one line of text
//! state      App                                       update: all changes begin there
//! change     changes of the document                   mouse: what clicks and drags do
//! unsaved    what would be lost                        quit: the end, and the question before it
//! steps      the steps of the history, in words
//! layout     the panes of the screen                   view: draws them
//! notice     what is said at the bottom, and the area that it leaves to a page
//! menu  title  status      the lines above and below
//! ```

pub mod document;

pub mod library;

pub mod message;

pub mod worker_event;

pub mod page;

pub mod line_prompt;

pub mod layout;

pub mod dialog;

pub mod state;

pub mod steps;

pub mod history;

pub mod unsaved;

pub mod change;

pub(in crate::tui) mod quit;

pub mod mouse;

pub mod update;

pub mod notice;

pub mod menu;

pub mod title;

pub mod status;

pub mod view;
