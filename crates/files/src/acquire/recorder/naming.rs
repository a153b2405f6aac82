//! The names of an array and its metadata, which the two files get together, with the first frame.

use std::fs::File;
use std::io;
use std::path::PathBuf;

use crate::acquire::recorder::error::{RecorderError, refused};
use crate::storage::{FileId, FinishedFile, persist_pair};

/// The state of the names of array and metadata.
#[derive(Debug)]
pub(super) enum NamingState {
    /// The files get their names with the first frame: the array, and the metadata beside it.
    Waiting(FinishedFile, FinishedFile),
    /// The files have their names; the identity of the array.
    Given(FileId),
    /// The files did not get their names, for this reason. Other files of these names stay as they are.
    Refused(RecorderError),
}

/// An array that has just got its name.
#[derive(Debug)]
pub(super) struct NamedArray {
    /// The array, open for further writing.
    pub(super) file: File,
    /// The error if the folder could not be synced.
    pub(super) unsynced: Option<RecorderError>,
}

impl NamingState {
    /// Returns the identity of the array if the files have their names; None while they wait for the first frame.
    ///
    /// # Errors
    /// Returns the reason why the files did not get their names.
    pub(super) fn array(&self) -> Result<Option<FileId>, RecorderError> {
        match self {
            Self::Waiting(..) => Ok(None),
            Self::Given(array) => Ok(Some(*array)),
            Self::Refused(reason) => Err(reason.clone()),
        }
    }

    /// Gives the files their names, and returns the array; None if they have them already.
    ///
    /// # Errors
    /// Returns the reason why the files do not get their names, or did not get them before.
    pub(super) fn give(&mut self) -> Result<Option<NamedArray>, RecorderError> {
        if self.array()?.is_some() {
            return Ok(None);
        }
        // Until the names are given below.
        let interrupted = io::ErrorKind::Interrupted.into();
        let unnamed = Self::Refused(RecorderError::io(PathBuf::new(), interrupted));
        let Self::Waiting(array, beside) = std::mem::replace(self, unnamed) else {
            return Ok(None);
        };
        match given(array, beside) {
            Ok((array, id)) => {
                *self = Self::Given(id);
                Ok(Some(array))
            }
            Err(error) => {
                *self = Self::Refused(error.clone());
                Err(error)
            }
        }
    }
}

/// Gives the files their names. Returns the array and its identity.
///
/// # Errors
/// Returns the system's error.
fn given(array: FinishedFile, beside: FinishedFile) -> Result<(NamedArray, FileId), RecorderError> {
    let path = array.path().to_owned();
    let (file, synced) = persist_pair(array, beside).map_err(refused)?;
    let id = FileId::of(&file).map_err(|error| RecorderError::io(path, error))?;
    let unsynced = synced.err().map(refused);
    Ok((NamedArray { file, unsynced }, id))
}
