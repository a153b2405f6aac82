//! The errors of files and of a library: which file, which operation, what was expected.

use std::io;
use std::path::{Path, PathBuf};

use crate::error::{ReadError, ReadErrorKind};
use crate::formats::file::{system_reason, write_reason};

/// The error for an operation on a file that the system refused.
#[derive(Debug, thiserror::Error)]
#[error("{}: cannot {doing}: {}", path.display(), self.reason())]
pub struct FileError {
    /// The operation, in words that follow "cannot".
    pub doing: &'static str,
    /// The file or folder.
    pub path: PathBuf,
    /// The error that the system reports.
    pub error: io::Error,
}

impl FileError {
    /// Tells an error of the system as that of an operation on a file.
    pub fn cannot<'a>(doing: &'static str, path: &'a Path) -> impl Fn(io::Error) -> Self + 'a {
        move |error| Self {
            doing,
            path: path.to_owned(),
            error,
        }
    }

    fn reason(&self) -> String {
        match self.doing {
            "write" | "record" => write_reason(&self.error),
            _ => system_reason(&self.error),
        }
    }

    /// Whether there is a file already, which was to be kept.
    pub fn exists(&self) -> bool {
        self.error.kind() == io::ErrorKind::AlreadyExists
    }
}

impl From<FileError> for ReadError {
    fn from(error: FileError) -> Self {
        let kind = ReadErrorKind::Io(error.error.kind());
        Self::new(error.to_string()).of_kind(kind)
    }
}

/// The error of an operation on a library. No shape was lost.
#[derive(Debug, thiserror::Error)]
pub enum LibraryError {
    /// The text is not a valid name.
    #[error(transparent)]
    Name(#[from] ReadError),
    /// No shape has that name.
    #[error("no shape named {0:?}")]
    Unknown(String),
    /// No shape in the trash has that name.
    #[error("no shape named {0:?} in the trash")]
    NotInTrash(String),
    /// The shape comes with the program and cannot be changed.
    #[error("{0:?} comes with taxel and cannot be replaced; choose another name")]
    Shipped(String),
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
    /// The system refused.
    #[error(transparent)]
    System(#[from] FileError),
    /// No folder was named, and the system does not say where a user's data belong.
    #[error("no home folder to keep the library in")]
    NoPlace,
    /// Anything else, in a sentence.
    #[error("{0}")]
    Refused(String),
}
