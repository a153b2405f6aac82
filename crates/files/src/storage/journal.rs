//! Unsaved work: kept in a file while the program runs, and offered again if it died.
//!
//! Each running program holds the lock of a file of its own in the folder's `.journal`. A journal whose lock is free
//! was left by a program that died; the program that takes its lock offers it, so several programs do not take each
//! other's.

use std::fs;
use std::io::{self, ErrorKind};
use std::path::{Path, PathBuf};
use std::time::Duration;

use crate::formats::shape::StoredShape;
use crate::storage::access::is_removable;
use crate::storage::atomic_file;
use crate::storage::error::{FileError, LibraryError};
use crate::storage::folder::{self, InnerFolder, JOURNAL, is_journal};
use crate::storage::library::Library;
use crate::storage::lock::{Lock, LockAttempt};

/// The largest number of journals that are offered at once. Each keeps a file open, and a program may have about a
/// thousand; the others wait for the next start.
const MOST_ORPHANS: usize = 100;

/// The name of unsaved work that has none.
pub const UNNAMED: &str = "unsaved";

/// The journal of a running program. Nothing is written before there is something to keep, and what is kept stays
/// until it is cleared: a program that ends without clearing it has lost nothing.
#[derive(Debug)]
pub struct Journal {
    /// The folder of the library.
    library: PathBuf,
    /// The journal's file, with the lock if the file system has locks.
    open: Option<(PathBuf, Option<Lock>)>,
}

impl Journal {
    /// Creates a journal in a library.
    pub fn new(library: &Library) -> Self {
        Self {
            library: library.folder().to_owned(),
            open: None,
        }
    }

    /// Keeps a shape in place of the one kept before; durable on return.
    ///
    /// # Errors
    /// Returns the system's error. The shape kept before is still there.
    pub fn keep(&mut self, shape: &StoredShape) -> Result<(), LibraryError> {
        let path = self.file()?;
        let content = shape.write();
        Ok(atomic_file::write(
            &path,
            Some(&temporary_of(&path)),
            content.as_bytes(),
        )?)
    }

    /// Returns true if the shape that was kept last is still there: someone may have removed it, or the whole folder.
    pub fn is_intact(&self) -> bool {
        self.is_locked() && self.open.as_ref().is_some_and(|(path, _)| path.exists())
    }

    /// Returns true if other programs find the lock of the file, or its folder if there are no locks.
    fn is_locked(&self) -> bool {
        let is_there = |(path, lock): &(PathBuf, Option<Lock>)| match lock {
            Some(lock) => lock.is_at(&lock_of(path)),
            None => path.parent().is_some_and(Path::is_dir),
        };
        self.open.as_ref().is_some_and(is_there)
    }

    /// Returns the journal's file. Its name is chosen at the first use. If someone has removed its lock, it gets
    /// another lock, or else another name: other programs would take the file for that of a dead one.
    fn file(&mut self) -> Result<PathBuf, LibraryError> {
        if let Some((path, _)) = self.open.as_ref().filter(|_| self.is_locked()) {
            return Ok(path.clone());
        }
        // The file itself may still be there.
        if let Some((path, _)) = self.open.take()
            && path.exists()
            && let Some(lock) = Lock::if_free(&lock_of(&path))
        {
            self.open = Some((path.clone(), Some(lock)));
            return Ok(path);
        }
        let folder = InnerFolder::of(&self.library, JOURNAL)?;
        folder.make()?;
        let process = std::process::id();
        for number in 0..1000 {
            let path = folder.path().join(format!("{process}-{number}.json"));
            // Left by a dead program with the same process number.
            if path.exists() {
                continue;
            }
            let lock = match Lock::attempt(&lock_of(&path))? {
                LockAttempt::Free(lock) => Some(lock),
                LockAttempt::Held => continue,
                // What is kept can be found in the folder. It is not offered, because nobody can tell whether its
                // program still runs.
                LockAttempt::Unsupported => None,
            };
            self.open = Some((path.clone(), lock));
            return Ok(path);
        }
        let none = io::Error::other("no journal could be locked");
        Err(FileError::new("create a journal", folder.path(), none).into())
    }

    /// Forgets the shape that was kept, because it is saved or given up.
    pub fn clear(&mut self) {
        if let Some((path, lock)) = self.open.take() {
            remove(&path, lock);
        }
    }
}

/// Work that a program left behind when it died. While this value lives, no other program offers the work.
#[derive(Debug)]
pub struct Orphan {
    /// The shape that was on the program's matrix.
    pub shape: StoredShape,
    path: PathBuf,
    lock: Lock,
}

impl Orphan {
    /// Returns the newest journals that wait in a library, at most 100, the oldest of them first. Removes work that
    /// is identical to the saved shape of its name. Leaves a journal alone if it cannot be read: it may be of a later
    /// version; and if this user may not remove it: it is another user's. Leaves files of other names alone, too, and
    /// a folder outside of the library that a link leads to.
    pub fn all(library: &Library) -> Vec<Self> {
        let mut paths = files_of(library);
        paths.sort_by_cached_key(|path| {
            let changed = fs::symlink_metadata(path).and_then(|file| file.modified());
            // Of files with the same time, `1-10.json` comes after `1-9.json`.
            (changed.ok(), path.as_os_str().len(), path.clone())
        });
        let newest = paths.into_iter().rev();
        let mut found: Vec<Self> = newest
            .filter_map(|path| {
                let journal = path.with_extension("json");
                match path.extension()?.to_str()? {
                    "json" => Self::of(library, path),
                    // Left by a program that died while it began or cleared a journal.
                    "lock" if !journal.exists() => {
                        if let Some(lock) = Lock::if_free(&path)
                            && !journal.exists()
                        {
                            remove(&journal, Some(lock));
                        }
                        None
                    }
                    _ => None,
                }
            })
            .take(MOST_ORPHANS)
            .collect();
        found.reverse();
        found
    }

    /// Returns the work in a journal, if its program is dead and the work would be lost.
    fn of(library: &Library, path: PathBuf) -> Option<Self> {
        let lock = Lock::if_free(&lock_of(&path))?;
        let content = match folder::read(&path) {
            // Its program has cleared it just now.
            Err(LibraryError::System(refused)) if refused.error.kind() == ErrorKind::NotFound => {
                remove(&path, Some(lock));
                return None;
            }
            content => content.ok()?,
        };
        let shape = StoredShape::read(&content).ok()?;
        if !is_removable(&path) {
            return None;
        }
        if is_saved(library, &shape) {
            remove(&path, Some(lock));
            return None;
        }
        Some(Self { shape, path, lock })
    }

    /// Returns the work that cannot be offered, each with its file and the reason, sorted by file: a journal that is
    /// damaged or of a later version. It stays where it is. Leaves out what this user may not remove or read: it is
    /// another user's.
    pub fn unreadable(library: &Library) -> Vec<(PathBuf, LibraryError)> {
        let mut paths = files_of(library);
        paths.retain(|path| path.extension().is_some_and(|ending| ending == "json"));
        paths.sort();
        let journals = paths.into_iter().filter(|path| is_removable(path));
        let unread = journals.filter_map(|path| {
            let reason = match folder::read(&path) {
                Ok(content) => {
                    let error = StoredShape::read(&content).err()?;
                    let path = path.clone();
                    LibraryError::Broken { path, error }
                }
                Err(LibraryError::System(refused))
                    if matches!(
                        refused.error.kind(),
                        ErrorKind::NotFound | ErrorKind::PermissionDenied
                    ) =>
                {
                    return None;
                }
                Err(error) => error,
            };
            Some((path, reason))
        });
        unread.collect()
    }

    /// Returns how long ago the work was written; None if the system does not say, or if its clock was set back
    /// since.
    pub fn age(&self) -> Option<Duration> {
        let written = fs::symlink_metadata(&self.path).ok()?.modified().ok()?;
        written.elapsed().ok()
    }

    /// Removes the work, because it is stored elsewhere now or is not wanted. Returns false if the system refuses: then
    /// it is still there.
    pub fn discard(self) -> bool {
        remove(&self.path, Some(self.lock))
    }
}

/// Returns the files of journals in a library, in no order. A folder that cannot be read must not keep the program from
/// starting, so it counts as empty.
fn files_of(library: &Library) -> Vec<PathBuf> {
    let folder = InnerFolder::of(library.folder(), JOURNAL);
    let Ok(Ok(mut paths)) = folder.map(|folder| folder.paths()) else {
        return Vec::new();
    };
    paths.retain(|path| is_journal(path));
    paths
}

/// Returns true if a library holds exactly this work under its name, or if there is nothing to hold.
fn is_saved(library: &Library, shape: &StoredShape) -> bool {
    let same = |saved: &StoredShape| {
        (saved.sensor, saved.imprint, &saved.source) == (shape.sensor, shape.imprint, &shape.source)
    };
    shape.imprint.is_empty() && shape.source.is_none()
        || library
            .load(shape.name.as_str())
            .is_ok_and(|saved| same(&saved.shape))
}

fn lock_of(path: &Path) -> PathBuf {
    path.with_extension("lock")
}

fn temporary_of(path: &Path) -> PathBuf {
    path.with_extension("tmp")
}

/// Removes a journal, and returns whether its file is gone. The lock goes last, so that nobody finds the file without
/// it.
fn remove(path: &Path, lock: Option<Lock>) -> bool {
    // What cannot be removed is offered again: better twice than never.
    let _ = fs::remove_file(temporary_of(path));
    let _ = fs::remove_file(path);
    let is_gone = path.symlink_metadata().is_err();
    let _ = fs::remove_file(lock_of(path));
    drop(lock);
    is_gone
}
