//! Work with the disk, which may answer late, or never.
//!
//! ```text
//! request          what is asked of the disk, and how it is carried out
//! queue            requests in order, on a thread of their own
//! files            opens and writes files of imprints
//! journal_writer   unsaved work, written beside the program
//! ```

pub(super) mod request;

pub(super) mod queue;

pub mod files;

pub mod journal_writer;
