//! The state of the program, what changes it, and the screen as a whole.

pub mod document;

pub mod message;

pub mod dialog;

pub mod state;

pub mod layout;

pub mod hit;

pub mod change;

pub mod library_event;

pub mod mouse;

pub mod dialog_update;

pub mod update;

pub mod menu;

pub mod status;

pub mod view;
