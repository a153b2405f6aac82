//! Work with the disk, which may answer late, or never.
//!
//! ```text
//! request          what is asked of the disk, and how it is carried out
//! queue            requests in order, on a thread of their own
//! reading          what is being read, for the page that asked
//! files            opens and writes files of imprints
//! write_access     where files may be written
//! journal_writer   unsaved work, written beside the program
//! leftover         unsaved work in a few words
//! reminders        what is remembered for the next run
//! shape_log        which stored shapes were used, for a record
//! ```

pub(super) mod request;

pub(super) mod queue;

pub(super) mod reading;

pub mod files;

pub(super) mod write_access;

pub mod journal_writer;

pub(super) mod leftover;

pub(super) mod reminders;

pub(super) mod shape_log;
