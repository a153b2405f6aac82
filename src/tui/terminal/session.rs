//! Entering and leaving the terminal's modes. Leaving twice is harmless.
//!
//! ```text
//! enter    raw mode, second screen, pasted text marked, mouse reported if it is wanted
//! leave    the same in reverse, then what was to be printed to standard error
//! ```
//! The terminal's original state is kept in one place for the whole process, so that a panic on any thread can
//! restore it.

#[cfg(target_os = "linux")]
use std::fs;
use std::io::{self, Write};
use std::os::fd::{AsFd, BorrowedFd};
use std::os::unix::net::UnixStream;
use std::sync::Mutex;
use std::time::Duration;

use crossterm::terminal::{Clear, ClearType, EnterAlternateScreen, LeaveAlternateScreen};
use crossterm::{Command, cursor};
use rustix::io::Errno;
use rustix::process::{Signal, kill_current_process_group};
#[cfg(not(target_os = "linux"))]
use rustix::process::{getpgid, getsid};
use rustix::termios::{OptionalActions, QueueSelector, Termios, tcflush, tcgetattr, tcsetattr};
use signal_hook::consts::{
    SIGABRT, SIGALRM, SIGCONT, SIGHUP, SIGINT, SIGPROF, SIGQUIT, SIGTERM, SIGTSTP, SIGUSR1,
    SIGUSR2, SIGVTALRM, SIGWINCH, SIGXCPU,
};
use signal_hook::iterator::backend::SignalDelivery;
use signal_hook::iterator::exfiltrator::SignalOnly;
use taxel_core::lock::locked;

use crate::tui::terminal::device::Device;
use crate::tui::terminal::settings::TerminalSettings;

const MOUSE_ON: &str = "\x1b[?1000h\x1b[?1002h\x1b[?1006h";
const MOUSE_OFF: &str = "\x1b[?1006l\x1b[?1002l\x1b[?1000l";
const SHOW_FRAME: &str = "\x1b[?2026l";
const PASTE_ON: &str = "\x1b[?2004h";
const PASTE_OFF: &str = "\x1b[?2004l";
const PLAIN: &str = "\x1b[m";
/// Moves to the last row: terminals clamp 999 to it.
const BELOW: &str = "\x1b[999;1H\r\n";

/// The end of the terminal's answer about its status; its beginning may have been read already.
const STATUS_END: &[u8] = b"0n";
const LAST_ANSWER: Duration = Duration::from_millis(500);

#[derive(Debug)]
struct SavedTerminal {
    device: Device,
    /// The attributes of the terminal before the program changed them.
    attributes: Termios,
    settings: TerminalSettings,
    mouse: bool,
    later: String,
}

/// The original state of the terminal; None outside of a session. It is static because the panic hook restores it,
/// too.
static SAVED: Mutex<Option<SavedTerminal>> = Mutex::new(None);

/// Enters raw mode and the second screen, and turns mouse events on if `mouse`. If the program is inside already,
/// everything is sent again: another program may have changed it while this one was stopped.
pub(in crate::tui) fn enter(
    device: &Device,
    settings: &TerminalSettings,
    mouse: bool,
) -> io::Result<()> {
    let mut held = locked(&SAVED);
    if held.is_none() {
        // Before anything is changed, so that everything is restored if the change fails half-way.
        *held = Some(SavedTerminal {
            device: device.try_clone()?,
            attributes: tcgetattr(device.input())?,
            settings: *settings,
            mouse,
            later: String::new(),
        });
    }
    if let Some(found) = held.as_mut() {
        found.mouse = mouse;
        let mut raw = found.attributes.clone();
        raw.make_raw();
        set(device, &raw)?;
    }
    let mut hello = String::new();
    if settings.kind.has_modes() {
        push(&mut hello, EnterAlternateScreen);
        hello += PASTE_ON;
    }
    if mouse {
        hello += MOUSE_ON;
    }
    push(&mut hello, cursor::MoveTo(0, 0));
    push(&mut hello, Clear(ClearType::All));
    device.write_last(hello.as_bytes()).map(drop)
}

/// Restores the terminal; outside of a session, does nothing. `is_asked`: whether an answer about the status may
/// still come; the shell would take it for typed text.
pub(in crate::tui) fn leave(is_asked: bool) -> io::Result<()> {
    let Some(found) = locked(&SAVED).take() else {
        return Ok(());
    };
    let mut goodbye = String::new();
    if found.settings.abilities.synchronized {
        goodbye += SHOW_FRAME;
    }
    if found.mouse {
        goodbye += MOUSE_OFF;
    }
    push(&mut goodbye, cursor::Show);
    let has_modes = found.settings.kind.has_modes();
    if has_modes {
        goodbye += PASTE_OFF;
        push(&mut goodbye, LeaveAlternateScreen);
    }
    if found.settings.abilities.styles {
        // The first screen returns with the style that was on when it was left. If the program was stopped in the
        // middle of a frame and continued, that is a style of the frame.
        goodbye += PLAIN;
    }
    if !has_modes {
        goodbye += BELOW;
    }
    let said = found.device.write_last(goodbye.as_bytes());
    if is_asked {
        found.device.skip_past(STATUS_END, LAST_ANSWER);
    }
    if found.mouse || is_asked {
        let _ = tcflush(found.device.input(), QueueSelector::IFlush);
    }
    let restored = set(&found.device, &found.attributes);
    // Printed last: standard error may be a file, which is read after the terminal is gone.
    eprint(&found.later);
    restored?;
    said.map(drop)
}

/// Keeps a text to print to standard error on leaving. Returns true if the program has the terminal; otherwise
/// nothing is kept.
pub(in crate::tui) fn tell_later(text: &str) -> bool {
    let mut found = locked(&SAVED);
    let ours = found.as_mut().map(|found| found.later += text);
    ours.is_some()
}

/// Prints a text to standard error: at once, or on leaving if the program has the terminal.
pub(in crate::tui) fn tell(text: &str) {
    if !tell_later(text) {
        eprint(text);
    }
}

/// Prints to standard error, and ignores a failure: there is no other place to report it.
fn eprint(text: &str) {
    let _ = io::stderr().write_all(text.as_bytes());
}

/// Returns the sequence that puts a text into the clipboard of the user's terminal (OSC 52); a terminal may ignore
/// it.
pub(in crate::tui) fn copied(text: &str) -> String {
    format!("\x1b]52;c;{}\x07", base64(text.as_bytes()))
}

/// Encodes bytes in base64 (RFC 4648, section 4).
fn base64(bytes: &[u8]) -> String {
    const DIGITS: &[u8; 64] = b"ABCDEFGHIJKLMNOPQRSTUVWXYZabcdefghijklmnopqrstuvwxyz0123456789+/";
    let mut text = String::new();
    for group in bytes.chunks(3) {
        // Three bytes after an empty one; missing ones are 0.
        let mut joined = [0; 4];
        joined[1..=group.len()].copy_from_slice(group);
        let joined = u32::from_be_bytes(joined);
        for index in 0..4 {
            let digit = (joined >> (18 - 6 * index) & 63) as usize;
            let digit = char::from(DIGITS[digit]);
            text.push(if index <= group.len() { digit } else { '=' });
        }
    }
    text
}

/// Sets the attributes without waiting for output: a line that takes none would block for ever.
fn set(device: &Device, attributes: &Termios) -> io::Result<()> {
    loop {
        match tcsetattr(device.input(), OptionalActions::Now, attributes) {
            Err(Errno::INTR) => {}
            other => return Ok(other?),
        }
    }
}

/// Appends a command as the bytes for the terminal.
fn push(text: &mut String, command: impl Command) {
    // Writing to a string cannot fail.
    let _ = command.write_ansi(text);
}

/// Returns true if somebody could continue the program: a process above it, on the same terminal, in another process
/// group. The first process of a connection has no such process; stopped, it would never come back.
///
/// Everything is read from `/proc`, where a process, group or session outside the program's PID namespace (a
/// container's) appears as 0; the system calls answer 0 there too, which is not a process number. A controlling
/// terminal belongs to one session only, so it replaces the session's number.
#[cfg(target_os = "linux")]
pub(in crate::tui) fn has_shell() -> bool {
    let Some(own) = Process::read("self") else {
        return false;
    };
    if own.terminal == 0 {
        return false;
    }
    let mut above = own.parent;
    while above != 0 {
        match Process::read(&above.to_string()) {
            Some(process) if process.terminal != own.terminal => return false,
            Some(process) if process.group != own.group => return true,
            Some(process) => above = process.parent,
            None => return false,
        }
    }
    false
}

/// Returns true if there is a shell that could continue the program: the program is in another process group than the
/// first process of its session.
#[cfg(not(target_os = "linux"))]
pub(in crate::tui) fn has_shell() -> bool {
    match (getsid(None), getpgid(None)) {
        (Ok(session), Ok(group)) => session != group,
        _ => false,
    }
}

/// Stops the whole process group, as the terminal itself would: a program that waits for this one (an editor or a
/// version control system) must stop too, or the shell would not notice.
pub(in crate::tui) fn stop() -> rustix::io::Result<()> {
    kill_current_process_group(Signal::STOP)
}

#[cfg(target_os = "linux")]
#[derive(Debug, PartialEq)]
struct Process {
    parent: u32,
    group: u32,
    /// The device number of the controlling terminal; 0 if there is none.
    terminal: i32,
}

#[cfg(target_os = "linux")]
impl Process {
    /// Reads `/proc/PID/stat`; `number` may be `self`.
    fn read(number: &str) -> Option<Self> {
        let stat = fs::read_to_string(format!("/proc/{number}/stat")).ok()?;
        Self::parse(&stat)
    }

    /// Parses `number (name) state parent group session terminal …`; the name may contain any character.
    fn parse(stat: &str) -> Option<Self> {
        let (_, rest) = stat.rsplit_once(')')?;
        let mut fields = rest.split_whitespace().skip(1);
        Some(Self {
            parent: fields.next()?.parse().ok()?,
            group: fields.next()?.parse().ok()?,
            terminal: fields.nth(1)?.parse().ok()?,
        })
    }
}

/// The signals that the program handles. Some have no meaning here; unhandled, they would end the program without
/// restoring the terminal, so they end it like TERM.
const RECEIVED: [i32; 14] = [
    SIGHUP, SIGINT, SIGQUIT, SIGTERM, SIGUSR1, SIGUSR2, SIGALRM, SIGVTALRM, SIGPROF, SIGXCPU,
    SIGABRT, SIGTSTP, SIGCONT, SIGWINCH,
];

#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(in crate::tui) enum SignalEvent {
    /// End; with the number of the signal.
    End(i32),
    Stop,
    Continue,
    /// Check the size of the terminal, which has changed.
    Size,
}

#[derive(Debug)]
pub(in crate::tui) struct SignalReceiver {
    delivery: SignalDelivery<UnixStream, SignalOnly>,
}

impl SignalReceiver {
    pub(in crate::tui) fn new() -> io::Result<Self> {
        let (read, write) = UnixStream::pair()?;
        read.set_nonblocking(true)?;
        write.set_nonblocking(true)?;
        let delivery = SignalDelivery::with_pipe(read, write, SignalOnly, RECEIVED)?;
        Ok(Self { delivery })
    }

    pub(in crate::tui) fn fd(&self) -> BorrowedFd<'_> {
        self.delivery.get_read().as_fd()
    }

    /// Returns the signals since the last call; those that end the program come first.
    pub(in crate::tui) fn received(&mut self) -> Vec<SignalEvent> {
        let mut received: Vec<SignalEvent> = self
            .delivery
            .pending()
            .map(|signal| match signal {
                SIGTSTP => SignalEvent::Stop,
                SIGCONT => SignalEvent::Continue,
                SIGWINCH => SignalEvent::Size,
                other => SignalEvent::End(other),
            })
            .collect();
        received.sort_by_key(|event| !matches!(event, SignalEvent::End(_)));
        received
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn base64_matches_the_examples_of_the_standard() {
        for (text, expected) in [
            ("", ""),
            ("f", "Zg=="),
            ("fo", "Zm8="),
            ("foo", "Zm9v"),
            ("foob", "Zm9vYg=="),
            ("fooba", "Zm9vYmE="),
            ("foobar", "Zm9vYmFy"),
        ] {
            assert_eq!(base64(text.as_bytes()), expected);
        }
    }

    #[cfg(all(test, target_os = "linux"))]
    #[test]
    fn a_name_may_contain_any_character_and_a_group_may_be_0() {
        let stat = "17 (a) S 1) (b) R 4 0 0 34816 17 4194304";
        assert_eq!(
            Process::parse(stat),
            Some(Process {
                parent: 4,
                group: 0,
                terminal: 34816
            })
        );
        assert_eq!(Process::parse("17 (a) S 4"), None);
        assert_eq!(Process::parse(""), None);
    }
}
