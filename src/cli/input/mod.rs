//! The input of commands: imprints, stored shapes and recordings, from files, standard input and the library.
//!
//! `shapes` decides what a `NAME|FILE` argument means; `content` reads a file and recognises its format; `lines`
//! answers lines one by one; `recording` reads the frames of a sensor, from a pipe through `spool`; `processing`
//! turns frames into imprints.

pub(super) mod content;

pub(super) mod lines;

pub(super) mod processing;

mod spool;

pub(super) mod recording;

pub(super) mod shapes;

pub(super) mod shape_set;
