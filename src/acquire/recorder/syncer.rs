//! Syncs a file now and then, on a thread of its own, so that frames never wait for the disk.

use std::fs::File;
use std::io;
use std::sync::mpsc::{SyncSender, TrySendError, sync_channel};
use std::thread::JoinHandle;
use std::time::{Duration, Instant};

/// The file is synced after this time.
const SYNCED: Duration = Duration::from_millis(900);

/// Syncs a file on a thread of its own.
#[derive(Debug)]
pub(super) struct Syncer {
    ask: Option<SyncSender<()>>,
    /// Ends at the first error. The system reports an error of the disk once only, to whoever asks first.
    thread: Option<JoinHandle<io::Result<()>>>,
    last: Instant,
}

impl Syncer {
    /// Syncs this file from now on.
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
        // Without it the file is synced at its end.
        let thread = thread.ok();
        Self {
            ask: thread.is_some().then_some(ask),
            thread,
            last: Instant::now(),
        }
    }

    /// Has the file synced if that was long ago, and does not wait for it.
    ///
    /// # Errors
    /// What an earlier one has failed with.
    pub(super) fn tick(&mut self) -> io::Result<()> {
        if self.last.elapsed() >= SYNCED {
            self.last = Instant::now();
            let asked = self.ask.as_ref().map(|ask| ask.try_send(()));
            // If it is full, the last sync still runs.
            if let Some(Err(TrySendError::Disconnected(()))) = asked {
                return self.end();
            }
        }
        Ok(())
    }

    /// Waits until no sync runs any more.
    ///
    /// # Errors
    /// What one of them has failed with.
    pub(super) fn end(&mut self) -> io::Result<()> {
        self.ask = None;
        let ended = self.thread.take().map(JoinHandle::join);
        // It does not panic.
        ended.and_then(Result::ok).unwrap_or(Ok(()))
    }
}

impl Drop for Syncer {
    fn drop(&mut self) {
        // An error was reported by the end of the recording; one that is given up says nothing.
        let _ = self.end();
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn an_error_of_a_sync_is_not_lost() {
        // Nothing there can be synced.
        let mut syncer = Syncer::new(&File::open("/dev/null").expect("opened"));
        syncer.last = Instant::now().checked_sub(SYNCED).expect("later than that");
        assert!(syncer.tick().is_ok(), "it does not wait");
        assert!(syncer.end().is_err());
    }
}
