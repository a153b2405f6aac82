//! Reads what commands are given: files, standard input, shapes of the library.

pub(super) mod content;

pub(super) mod shapes;
