//! Work with the disk, which may answer late, or never.
//!
//! ```text
//! request          what is asked of the disk, and how it is carried out
//! queue            requests in order, on a thread of their own
//! files            opens and writes files of imprints
//! write_access     where files may be written
//! journal_writer   unsaved work, written beside the program
//! leftover         unsaved work in a few words
//! reminders        what is remembered for the next run
//! ```

pub(super) mod request;

pub(super) mod queue;

pub mod files;

pub(super) mod write_access;

pub mod journal_writer;

pub(super) mod leftover;

pub(super) mod reminders;
