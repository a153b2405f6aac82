//! Who may write: a lock that is held for the moment of writing, and by journals as long as their program runs.
//!
//! The system releases a lock when its program dies, so no lock is ever left behind.

use std::fs::{self, File, TryLockError};
use std::io::{self, ErrorKind};
use std::path::{Path, PathBuf};
use std::time::{Duration, Instant};

use crate::storage::LibraryError;
use crate::storage::file::{regular, system};

/// How long writing waits for another program. Holding takes milliseconds, unless that program is stopped.
const PATIENCE: Duration = Duration::from_secs(5);

/// How often it tries meanwhile.
const PAUSE: Duration = Duration::from_millis(5);

/// A lock that is held until this is dropped.
#[derive(Debug)]
pub(crate) struct Lock {
    /// Closing it releases the lock.
    _file: File,
}

impl Lock {
    /// The lock of a folder, waited for; none on a file system without locks, which is taken as it is.
    pub(crate) fn of(folder: &Path) -> Result<Option<Self>, LibraryError> {
        let path = of_folder(folder);
        let file = open(&path)?;
        let start = Instant::now();
        loop {
            match file.try_lock() {
                Ok(()) => return Ok(Some(Self { _file: file })),
                Err(TryLockError::WouldBlock) if start.elapsed() < PATIENCE => {
                    std::thread::sleep(PAUSE);
                }
                Err(TryLockError::WouldBlock) => {
                    let busy = io::Error::other("another program has held it for five seconds");
                    return Err(system("lock it", &path)(busy));
                }
                Err(TryLockError::Error(error)) if error.kind() == ErrorKind::Interrupted => {}
                Err(TryLockError::Error(error)) if knows_none(&error) => return Ok(None),
                Err(TryLockError::Error(error)) => return Err(system("lock it", &path)(error)),
            }
        }
    }

    /// The lock at a path, if it is to be had.
    pub(crate) fn at(path: &Path) -> Result<LockAttempt, LibraryError> {
        let file = open(path)?;
        loop {
            match file.try_lock() {
                // Whoever had it may have removed the file: then this is the lock of nothing.
                Ok(()) if is_at(&file, path) => return Ok(LockAttempt::Free(Self { _file: file })),
                Ok(()) | Err(TryLockError::WouldBlock) => return Ok(LockAttempt::Held),
                Err(TryLockError::Error(error)) if error.kind() == ErrorKind::Interrupted => {}
                Err(TryLockError::Error(error)) if knows_none(&error) => {
                    return Ok(LockAttempt::Unknown);
                }
                Err(TryLockError::Error(error)) => return Err(system("lock it", path)(error)),
            }
        }
    }

    /// The lock at a path; none where it cannot be had, for whatever reason.
    pub(crate) fn if_free(path: &Path) -> Option<Self> {
        match Self::at(path) {
            Ok(LockAttempt::Free(lock)) => Some(lock),
            _ => None,
        }
    }
}

/// What became of a try to lock.
#[derive(Debug)]
pub(crate) enum LockAttempt {
    /// It was free, and is ours.
    Free(Lock),
    /// Somebody else has it.
    Held,
    /// The file system knows no locks.
    Unknown,
}

/// Whether the file system knows no locks. NFS without its lock daemon says that none are left.
fn knows_none(error: &io::Error) -> bool {
    // ENOLCK, for which the standard library has no kind.
    let none_left = if cfg!(target_os = "macos") { 77 } else { 37 };
    error.kind() == ErrorKind::Unsupported || error.raw_os_error() == Some(none_left)
}

/// Where a folder's lock is.
pub(crate) fn of_folder(folder: &Path) -> PathBuf {
    folder.join(".lock")
}

/// The lock's file, made where there is none. One that another user has made is locked without writing.
fn open(path: &Path) -> Result<File, LibraryError> {
    if fs::symlink_metadata(path).is_ok() {
        // Before it is opened: opening a pipe waits.
        regular(path)?;
    }
    let file = File::options()
        .create(true)
        .truncate(false)
        .write(true)
        .open(path);
    match file {
        Err(error)
            if matches!(
                error.kind(),
                ErrorKind::PermissionDenied | ErrorKind::ReadOnlyFilesystem
            ) =>
        {
            File::open(path).map_err(|_| system("open the lock", path)(error))
        }
        file => file.map_err(system("open the lock", path)),
    }
}

#[cfg(unix)]
fn is_at(file: &File, path: &Path) -> bool {
    use std::os::unix::fs::MetadataExt;
    let id = |found: fs::Metadata| (found.dev(), found.ino());
    let (opened, found) = (file.metadata().map(id), fs::symlink_metadata(path).map(id));
    matches!((opened, found), (Ok(opened), Ok(found)) if opened == found)
}

/// Here an open file cannot be removed.
#[cfg(not(unix))]
fn is_at(_: &File, _: &Path) -> bool {
    true
}
