//! Formats answers: character sets, imprints, evaluations, recordings, progress and more.
//!
//! Only `line_writer` writes to standard output. Other answers are returned by the commands as text, and
//! [`crate::cli::run`] writes them.

pub(super) mod charset;

pub(super) mod note;

pub(super) mod report;

pub(super) mod heat_map;

pub(super) mod line_writer;

pub(super) mod record_writer;

pub(super) mod recording_list;

pub(super) mod sweep_summary;

pub(super) mod progress;

pub(super) mod evaluation;

pub(super) mod plot;

pub(super) mod pose;

pub(super) mod separation;

pub(super) mod answer;
