//! Formats answers: character sets, imprints, evaluations, recordings, progress and more.

pub(super) mod charset;

pub(super) mod report;

pub(super) mod progress;

pub(super) mod evaluation;

pub(super) mod table;

pub(super) mod answer;
