//! What is typed in one line: a name to save under, and `:` commands.

pub mod name;

pub mod commands;

pub mod state;

pub mod explore;

pub mod command;
