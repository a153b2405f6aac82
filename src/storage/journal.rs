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
use crate::storage::atomic_file;
use crate::storage::error::{FileError, LibraryError};
use crate::storage::folder;
use crate::storage::library::Library;
use crate::storage::lock::{Lock, LockAttempt};

/// How many journals are offered at once. Each keeps a file open, and a program may have about a thousand; the others
/// wait for the next start.
const MOST_ORPHANS: usize = 100;

/// The name of unsaved work that has none.
pub const UNNAMED: &str = "unsaved";

/// The journal of a running program. Nothing is written before there is something to keep, and what is kept stays
/// until it is cleared: a program that ends without doing so, for whatever reason, has lost nothing.
#[derive(Debug)]
pub struct Journal {
    folder: PathBuf,
    /// Its file with the lock, where there are locks.
    open: Option<(PathBuf, Option<Lock>)>,
}

impl Journal {
    /// A journal in a library.
    pub fn new(library: &Library) -> Self {
        Self {
            folder: folder_in(library),
            open: None,
        }
    }

    /// Keeps a shape in place of the one kept before; durable on return.
    ///
    /// # Errors
    /// What the system refuses. The shape kept before is still there.
    pub fn keep(&mut self, shape: &StoredShape) -> Result<(), LibraryError> {
        match self.write(shape) {
            // The folder was removed meanwhile: it is made again.
            Err(LibraryError::System(refused)) if refused.error.kind() == ErrorKind::NotFound => {
                self.open = None;
                self.write(shape)
            }
            written => written,
        }
    }

    fn write(&mut self, shape: &StoredShape) -> Result<(), LibraryError> {
        let path = self.file()?;
        let content = shape.write();
        Ok(atomic_file::write(
            &path,
            Some(&temporary_of(&path)),
            content.as_bytes(),
        )?)
    }

    /// The journal's file; its name is chosen at the first use.
    fn file(&mut self) -> Result<PathBuf, LibraryError> {
        if let Some((path, _)) = &self.open {
            return Ok(path.clone());
        }
        folder::make_inner(&self.folder)?;
        let process = std::process::id();
        for number in 0..1000 {
            let path = self.folder.join(format!("{process}-{number}.json"));
            // Left by a dead program that had the same number.
            if path.exists() {
                continue;
            }
            let lock = match Lock::attempt(&lock_of(&path))? {
                LockAttempt::Free(lock) => Some(lock),
                LockAttempt::Held => continue,
                // What is kept can be found in the folder; whether its program still runs cannot be known, so it is
                // not offered.
                LockAttempt::Unsupported => None,
            };
            self.open = Some((path.clone(), lock));
            return Ok(path);
        }
        let none = io::Error::other("no journal could be locked");
        Err(FileError::new("create a journal", &self.folder, none).into())
    }

    /// Forgets what was kept: it is saved, or given up.
    pub fn clear(&mut self) {
        if let Some((path, lock)) = self.open.take() {
            remove(&path, lock);
        }
    }
}

/// Work that a program left behind when it died. While this lives, no other program offers it.
#[derive(Debug)]
pub struct Orphan {
    /// What was on its matrix.
    pub shape: StoredShape,
    path: PathBuf,
    lock: Lock,
}

impl Orphan {
    /// The newest that wait in a library, at most 100, the oldest of them first. Work identical to the saved shape of its
    /// name is removed. A journal that cannot be read is left alone: it may be one of a later version.
    pub fn all(library: &Library) -> Vec<Self> {
        let journals = folder_in(library);
        // A folder that cannot be read must not keep the program from starting.
        let Ok(names) = folder::names(&journals) else {
            return Vec::new();
        };
        let mut paths: Vec<PathBuf> = names.into_iter().map(|name| journals.join(name)).collect();
        paths.sort_by_cached_key(|path| {
            let changed = fs::symlink_metadata(path).and_then(|file| file.modified());
            // Of those of the same moment, `1-10.json` comes after `1-9.json`.
            (changed.ok(), path.as_os_str().len(), path.clone())
        });
        let newest = paths.into_iter().rev();
        let mut found: Vec<Self> = newest
            .filter_map(|path| {
                let journal = path.with_extension("json");
                match path.extension()?.to_str()? {
                    "json" => Self::of(library, path),
                    // Left of a journal that was begun, or being cleared, when its program died.
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

    /// The work in a journal, if its program is dead and it would be lost.
    fn of(library: &Library, path: PathBuf) -> Option<Self> {
        let lock = Lock::if_free(&lock_of(&path))?;
        // Half-written; the one before is whole.
        let _ = fs::remove_file(temporary_of(&path));
        let content = match folder::read(&path) {
            // Its program has cleared it just now.
            Err(LibraryError::System(refused)) if refused.error.kind() == ErrorKind::NotFound => {
                remove(&path, Some(lock));
                return None;
            }
            content => content.ok()?,
        };
        let shape = StoredShape::read(&content).ok()?;
        if is_saved(library, &shape) {
            remove(&path, Some(lock));
            return None;
        }
        Some(Self { shape, path, lock })
    }

    /// How long ago it was written; None where the system does not say, or its clock was set back since.
    pub fn age(&self) -> Option<Duration> {
        let written = fs::symlink_metadata(&self.path).ok()?.modified().ok()?;
        written.elapsed().ok()
    }

    /// The work is elsewhere now, or is not wanted.
    pub fn discard(self) {
        remove(&self.path, Some(self.lock));
    }
}

/// Whether a library holds just this under its name, or there is nothing to hold.
fn is_saved(library: &Library, shape: &StoredShape) -> bool {
    let same = |saved: &StoredShape| {
        (saved.sensor, saved.imprint, &saved.source) == (shape.sensor, shape.imprint, &shape.source)
    };
    shape.imprint.is_empty() && shape.source.is_none()
        || library
            .load(shape.name.as_str())
            .is_ok_and(|saved| same(&saved.shape))
}

fn folder_in(library: &Library) -> PathBuf {
    library.folder().join(".journal")
}

fn lock_of(path: &Path) -> PathBuf {
    path.with_extension("lock")
}

fn temporary_of(path: &Path) -> PathBuf {
    path.with_extension("tmp")
}

/// The lock goes last, so that nobody finds the file without it.
fn remove(path: &Path, lock: Option<Lock>) {
    // What cannot be removed is offered again: better twice than never.
    let _ = fs::remove_file(temporary_of(path));
    let _ = fs::remove_file(path);
    let _ = fs::remove_file(lock_of(path));
    drop(lock);
}
