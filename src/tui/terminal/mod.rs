//! The real terminal, on crossterm and ratatui.
//!
//! ```text
//! input       a thread that reads keys            ─┐
//! unix        a thread that waits for signals      ├─ one channel ─ event_loop: updates, then draws what has changed
//! jobs        their answers                       ─┘
//! session     enters and leaves the modes; a thread that writes frames
//! screen      changed cells -> the bytes of a frame
//! settings    environment and flags -> what this terminal is sent
//! ```
//! Reading and writing may each block for ever: only their own thread waits. Nothing wakes up while nothing happens. The
//! terminal is never asked anything: over a slow line, answers could be taken for keys.

pub mod settings;

pub mod input;

pub mod screen;

mod session;

mod unix;

mod event_loop;

pub use event_loop::run;
