//! Unsaved work: kept in a file while the program runs, and offered again if it died.
//!
//! A program has one file in the folder `.journal` with all of its unsaved work, an array of shapes, and holds the lock
//! of that file. A file whose lock is free was left by a program that died; the program that takes its lock offers its
//! work, so several programs do not take each other's.

use std::fs::{self, File};
use std::io::Read;
use std::path::PathBuf;
use std::sync::{Arc, Mutex};
use std::time::{Duration, SystemTime, UNIX_EPOCH};

use serde_json::value::RawValue;
use taxel_core::lock::locked;

use crate::formats::file::{has_ending, is_missing};
use crate::formats::shape::StoredShape;
use crate::storage::error::FileError;
use crate::storage::file::{Existing, FileId, NewFile, folder_of, make_folder, open, paths_in};
use crate::storage::library::Library;

pub(super) const FOLDER: &str = ".journal";

/// The size, in bytes, beyond which a journal is not read.
const MOST_BYTES: u64 = 1 << 28;

/// The name of unsaved work that has none.
pub const UNNAMED: &str = "unsaved";

/// The journal of a running program. Nothing is written before there is something to keep, and what is kept stays
/// until it is cleared: a program that ends without clearing it has lost nothing.
#[derive(Debug)]
pub struct Journal {
    path: PathBuf,
    /// The file, if there is one, opened and locked.
    file: Option<File>,
    works: Vec<StoredShape>,
}

impl Journal {
    /// Creates a journal in a library, under a name that no program has used, also none of the same process number that
    /// has died.
    pub fn new(library: &Library) -> Self {
        let now = UNIX_EPOCH.elapsed().map_or(0, |now| now.as_nanos());
        let name = format!("{now}-{}.json", std::process::id());
        Self {
            path: library.folder().join(FOLDER).join(name),
            file: None,
            works: Vec::new(),
        }
    }

    /// Keeps work in place of all that was kept before; durable on return. Without work, there is no file.
    ///
    /// # Errors
    /// The system's error. What was kept before is still there.
    pub fn keep(&mut self, works: Vec<StoredShape>) -> Result<(), FileError> {
        let path = &self.path;
        if works.is_empty() {
            if self.file.is_some()
                && let Err(error) = fs::remove_file(path)
                && !is_missing(&error)
            {
                return Err(FileError::cannot("remove", path)(error));
            }
            self.file = None;
            return Ok(());
        }
        let existing = match self.file {
            Some(_) => Existing::Replaced,
            None => Existing::Kept,
        };
        make_folder(folder_of(path))?;
        let texts: Vec<String> = works.iter().map(StoredShape::write).collect();
        let content = format!("[{}]\n", texts.join(","));
        let file = NewFile::with_content(path, content.as_bytes(), existing)?;
        // Locked before it has its name, so that no other program finds it free.
        let locked = file.output.get_ref().try_lock();
        locked.map_err(|error| FileError::cannot("lock", path)(error.into()))?;
        self.file = Some(file.persist()?);
        self.works = works;
        Ok(())
    }

    /// Whether what was kept last is still there: someone may have removed it, or the whole folder.
    pub fn is_intact(&self) -> bool {
        let file = self.file.as_ref();
        file.is_none_or(|file| FileId::of(file).is_ok_and(|id| id.is_at(&self.path)))
    }
}

/// A piece of work that a program left behind when it died. While this value or another piece of the same program
/// lives, no other program offers the work.
#[derive(Debug)]
pub struct Orphan {
    /// The shape.
    pub shape: StoredShape,
    written: Option<SystemTime>,
    journal: Arc<Mutex<Journal>>,
}

impl Orphan {
    /// The work that waits in a library, that of the newest program last. Work that is identical to the saved shape of
    /// its name is left out. Leaves a journal alone if it cannot be read: it may be of a later version.
    pub fn all(library: &Library) -> Vec<Self> {
        // A folder that cannot be read must not keep the program from starting.
        let paths = paths_in(&library.folder().join(FOLDER)).unwrap_or_default();
        let journals = paths.into_iter().filter(|path| has_ending(path, "json"));
        let works = journals.map(|path| Self::of(library, path));
        works.flatten().flatten().collect()
    }

    /// The work in a journal, if its program is dead and the work would be lost. Removes a journal without such work.
    fn of(library: &Library, path: PathBuf) -> Option<Vec<Self>> {
        let file = open(&path).ok()?;
        file.try_lock().ok()?;
        // Its program may have replaced it before the lock was free.
        if !FileId::of(&file).ok()?.is_at(&path) {
            return None;
        }
        let mut content = Vec::new();
        (&file).take(MOST_BYTES).read_to_end(&mut content).ok()?;
        let texts: Vec<&RawValue> = serde_json::from_slice(&content).ok()?;
        let works = texts
            .iter()
            .map(|text| StoredShape::read(text.get().as_bytes()));
        let mut works: Vec<StoredShape> = works.collect::<Result<_, _>>().ok()?;
        works.retain(|work| !is_saved(library, work));
        let written = file.metadata().and_then(|found| found.modified()).ok();
        let journal = Arc::new(Mutex::new(Journal {
            path,
            file: Some(file),
            works: works.clone(),
        }));
        if works.is_empty() {
            // What cannot be removed is looked at again at the next start.
            let _ = locked(&journal).keep(Vec::new());
        }
        let orphan = |shape| Self {
            shape,
            written,
            journal: Arc::clone(&journal),
        };
        Some(works.into_iter().map(orphan).collect())
    }

    /// How long ago the work was written; None if the system does not say, or if its clock was set back since.
    pub fn age(&self) -> Option<Duration> {
        self.written?.elapsed().ok()
    }

    /// Removes the work, because it is stored elsewhere now or is not wanted. Returns false if the system refuses: then
    /// it is still there.
    pub fn discard(self) -> bool {
        let mut journal = locked(&self.journal);
        let others = journal.works.iter().filter(|work| **work != self.shape);
        let others = others.cloned().collect();
        journal.keep(others).is_ok()
    }
}

/// Whether a library holds exactly this work under its name, or there is nothing to hold.
fn is_saved(library: &Library, shape: &StoredShape) -> bool {
    let is_nothing = shape.imprint.is_empty() && shape.source.is_none();
    let same = |saved: &StoredShape| {
        (saved.sensor, saved.imprint, &saved.source) == (shape.sensor, shape.imprint, &shape.source)
    };
    is_nothing || (library.load(shape.name.as_str())).is_ok_and(|saved| same(&saved.shape))
}
