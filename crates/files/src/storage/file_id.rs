//! The identity of a file: whether a name still belongs to it, or another program has given the name to another file.

use std::fs::File;
use std::io;
use std::path::Path;

/// The identity of a file, which it keeps when it is renamed. It stays unique as long as the file is open.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct FileId {
    /// The number of the device.
    #[cfg(unix)]
    device: u64,
    /// The number of the file on its device.
    #[cfg(unix)]
    number: u64,
}

#[cfg(unix)]
impl FileId {
    /// Returns the identity of the file that this metadata describes.
    pub fn in_metadata(found: &std::fs::Metadata) -> Self {
        use std::os::unix::fs::MetadataExt;
        Self {
            device: found.dev(),
            number: found.ino(),
        }
    }

    /// Returns the identity of an open file.
    ///
    /// # Errors
    /// Returns the system's error.
    pub fn of(file: &File) -> io::Result<Self> {
        file.metadata().map(|found| Self::in_metadata(&found))
    }

    /// Returns the identity of the file that a stream, such as standard input, reads or writes.
    ///
    /// # Errors
    /// Returns the system's error.
    pub fn of_stream(stream: impl std::os::fd::AsFd) -> io::Result<Self> {
        let stream = stream.as_fd().try_clone_to_owned()?;
        Self::of(&File::from(stream))
    }

    /// Returns the identity of the file at a path; of a link, that of the file that it leads to.
    ///
    /// # Errors
    /// Returns the system's error.
    pub fn behind(path: &Path) -> io::Result<Self> {
        path.metadata().map(|found| Self::in_metadata(&found))
    }

    /// Returns true if the file has this path.
    pub fn is_at(self, path: &Path) -> bool {
        let found = path.symlink_metadata();
        found.is_ok_and(|found| Self::in_metadata(&found) == self)
    }
}

#[cfg(not(unix))]
impl FileId {
    /// Returns the same for every file: on these systems an open file cannot be removed.
    pub(crate) fn of(_: &File) -> io::Result<Self> {
        Ok(Self {})
    }

    /// Returns true.
    pub(crate) fn is_at(self, _: &Path) -> bool {
        true
    }
}
