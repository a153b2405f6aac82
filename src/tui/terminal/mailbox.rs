//! Messages from workers, which wake the loop.

use std::io::{self, Read, Write};
use std::os::fd::{AsFd, BorrowedFd};
use std::os::unix::net::UnixStream;
use std::sync::Arc;
use std::sync::mpsc;

use crate::tui::message::Message;

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
    pub(super) fn bell(&self) -> BorrowedFd<'_> {
        self.bell.as_fd()
    }

    /// All messages that are there. Answers whether there can be more: whether any worker is left.
    pub(super) fn collect(&mut self) -> (Vec<Message>, bool) {
        // First the bell: what is sent after this rings anew.
        let mut rung = [0; 64];
        let open = loop {
            match self.bell.read(&mut rung) {
                Ok(0) => break false,
                Ok(_) => {}
                Err(error) => break error.kind() == io::ErrorKind::WouldBlock,
            }
        };
        (self.messages.try_iter().collect(), open)
    }
}
