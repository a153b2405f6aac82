//! Settings: the file, the flags that override it, and the values in effect.
//!
//! | from | read by | beats |
//! |---|---|---|
//! | a flag | `flags` | everything |
//! | an environment variable | `resolved` | the file |
//! | the settings file | `file` | the default |
//! | the program's default | `resolved` | |
//!
//! `resolved` combines them, and remembers where each value comes from, for `taxel config`.

pub(crate) mod sensors;

pub mod file;

pub(super) mod pitch;

pub(super) mod flags;

pub(super) mod resolved;
