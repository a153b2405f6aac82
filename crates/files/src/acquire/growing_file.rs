//! A file that is read while it grows, even if it is truncated and rewritten, or if another file takes its name.

use std::fmt;
use std::fs::{self, File};
use std::io::{self, ErrorKind, Read, Seek};
use std::os::unix::fs::FileExt;
use std::path::{Path, PathBuf};
use std::time::{Duration, SystemTime};

use crate::storage::FileId;

/// The pause at the end of a file before it is checked for growth again.
const GROWTH: Duration = Duration::from_millis(50);

/// The number of last bytes that are compared with the file, to find out whether it was rewritten.
const REMEMBERED: usize = 1 << 12;

/// The reason why a file is read from its start again.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash)]
pub enum ReadAnew {
    /// The file is shorter than it was, or holds something else.
    Cut,
    /// Another file has its name.
    Replaced,
}

impl fmt::Display for ReadAnew {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.write_str(match self {
            Self::Cut => "was truncated or rewritten: reading it again from its start",
            Self::Replaced => "was replaced: reading the new file from its start",
        })
    }
}

/// A file with a name, read up to its present end.
#[derive(Debug)]
pub(super) struct GrowingFile {
    path: PathBuf,
    file: File,
    /// The number of bytes that were read.
    offset: u64,
    /// The last of these bytes.
    last: Vec<u8>,
    /// Whether everything that was there has been read.
    at_end: bool,
    /// The modification time of the file when it was last checked.
    changed: Option<SystemTime>,
}

impl GrowingFile {
    /// Opens a file.
    ///
    /// # Errors
    /// Returns the system's error.
    pub(super) fn open(path: &Path) -> io::Result<Self> {
        Ok(Self::new(path, File::open(path)?))
    }

    /// Takes an open file, before its first byte.
    pub(super) fn new(path: &Path, file: File) -> Self {
        Self {
            path: path.to_owned(),
            file,
            offset: 0,
            last: Vec::new(),
            at_end: false,
            changed: None,
        }
    }

    /// Goes back to the first byte.
    ///
    /// # Errors
    /// Returns the system's error.
    pub(super) fn rewind(&mut self) -> io::Result<()> {
        self.file.rewind()?;
        (self.offset, self.at_end, self.changed) = (0, false, None);
        self.last.clear();
        Ok(())
    }

    /// Reads the bytes that have arrived; waits a moment if there are none.
    ///
    /// # Errors
    /// Returns the system's error.
    pub(super) fn read(&mut self, bytes: &mut [u8]) -> io::Result<usize> {
        let count = read_some(&mut self.file, bytes)?;
        self.at_end = count == 0;
        if self.at_end {
            std::thread::sleep(GROWTH);
        }
        self.offset += count as u64;
        let read = &bytes[..count];
        self.last.extend(&read[count.saturating_sub(REMEMBERED)..]);
        let old = self.last.len().saturating_sub(REMEMBERED);
        self.last.drain(..old);
        Ok(count)
    }

    /// Goes back to the start of the file if it was rewritten or replaced, and returns which. Must be called before
    /// each read.
    ///
    /// # Errors
    /// Returns the system's error.
    pub(super) fn anew(&mut self) -> io::Result<Option<ReadAnew>> {
        if !self.at_end {
            return Ok(None);
        }
        if self.was_cut()? {
            self.rewind()?;
            return Ok(Some(ReadAnew::Cut));
        }
        // While no file has that name, the open file is the only one.
        let Ok(named) = fs::metadata(&self.path) else {
            return Ok(None);
        };
        let own = self.file.metadata()?;
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

    /// Returns true if what was read is no longer there.
    fn was_cut(&mut self) -> io::Result<bool> {
        let found = self.file.metadata()?;
        if found.len() < self.offset {
            return Ok(true);
        }
        let changed = found.modified().ok();
        if changed.is_some() && changed == self.changed {
            return Ok(false);
        }
        self.changed = changed;
        let mut bytes = vec![0; self.last.len()];
        let start = self.offset - self.last.len() as u64;
        match self.file.read_exact_at(&mut bytes, start) {
            // The file was truncated between the two looks.
            Err(error) if error.kind() == ErrorKind::UnexpectedEof => Ok(true),
            read => read.map(|()| bytes != self.last),
        }
    }
}

/// Reads the bytes that are there. A read that a signal interrupted is repeated: without bytes, it would count as the
/// end of the file.
///
/// # Errors
/// Returns the system's error.
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

    /// A file whose first read is interrupted.
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
