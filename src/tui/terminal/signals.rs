//! Signals from the system: to end, to stop, to check the size again. The handlers write into a pipe, so that the
//! loop can wait for signals together with everything else.

use std::io;
use std::os::fd::{AsFd, BorrowedFd};
use std::os::unix::net::UnixStream;

use signal_hook::consts::{
    SIGABRT, SIGALRM, SIGCONT, SIGHUP, SIGINT, SIGPROF, SIGQUIT, SIGTERM, SIGTSTP, SIGUSR1,
    SIGUSR2, SIGVTALRM, SIGWINCH, SIGXCPU,
};
use signal_hook::iterator::backend::SignalDelivery;
use signal_hook::iterator::exfiltrator::SignalOnly;

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
