//! What is written and read: files of other programs, drawings, the stored shapes, and hostile bytes.

#[path = "../common/mod.rs"]
mod common;

#[path = "../common/skip.rs"]
mod skip;

mod drawing;

mod exchange;

#[cfg(feature = "frames")]
mod frames;

#[cfg(feature = "cli")]
mod hostile;

#[cfg(feature = "cli")]
mod library;
