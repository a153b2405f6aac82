//! The error for frames that cannot be recorded.

use std::io;
use std::path::PathBuf;

use crate::formats::recording::MetadataError;
use crate::storage::FileError;

/// The error for frames that cannot be recorded.
#[derive(Debug, thiserror::Error)]
#[non_exhaustive]
pub enum RecorderError {
    /// The system refuses.
    #[error("{}: cannot record: {error}", path.display())]
    Io {
        /// The file.
        path: PathBuf,
        /// The error that the system reports.
        error: io::Error,
    },
    /// There is a file already.
    #[error("{} already exists", path.display())]
    Exists {
        /// The file.
        path: PathBuf,
    },
    /// The file beside the array is not the description of a recording, so it is not replaced.
    #[error("{} is not the description of a recording: record to another name", path.display())]
    Foreign {
        /// The file.
        path: PathBuf,
    },
    /// The name of the file does not end like that of an array.
    #[error("{}: expected a file that ends in .npy", path.display())]
    Ending {
        /// The file.
        path: PathBuf,
    },
    /// The file, or the description beside it, is the source.
    #[error("{} is the source being watched: record to another file", path.display())]
    IsSource {
        /// The file.
        path: PathBuf,
    },
}

/// Why the description beside an array cannot be read.
#[derive(Debug, thiserror::Error)]
#[non_exhaustive]
pub enum DescriptionError {
    /// The system refuses.
    #[error("{}: cannot read: {error}", path.display())]
    Io {
        /// The file.
        path: PathBuf,
        /// What the system reports.
        error: io::Error,
    },
    /// It is damaged, or was changed.
    #[error("{}: {error}", path.display())]
    Broken {
        /// The file.
        path: PathBuf,
        /// What is wrong with it.
        error: MetadataError,
    },
}

/// Converts the error of a file.
pub(super) fn refused(error: FileError) -> RecorderError {
    let path = error.path.clone();
    match error.into_io() {
        exists if exists.kind() == io::ErrorKind::AlreadyExists => RecorderError::Exists { path },
        error => RecorderError::Io { path, error },
    }
}
