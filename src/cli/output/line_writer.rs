//! Writes lines to standard output on a separate thread, so that a slow reader does not hold up a recording.

use std::io::{self, Write};
use std::sync::Arc;
use std::sync::atomic::{AtomicBool, Ordering};
use std::sync::mpsc::{
    Receiver, RecvTimeoutError, SyncSender, TryRecvError, TrySendError, channel, sync_channel,
};
use std::thread::{Builder, JoinHandle};
use std::time::{Duration, Instant};

use taxel_core::imprint::Imprint;

use crate::cli::error::CliError;

/// The most lines that may wait; for frames of 64 × 64 they take about 5 MB.
const WAITING: usize = 1000;

/// The time after which a line is sent again if too many are waiting, and a signal is looked for.
const PAUSE: Duration = Duration::from_millis(1);

/// The time that a reader has, after a signal, to read what is waiting.
const PATIENCE: Duration = Duration::from_secs(1);

pub(crate) type PendingLine = (Vec<u8>, Option<Imprint>);

pub(crate) type Finish<'a> = dyn FnMut(&mut Vec<u8>, Option<&Imprint>) + 'a;

#[derive(Debug)]
pub(crate) struct LineWriter {
    /// The channel to the thread. Sending fails once the thread has ended because of an error.
    lines: SyncSender<PendingLine>,
    thread: JoinHandle<Result<(), CliError>>,
    ended: Receiver<()>,
    stopped: Arc<AtomicBool>,
    /// The number of lines dropped because too many were waiting.
    pub(crate) given_up: u64,
}

impl LineWriter {
    /// Starts the thread, which calls `run` once with the lines to write. Once `stopped` is set, a reader that does not
    /// read cannot keep the program from ending.
    pub(crate) fn start(
        stopped: &Arc<AtomicBool>,
        run: impl FnOnce(&WaitingLines) -> Result<(), CliError> + Send + 'static,
    ) -> Result<Self, CliError> {
        let (lines, receiver) = sync_channel(WAITING);
        let (ends, ended) = channel();
        let thread = Builder::new().spawn(move || {
            let _ends = ends;
            run(&WaitingLines(receiver))
        });
        let refused = |error| io::Error::other(format!("cannot start a thread: {error}"));
        Ok(Self {
            lines,
            thread: thread.map_err(|error| CliError::Write(refused(error)))?,
            ended,
            stopped: Arc::clone(stopped),
            given_up: 0,
        })
    }

    pub(crate) fn is_over(&self) -> bool {
        self.thread.is_finished()
    }

    /// Sends a line. If too many are waiting, it waits until there is room, or drops the line if `may_give_up`; after
    /// a signal, it drops the line, uncounted. Returns false once nothing can be written.
    pub(crate) fn send(&mut self, mut line: PendingLine, may_give_up: bool) -> bool {
        loop {
            line = match self.lines.try_send(line) {
                Ok(()) => return true,
                Err(TrySendError::Disconnected(_)) => return false,
                Err(TrySendError::Full(_)) if may_give_up => {
                    self.given_up += 1;
                    return true;
                }
                Err(TrySendError::Full(_)) if self.stopped.load(Ordering::Relaxed) => return true,
                Err(TrySendError::Full(line)) => line,
            };
            std::thread::sleep(PAUSE);
        }
    }

    /// Waits until all lines are written; after a signal, for a second at most. Lines that nobody has read by then are
    /// lost.
    pub(crate) fn finish(self) -> Result<(), CliError> {
        drop(self.lines);
        let mut stopped_at = None;
        while let Err(RecvTimeoutError::Timeout) = self.ended.recv_timeout(10 * PAUSE) {
            if self.stopped.load(Ordering::Relaxed)
                && stopped_at.get_or_insert_with(Instant::now).elapsed() > PATIENCE
            {
                // The thread ends with the program.
                return Ok(());
            }
        }
        self.thread.join().unwrap_or_else(|_| {
            Err(CliError::Write(io::Error::other(
                "the thread that writes has failed",
            )))
        })
    }
}

#[derive(Debug)]
pub(crate) struct WaitingLines(Receiver<PendingLine>);

impl WaitingLines {
    pub(crate) fn write(&self, finish: &mut Finish<'_>) -> Result<(), CliError> {
        self.write_to(io::stdout().lock(), finish)
            .map_err(CliError::Write)
    }

    fn write_to(&self, output: impl Write, finish: &mut Finish<'_>) -> io::Result<()> {
        let mut output = io::BufWriter::with_capacity(1 << 16, output);
        loop {
            let (mut line, imprint) = match self.0.try_recv() {
                Ok(line) => line,
                Err(TryRecvError::Disconnected) => return output.flush(),
                Err(TryRecvError::Empty) => {
                    output.flush()?;
                    match self.0.recv() {
                        Ok(line) => line,
                        Err(_) => return Ok(()),
                    }
                }
            };
            finish(&mut line, imprint.as_ref());
            output.write_all(&line)?;
        }
    }
}
