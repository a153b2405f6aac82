//! The errors of files, of archives and of a library: which file, which operation, what was expected.

use std::io;
use std::path::{Path, PathBuf};

use crate::error::ReadError;
use crate::formats::ArchiveError;
use crate::formats::file::write_reason;
use crate::formats::file::{is_missing, system_reason};

/// The error for an operation on a file that the system refused.
#[derive(Debug, thiserror::Error)]
#[error("{}: cannot {doing}: {}", path.display(), system_reason(error))]
pub struct FileError {
    /// The operation, in words that follow "cannot".
    pub doing: &'static str,
    /// The file or folder.
    pub path: PathBuf,
    /// The error that the system reports.
    pub error: io::Error,
}

impl FileError {
    /// Says what was being done with which file when the system refused.
    pub fn new(doing: &'static str, path: &Path, error: io::Error) -> Self {
        Self {
            doing,
            path: path.to_owned(),
            error,
        }
    }

    /// Whether there is a file already, which was to be kept.
    pub fn exists(&self) -> bool {
        self.error.kind() == io::ErrorKind::AlreadyExists
    }

    /// Whether there is no such file, or if a file is where a folder is expected.
    pub fn is_missing(&self) -> bool {
        is_missing(&self.error)
    }
}

/// The error for a file of a sweep or a model that cannot be written or read.
#[derive(Debug, thiserror::Error)]
#[error("{name}: {error}")]
pub struct ArchiveFileError {
    /// The file's name.
    pub name: String,
    /// The problem.
    pub error: ArchiveError,
}

impl From<FileError> for ArchiveFileError {
    fn from(error: FileError) -> Self {
        let path = error.path.clone();
        Self::doing("write", &path, &error.error)
    }
}

impl ArchiveFileError {
    /// Creates an error about a file.
    pub fn new(path: &Path, error: impl Into<ArchiveError>) -> Self {
        Self {
            name: path.to_string_lossy().into_owned(),
            error: error.into(),
        }
    }

    /// Creates the error for an operation that the system refused, in words that follow "cannot".
    pub(crate) fn doing(doing: &str, path: &Path, error: &io::Error) -> Self {
        let reason = match doing {
            "write" => write_reason(error),
            _ => system_reason(error),
        };
        let text = format!("cannot {doing}: {reason}");
        Self::new(path, io::Error::new(error.kind(), text))
    }

    /// Whether there is no such file, or if a file is where a folder is expected.
    pub fn is_missing(&self) -> bool {
        matches!(&self.error, ArchiveError::Io(error) if is_missing(error))
    }

    /// Whether a file of that name is there already, and was to be kept.
    pub fn exists(&self) -> bool {
        matches!(&self.error, ArchiveError::Io(error) if error.kind() == io::ErrorKind::AlreadyExists)
    }
}

/// The error of an operation on a library. No shape was lost.
#[derive(Debug, thiserror::Error)]
pub enum LibraryError {
    /// The text is not a valid name.
    #[error(transparent)]
    Name(#[from] ReadError),
    /// No shape has that name.
    #[error("no shape named {name:?}")]
    Unknown {
        /// The given name.
        name: String,
    },
    /// No shape in the trash has that name.
    #[error("no shape named {name:?} in the trash")]
    NotInTrash {
        /// The given name.
        name: String,
    },
    /// The trash is empty.
    #[error("the trash is empty")]
    TrashEmpty,
    /// The shape comes with the program and cannot be changed.
    #[error("{name:?} comes with taxel and cannot be replaced; choose another name")]
    Shipped {
        /// The name of the shape.
        name: String,
    },
    /// The shape comes with the program and cannot be deleted.
    #[error("{name:?} comes with taxel and cannot be deleted")]
    NotDeletable {
        /// The name of the shape.
        name: String,
    },
    /// The name is taken.
    #[error("{name:?} already exists")]
    Exists {
        /// The name as the file has it.
        name: String,
        /// The stamp of the file's present content.
        stamp: u64,
    },
    /// Another program has written the file since it was loaded.
    #[error("{name:?} was changed by another program since it was loaded")]
    Changed {
        /// The name.
        name: String,
        /// The stamp of the file's present content.
        stamp: u64,
    },
    /// The path is taken by something of another kind than expected: a folder instead of a file, for example.
    #[error("{}: is {what}, expected {expected}", path.display())]
    InTheWay {
        /// The path.
        path: PathBuf,
        /// The kind of thing that is there.
        what: &'static str,
        /// The kind of thing that is expected.
        expected: &'static str,
    },
    /// The file does not hold a shape.
    #[error("{}: {error}", path.display())]
    Broken {
        /// The file.
        path: PathBuf,
        /// The problem with the content.
        error: ReadError,
    },
    /// The system refused.
    #[error(transparent)]
    System(#[from] FileError),
    /// No folder was named, and the system does not say where a user's data belong.
    #[error("no home folder to keep the library in")]
    NoPlace,
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_file_below_a_file_is_missing_to_every_command() {
        for (kind, is_missing) in [
            (io::ErrorKind::NotFound, true),
            (io::ErrorKind::NotADirectory, true),
            (io::ErrorKind::PermissionDenied, false),
        ] {
            let path = Path::new("a");
            let file = FileError::new("read it", path, kind.into());
            let archive = ArchiveFileError::doing("read", path, &kind.into());
            assert_eq!(
                [file.is_missing(), archive.is_missing()],
                [is_missing; 2],
                "{kind}"
            );
        }
    }
}
