//! What only Unix has: signals, job control, a terminal that is gone.

use std::fs::{self, File};
use std::io;
use std::os::unix::net::UnixStream;
use std::process;
use std::sync::mpsc::Sender;
use std::thread;
use std::time::Duration;

use rustix::event::{PollFd, PollFlags, poll};
use rustix::process::{Signal, kill_current_process_group};
use signal_hook::consts::{SIGCONT, SIGHUP, SIGINT, SIGQUIT, SIGTERM, SIGTSTP, SIGUSR1, SIGUSR2};
use signal_hook::iterator::backend::SignalDelivery;
use signal_hook::iterator::exfiltrator::SignalOnly;

use crate::tui::terminal::event_loop::Event;
use crate::tui::terminal::session;

/// Some mean nothing here; unhandled, they would end the program without restoring the terminal.
const RECEIVED: [i32; 8] = [
    SIGHUP, SIGINT, SIGQUIT, SIGTERM, SIGUSR1, SIGUSR2, SIGTSTP, SIGCONT,
];

/// How long the event loop may take to end. It waits for 1.5 s at most, unless the system keeps it.
const PATIENCE: Duration = Duration::from_secs(5);

/// Sends signals to the event loop. A terminal that is gone counts as SIGHUP, whether or not the system sends it.
pub(super) fn watch(terminal: File, events: Sender<Event>) -> io::Result<()> {
    let (read, write) = UnixStream::pair()?;
    read.set_nonblocking(true)?;
    write.set_nonblocking(true)?;
    let mut signals = SignalDelivery::with_pipe(read, write, SignalOnly, RECEIVED)?;
    thread::spawn(move || {
        loop {
            let mut files = [
                PollFd::new(signals.get_read(), PollFlags::IN),
                PollFd::new(&terminal, PollFlags::empty()),
            ];
            let is_gone = poll(&mut files, None).is_ok() && !files[1].revents().is_empty();
            for signal in signals.pending().chain(is_gone.then_some(SIGHUP)) {
                let _ = events.send(Event::Signal(signal));
                if !matches!(signal, SIGTSTP | SIGCONT) {
                    thread::sleep(PATIENCE);
                    session::leave();
                    process::exit(128 + signal);
                }
            }
        }
    });
    Ok(())
}

/// Returns true if there is a shell that could continue the program: the first process of a session has none, nor the
/// processes in its group. From `/proc`, as the system calls answer 0 in a container that has no such process.
pub(super) fn has_shell() -> bool {
    let stat = fs::read_to_string("/proc/self/stat").unwrap_or_default();
    // The name, which ends with the last parenthesis, may contain anything. Then: state, parent, group, session.
    let fields = stat.rsplit(')').next().unwrap_or_default();
    let fields: Vec<&str> = fields.split_whitespace().skip(2).take(2).collect();
    fields.is_empty() || fields[0] != fields[1]
}

/// Stops the whole process group, as the terminal itself would: a program that waits for this one must stop, too, or
/// the shell would not notice.
pub(super) fn stop() -> bool {
    kill_current_process_group(Signal::STOP).is_ok()
}
