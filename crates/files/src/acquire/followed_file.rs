//! A recording that may still grow: at its end, it waits for more, like `tail -f`.
//!
//! A file that has grown since it was opened is followed until it is truncated or replaced. A file that has not grown
//! but was changed shortly before gets a moment to grow; any other file is read to its end.

use std::cell::Cell;
use std::fs::File;
use std::io::{self, ErrorKind, Read, Seek, SeekFrom};
use std::ops::ControlFlow;
use std::path::Path;
use std::time::{Duration, SystemTime};

use crate::acquire::growing_file::{GrowingFile, ReadAnew};

/// The time without a change after which a file is complete, if it has not grown since it was opened.
const UNCHANGED: Duration = Duration::from_secs(2);

/// The growth of a file.
#[derive(Debug)]
pub(super) struct Growth {
    file: File,
    /// The length of the file in bytes when it was opened.
    length: u64,
    /// The number of bytes that were read; those that are read again count once.
    bytes: Cell<u64>,
    has_grown: Cell<bool>,
    has_caught_up: Cell<bool>,
    /// Whether the content that the file had when it was opened is gone, so that all of its present content has arrived
    /// since.
    is_new: Cell<bool>,
}

impl Growth {
    /// Returns the number of bytes that were read so far.
    pub(super) fn bytes(&self) -> u64 {
        self.bytes.get()
    }

    /// Returns true if everything that was in the file has been read, so that frames now arrive as they are written.
    pub(super) fn has_caught_up(&self) -> bool {
        self.has_caught_up.get() || self.is_new.get()
    }

    /// Returns true if the file has become longer since it was opened, or is another file by now.
    pub(super) fn has_grown(&self) -> bool {
        if !self.has_grown.get() {
            let found = self.file.metadata();
            let has_grown = found.is_ok_and(|found| found.len() > self.length);
            self.has_grown.set(has_grown);
        }
        self.has_grown.get()
    }

    /// Returns true if more may come: the file has grown, or was changed just now.
    pub(super) fn may_go_on(&self) -> bool {
        self.has_grown() || self.was_just_changed()
    }

    /// Returns true if the file was changed just now, so that it may be about to grow.
    fn was_just_changed(&self) -> bool {
        let changed = self.file.metadata().and_then(|found| found.modified());
        let age = changed.map(|changed| SystemTime::now().duration_since(changed));
        matches!(age, Ok(Ok(age)) if age < UNCHANGED)
    }
}

/// The reason why reading a followed file ended before its end.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) enum FollowEnd {
    /// No more is wanted.
    Stopped,
    /// The file must be read again from its start.
    Anew(ReadAnew),
}

/// A recording that may still grow. Reading waits at its end.
pub(super) struct FollowedFile<'a> {
    file: GrowingFile,
    growth: &'a Growth,
    /// The function that is called while waiting for more; it breaks if no more is wanted.
    waiting: &'a mut dyn FnMut() -> ControlFlow<()>,
    end: Option<FollowEnd>,
    /// Whether the last byte that was read ends a line, or none was read.
    ended_line: bool,
    /// The number of bytes from the start of the file to the next one.
    offset: u64,
}

/// Follows an open file of that path, at its start. Also returns its growth.
///
/// # Errors
/// Returns the system's error.
pub(super) fn of(path: &Path, file: File) -> io::Result<(GrowingFile, Growth)> {
    let growth = Growth {
        length: file.metadata()?.len(),
        file: file.try_clone()?,
        bytes: Cell::new(0),
        has_grown: Cell::new(false),
        has_caught_up: Cell::new(false),
        is_new: Cell::new(false),
    };
    Ok((GrowingFile::new(path, file), growth))
}

impl<'a> FollowedFile<'a> {
    /// Follows a file from its start.
    ///
    /// # Errors
    /// Returns the system's error.
    pub(super) fn new(
        mut file: GrowingFile,
        growth: &'a Growth,
        waiting: &'a mut dyn FnMut() -> ControlFlow<()>,
    ) -> io::Result<Self> {
        file.rewind()?;
        Ok(Self {
            file,
            growth,
            waiting,
            end: None,
            ended_line: true,
            offset: 0,
        })
    }

    /// Returns the file, and why reading it ended before its end, if it did.
    pub(super) fn into_parts(self) -> (GrowingFile, Option<FollowEnd>) {
        (self.file, self.end)
    }
}

impl Read for FollowedFile<'_> {
    /// Reads the bytes that have come; waits if there are none.
    ///
    /// # Errors
    /// Returns an error of the kind [`ErrorKind::UnexpectedEof`] if reading ended within a line, before the end of the
    /// file; otherwise the system's error.
    fn read(&mut self, bytes: &mut [u8]) -> io::Result<usize> {
        while self.end.is_none() {
            if let Some(how) = self.file.anew()? {
                self.growth.has_grown.set(true);
                self.growth.is_new.set(true);
                self.end = Some(FollowEnd::Anew(how));
                break;
            }
            let count = self.file.read(bytes)?;
            if count > 0 {
                self.ended_line = bytes[count - 1] == b'\n';
                self.offset += count as u64;
                self.growth.bytes.update(|bytes| bytes + count as u64);
                return Ok(count);
            }
            if !self.growth.may_go_on() {
                break;
            }
            self.growth.has_caught_up.set(true);
            if (self.waiting)().is_break() {
                self.end = Some(FollowEnd::Stopped);
            }
        }
        // The end of the file would end its last line, but the rest of that line was never read.
        if self.end.is_some() && !self.ended_line {
            return Err(ErrorKind::UnexpectedEof.into());
        }
        Ok(0)
    }
}

impl Seek for FollowedFile<'_> {
    /// Seeks only to the start, which is all that a reader of lines or markers needs.
    fn seek(&mut self, to: SeekFrom) -> io::Result<u64> {
        if to != SeekFrom::Start(0) {
            return Err(ErrorKind::Unsupported.into());
        }
        // Bytes that are read again did not arrive just now.
        self.growth.has_caught_up.set(false);
        let again = std::mem::take(&mut self.offset);
        self.growth.bytes.update(|bytes| bytes - again);
        self.file.rewind().map(|()| 0)
    }
}
