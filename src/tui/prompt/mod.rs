//! What is typed in one line at the foot of the screen: a name to save under, and `:` commands.

pub mod commands;

pub mod state;

pub mod read;

pub mod view;

pub mod update;
