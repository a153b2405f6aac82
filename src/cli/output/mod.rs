//! Writes answers: the character set, the tables, progress.

pub(super) mod charset;

pub(super) mod report;

pub(super) mod sweep_summary;

pub(super) mod progress;
