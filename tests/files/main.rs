//! Files that taxel reads and writes: those of other programs, drawings, stored shapes, and hostile bytes.

#[path = "../common/mod.rs"]
mod common;

#[path = "../common/property.rs"]
mod property;

#[path = "../common/skip.rs"]
mod skip;

#[path = "../common/array.rs"]
mod array;

mod drawing;

mod exchange;

mod frames;

mod hostile;

mod library;
