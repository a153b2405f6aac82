//! Settings: the file, the environment and the flags that override it, and the values in effect.

pub(crate) mod sensors;

pub mod file;

pub(super) mod resolved;
