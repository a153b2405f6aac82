//! The program without a terminal, driven by a script: keys in as text, screens out as text, the same bytes on every
//! machine.

mod drawing;

pub mod session;

pub mod setting;

pub mod command;

pub mod runner;

pub mod record;

pub use session::Session;
