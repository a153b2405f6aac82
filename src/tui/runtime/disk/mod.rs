//! Work with the disk, which may answer late, or never.

pub(super) mod request;

pub(super) mod queue;

pub mod files;

pub mod journal_writer;
