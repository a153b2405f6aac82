//! The commands, one file each.

pub(super) mod export;

pub(super) mod describe;

pub(super) mod touch;

pub(super) mod library;

pub(super) mod batch;

pub(super) mod sweep;

pub(super) mod screen;

pub(super) mod script;

pub(super) mod completions;

pub(super) mod man;
