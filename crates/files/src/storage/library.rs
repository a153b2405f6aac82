//! The library: the shapes of a folder and those that come with the program. Listing, loading, saving, deleting and
//! restoring.

use std::collections::HashSet;
use std::ffi::OsString;
use std::fs;
use std::io::{self, ErrorKind};
use std::path::{Path, PathBuf};
use std::sync::Arc;
use std::sync::atomic::{AtomicBool, Ordering};

use crate::formats::file::is_missing;
use crate::formats::name::{Name, folded};
use crate::formats::shape::StoredShape;
use crate::quote::did_you_mean;
use crate::storage::atomic_file::{self, sync_folder};
use crate::storage::error::{FileError, LibraryError};
use crate::storage::folder::{self, InnerFolder, JOURNAL, TRASH, is_journal, stamp};
use crate::storage::lock::{self, LOCK, Lock};
use crate::storage::name_index::NameIndex;
use crate::storage::shipped;
use crate::storage::temporary::is_temporary;
use crate::storage::trash::Trash;

/// The origin of a shape.
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord, Hash)]
pub enum ShapeOrigin {
    /// The user's folder.
    Own,
    /// The program.
    Shipped,
}

/// A row of the list: what is known without opening the file.
#[derive(Clone, Debug, PartialEq, Eq, Hash)]
pub struct LibraryEntry {
    /// The name of the shape: the name of its file without `.json`.
    pub name: String,
    /// The origin of the shape.
    pub origin: ShapeOrigin,
}

/// A shape and the stamp of its file, by which a later change is noticed.
#[derive(Clone, Debug, PartialEq)]
pub struct LoadedShape {
    /// The shape, under the name of its file.
    pub shape: StoredShape,
    /// The name inside the file; it differs from the file's own name if the file was renamed or copied by hand.
    pub written_name: Name,
    /// A hash of the file's content.
    pub stamp: u64,
    /// The origin of the shape.
    pub origin: ShapeOrigin,
}

/// The content that a writer expects to replace.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash)]
pub enum Expected {
    /// Nothing: the name is free.
    Nothing,
    /// A file with this stamp.
    Stamp(u64),
}

/// The name of a file that is being written. Its writer holds the lock, so one name is enough.
const TEMPORARY: &str = ".taxel-tmp";

/// The name of the file with the commands that were typed.
pub(super) const COMMANDS: &str = ".commands";

/// The name of the file with the set of shapes that was recognised last.
pub(super) const RECOGNISED_SET: &str = ".recognise";

/// A library in a folder. The folder is made when the first shape is saved.
///
/// ```
/// use taxel_files::formats::StoredShape;
/// use taxel_core::prelude::*;
/// use taxel_files::storage::{Expected, Library, LibraryError, ShapeOrigin};
///
/// # let folder = tempfile::tempdir()?;
/// # let folder = folder.path().join("shapes");
/// let library = Library::open(folder);
/// let sensor = Sensor::default();
/// let hexagon = Source::from(Figure::hexagon(2.5).on(&sensor)?);
/// let imprint = Plane::new(sensor).touch(&hexagon);
/// let shape = StoredShape::new("my hexagon".parse()?, sensor, imprint, Some(hexagon))?;
///
/// // There must be no such shape yet; the stamp says which content a later save may replace.
/// let stamp = library.save(&shape, Expected::Nothing)?;
/// assert!(matches!(library.save(&shape, Expected::Nothing), Err(LibraryError::Exists { .. })));
/// library.save(&shape, Expected::Stamp(stamp))?;
///
/// assert_eq!(library.load("my hexagon")?.shape, shape);
/// let own = library.list()?.into_iter().filter(|entry| entry.origin == ShapeOrigin::Own);
/// assert_eq!(own.count(), 1, "beside those that come with the program");
/// library.delete("my hexagon")?;
/// library.restore_last()?;
/// # Ok::<(), Box<dyn std::error::Error>>(())
/// ```
#[derive(Clone, Debug)]
pub struct Library {
    folder: PathBuf,
    names: Arc<NameIndex>,
    /// Whether a thread waits for the lock.
    waits: Arc<AtomicBool>,
}

impl Library {
    /// Opens the library in a folder, and removes half-written files that a program left in it or in its trash when it
    /// died.
    pub fn open(folder: PathBuf) -> Self {
        let half_written = half_written_in(&folder);
        if !half_written.is_empty()
            && let Some(_lock) = Lock::if_free(&lock::path_in(&folder))
        {
            for path in half_written {
                // If this fails it does no harm, and the next start tries again.
                let _ = fs::remove_file(path);
            }
        }
        Self {
            folder,
            names: Arc::default(),
            waits: Arc::default(),
        }
    }

    /// Returns true if a change, on another thread, waits because another program holds the lock. A change waits for
    /// at most five seconds.
    pub fn waits_for_lock(&self) -> bool {
        self.waits.load(Ordering::Relaxed)
    }

    /// Returns the file, if any, in the place of a folder above the library's folder. Then only shapes that come with
    /// the program can be loaded, and none can be saved.
    pub fn file_above(&self) -> Option<&Path> {
        folder::file_above(&self.folder)
    }

    /// Returns the folder of the library.
    pub fn folder(&self) -> &Path {
        &self.folder
    }

    /// Lists all shapes by name, the user's first, without opening any file. Skips files that are not called
    /// `NAME.json`, and shapes that come with the program if the user has one of the same name.
    ///
    /// # Errors
    /// Returns an error if the folder exists but cannot be read.
    pub fn list(&self) -> Result<Vec<LibraryEntry>, LibraryError> {
        let own = |name| LibraryEntry {
            name,
            origin: ShapeOrigin::Own,
        };
        let mut entries: Vec<LibraryEntry> = self.own_names()?.into_iter().map(own).collect();
        entries.sort_by_cached_key(|entry| (folded(&entry.name), entry.name.clone()));
        let key = |entry: &LibraryEntry| folded(&entry.name);
        let shipped: Vec<LibraryEntry> = shipped::names()
            .filter(|name| entries.binary_search_by_key(&folded(name), key).is_err())
            .map(|name| LibraryEntry {
                name: name.to_owned(),
                origin: ShapeOrigin::Shipped,
            })
            .collect();
        entries.extend(shipped);
        Ok(entries)
    }

    fn own_names(&self) -> Result<Vec<String>, LibraryError> {
        let own = |file: OsString| file.to_str().and_then(name_of).map(str::to_owned);
        let files = folder::names(&self.folder)?.into_iter();
        Ok(files.filter_map(own).collect())
    }

    /// Returns the name of the user's shape, spelled as in its file; None if the user has none of that name.
    fn own_name(&self, name: &Name) -> Result<Option<String>, LibraryError> {
        // The usual case needs no search.
        let path = self.path(name.as_str());
        match fs::symlink_metadata(&path) {
            Ok(_) => return Ok(Some(name.as_str().to_owned())),
            Err(error) if is_missing(&error) => {}
            Err(error) => return Err(FileError::new("access it", &path, error).into()),
        }
        self.names.find(&self.folder, name, || self.own_names())
    }

    /// Returns the path of the user's shape of that name. A name cannot lead out of the folder.
    fn path(&self, name: &str) -> PathBuf {
        self.folder.join(format!("{name}.json"))
    }

    /// Loads the shape of that name, regardless of case. The user's shape comes before one that comes with the
    /// program.
    ///
    /// # Errors
    /// Returns an error if there is no such shape, or if its file is broken or cannot be read.
    pub fn load(&self, name: &str) -> Result<LoadedShape, LibraryError> {
        let name = Name::new(name)?;
        let Some((own, content)) = self.read_own(&name)? else {
            let unknown = || LibraryError::Unknown {
                name: name.to_string(),
            };
            let (shape, stamp) = shipped::load(&name).ok_or_else(unknown)??;
            return Ok(LoadedShape {
                written_name: shape.name.clone(),
                shape,
                stamp,
                origin: ShapeOrigin::Shipped,
            });
        };
        let path = self.path(&own);
        let shape =
            StoredShape::read(&content).map_err(|error| LibraryError::Broken { path, error })?;
        // A file that was renamed by hand goes by its new name.
        Ok(LoadedShape {
            written_name: shape.name.clone(),
            shape: shape.renamed(Name::new(&own)?),
            stamp: stamp(&content),
            origin: ShapeOrigin::Own,
        })
    }

    /// Returns the name of the user's shape, spelled as in its file, and the content of the file; None if the user has
    /// none of that name.
    fn read_own(&self, name: &Name) -> Result<Option<(String, Vec<u8>)>, LibraryError> {
        // The usual case needs no search, and no look at the file before it is read.
        match folder::read(&self.path(name.as_str())) {
            Err(LibraryError::System(refused)) if refused.is_missing() => {}
            read => return Ok(Some((name.to_string(), read?))),
        }
        let Some(own) = self.names.find(&self.folder, name, || self.own_names())? else {
            return Ok(None);
        };
        let content = folder::read(&self.path(&own))?;
        Ok(Some((own, content)))
    }

    /// Returns the name under which a shape of that name is or would be stored: the name of its file, which may
    /// differ in case.
    ///
    /// # Errors
    /// Returns an error if the folder cannot be read.
    pub fn stored_name(&self, name: &Name) -> Result<String, LibraryError> {
        Ok(self.own_name(name)?.unwrap_or_else(|| name.to_string()))
    }

    /// Saves a shape under its name, and returns the stamp of its file.
    ///
    /// # Errors
    /// Returns [`LibraryError::Exists`] if the name is taken, [`LibraryError::Changed`] if the file's stamp is not
    /// the expected one, [`LibraryError::Shipped`] for the name of a shipped shape, or the system's error.
    pub fn save(&self, shape: &StoredShape, expected: Expected) -> Result<u64, LibraryError> {
        let name = &shape.name;
        folder::make(&self.folder)?;
        let lock = Lock::wait(&self.folder, &self.waits)?;
        let own = self.own_name(name)?;
        match &own {
            Some(own) => self.check_replaceable(own, expected)?,
            None if shipped::has(name) => {
                return Err(LibraryError::Shipped {
                    name: name.to_string(),
                });
            }
            None => {}
        }
        // A file that differs in case only has the same name: it is replaced.
        let name = own.map_or_else(|| Ok(name.clone()), |own| Name::new(&own))?;
        let path = self.path(name.as_str());
        let content = shape.clone().renamed(name).write();
        let temporary = temporary_in(&self.folder, lock.as_ref());
        atomic_file::write(&path, temporary.as_deref(), content.as_bytes())?;
        Ok(stamp(content.as_bytes()))
    }

    /// Refuses to replace a file that is read-only or whose content is not as expected.
    fn check_replaceable(&self, own: &str, expected: Expected) -> Result<(), LibraryError> {
        let path = self.path(own);
        let now = stamp(&folder::read(&path)?);
        if folder::regular(&path)?.permissions().readonly() {
            let protected = io::Error::from(ErrorKind::PermissionDenied);
            return Err(FileError::new("replace it, it is read-only", &path, protected).into());
        }
        let name = own.to_owned();
        match expected {
            Expected::Stamp(known) if known == now => Ok(()),
            Expected::Stamp(_) => Err(LibraryError::Changed { name, stamp: now }),
            Expected::Nothing => Err(LibraryError::Exists { name, stamp: now }),
        }
    }

    /// Returns the name of a shape that can be deleted, spelled as in its file.
    ///
    /// # Errors
    /// Returns an error if no such shape is stored, if it comes with the program, or if the folder cannot be read.
    pub fn deletable(&self, name: &str) -> Result<String, LibraryError> {
        let name = Name::new(name)?;
        if self.folder.is_dir()
            && let Some(own) = self.own_name(&name)?
        {
            return Ok(own);
        }
        let shipped = shipped::has(&name);
        let name = name.to_string();
        Err(if shipped {
            LibraryError::NotDeletable { name }
        } else {
            LibraryError::Unknown { name }
        })
    }

    /// Moves a shape into the trash without reading its file, and returns its name, spelled as in its file.
    ///
    /// # Errors
    /// Returns an error if no such shape is stored, if it comes with the program, or if the system refuses.
    pub fn delete(&self, name: &str) -> Result<String, LibraryError> {
        // Checked before the lock is taken: the lock is a file in the folder, which may not exist.
        self.deletable(name)?;
        let _lock = Lock::wait(&self.folder, &self.waits)?;
        let own = self.deletable(name)?;
        let path = self.path(&own);
        folder::regular(&path)?;
        let mut trash = Trash::made(&self.folder)?;
        fs::rename(&path, trash.next_path(&own)?)
            .map_err(|error| FileError::new("move it into the trash", &path, error))?;
        sync_folder(trash.folder())?;
        sync_folder(&self.folder)?;
        trash.forget_oldest();
        Ok(own)
    }

    /// Puts a shape that was never saved into the trash, under its name with a free number, and returns that name.
    ///
    /// # Errors
    /// Returns the system's error; then the shape is stored nowhere.
    pub fn throw_away(&self, shape: &StoredShape) -> Result<String, LibraryError> {
        folder::make(&self.folder)?;
        let lock = Lock::wait(&self.folder, &self.waits)?;
        let mut trash = Trash::made(&self.folder)?;
        let free = |name: &Name| {
            let thrown = trash.newest_first().any(|thrown| name.same(&thrown.name));
            !thrown && matches!(self.own_name(name), Ok(None))
        };
        let mut numbered = (1..1000).filter_map(|number| {
            let name = format!("{} {number}", shape.name);
            Name::new(&name).ok()
        });
        // If all numbers are taken, the name is used without one: in the trash a name may occur twice.
        let name = numbered.find(free);
        let name = name.unwrap_or_else(|| shape.name.clone());
        let thrown = shape.clone().renamed(name.clone());
        let path = trash.next_path(name.as_str())?;
        let temporary = temporary_in(trash.folder(), lock.as_ref());
        atomic_file::write(&path, temporary.as_deref(), thrown.write().as_bytes())?;
        trash.forget_oldest();
        Ok(name.to_string())
    }

    /// Returns the end of a message about the unknown name of a shape, or of a shape in the trash: a suggestion of a
    /// similar name. Empty if there is none, and for other errors.
    pub fn suggestion(&self, error: &LibraryError) -> String {
        match error {
            LibraryError::Unknown { name } => self.list().map_or_else(
                |_| String::new(),
                |shapes| did_you_mean(name, shapes.iter().map(|shape| shape.name.as_str())),
            ),
            LibraryError::NotInTrash { name } => self.in_trash().map_or_else(
                |_| String::new(),
                |names| did_you_mean(name, names.iter().map(String::as_str)),
            ),
            _ => String::new(),
        }
    }

    /// Returns the names of the shapes in the trash, the last deleted first, each once.
    ///
    /// # Errors
    /// Returns an error if the folder exists but cannot be read.
    pub fn in_trash(&self) -> Result<Vec<String>, LibraryError> {
        let mut met = HashSet::new();
        let trash = Trash::read(&self.folder)?;
        let names = trash.newest_first().map(|deleted| &deleted.name);
        Ok(names
            .filter(|name| met.insert(folded(name)))
            .cloned()
            .collect())
    }

    /// Restores the last deleted shape of that name, and returns its name.
    ///
    /// # Errors
    /// Returns an error if no shape of that name is in the trash, the name is taken again, or the system refuses.
    pub fn restore(&self, name: &str) -> Result<String, LibraryError> {
        let name = Name::new(name)?;
        let missing = || LibraryError::NotInTrash {
            name: name.to_string(),
        };
        self.restore_newest(|deleted| name.same(deleted), missing)
    }

    /// Restores the last deleted shape, whether this program deleted it or another one, and returns its name.
    ///
    /// # Errors
    /// Returns an error if the trash is empty, the name is taken again, or the system refuses.
    pub fn restore_last(&self) -> Result<String, LibraryError> {
        self.restore_newest(|_| true, || LibraryError::TrashEmpty)
    }

    /// Restores the newest shape in the trash whose name is wanted.
    fn restore_newest(
        &self,
        is_wanted: impl Fn(&str) -> bool,
        missing: impl Fn() -> LibraryError,
    ) -> Result<String, LibraryError> {
        if !self.folder.is_dir() {
            return Err(missing());
        }
        let _lock = Lock::wait(&self.folder, &self.waits)?;
        let trash = Trash::read(&self.folder)?;
        let mut newest = trash.newest_first();
        let deleted = newest.find(|deleted| is_wanted(&deleted.name));
        let deleted = deleted.ok_or_else(missing)?;
        folder::regular(&deleted.path)?;
        if let Some(name) = self.own_name(&Name::new(&deleted.name)?)? {
            let stamp = stamp(&folder::read(&self.path(&name))?);
            return Err(LibraryError::Exists { name, stamp });
        }
        fs::rename(&deleted.path, self.path(&deleted.name))
            .map_err(|error| FileError::new("bring it back", &deleted.path, error))?;
        sync_folder(&self.folder)?;
        sync_folder(trash.folder())?;
        Ok(deleted.name.clone())
    }

    /// Lists everything in the folder and its journal that is neither a shape nor one of the library's own files, and
    /// half-written files in its trash, by path, each with a description: files of others, half-written ones, unsaved
    /// work. None of them is harmful.
    ///
    /// # Errors
    /// Returns an error if the folder exists but cannot be read.
    pub fn leftovers(&self) -> Result<Vec<(PathBuf, &'static str)>, LibraryError> {
        let mut found = Vec::new();
        for name in folder::names(&self.folder)? {
            let what = match name.to_str() {
                Some(LOCK | COMMANDS | RECOGNISED_SET | TEMPORARY) => continue,
                Some(inner @ (TRASH | JOURNAL)) => match InnerFolder::of(&self.folder, inner) {
                    Ok(_) => continue,
                    Err(_) => "a symbolic link, which is not followed",
                },
                Some(name) if is_temporary(name) => HALF_WRITTEN,
                Some(name) if name_of(name).is_some() => continue,
                Some(name) if name.strip_suffix(".json").is_some() => {
                    "not a shape: shapes cannot have this name"
                }
                _ => "not a shape: its name is not NAME.json",
            };
            found.push((self.folder.join(name), what));
        }
        let half_written = half_written_in(&self.folder).into_iter();
        found.extend(half_written.map(|path| (path, HALF_WRITTEN)));
        let journal = InnerFolder::of(&self.folder, JOURNAL);
        for path in journal.map_or(Ok(Vec::new()), |journal| journal.paths())? {
            let ending = path.extension().and_then(|ending| ending.to_str());
            let what = match ending.filter(|_| is_journal(&path)) {
                Some("json") => "unsaved work, of a running program or of one that died",
                Some("lock" | "tmp") => continue,
                _ => "not a journal",
            };
            found.push((path, what));
        }
        found.sort();
        Ok(found)
    }
}

/// The description of a half-written file.
const HALF_WRITTEN: &str = "half-written by a program that died, or being written";

/// Returns the files that the holder of the library's lock is writing, or was writing when it died: in the folder, in
/// its trash, or both.
fn half_written_in(folder: &Path) -> Vec<PathBuf> {
    let trash = InnerFolder::of(folder, TRASH).ok();
    let folders = [Some(folder), trash.as_ref().map(InnerFolder::path)];
    let paths = folders.into_iter().flatten().map(|own| own.join(TEMPORARY));
    paths
        .filter(|path| fs::symlink_metadata(path).is_ok())
        .collect()
}

/// Returns the temporary path that the holder of the library's lock uses in a folder; None on a file system without
/// locks, where another program may be writing too.
fn temporary_in(folder: &Path, lock: Option<&Lock>) -> Option<PathBuf> {
    lock.map(|_| folder.join(TEMPORARY))
}

/// Returns the name of the shape in a file with this name; None if it is not `NAME.json`.
fn name_of(file: &str) -> Option<&str> {
    let name = file.strip_suffix(".json")?;
    Name::new(name).is_ok().then_some(name)
}
