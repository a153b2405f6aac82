//! Defines the command-line arguments and reads them.

pub(super) mod help;

pub(super) mod parameters;

pub(super) mod program;

pub(super) mod definitions;

pub(super) mod request;
