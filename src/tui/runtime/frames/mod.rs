//! The frames of a source: watched, recorded, or read frame by frame for a script.

pub(super) mod source;

pub(super) mod watcher;

pub(super) mod feed;

pub(super) mod recording;
