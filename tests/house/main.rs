//! The project itself: its source keeps the laws of its rooms, and its papers say what the program does.

mod laws;

mod source;

#[cfg(feature = "sweep")]
mod examples;

#[cfg(feature = "cli")]
mod dependencies;

#[cfg(feature = "cli")]
mod readme;

#[cfg(feature = "cli")]
mod version;
