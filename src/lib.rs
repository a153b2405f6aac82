//! The program taxel: `cli` is the command line, `tui` the screen;
//! `frames` is what both do with frames of a sensor, `naming` how both name touches. They are public only for tests, benchmarks and
//! other packages of the program; the libraries are `taxel-core` and `taxel-files`.

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
