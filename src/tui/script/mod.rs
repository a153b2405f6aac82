//! The program without a terminal, driven by a script: keys in as text, screens out as text, the same bytes on every
//! machine.
//!
//! ```text
//! runner    the commands of a script        session   the program on a screen in memory
//! ```

pub mod session;

pub mod runner;

pub use session::Session;
