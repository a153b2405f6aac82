//! Messages from other threads, which wake the event loop.
//!
//! The mailbox is a queue, and a socket pair that the loop waits for together with the terminal and the signals. The
//! queue is not bounded, since workers must never wait for a slow terminal. It holds little: workers report their
//! progress ten times a second, and answer requests of the screen. Frames wait in `runtime::frames::feed`, and one
//! message here says that some have come.

use std::io::{self, Read, Write};
use std::os::fd::{AsFd, BorrowedFd};
use std::os::unix::net::UnixStream;
use std::sync::Arc;
use std::sync::mpsc;

use crate::tui::app::message::Message;

/// The sending end; each worker has a clone.
#[derive(Clone, Debug)]
pub struct Sender {
    messages: mpsc::Sender<Message>,
    /// The socket; one byte in it wakes the loop.
    wakeup: Arc<UnixStream>,
}

#[derive(Debug)]
pub struct Mailbox {
    messages: mpsc::Receiver<Message>,
    wakeup: UnixStream,
}

pub fn new() -> io::Result<(Sender, Mailbox)> {
    let (read, write) = UnixStream::pair()?;
    read.set_nonblocking(true)?;
    write.set_nonblocking(true)?;
    let (sender, receiver) = mpsc::channel();
    Ok((
        Sender {
            messages: sender,
            wakeup: Arc::new(write),
        },
        Mailbox {
            messages: receiver,
            wakeup: read,
        },
    ))
}

impl Sender {
    pub fn send(&self, message: Message) {
        if self.messages.send(message).is_ok() {
            // A full socket has woken the loop already.
            let _ = (&*self.wakeup).write(&[0]);
        }
    }
}

impl Mailbox {
    pub(in crate::tui) fn fd(&self) -> BorrowedFd<'_> {
        self.wakeup.as_fd()
    }

    pub(in crate::tui) fn collect(&mut self) -> Vec<Message> {
        // Empty the socket first: a message that is sent after this wakes the loop again.
        let mut bytes = [0; 64];
        while self.wakeup.read(&mut bytes).is_ok_and(|count| count > 0) {}
        self.messages.try_iter().collect()
    }
}
