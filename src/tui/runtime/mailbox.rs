//! Messages from workers, which wake the loop.

use std::io::{self, Read, Write};
use std::os::fd::{AsFd, BorrowedFd};
use std::os::unix::net::UnixStream;
use std::sync::Arc;
use std::sync::mpsc;

use crate::tui::app::message::Message;

/// The end that a worker has; as many as there are workers.
#[derive(Clone, Debug)]
pub struct Sender {
    messages: mpsc::Sender<Message>,
    bell: Arc<UnixStream>,
}

/// The end that the loop has.
#[derive(Debug)]
pub struct Mailbox {
    messages: mpsc::Receiver<Message>,
    bell: UnixStream,
}

/// A new pair.
///
/// # Errors
/// Where the process may not open more files.
pub fn new() -> io::Result<(Sender, Mailbox)> {
    let (read, write) = UnixStream::pair()?;
    read.set_nonblocking(true)?;
    write.set_nonblocking(true)?;
    let (sender, receiver) = mpsc::channel();
    Ok((
        Sender {
            messages: sender,
            bell: Arc::new(write),
        },
        Mailbox {
            messages: receiver,
            bell: read,
        },
    ))
}

impl Sender {
    /// Sends a message; lost where the program has ended.
    pub fn send(&self, message: Message) {
        if self.messages.send(message).is_ok() {
            // A full pipe rings already.
            let _ = (&*self.bell).write(&[0]);
        }
    }
}

impl Mailbox {
    /// Readable when there are messages.
    pub(in crate::tui) fn fd(&self) -> BorrowedFd<'_> {
        self.bell.as_fd()
    }

    /// All messages that are there.
    pub(in crate::tui) fn collect(&mut self) -> Vec<Message> {
        // First the bell: what is sent after this rings anew. The world keeps a sender as long as the loop runs.
        let mut rung = [0; 64];
        while self.bell.read(&mut rung).is_ok_and(|count| count > 0) {}
        self.messages.try_iter().collect()
    }
}
