//! The program taxel, on the libraries `taxel-core` and `taxel-files`. Its parts are public only for tests, benchmarks and
//! the Python module.
//!
//! ```text
//! main.rs -> cli::run   the command line: a command is a file in cli/commands/, and without one the screen opens
//! tui                   the screen
//! frames                what both do with the frames of a sensor
//! naming                how both name touches
//! ```
//!
//! To follow one command to the bottom, read `cli/commands/sweep.rs`, then `taxel_core::pose::PoseGrid`, then
//! `taxel_core::sweep`.

// Compiles and runs the examples of the guide to the library as tests of the documentation.
#[cfg(doctest)]
#[doc = include_str!("../docs/library.md")]
struct LibraryGuide;

#[cfg(not(unix))]
compile_error!("taxel needs a Unix-like system; on Windows use WSL");

pub mod cli;
pub mod frames;
mod naming;
pub mod tui;
