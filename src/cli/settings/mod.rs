//! Settings: the file, the flags that override it, and the values in effect.

pub mod file;

pub(super) mod pitch;

pub(super) mod flags;

pub(super) mod resolved;
