//! Syncs a file now and then, on a separate thread, so that frames never wait for the disk.

use std::fs::File;
use std::io;
use std::sync::mpsc::{SyncSender, TrySendError, sync_channel};
use std::thread::JoinHandle;
use std::time::{Duration, Instant};

/// The time after which the file is synced again.
const SYNCED: Duration = Duration::from_millis(900);

/// A thread that syncs a file.
#[derive(Debug)]
pub(super) struct Syncer {
    ask: Option<SyncSender<()>>,
    /// The thread, which ends at the first error. The system reports an error of the disk only once, to whoever asks
    /// first.
    thread: Option<JoinHandle<io::Result<()>>>,
    last: Instant,
}

impl Syncer {
    /// Starts a thread that syncs this file.
    pub(super) fn new(file: &File) -> Self {
        let (ask, asked) = sync_channel::<()>(1);
        let thread = file.try_clone().and_then(|file| {
            std::thread::Builder::new().spawn(move || {
                while asked.recv().is_ok() {
                    file.sync_data()?;
                }
                Ok(())
            })
        });
        // Without the thread, the file is synced at its end.
        let thread = thread.ok();
        Self {
            ask: thread.is_some().then_some(ask),
            thread,
            last: Instant::now(),
        }
    }

    /// Asks the thread to sync the file if the last sync was long ago, and does not wait for it.
    ///
    /// # Errors
    /// Returns the error of an earlier sync.
    pub(super) fn tick(&mut self) -> io::Result<()> {
        if self.last.elapsed() >= SYNCED {
            self.last = Instant::now();
            let asked = self.ask.as_ref().map(|ask| ask.try_send(()));
            // If the channel is full, the last sync still runs.
            if let Some(Err(TrySendError::Disconnected(()))) = asked {
                return self.end();
            }
        }
        Ok(())
    }

    /// Waits until no sync is running.
    ///
    /// # Errors
    /// Returns the error of a sync that failed.
    pub(super) fn end(&mut self) -> io::Result<()> {
        self.ask = None;
        let ended = self.thread.take().map(JoinHandle::join);
        // The thread does not panic.
        ended.and_then(Result::ok).unwrap_or(Ok(()))
    }
}

impl Drop for Syncer {
    fn drop(&mut self) {
        // The end of the recording has reported an error; a recording that is given up reports none.
        let _ = self.end();
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn an_error_of_a_sync_is_not_lost() {
        // This file cannot be synced.
        let mut syncer = Syncer::new(&File::open("/dev/null").expect("opened"));
        syncer.last = Instant::now().checked_sub(SYNCED).expect("later than that");
        assert!(syncer.tick().is_ok(), "it does not wait");
        assert!(syncer.end().is_err());
    }
}
