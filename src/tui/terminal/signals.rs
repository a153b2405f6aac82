//! Signals from the system: to end, to stop, to check the size again. Handlers write into a pipe that can be waited for
//! together with everything else.

use std::io;
use std::os::fd::{AsFd, BorrowedFd};
use std::os::unix::net::UnixStream;

use signal_hook::consts::{
    SIGABRT, SIGALRM, SIGCONT, SIGHUP, SIGINT, SIGPROF, SIGQUIT, SIGTERM, SIGTSTP, SIGUSR1,
    SIGUSR2, SIGVTALRM, SIGWINCH, SIGXCPU,
};
use signal_hook::iterator::backend::SignalDelivery;
use signal_hook::iterator::exfiltrator::SignalOnly;

/// The signals that are heard. Those of them that mean nothing here would end the program with the terminal as it is, so
/// they end it like TERM.
const HEARD: [i32; 14] = [
    SIGHUP, SIGINT, SIGQUIT, SIGTERM, SIGUSR1, SIGUSR2, SIGALRM, SIGVTALRM, SIGPROF, SIGXCPU,
    SIGABRT, SIGTSTP, SIGCONT, SIGWINCH,
];

/// A signal, as far as it matters here.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(in crate::tui) enum SignalEvent {
    /// End, by this number.
    End(i32),
    /// Stop.
    Stop,
    /// Go on.
    Continue,
    /// The terminal has another size.
    Size,
}

/// Listens from its making on.
#[derive(Debug)]
pub(in crate::tui) struct SignalReceiver {
    /// Delivers signals through a socket, which the loop waits for.
    delivery: SignalDelivery<UnixStream, SignalOnly>,
}

impl SignalReceiver {
    /// Begins to listen.
    pub(in crate::tui) fn new() -> io::Result<Self> {
        let (read, write) = UnixStream::pair()?;
        read.set_nonblocking(true)?;
        write.set_nonblocking(true)?;
        let delivery = SignalDelivery::with_pipe(read, write, SignalOnly, HEARD)?;
        Ok(Self { delivery })
    }

    /// Readable after a signal has arrived.
    pub(in crate::tui) fn fd(&self) -> BorrowedFd<'_> {
        self.delivery.get_read().as_fd()
    }

    /// The signals since the last call; those that end the program come first.
    pub(in crate::tui) fn received(&mut self) -> Vec<SignalEvent> {
        let mut heard: Vec<SignalEvent> = self
            .delivery
            .pending()
            .map(|signal| match signal {
                SIGTSTP => SignalEvent::Stop,
                SIGCONT => SignalEvent::Continue,
                SIGWINCH => SignalEvent::Size,
                other => SignalEvent::End(other),
            })
            .collect();
        heard.sort_by_key(|said| !matches!(said, SignalEvent::End(_)));
        heard
    }
}
