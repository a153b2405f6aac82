//! A writer that stores the first error instead of returning it.

use std::io::{self, Seek, SeekFrom, Write};
use std::sync::atomic::{AtomicBool, Ordering};

/// A writer that stops writing at the first error, or when it is to stop. From then on it only counts what would have
/// been written, since a zip whose writer fails complains on standard error, where the screen is.
pub(crate) struct FirstErrorWriter<'a, W> {
    output: W,
    stopped: &'a AtomicBool,
    /// The first error.
    error: Option<io::Error>,
    place: u64,
    end: u64,
    /// The largest number of bytes that are written.
    most: u64,
}

impl<'a, W: Write + Seek> FirstErrorWriter<'a, W> {
    /// Creates a writer of a file of at most `most` bytes; a longer file is an error.
    pub(crate) fn new(output: W, most: u64, stopped: &'a AtomicBool) -> Self {
        Self {
            output,
            stopped,
            error: None,
            place: 0,
            end: 0,
            most,
        }
    }

    /// Returns the first error of the system or of stopping, otherwise `written`, the result of the function that
    /// wrote: it may not have noticed that error.
    pub(crate) fn finish<E: From<io::Error>>(self, written: Result<(), E>) -> Result<(), E> {
        match self.error {
            Some(error) => Err(error.into()),
            None => written,
        }
    }

    fn attempt<T>(&mut self, act: impl FnOnce(&mut W) -> io::Result<T>) -> Option<T> {
        if self.stopped.load(Ordering::Relaxed) && self.error.is_none() {
            self.error = Some(io::Error::other("stopped"));
        }
        if self.error.is_some() {
            return None;
        }
        act(&mut self.output)
            .map_err(|error| self.error = Some(error))
            .ok()
    }
}

impl<W: Write + Seek> Write for FirstErrorWriter<'_, W> {
    fn write(&mut self, bytes: &[u8]) -> io::Result<usize> {
        let place = self.place + bytes.len() as u64;
        let fits = place <= self.most;
        let _ = self.attempt(|output| {
            if fits {
                output.write_all(bytes)
            } else {
                Err(io::ErrorKind::FileTooLarge.into())
            }
        });
        self.place = place;
        self.end = self.end.max(self.place);
        Ok(bytes.len())
    }

    fn flush(&mut self) -> io::Result<()> {
        let _ = self.attempt(Write::flush);
        Ok(())
    }
}

impl<W: Write + Seek> Seek for FirstErrorWriter<'_, W> {
    fn seek(&mut self, to: SeekFrom) -> io::Result<u64> {
        let _ = self.attempt(|output| output.seek(to));
        let place = match to {
            SeekFrom::Start(place) => Some(place),
            SeekFrom::End(by) => self.end.checked_add_signed(by),
            SeekFrom::Current(by) => self.place.checked_add_signed(by),
        };
        self.place = place.ok_or(io::ErrorKind::InvalidInput)?;
        Ok(self.place)
    }
}
