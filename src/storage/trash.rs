//! Deleting moves a shape into a trash inside the library, from where it comes back.
//!
//! The files there have a running number before their name; the last [`TRASH_KEPT`] are kept.

use std::fs;
use std::path::{Path, PathBuf};

use crate::formats::name::folded;
use crate::formats::{Name, StoredShape};
use crate::storage::LibraryError;
use crate::storage::file::system;
use crate::storage::library::{Library, TEMPORARY};
use crate::storage::lock::Lock;
use crate::storage::{file, shipped};

/// How many deleted shapes are kept.
pub const TRASH_KEPT: usize = 50;

/// A file in the trash.
struct Deleted {
    number: u64,
    name: String,
    path: PathBuf,
}

impl Library {
    fn trash(&self) -> PathBuf {
        self.folder().join(".trash")
    }

    /// What is in the trash, the oldest first; nothing where there is no trash yet.
    fn deleted(&self) -> Result<Vec<Deleted>, LibraryError> {
        let trash = self.trash();
        let names = file::names(&trash)?;
        let of = |name| Deleted::of(&trash.join(name));
        let mut deleted: Vec<Deleted> = names.into_iter().filter_map(of).collect();
        deleted.sort_by_key(|deleted| deleted.number);
        Ok(deleted)
    }

    /// Moves a shape into the trash, whatever its file holds; answers its name as the file had it.
    ///
    /// # Errors
    /// Where there is none of that name, it comes with the program, or the system refuses.
    pub fn delete(&self, name: &str) -> Result<String, LibraryError> {
        let name = Name::new(name)?;
        let unknown = || {
            let shipped = shipped::has(&name);
            let name = name.to_string();
            if shipped {
                LibraryError::Shipped { name }
            } else {
                LibraryError::Unknown { name }
            }
        };
        if !self.folder().is_dir() {
            return Err(unknown());
        }
        let _lock = Lock::of(self.folder())?;
        let own = self.own_name(&name)?.ok_or_else(unknown)?;
        let path = self.path(&own);
        file::regular(&path)?;
        file::make_inner_folder(&self.trash())?;
        let deleted = self.deleted()?;
        let target = self.next(&deleted, &own);
        fs::rename(&path, &target).map_err(system("move it into the trash", &path))?;
        file::sync(&self.trash())?;
        file::sync(self.folder())?;
        forget_oldest(deleted);
        Ok(own)
    }

    /// Puts a shape into the trash that was never stored, under its name with a number, so that it is in the way of
    /// nothing when it is brought back; answers that name.
    ///
    /// # Errors
    /// What the system refuses; then it is nowhere.
    pub fn throw_away(&self, shape: &StoredShape) -> Result<String, LibraryError> {
        file::make_folder(self.folder())?;
        let _lock = Lock::of(self.folder())?;
        file::make_inner_folder(&self.trash())?;
        let deleted = self.deleted()?;
        let free = |name: &Name| {
            let thrown = deleted.iter().any(|deleted| name.same(&deleted.name));
            !thrown && matches!(self.own_name(name), Ok(None))
        };
        let mut numbered = (1..1000).filter_map(|number| {
            let name = format!("{} {number}", shape.name);
            Name::new(&name).ok()
        });
        // In the trash a name may stand twice.
        let name = numbered.find(free);
        let name = name.unwrap_or_else(|| shape.name.clone());
        let thrown = shape.clone().renamed(name.clone());
        let target = self.next(&deleted, name.as_str());
        let temporary = self.trash().join(TEMPORARY);
        file::write(&target, &temporary, thrown.write().as_bytes())?;
        forget_oldest(deleted);
        Ok(name.to_string())
    }

    /// Where the next one in the trash is.
    fn next(&self, deleted: &[Deleted], name: &str) -> PathBuf {
        let number = deleted.last().map_or(1, |last| last.number + 1);
        self.trash().join(format!("{number:010} {name}.json"))
    }

    /// The names of the shapes in the trash, those that were deleted last first, each once.
    ///
    /// # Errors
    /// Where the folder is there but cannot be read.
    pub fn in_trash(&self) -> Result<Vec<String>, LibraryError> {
        let mut names: Vec<String> = Vec::new();
        for deleted in self.deleted()?.into_iter().rev() {
            if !names
                .iter()
                .any(|name| folded(name) == folded(&deleted.name))
            {
                names.push(deleted.name);
            }
        }
        Ok(names)
    }

    /// Brings back the shape of that name that was deleted last; answers its name.
    ///
    /// # Errors
    /// Where none of that name is in the trash, the name is taken again, or the system refuses.
    pub fn restore(&self, name: &str) -> Result<String, LibraryError> {
        let name = Name::new(name)?;
        let missing = || LibraryError::NotInTrash {
            name: name.to_string(),
        };
        if !self.folder().is_dir() {
            return Err(missing());
        }
        let _lock = Lock::of(self.folder())?;
        let deleted = self
            .deleted()?
            .into_iter()
            .rev()
            .find(|deleted| name.same(&deleted.name))
            .ok_or_else(missing)?;
        file::regular(&deleted.path)?;
        if let Some(taken) = self.own_name(&name)? {
            let stamp = file::read(&self.path(&taken))
                .map(|content| file::stamp(&content))
                .unwrap_or_default();
            return Err(LibraryError::Exists { name: taken, stamp });
        }
        fs::rename(&deleted.path, self.path(&deleted.name))
            .map_err(system("bring it back", &deleted.path))?;
        file::sync(self.folder())?;
        file::sync(&self.trash())?;
        Ok(deleted.name)
    }
}

/// Makes room for one more.
fn forget_oldest(mut deleted: Vec<Deleted>) {
    for old in deleted.drain(..deleted.len().saturating_sub(TRASH_KEPT - 1)) {
        // One too many does no harm.
        let _ = fs::remove_file(old.path);
    }
}

impl Deleted {
    fn of(path: &Path) -> Option<Self> {
        let (number, name) = path
            .file_name()?
            .to_str()?
            .strip_suffix(".json")?
            .split_once(' ')?;
        Some(Self {
            number: number.parse().ok().filter(|&number| number < u64::MAX)?,
            name: Name::new(name).ok()?.to_string(),
            path: path.to_owned(),
        })
    }
}
