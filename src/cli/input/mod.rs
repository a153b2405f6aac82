//! The input of commands: imprints, stored shapes and recordings, from files, standard input and the library.

pub(super) mod content;

pub(super) mod lines;

pub(crate) mod outlines;

pub(super) mod recording;

pub(super) mod shapes;
