//! The shapes of a folder, and those that come with the program: list, load, save.

use std::ffi::OsString;
use std::fs;
use std::io::{self, ErrorKind};
use std::path::{Path, PathBuf};

use crate::formats::name::folded;
use crate::formats::{Name, StoredShape};
use crate::storage::LibraryError;
use crate::storage::file::{stamp, system};
use crate::storage::lock::Lock;
use crate::storage::{file, lock, shipped};

/// Where a shape comes from.
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord)]
#[non_exhaustive]
pub enum ShapeOrigin {
    /// The user's folder.
    Own,
    /// The program.
    Shipped,
}

/// A line of the list: what is known without opening the file.
#[derive(Clone, Debug, PartialEq, Eq)]
#[non_exhaustive]
pub struct LibraryEntry {
    /// The shape's name: its file's, without `.json`.
    pub name: String,
    /// Where it comes from.
    pub origin: ShapeOrigin,
}

/// A shape with what its file held, to tell later whether somebody else has written it.
#[derive(Clone, Debug, PartialEq)]
#[non_exhaustive]
pub struct LoadedShape {
    /// The shape, under the name of its file.
    pub shape: StoredShape,
    /// What the file held.
    pub stamp: u64,
    /// Where it comes from.
    pub origin: ShapeOrigin,
}

/// What the writer believes to be in the place it writes to.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
#[non_exhaustive]
pub enum Expected {
    /// Nothing.
    Nothing,
    /// This content, which is to be replaced.
    Stamp(u64),
}

/// The name of a file that is being written: its writer holds the lock, so one name is enough.
pub(crate) const TEMPORARY: &str = ".taxel-tmp";

/// A library: a folder, which is made when something is written first.
#[derive(Clone, Debug)]
pub struct Library {
    folder: PathBuf,
}

impl Library {
    /// The library in a folder. What a program that died left half-written there is swept away.
    pub fn open(folder: PathBuf) -> Self {
        let temporary = folder.join(TEMPORARY);
        if fs::symlink_metadata(&temporary).is_ok()
            && let Some(_lock) = Lock::if_free(&lock::of_folder(&folder))
        {
            // What cannot be removed harms nothing; the next start tries again.
            let _ = fs::remove_file(temporary);
        }
        Self { folder }
    }

    /// Its folder.
    pub fn folder(&self) -> &Path {
        &self.folder
    }

    /// All shapes by name, the user's first; none is opened. Files that are no `NAME.json` are passed over, and so is a
    /// shape that comes with the program where the user has one of that name.
    ///
    /// # Errors
    /// Where the folder is there but cannot be read.
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
        let files = file::names(&self.folder)?.into_iter();
        Ok(files.filter_map(own).collect())
    }

    /// The user's shape of that name, in the case its file has.
    pub(crate) fn own_name(&self, name: &Name) -> Result<Option<String>, LibraryError> {
        // The usual case needs no search.
        let path = self.path(name.as_str());
        match fs::symlink_metadata(&path) {
            Ok(_) => return Ok(Some(name.as_str().to_owned())),
            Err(error)
                if matches!(error.kind(), ErrorKind::NotFound | ErrorKind::NotADirectory) => {}
            Err(error) => return Err(system("look at it", &path)(error)),
        }
        Ok(self.own_names()?.into_iter().find(|own| name.same(own)))
    }

    /// Where the user's shape of that name is or would be. Names cannot lead out of the folder.
    pub(crate) fn path(&self, name: &str) -> PathBuf {
        self.folder.join(format!("{name}.json"))
    }

    /// The shape of that name, upper and lower case alike; the user's before one that comes with the program.
    ///
    /// # Errors
    /// Where there is none, or its file is broken or cannot be read.
    pub fn load(&self, name: &str) -> Result<LoadedShape, LibraryError> {
        let name = Name::new(name)?;
        let Some(own) = self.own_name(&name)? else {
            let unknown = || LibraryError::Unknown {
                name: name.to_string(),
            };
            let (shape, stamp) = shipped::load(&name).ok_or_else(unknown)??;
            return Ok(LoadedShape {
                shape,
                stamp,
                origin: ShapeOrigin::Shipped,
            });
        };
        let path = self.path(&own);
        let content = file::read(&path)?;
        let shape =
            StoredShape::read(&content).map_err(|error| LibraryError::Broken { path, error })?;
        // A file that was renamed by hand goes by its new name.
        Ok(LoadedShape {
            shape: shape.renamed(Name::new(&own)?),
            stamp: stamp(&content),
            origin: ShapeOrigin::Own,
        })
    }

    /// The name under which a shape of that name is stored: that of its file, which may differ in upper and lower case.
    ///
    /// # Errors
    /// Where the folder cannot be read.
    pub fn stored_name(&self, name: &Name) -> Result<String, LibraryError> {
        Ok(self.own_name(name)?.unwrap_or_else(|| name.to_string()))
    }

    /// Stores a shape under its name; answers what its file holds now.
    ///
    /// # Errors
    /// [`LibraryError::Exists`] where the name is taken, [`LibraryError::Changed`] where the file holds something else
    /// than expected, [`LibraryError::Shipped`] for the name of a shipped shape; or what the system refuses.
    pub fn save(&self, shape: &StoredShape, expected: Expected) -> Result<u64, LibraryError> {
        let name = &shape.name;
        file::make_folder(&self.folder)?;
        let lock = Lock::of(&self.folder)?;
        let own = self.own_name(name)?;
        if let Some(own) = &own {
            let path = self.path(own);
            let now = stamp(&file::read(&path)?);
            if file::regular(&path)?.permissions().readonly() {
                let protected = io::Error::from(ErrorKind::PermissionDenied);
                return Err(system("replace it, it is read-only", &path)(protected));
            }
            match expected {
                Expected::Stamp(known) if known == now => {}
                Expected::Stamp(_) => {
                    return Err(LibraryError::Changed {
                        name: own.clone(),
                        stamp: now,
                    });
                }
                Expected::Nothing => {
                    return Err(LibraryError::Exists {
                        name: own.clone(),
                        stamp: now,
                    });
                }
            }
        } else if shipped::has(name) {
            return Err(LibraryError::Shipped {
                name: name.to_string(),
            });
        }
        // A file that differs in case only is the same name: it is replaced, not doubled.
        let name = own.map_or_else(|| Ok(name.clone()), |own| Name::new(&own))?;
        let path = self.path(name.as_str());
        let content = shape.clone().renamed(name).write();
        let temporary = match lock {
            Some(_) => TEMPORARY.to_owned(),
            // Without locks, another program may be writing too.
            None => format!("{TEMPORARY}-{}", std::process::id()),
        };
        file::write(&path, &self.folder.join(temporary), content.as_bytes())?;
        Ok(stamp(content.as_bytes()))
    }
}

/// The name of the shape in a file of this name; none where it is no `NAME.json`.
pub(crate) fn name_of(file: &str) -> Option<&str> {
    let name = file.strip_suffix(".json")?;
    Name::new(name).is_ok().then_some(name)
}
