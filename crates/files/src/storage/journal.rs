//! Unsaved work: kept in a file while the program runs, and offered again if it died.
//!
//! Each journal is a file in the folder's `.journal`, beside it a file whose lock its program holds. A journal whose
//! lock is free was left by a program that died; the program that takes its lock offers it, so several programs do not
//! take each other's.

use std::fs::{self, File};
use std::io::{self, ErrorKind};
use std::path::{Path, PathBuf};
use std::time::Duration;

use crate::formats::shape::StoredShape;
use crate::storage::error::{FileError, LibraryError};
use crate::storage::file::{self, Existing};
use crate::storage::folder;
use crate::storage::library::Library;

pub(super) const FOLDER: &str = ".journal";

/// The largest number of journals that are offered at once. Each keeps a file open, and a program may have about a
/// thousand; the others wait for the next start.
const MOST_ORPHANS: usize = 100;

/// The name of unsaved work that has none.
pub const UNNAMED: &str = "unsaved";

/// The journal of a running program. Nothing is written before there is something to keep, and what is kept stays
/// until it is cleared: a program that ends without clearing it has lost nothing.
#[derive(Debug)]
pub struct Journal {
    folder: PathBuf,
    open: Option<(PathBuf, File)>,
}

impl Journal {
    /// Creates a journal in a library.
    pub fn new(library: &Library) -> Self {
        Self {
            folder: library.folder().join(FOLDER),
            open: None,
        }
    }

    /// Keeps a shape in place of the one kept before; durable on return.
    ///
    /// # Errors
    /// The system's error. The shape kept before is still there.
    pub fn keep(&mut self, shape: &StoredShape) -> Result<(), LibraryError> {
        // Someone may have removed the whole folder.
        let open = self.open.take().filter(|(path, _)| lock_of(path).exists());
        let (path, _) = self.open.insert(match open {
            Some(open) => open,
            None => self.begin()?,
        });
        let content = shape.write();
        Ok(file::write(path, content.as_bytes(), Existing::Replaced)?)
    }

    /// Whether the shape that was kept last is still there: someone may have removed it, or the whole folder.
    pub fn is_intact(&self) -> bool {
        let open = self.open.as_ref();
        open.is_some_and(|(path, _)| path.exists() && lock_of(path).exists())
    }

    /// Takes a name that no other journal has or had, with its lock.
    fn begin(&self) -> Result<(PathBuf, File), LibraryError> {
        folder::make(&self.folder)?;
        let refuse = |path: &Path, error| FileError::new("create a journal", path, error);
        let process = std::process::id();
        for number in 0_u32.. {
            let path = self.folder.join(format!("{process}-{number}.json"));
            // Left by a dead program with the same process number.
            if path.exists() {
                continue;
            }
            match File::create_new(lock_of(&path)) {
                Err(error) if error.kind() == ErrorKind::AlreadyExists => {}
                made => {
                    let lock = made.map_err(|error| refuse(&path, error))?;
                    lock.try_lock()
                        .map_err(|error| refuse(&path, error.into()))?;
                    return Ok((path, lock));
                }
            }
        }
        Err(refuse(&self.folder, io::Error::other("no name is free")).into())
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
    lock: File,
}

impl Orphan {
    /// The newest journals that wait in a library, at most 100, the oldest of them first. Removes work that is
    /// identical to the saved shape of its name. Leaves a journal alone if it cannot be read: it may be of a later
    /// version.
    pub fn all(library: &Library) -> Vec<Self> {
        let folder = library.folder().join(FOLDER);
        // A folder that cannot be read must not keep the program from starting.
        let names = folder::names(&folder).unwrap_or_default().into_iter();
        let mut paths: Vec<PathBuf> = names.map(|name| folder.join(name)).collect();
        paths.retain(|path| path.extension().is_some_and(|ending| ending == "json"));
        paths.sort_by_cached_key(|path| {
            let changed = fs::symlink_metadata(path).and_then(|file| file.modified());
            (changed.ok(), path.clone())
        });
        let newest = paths.into_iter().rev();
        let orphans = newest.filter_map(|path| Self::of(library, path));
        let mut found: Vec<Self> = orphans.take(MOST_ORPHANS).collect();
        found.reverse();
        found
    }

    /// The work in a journal, if its program is dead and the work would be lost.
    fn of(library: &Library, path: PathBuf) -> Option<Self> {
        let lock = folder::open_lock(&lock_of(&path)).ok()?;
        lock.try_lock().ok()?;
        let shape = StoredShape::read(&folder::read(&path).ok()?).ok()?;
        if is_saved(library, &shape) {
            remove(&path, lock);
            return None;
        }
        Some(Self { shape, path, lock })
    }

    /// How long ago the work was written; None if the system does not say, or if its clock was set back since.
    pub fn age(&self) -> Option<Duration> {
        let written = fs::symlink_metadata(&self.path).ok()?.modified().ok()?;
        written.elapsed().ok()
    }

    /// Removes the work, because it is stored elsewhere now or is not wanted. Returns false if the system refuses: then
    /// it is still there.
    pub fn discard(self) -> bool {
        remove(&self.path, self.lock)
    }
}

/// Whether a library holds exactly this work under its name, or there is nothing to hold.
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

/// Removes a journal, and returns whether its file is gone. The lock goes last, so that nobody finds the file without
/// it.
fn remove(path: &Path, lock: File) -> bool {
    // What cannot be removed is offered again: better twice than never.
    let _ = fs::remove_file(path);
    let is_gone = path.symlink_metadata().is_err();
    if is_gone {
        let _ = fs::remove_file(lock_of(path));
    }
    drop(lock);
    is_gone
}
