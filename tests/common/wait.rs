//! Pipes and connections that the program opens. The test waits for it, but with a deadline.
#![allow(dead_code, reason = "every test file uses its own part of this one")]

use std::fs::File;
use std::net::{TcpListener, TcpStream};
use std::path::Path;
use std::process::Command;
use std::sync::mpsc::channel;
use std::time::Duration;

use crate::skip;

/// The longest wait for anything, however busy the machine is.
const DEADLINE: Duration = Duration::from_secs(60);

/// Makes a named pipe. Without `mkfifo`, reports the test as skipped and returns false.
pub(crate) fn fifo(path: &Path) -> bool {
    let Ok(made) = Command::new("mkfifo").arg(path).status() else {
        skip::lacking("mkfifo");
        return false;
    };
    assert!(made.success(), "mkfifo {}: {made}", path.display());
    true
}

/// Opens the writing end of a pipe, once the program reads from it.
pub(crate) fn writer_of(fifo: &Path) -> File {
    let path = fifo.to_owned();
    let opened = within_deadline("reader of the pipe", move || {
        File::options().write(true).open(path)
    });
    opened.expect("the pipe opens")
}

/// Waits for the next connection that the program makes.
pub(crate) fn connection(listener: &TcpListener) -> TcpStream {
    let listener = listener.try_clone().expect("a second handle");
    let accepted = within_deadline("connection", move || listener.accept());
    accepted.expect("it connects").0
}

/// Runs a call that may wait for ever on a thread of its own. If the test fails, the thread is left behind.
fn within_deadline<T: Send + 'static>(what: &str, wait: impl FnOnce() -> T + Send + 'static) -> T {
    let (done, waits) = channel();
    std::thread::spawn(move || drop(done.send(wait())));
    let found = waits.recv_timeout(DEADLINE);
    found.unwrap_or_else(|_| panic!("no {what} within {} seconds", DEADLINE.as_secs()))
}
