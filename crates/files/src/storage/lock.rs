//! A lock: a writer of a shape holds one while it writes, and a journal holds one as long as its program runs.
//!
//! The system releases a lock when its program dies, so none is ever left behind.

use std::fs::{self, File, TryLockError};
use std::io::{self, ErrorKind};
use std::path::{Path, PathBuf};
use std::sync::atomic::{AtomicBool, Ordering};
use std::time::{Duration, Instant};

use crate::storage::access::share;
use crate::storage::error::{FileError, LibraryError};
use crate::storage::file_id::FileId;
use crate::storage::folder::regular;

/// The name of a folder's lock.
pub(crate) const LOCK: &str = ".lock";

/// The time that a writer waits for another program. Writing takes milliseconds, unless that program is stopped.
const PATIENCE: Duration = Duration::from_secs(5);

/// The pause between two attempts.
const PAUSE: Duration = Duration::from_millis(5);

/// A lock that is held until this is dropped.
#[derive(Debug)]
pub(crate) struct Lock {
    file: File,
}

impl Drop for Lock {
    /// Unlocks the file, because closing it would release the lock only when every copy is closed, and a child
    /// process that is just being started has a copy until its program runs.
    fn drop(&mut self) {
        // If this fails, closing the file is what remains.
        let _ = self.file.unlock();
    }
}

/// The outcome of one attempt to lock.
#[derive(Debug)]
pub(crate) enum LockAttempt {
    /// The lock was free and is held now.
    Free(Lock),
    /// Another program holds it.
    Held,
    /// The file system has no locks.
    Unsupported,
}

impl Lock {
    /// Waits for the lock of a folder, and sets `waits` while another program holds it; None on a file system without
    /// locks.
    ///
    /// # Errors
    /// Returns an error if another program holds it for [`PATIENCE`], or the system refuses.
    pub(crate) fn wait(folder: &Path, waits: &AtomicBool) -> Result<Option<Self>, LibraryError> {
        let path = path_in(folder);
        let file = open(&path)?;
        let start = Instant::now();
        let locked = loop {
            match try_lock(&file, &path) {
                Ok(Some(false)) if start.elapsed() < PATIENCE => {
                    waits.store(true, Ordering::Relaxed);
                    std::thread::sleep(PAUSE);
                }
                Ok(Some(false)) => {
                    let busy = io::Error::other("another program has held it for five seconds");
                    break Err(FileError::new("lock it", &path, busy));
                }
                locked => break locked,
            }
        };
        waits.store(false, Ordering::Relaxed);
        Ok(locked?.map(|_| Self { file }))
    }

    /// Tries once to take the lock at a path.
    ///
    /// # Errors
    /// Returns the system's error.
    pub(crate) fn attempt(path: &Path) -> Result<LockAttempt, LibraryError> {
        let lock = Self { file: open(path)? };
        Ok(match try_lock(&lock.file, path)? {
            // The program that held it may have removed the file: then this lock protects nothing.
            Some(true) if lock.is_at(path) => LockAttempt::Free(lock),
            Some(_) => LockAttempt::Held,
            None => LockAttempt::Unsupported,
        })
    }

    /// Returns true if the locked file still has this path: otherwise nobody else finds the lock.
    pub(crate) fn is_at(&self, path: &Path) -> bool {
        FileId::of(&self.file).is_ok_and(|id| id.is_at(path))
    }

    /// Takes the lock at a path; None if this fails for any reason.
    pub(crate) fn if_free(path: &Path) -> Option<Self> {
        match Self::attempt(path) {
            Ok(LockAttempt::Free(lock)) => Some(lock),
            _ => None,
        }
    }
}

/// Tries to lock a file. Returns true if the lock was free and is held now; None on a file system without locks.
fn try_lock(file: &File, path: &Path) -> Result<Option<bool>, FileError> {
    loop {
        match file.try_lock() {
            Ok(()) => return Ok(Some(true)),
            Err(TryLockError::WouldBlock) => return Ok(Some(false)),
            Err(TryLockError::Error(error)) if error.kind() == ErrorKind::Interrupted => {}
            Err(TryLockError::Error(error)) if is_unsupported(&error) => return Ok(None),
            Err(TryLockError::Error(error)) => return Err(FileError::new("lock it", path, error)),
        }
    }
}

/// Returns true if an error means that the file system has no locks. NFS without its lock daemon reports that no
/// locks are left (`ENOLCK`); some file systems that are mounted by a program of the user's report that locking is
/// not permitted (`EPERM`) or invalid (`EINVAL`). If the user may not open the file, that is another error, reported
/// before.
fn is_unsupported(error: &io::Error) -> bool {
    // The standard library has no kind for `ENOLCK`.
    #[cfg(unix)]
    let none_left = error.raw_os_error() == Some(rustix::io::Errno::NOLCK.raw_os_error());
    #[cfg(not(unix))]
    let none_left = false;
    none_left
        || matches!(
            error.kind(),
            ErrorKind::Unsupported | ErrorKind::PermissionDenied | ErrorKind::InvalidInput
        )
}

/// Returns the path of a folder's lock.
pub(crate) fn path_in(folder: &Path) -> PathBuf {
    folder.join(LOCK)
}

/// Opens the lock's file, and makes it if it does not exist, for all who may write in its folder. A file that another
/// user has made is opened for reading.
fn open(path: &Path) -> Result<File, LibraryError> {
    let mut options = File::options();
    options.write(true);
    if fs::symlink_metadata(path).is_ok() {
        // Checked before opening: opening a pipe waits.
        regular(path)?;
    } else if let Ok(made) = options.clone().create_new(true).open(path) {
        if let Some(folder) = path.parent() {
            share(&made, folder);
        }
        return Ok(made);
    }
    let file = match options.create(true).truncate(false).open(path) {
        Err(error)
            if matches!(
                error.kind(),
                ErrorKind::PermissionDenied | ErrorKind::ReadOnlyFilesystem
            ) =>
        {
            File::open(path).map_err(|_| error)
        }
        file => file,
    };
    Ok(file.map_err(|error| FileError::new("open the lock", path, error))?)
}

#[cfg(test)]
mod tests {
    use super::*;

    /// A child process that is just being started has such a copy.
    #[test]
    fn a_copy_of_the_file_does_not_keep_the_lock() {
        let folder = tempfile::tempdir().expect("a folder");
        let path = path_in(folder.path());
        let lock = Lock::if_free(&path).expect("a lock");
        assert!(Lock::if_free(&path).is_none());
        let copy = lock.file.try_clone().expect("a copy");
        drop(lock);
        assert!(Lock::if_free(&path).is_some());
        drop(copy);
    }
}
