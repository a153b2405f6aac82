//! What touches the world outside for the screen: the library, the journal, and workers.

pub mod effect;

pub mod workers;

pub mod journal_writer;

pub mod perform;

pub mod mailbox;
