//! Files that taxel reads and writes: those of other programs, drawings, stored shapes, and hostile bytes.

#[path = "../common/mod.rs"]
mod common;

#[path = "../common/property.rs"]
mod property;

#[path = "../common/skip.rs"]
mod skip;

#[cfg(feature = "frames")]
#[path = "../common/array.rs"]
mod array;

mod drawing;

mod exchange;

#[cfg(feature = "frames")]
mod frames;

#[cfg(feature = "cli")]
mod hostile;

#[cfg(feature = "cli")]
mod library;
