//! Bytes and files of taxel: what `taxel-core` computes, read and written.
//!
//! ```text
//!  formats   text, CSV, NPY, JSON, atlases, models; outlines from SVG and points; recordings and streams of
//!            sensors; drawings
//!  storage   files: atomic writes, the folder of stored shapes with its journal and trash, models
//!  acquire   where frames come from: serial, pipes, tcp, files; recording them
//!  memory    stops sweeps, trainings and merges before the memory runs out
//! ```
//! `formats` only reads and writes streams that its callers have opened; the others open them.

#![warn(missing_docs)]

#[cfg(unix)]
pub mod acquire;
mod error;
pub mod formats;
pub mod memory;
pub mod storage;

pub use error::{ReadError, ReadErrorKind};
