//! Formats answers: character sets, imprints, evaluations, recordings, progress and more.
//!
//! Most of it is text that commands return and [`crate::cli::run`] writes. `line_writer` writes answers that come one by
//! one; `note` and `progress` write to standard error.

pub(super) mod charset;

pub(super) mod note;

pub(super) mod report;

pub(super) mod heat_map;

pub(super) mod line_writer;

pub(super) mod recording_list;

pub(super) mod ranges;

pub(super) mod sweep_summary;

pub(super) mod progress;

pub(super) mod evaluation;

pub(super) mod plot;

pub(super) mod pose;

pub(super) mod separation;

pub(super) mod answer;
