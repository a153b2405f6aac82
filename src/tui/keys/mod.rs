//! Keys: their notation, what each means where, and what a user has changed of it.

pub mod key;

pub mod binding;

pub mod default_keys;

pub mod action;

pub mod keymap;
