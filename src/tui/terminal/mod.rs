//! The real terminal: enters and leaves raw mode, reads and writes bytes.
//!
//! ```text
//! settings   environment and flags -> what this terminal is sent
//! input      bytes -> key, paste, mouse
//! style      changes of style -> few bytes
//! screen     changed cells -> few bytes, frame by frame
//! device     the terminal's two files
//! pacing     pictures of a source, no faster than the line
//! session    one way in, one way out
//! signals    what the system says
//! job        stopped and continued by a shell
//! outcome    how it ended
//! event_loop waits for all of them, and for messages from workers (`runtime::mailbox`)
//! ```
//! The loop sleeps until there is something to do, without a tick. It writes only what has changed on the screen, in
//! one write per frame. It ends when the terminal is gone, whether or not a signal reports this. The terminal is
//! queried only for its status, after pictures of a source: answers to other queries could be taken for keys, over a
//! slow line or by the shell.

pub mod settings;

pub mod input;

mod style;

pub mod screen;

mod device;

mod pacing;

mod session;

mod signals;

mod job;

mod outcome;

mod event_loop;

use std::io;
use std::sync::Arc;

pub use event_loop::SessionEvent;
pub use outcome::Outcome;
pub use settings::TerminalSettings;

use crate::tui::app::message::Message;
use crate::tui::app::state::App;
use crate::tui::runtime::World;
use crate::tui::runtime::mailbox::{Mailbox, Sender};

/// Runs the program until it ends. The terminal is restored, also after an error, a signal or a panic, and unsaved
/// work is in the journal wherever the program may not come back. `first` is handled at the start, then the messages
/// from the mailbox. `watch` is called with every event that a record of the session contains.
///
/// # Errors
/// Returns an error if there is no terminal, or if it cannot be read or written.
pub fn run(
    app: App,
    first: Option<Message>,
    world: World,
    settings: &TerminalSettings,
    (sender, mailbox): (Sender, Mailbox),
    watch: &mut dyn FnMut(SessionEvent<'_>),
) -> io::Result<Outcome> {
    let world = world.with_workers(Arc::new(move |event| sender.send(Message::Worker(event))));
    event_loop::run(app, first, world, settings, mailbox, watch)
}
