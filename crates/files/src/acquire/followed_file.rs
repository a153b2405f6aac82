//! A file that is read while it grows, like `tail -f`: a stream of bytes, or a recording that is played meanwhile.
//!
//! A recording that has grown since it was opened is followed until it is truncated or replaced. One that has not grown
//! but was changed shortly before gets a moment to grow; any other is read to its end.

use std::cell::Cell;
use std::fmt;
use std::fs::{self, File};
use std::io::{self, ErrorKind, Read, Seek, SeekFrom};
use std::ops::ControlFlow;
use std::path::{Path, PathBuf};
use std::time::{Duration, SystemTime};

use crate::storage::FileId;

/// The time without a change after which a file is complete, if it has not grown since it was opened.
const UNCHANGED: Duration = Duration::from_secs(2);

#[derive(Debug)]
pub(super) struct Growth {
    file: File,
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
    pub(super) fn bytes(&self) -> u64 {
        self.bytes.get()
    }

    /// Whether everything that was in the file has been read, so that frames now arrive as they are written.
    pub(super) fn has_caught_up(&self) -> bool {
        self.has_caught_up.get() || self.is_new.get()
    }

    /// Whether the file has become longer since it was opened, or is another file by now.
    pub(super) fn has_grown(&self) -> bool {
        if !self.has_grown.get() {
            let found = self.file.metadata();
            let has_grown = found.is_ok_and(|found| found.len() > self.length);
            self.has_grown.set(has_grown);
        }
        self.has_grown.get()
    }

    /// Whether more may come: the file has grown, or was changed just now.
    pub(super) fn may_go_on(&self) -> bool {
        self.has_grown() || self.was_just_changed()
    }

    /// Whether the file was changed just now, so that it may be about to grow.
    fn was_just_changed(&self) -> bool {
        let changed = self.file.metadata().and_then(|found| found.modified());
        let age = changed.map(|changed| SystemTime::now().duration_since(changed));
        matches!(age, Ok(Ok(age)) if age < UNCHANGED)
    }
}

#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) enum FollowEnd {
    Stopped,
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
    offset: u64,
}

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

    pub(super) fn into_parts(self) -> (GrowingFile, Option<FollowEnd>) {
        (self.file, self.end)
    }
}

impl Read for FollowedFile<'_> {
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

/// The pause at the end of a file before it is checked for growth again.
const GROWTH: Duration = Duration::from_millis(50);

/// The reason why a file is read from its start again.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash)]
pub enum ReadAnew {
    /// The file is shorter than what was read of it.
    Cut,
    /// Another file has its name.
    Replaced,
}

impl fmt::Display for ReadAnew {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.write_str(match self {
            Self::Cut => "was truncated: reading it again from its start",
            Self::Replaced => "was replaced: reading the new file from its start",
        })
    }
}

/// A file with a name, read up to its present end.
#[derive(Debug)]
pub(super) struct GrowingFile {
    path: PathBuf,
    file: File,
    offset: u64,
    at_end: bool,
}

impl GrowingFile {
    pub(super) fn open(path: &Path) -> io::Result<Self> {
        Ok(Self::new(path, File::open(path)?))
    }

    pub(super) fn new(path: &Path, file: File) -> Self {
        Self {
            path: path.to_owned(),
            file,
            offset: 0,
            at_end: false,
        }
    }

    pub(super) fn rewind(&mut self) -> io::Result<()> {
        self.file.rewind()?;
        (self.offset, self.at_end) = (0, false);
        Ok(())
    }

    /// Reads the bytes that have arrived; waits a moment if there are none.
    pub(super) fn read(&mut self, bytes: &mut [u8]) -> io::Result<usize> {
        let count = read_some(&mut self.file, bytes)?;
        self.at_end = count == 0;
        if self.at_end {
            std::thread::sleep(GROWTH);
        }
        self.offset += count as u64;
        Ok(count)
    }

    /// Goes back to the start of the file if it was truncated or replaced, and returns which. Must be called before
    /// each read.
    pub(super) fn anew(&mut self) -> io::Result<Option<ReadAnew>> {
        if !self.at_end {
            return Ok(None);
        }
        let own = self.file.metadata()?;
        if own.len() < self.offset {
            self.rewind()?;
            return Ok(Some(ReadAnew::Cut));
        }
        // While no file has that name, the open file is the only one.
        let Ok(named) = fs::metadata(&self.path) else {
            return Ok(None);
        };
        // Read the old file to its end before switching: bytes may have been appended before the rename.
        let is_own = FileId::in_metadata(&named) == FileId::in_metadata(&own);
        if is_own || !named.is_file() || own.len() > self.offset {
            return Ok(None);
        }
        self.switched(Self::open(&self.path))
    }

    /// Continues with the file that now has the name. If it has vanished since it was checked, waits for another one.
    fn switched(&mut self, opened: io::Result<Self>) -> io::Result<Option<ReadAnew>> {
        match opened {
            Ok(file) => {
                *self = file;
                Ok(Some(ReadAnew::Replaced))
            }
            Err(error) if error.kind() == ErrorKind::NotFound => Ok(None),
            Err(error) => Err(error),
        }
    }
}

/// Reads the bytes that are there. A read that a signal interrupted is repeated: without bytes, it would count as the
/// end of the file.
fn read_some(file: &mut impl Read, bytes: &mut [u8]) -> io::Result<usize> {
    loop {
        match file.read(bytes) {
            Err(error) if error.kind() == ErrorKind::Interrupted => {}
            read => return read,
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    struct Interrupted(bool);

    impl Read for Interrupted {
        fn read(&mut self, bytes: &mut [u8]) -> io::Result<usize> {
            if std::mem::replace(&mut self.0, true) {
                bytes.fill(1);
                return Ok(bytes.len());
            }
            Err(ErrorKind::Interrupted.into())
        }
    }

    #[test]
    fn an_interrupted_read_is_not_the_end_of_a_file() {
        assert!(matches!(
            read_some(&mut Interrupted(false), &mut [0; 8]),
            Ok(8)
        ));
    }

    #[test]
    fn a_new_file_that_vanishes_at_once_does_not_end_the_watch() {
        let folder = tempfile::tempdir().expect("a folder");
        let path = folder.path().join("growing");
        fs::write(&path, "1 2").expect("written");
        let mut growing = GrowingFile::open(&path).expect("opened");
        // The file was removed between the look at its name and its opening.
        let vanished = GrowingFile::open(&folder.path().join("vanished"));
        assert!(matches!(growing.switched(vanished), Ok(None)));
        let mut bytes = [0; 8];
        assert!(matches!(growing.read(&mut bytes), Ok(3)));
        let refused = Err(ErrorKind::PermissionDenied.into());
        assert!(growing.switched(refused).is_err());
    }
}
