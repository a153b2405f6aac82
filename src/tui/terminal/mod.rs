//! The real terminal: enters and leaves raw mode, reads and writes bytes.
//!
//! ```text
//! settings   environment and flags -> what this terminal is sent
//! input      bytes -> key, paste, mouse
//! screen     changed cells -> bytes, frame by frame
//! device     the terminal's two files
//! session    one way in, one way out
//! event_loop waits for all of them, and for messages from workers (`runtime::mailbox`)
//! ```
//! The loop sleeps until there is something to do, without a tick. It writes only what has changed on the screen, in
//! one write per frame. It ends when the terminal is gone, whether or not a signal reports this. The terminal is
//! queried only for its status, after pictures of a source: answers to other queries could be taken for keys, over a
//! slow line or by the shell.

pub mod settings;

pub mod input;

pub mod screen;

mod device;

mod session;

mod event_loop;

pub use event_loop::{Outcome, run};
pub use settings::TerminalSettings;
