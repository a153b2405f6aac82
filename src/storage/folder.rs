//! Reading the files of a library, and listing and making its folders.

use std::ffi::OsString;
use std::fs::{self, File, Metadata};
use std::hash::{DefaultHasher, Hash, Hasher};
use std::io::{ErrorKind, Read};
use std::path::Path;

use crate::formats::shape::MAX_BYTES;
use crate::storage::atomic_file::sync_folder;
use crate::storage::error::{FileError, LibraryError};

/// A hash of a file's content. Two contents with the same stamp are taken for equal.
pub(crate) fn stamp(content: &[u8]) -> u64 {
    let mut hasher = DefaultHasher::new();
    content.hash(&mut hasher);
    hasher.finish()
}

/// The metadata of a regular file. A link is refused too: what it leads to is not the library's.
pub(crate) fn regular(path: &Path) -> Result<Metadata, LibraryError> {
    let found = path.symlink_metadata();
    let found = found.map_err(|error| FileError::new("look at it", path, error))?;
    let kind = found.file_type();
    let what = if kind.is_file() {
        return Ok(found);
    } else if kind.is_symlink() {
        "a symbolic link"
    } else if kind.is_dir() {
        "a folder"
    } else {
        "a device, a pipe or a socket"
    };
    Err(in_the_way(path, what, "a regular file"))
}

fn in_the_way(path: &Path, what: &'static str, expected: &'static str) -> LibraryError {
    LibraryError::InTheWay {
        path: path.to_owned(),
        what,
        expected,
    }
}

/// A regular file's content, at most one byte more than a shape may have.
pub(crate) fn read(path: &Path) -> Result<Vec<u8>, LibraryError> {
    // Checked before opening: opening a pipe waits for a writer.
    let found = regular(path)?;
    // One byte more, so that the end is found without growing: two reads a file count where a library is large.
    let length = usize::try_from(found.len()).map_or(MAX_BYTES, |length| length.min(MAX_BYTES));
    let mut content = Vec::with_capacity(length + 1);
    let file = File::open(path).map_err(|error| FileError::new("open it", path, error))?;
    file.take(MAX_BYTES as u64 + 1)
        .read_to_end(&mut content)
        .map_err(|error| FileError::new("read it", path, error))?;
    Ok(content)
}

/// The names of what is in a folder; empty if the folder does not exist.
pub(crate) fn names(folder: &Path) -> Result<Vec<OsString>, FileError> {
    let refuse = |error| FileError::new("read the folder", folder, error);
    let files = loop {
        match fs::read_dir(folder) {
            // The standard library retries opening a file after a signal, but not opening a folder.
            Err(error) if error.kind() == ErrorKind::Interrupted => {}
            Err(error) if error.kind() == ErrorKind::NotFound => return Ok(Vec::new()),
            files => break files.map_err(refuse)?,
        }
    };
    files
        .map(|file| Ok(file.map_err(refuse)?.file_name()))
        .collect()
}

/// Makes a folder and those above it, and syncs them. A link to a folder counts as a folder.
pub(crate) fn make(path: &Path) -> Result<(), LibraryError> {
    if path.as_os_str().is_empty() || path.is_dir() {
        return Ok(());
    }
    let parent = path.parent().unwrap_or(Path::new(""));
    make(parent)?;
    match fs::create_dir(path) {
        Err(error) if error.kind() == ErrorKind::AlreadyExists => {
            // Another program was faster, or something else has the name.
            if !path.is_dir() {
                return Err(in_the_way(path, "no folder", "a folder"));
            }
        }
        made => made.map_err(|error| FileError::new("make the folder", path, error))?,
    }
    let parent = if parent.as_os_str().is_empty() {
        Path::new(".")
    } else {
        parent
    };
    Ok(sync_folder(parent)?)
}

/// As [`make`], for a folder inside the library, which must not lead out of it.
pub(crate) fn make_inner(path: &Path) -> Result<(), LibraryError> {
    let found = path.symlink_metadata();
    if found.is_ok_and(|found| found.file_type().is_symlink()) {
        return Err(in_the_way(path, "a symbolic link", "a folder"));
    }
    make(path)
}
