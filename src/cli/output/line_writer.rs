//! Lines on standard output, written by a thread of their own, so that a reader that is slow does not hold up a
//! recording.

use std::io::{self, Write};
use std::sync::mpsc::{Receiver, SyncSender, TryRecvError, TrySendError, sync_channel};
use std::thread::JoinHandle;

/// So many lines may wait; those of 64 × 64 frames take about 5 MB.
const WAITING: usize = 1000;

/// The sending end.
#[derive(Debug)]
pub(crate) struct LineWriter {
    /// To the thread. Sending fails once the thread has ended because of an error.
    lines: SyncSender<Vec<u8>>,
    /// Returns the error of writing, if there was one.
    thread: JoinHandle<io::Result<()>>,
    /// Lines that were given up because too many were waiting.
    pub(crate) given_up: u64,
}

impl LineWriter {
    /// Starts the thread.
    pub(crate) fn start() -> Self {
        let (lines, receiver) = sync_channel(WAITING);
        Self {
            lines,
            thread: std::thread::spawn(move || write(&receiver)),
            given_up: 0,
        }
    }

    /// Sends a line; waits if too many are waiting, or gives it up if that is allowed. False once nothing can be
    /// written.
    pub(crate) fn send(&mut self, line: Vec<u8>, may_give_up: bool) -> bool {
        if !may_give_up {
            return self.lines.send(line).is_ok();
        }
        match self.lines.try_send(line) {
            Ok(()) => true,
            Err(TrySendError::Full(_)) => {
                self.given_up += 1;
                true
            }
            Err(TrySendError::Disconnected(_)) => false,
        }
    }

    /// Waits until all lines are written.
    ///
    /// # Errors
    /// Those of standard output.
    pub(crate) fn finish(self) -> io::Result<()> {
        drop(self.lines);
        self.thread
            .join()
            .unwrap_or_else(|_| Err(io::Error::other("the thread that writes has failed")))
    }
}

/// Writes lines, and holds none back while there are no more.
fn write(lines: &Receiver<Vec<u8>>) -> io::Result<()> {
    let mut output = io::BufWriter::with_capacity(1 << 16, io::stdout().lock());
    loop {
        let line = match lines.try_recv() {
            Ok(line) => line,
            Err(TryRecvError::Disconnected) => return output.flush(),
            Err(TryRecvError::Empty) => {
                output.flush()?;
                match lines.recv() {
                    Ok(line) => line,
                    Err(_) => return Ok(()),
                }
            }
        };
        output.write_all(&line)?;
    }
}
