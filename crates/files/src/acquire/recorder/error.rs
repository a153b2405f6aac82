//! The error for frames that cannot be recorded.

use std::io;
use std::path::PathBuf;
use std::sync::Arc;

use crate::formats::file::{system_reason, write_reason};
use crate::formats::recording::MetadataError;
use crate::storage::FileError;

/// The error for frames that cannot be recorded.
#[derive(Clone, Debug, thiserror::Error)]
pub enum RecorderError {
    /// The system cannot write the file.
    #[error("{}: cannot record: {}", path.display(), write_reason(error))]
    Io {
        /// The file.
        path: PathBuf,
        /// The error that the system reports.
        error: Arc<io::Error>,
    },
    /// The file exists already.
    #[error("{:?} already exists", path.to_string_lossy())]
    Exists {
        /// The file.
        path: PathBuf,
    },
    /// The file beside the array is not the metadata of a recording, so it is not replaced.
    #[error("{} does not belong to a recording: record to another name", path.display())]
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
    /// The file was replaced, moved or removed while frames were recorded in it.
    #[error(
        "{}: replaced, moved or removed while frames were recorded in it; the .json file beside it is left as it is",
        path.display()
    )]
    Replaced {
        /// The path that the file had.
        path: PathBuf,
    },
    /// The file, or the metadata beside it, is the source.
    #[error("{} is the source being watched: record to another file", path.display())]
    IsSource {
        /// The file.
        path: PathBuf,
    },
}

impl RecorderError {
    /// Creates the error for a file that the system cannot write.
    pub(super) fn io(path: PathBuf, error: io::Error) -> Self {
        let error = Arc::new(error);
        Self::Io { path, error }
    }
}

/// The consequence of missing metadata.
const UNKNOWN: &str = "the recording's threshold and tare are unknown";

/// The error for metadata beside an array that is missing or cannot be read.
#[derive(Debug, thiserror::Error)]
pub enum MetadataFileError {
    /// The system cannot read the file.
    #[error("{}: cannot read: {}; {UNKNOWN}", path.display(), system_reason(error))]
    Io {
        /// The file.
        path: PathBuf,
        /// The error that the system reports.
        error: io::Error,
    },
    /// The metadata is larger than 4 MiB, and was not read.
    #[error("{}: larger than 4 MiB, the limit for metadata; {UNKNOWN}", path.display())]
    Large {
        /// The file.
        path: PathBuf,
    },
    /// The metadata is damaged, of another version, or was changed.
    #[error("{}: {error}; {UNKNOWN}", path.display())]
    Broken {
        /// The file.
        path: PathBuf,
        /// The error in the metadata.
        error: MetadataError,
    },
    /// The array was recorded by taxel, but has no metadata beside it.
    #[error("{}: missing; {UNKNOWN}", path.display())]
    Missing {
        /// The path of the metadata.
        path: PathBuf,
    },
    /// The array was recorded by taxel, but the file beside it is empty or something other than metadata.
    #[error("{}: empty or not written by taxel; {UNKNOWN}", path.display())]
    Foreign {
        /// The file.
        path: PathBuf,
    },
}

/// Converts the error of a file.
pub(super) fn refused(error: FileError) -> RecorderError {
    let path = error.path.clone();
    match error.into_io() {
        exists if exists.kind() == io::ErrorKind::AlreadyExists => RecorderError::Exists { path },
        error => RecorderError::io(path, error),
    }
}
