//! Files that the screen opens and writes.

pub(crate) mod files;
