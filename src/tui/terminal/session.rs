//! Entering and leaving the terminal's modes, and what is written between. Leaving twice is harmless.
//!
//! There is one session for the whole process, so that a panic on any thread can restore the terminal. Frames are
//! written by a thread: a terminal that takes no output keeps nobody from ending the program.

use std::fs::File;
use std::io::{self, ErrorKind, IsTerminal, Write};
use std::os::fd::AsFd;
use std::sync::Mutex;
use std::sync::mpsc::{self, Receiver, Sender};
use std::thread;
use std::time::Duration;

use crossterm::terminal::{disable_raw_mode, enable_raw_mode};
use signal_hook::consts::SIGHUP;
use taxel_core::lock::locked;

use crate::tui::terminal::event_loop::Event;
use crate::tui::terminal::screen::{END_SYNCHRONIZED, SHOW_CURSOR};
use crate::tui::terminal::settings::TerminalSettings;

/// Second screen, and pasted text marked.
const MODES: [&str; 2] = ["\x1b[?1049h\x1b[?2004h", "\x1b[?2004l\x1b[?1049l"];
/// Buttons, drags and positions beyond column 223, but not each motion, which would flood a slow line.
const MOUSE: [&str; 2] = [
    "\x1b[?1000h\x1b[?1002h\x1b[?1006h",
    "\x1b[?1006l\x1b[?1002l\x1b[?1000l",
];
/// Moves to the last row: terminals clamp 999 to it.
const BELOW: &str = "\x1b[999;1H\r\n";

/// How long leaving waits for a terminal that takes no output.
const LAST_WRITE: Duration = Duration::from_millis(200);

struct Session {
    frames: Sender<Vec<u8>>,
    /// Closed when all is written.
    written: Receiver<()>,
    goodbye: String,
    /// What was to be printed to standard error.
    later: String,
}

static SESSION: Mutex<Option<Session>> = Mutex::new(None);

/// Opens the terminal for writing: standard output, or the controlling terminal if that goes elsewhere.
pub(super) fn terminal() -> io::Result<File> {
    if io::stdout().is_terminal() {
        return io::stdout().as_fd().try_clone_to_owned().map(File::from);
    }
    let none = "there is no terminal here; 'taxel figure' and the other commands work without one, \
                and 'taxel script' drives the screen without one";
    let opened = File::options().write(true).open("/dev/tty");
    opened.map_err(|_| io::Error::other(none))
}

/// Enters raw mode and the second screen. Each write is answered by [`Event::Written`], also this first one.
pub(super) fn enter(
    terminal: &File,
    settings: &TerminalSettings,
    events: &Sender<Event>,
) -> io::Result<()> {
    let mut terminal = terminal.try_clone()?;
    enable_raw_mode()?;
    let (frames, to_write) = mpsc::channel::<Vec<u8>>();
    let (all_written, written) = mpsc::channel();
    let events = events.clone();
    thread::spawn(move || {
        let _all_written = all_written;
        for bytes in to_write {
            let is_written = write(&mut terminal, &bytes).is_ok();
            let event = is_written.then_some(Event::Written);
            let _ = events.send(event.unwrap_or(Event::Signal(SIGHUP)));
        }
    });
    let mut hello = String::new();
    // A frame may be unfinished, in its style, with the cursor hidden.
    let mut goodbye = SHOW_CURSOR.to_owned();
    if settings.abilities.synchronized {
        goodbye += END_SYNCHRONIZED;
    }
    for ([on, off], wanted) in [(MOUSE, settings.mouse), (MODES, settings.kind.has_modes())] {
        if wanted {
            hello += on;
            goodbye += off;
        }
    }
    if settings.abilities.styles {
        goodbye += "\x1b[m";
    }
    if !settings.kind.has_modes() {
        goodbye += BELOW;
    }
    let _ = frames.send(hello.into_bytes());
    *locked(&SESSION) = Some(Session {
        frames,
        written,
        goodbye,
        later: String::new(),
    });
    Ok(())
}

fn write(terminal: &mut File, mut bytes: &[u8]) -> io::Result<()> {
    while !bytes.is_empty() {
        match terminal.write(bytes) {
            Ok(count) => bytes = &bytes[count..],
            Err(error) if error.kind() == ErrorKind::Interrupted => {}
            // An earlier program has left it in this mode.
            Err(error) if error.kind() == ErrorKind::WouldBlock => {
                thread::sleep(Duration::from_millis(10));
            }
            Err(error) => return Err(error),
        }
    }
    Ok(())
}

/// Sends bytes to the terminal; returns false outside of a session.
pub(super) fn send(bytes: Vec<u8>) -> bool {
    let session = locked(&SESSION);
    session
        .as_ref()
        .is_some_and(|session| session.frames.send(bytes).is_ok())
}

/// Restores the terminal; outside of a session, does nothing.
pub(super) fn leave() {
    let Some(session) = locked(&SESSION).take() else {
        return;
    };
    let _ = session.frames.send(session.goodbye.into_bytes());
    drop(session.frames);
    let _ = session.written.recv_timeout(LAST_WRITE);
    // On a terminal that is gone there is nothing to restore.
    let _ = disable_raw_mode();
    // Printed last: standard error may be a file, which is read after the terminal is gone.
    eprint(&session.later);
}

/// Keeps a text to print to standard error on leaving. Returns false outside of a session, where nothing is kept.
pub(super) fn tell_later(text: &str) -> bool {
    let mut session = locked(&SESSION);
    let kept = session.as_mut().map(|session| session.later += text);
    kept.is_some()
}

/// Prints a text to standard error: at once, or on leaving if the program has the terminal.
pub(super) fn tell(text: &str) {
    if !tell_later(text) {
        eprint(text);
    }
}

/// Ignores a failure: there is no other place to report it.
fn eprint(text: &str) {
    let _ = io::stderr().write_all(text.as_bytes());
}
