//! The folder of a library: its files, and the lock that a writer of a shape holds while it writes.

use std::ffi::OsString;
use std::fs::{self, File, TryLockError};
use std::hash::{DefaultHasher, Hash, Hasher};
use std::io::{self, ErrorKind, Read};
use std::path::Path;
use std::sync::atomic::{AtomicBool, Ordering};
use std::time::{Duration, Instant};

use crate::formats::shape::MAX_BYTES;
use crate::storage::error::{FileError, LibraryError};
use crate::storage::file::{folder_of, kind_in_words, sync_folder};

const LOCK: &str = ".lock";

/// The time that a writer waits for another program. Writing takes milliseconds, unless that program is stopped.
const PATIENCE: Duration = Duration::from_secs(5);

const PAUSE: Duration = Duration::from_millis(5);

/// A hash of a file's content. Two contents with the same stamp count as equal.
pub(crate) fn stamp(content: &[u8]) -> u64 {
    let mut hasher = DefaultHasher::new();
    content.hash(&mut hasher);
    hasher.finish()
}

/// Reads the content of a regular file, at most one byte more than a shape may have.
pub(crate) fn read(path: &Path) -> Result<Vec<u8>, LibraryError> {
    let refuse = |doing| move |error| FileError::new(doing, path, error);
    // Looked at first, because opening a pipe waits for its writer.
    let found = path.metadata().map_err(refuse("open"))?;
    if !found.is_file() {
        let what = kind_in_words(found.file_type());
        return Err(in_the_way(path, what, "a regular file"));
    }
    let file = File::open(path).map_err(refuse("open"))?;
    let mut content = Vec::new();
    let most = MAX_BYTES as u64 + 1;
    let read = file.take(most).read_to_end(&mut content);
    read.map_err(refuse("read"))?;
    Ok(content)
}

fn in_the_way(path: &Path, what: &'static str, expected: &'static str) -> LibraryError {
    let path = path.to_owned();
    LibraryError::InTheWay {
        path,
        what,
        expected,
    }
}

/// The names of everything in a folder; none if the folder does not exist, or if a file is where a folder above it
/// would be.
pub(crate) fn names(folder: &Path) -> Result<Vec<OsString>, FileError> {
    let refuse = |error| FileError::new("read the folder", folder, error);
    let files = match fs::read_dir(folder) {
        Err(error) if error.kind() == ErrorKind::NotFound => return Ok(Vec::new()),
        Err(error) if error.kind() == ErrorKind::NotADirectory => {
            return if file_above(folder).is_some() {
                Ok(Vec::new())
            } else {
                Err(refuse(io::Error::new(error.kind(), "it is a file")))
            };
        }
        files => files.map_err(refuse)?,
    };
    files
        .map(|file| Ok(file.map_err(refuse)?.file_name()))
        .collect()
}

/// The file that is where a folder above `path` would be, if there is one.
pub(crate) fn file_above(path: &Path) -> Option<&Path> {
    let above = path.ancestors().skip(1);
    let mut found = above.filter(|above| !above.as_os_str().is_empty() && above.exists());
    found.next().filter(|above| !above.is_dir())
}

/// Makes a folder and the folders above it, and syncs them. A link to a folder counts as a folder.
pub(crate) fn make(path: &Path) -> Result<(), LibraryError> {
    if path.as_os_str().is_empty() || path.is_dir() {
        return Ok(());
    }
    make(path.parent().unwrap_or(Path::new("")))?;
    match fs::create_dir(path) {
        // Another program was faster, or something else has the name.
        Err(error) if error.kind() == ErrorKind::AlreadyExists => match path.metadata() {
            Ok(found) if found.is_dir() => {}
            Ok(found) => {
                let what = kind_in_words(found.file_type());
                return Err(in_the_way(path, what, "a folder"));
            }
            Err(_) => return Err(in_the_way(path, "a broken symbolic link", "a folder")),
        },
        made => made.map_err(|error| FileError::new("make the folder", path, error))?,
    }
    Ok(sync_folder(folder_of(path))?)
}

/// Opens the file of a lock, and makes it if it does not exist. One that this user may not write is opened for reading.
/// The system releases a lock when its program dies or the file is closed.
pub(crate) fn open_lock(path: &Path) -> Result<File, FileError> {
    let mut options = File::options();
    options.read(true).write(true).create(true);
    options
        .open(path)
        .or_else(|error| File::open(path).map_err(|_| error))
        .map_err(|error| FileError::new("open the lock", path, error))
}

/// Waits for the lock of a library's folder, and sets `waits` while another program holds it. An error if another
/// program holds it for [`PATIENCE`].
pub(crate) fn lock(folder: &Path, waits: &AtomicBool) -> Result<File, FileError> {
    let path = folder.join(LOCK);
    let file = open_lock(&path)?;
    let start = Instant::now();
    let locked = loop {
        match file.try_lock() {
            Err(TryLockError::WouldBlock) if start.elapsed() < PATIENCE => {
                waits.store(true, Ordering::Relaxed);
                std::thread::sleep(PAUSE);
            }
            Err(TryLockError::WouldBlock) => {
                let busy = "another program has held it for five seconds";
                break Err(io::Error::other(busy));
            }
            Err(TryLockError::Error(error)) => break Err(error),
            Ok(()) => break Ok(()),
        }
    };
    waits.store(false, Ordering::Relaxed);
    locked.map_err(|error| FileError::new("lock it", &path, error))?;
    Ok(file)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_file_is_read_whole_but_no_further_than_a_shape_may_go() {
        let folder = tempfile::tempdir().expect("a folder");
        let path = folder.path().join("file");
        for (length, read_of_it) in [
            (0, 0),
            (MAX_BYTES, MAX_BYTES),
            (MAX_BYTES + 5, MAX_BYTES + 1),
        ] {
            fs::write(&path, vec![b'x'; length]).expect("written");
            let content = read(&path).expect("read");
            assert_eq!(content.len(), read_of_it, "of {length} bytes");
        }
    }
}
