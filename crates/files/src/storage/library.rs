//! The library: the shapes of a folder and those that come with the program. Listing, loading, saving, deleting and
//! restoring.

use std::collections::HashSet;
use std::fs::{self, File};
use std::io::{self, ErrorKind, Read};
use std::path::{Path, PathBuf};
use std::sync::Arc;
use std::sync::atomic::{AtomicBool, Ordering};
use std::time::UNIX_EPOCH;

use taxel_core::quote::did_you_mean;
use xxhash_rust::xxh3::xxh3_64;

use crate::formats::name::{Name, folded};
use crate::formats::shape::{MAX_BYTES, StoredShape};
use crate::storage::error::{FileError, LibraryError};
use crate::storage::file::{self, Existing, make_folder, open, paths_in, sync_folder, wrong};
use crate::storage::shipped;

const TRASH: &str = ".trash";

const LOCK: &str = ".lock";

/// The number of deleted shapes that are kept; older ones are removed for good.
pub const TRASH_KEPT: usize = 50;

/// The environment variable that names the folder of the library.
pub const LIBRARY_VARIABLE: &str = "TAXEL_LIBRARY";

/// The folder of the library if none is named: `taxel/library` in the user's data folder; None if the system does not
/// say where that is.
pub fn usual_folder() -> Option<PathBuf> {
    let own = directories::ProjectDirs::from("", "", "taxel")?;
    Some(own.data_dir().join("library"))
}

/// Replaces `~/` at the start of a path by the user's home folder; None if that is not known.
pub fn below_home(path: &str) -> Option<PathBuf> {
    match path.strip_prefix("~/") {
        Some(rest) => directories::BaseDirs::new().map(|own| own.home_dir().join(rest)),
        None => Some(PathBuf::from(path)),
    }
}

/// Where a shape comes from.
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
    /// Where it comes from.
    pub origin: ShapeOrigin,
}

/// A shape and the stamp of its file, by which a later change is noticed.
#[derive(Clone, Debug, PartialEq)]
pub struct LoadedShape {
    /// The shape, under the name of its file.
    pub shape: StoredShape,
    /// A hash of the file's content.
    pub stamp: u64,
    /// Where it comes from.
    pub origin: ShapeOrigin,
}

/// The content that a writer expects to replace.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash)]
pub enum Expected {
    /// Nothing: the name is free.
    Nothing,
    /// A file with this stamp.
    Stamp(u64),
    /// Whatever is there.
    Anything,
}

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
/// library.restore(None)?;
/// # Ok::<(), Box<dyn std::error::Error>>(())
/// ```
#[derive(Clone, Debug)]
pub struct Library {
    folder: PathBuf,
    waits: Arc<AtomicBool>,
}

impl Library {
    /// Opens the library in a folder, which may not exist yet.
    pub fn open(folder: PathBuf) -> Self {
        Self {
            folder,
            waits: Arc::default(),
        }
    }

    /// Whether a change, on another thread, waits because another program holds the lock.
    pub fn waits_for_lock(&self) -> bool {
        self.waits.load(Ordering::Relaxed)
    }

    /// The folder of the library.
    pub fn folder(&self) -> &Path {
        &self.folder
    }

    /// Lists all shapes by name, the user's first, without opening any file. Skips files that are not called
    /// `NAME.json`, and shapes that come with the program if the user has one of the same name.
    ///
    /// # Errors
    /// If the folder exists but cannot be read.
    pub fn list(&self) -> Result<Vec<LibraryEntry>, LibraryError> {
        let mut own = self.own_names()?;
        own.sort_by_cached_key(|name| (folded(name), name.clone()));
        let known: HashSet<String> = own.iter().map(|name| folded(name)).collect();
        let shipped = shipped::names().filter(|name| !known.contains(&folded(name)));
        let of = |origin| move |name| LibraryEntry { name, origin };
        let own = own.into_iter().map(of(ShapeOrigin::Own));
        let shipped = shipped.map(str::to_owned).map(of(ShapeOrigin::Shipped));
        Ok(own.chain(shipped).collect())
    }

    fn own_names(&self) -> Result<Vec<String>, FileError> {
        let files = paths_in(&self.folder)?.into_iter();
        Ok(files.filter_map(|path| name_of(&path)).collect())
    }

    /// The name of the user's shape, spelled as in its file; None if the user has none of that name.
    ///
    /// # Errors
    /// If the folder cannot be read.
    pub fn own_name(&self, name: &Name) -> Result<Option<String>, FileError> {
        // The usual case needs no search.
        if self.path(name.as_str()).symlink_metadata().is_ok() {
            return Ok(Some(name.to_string()));
        }
        Ok(self.own_names()?.into_iter().find(|own| name.same(own)))
    }

    fn path(&self, name: &str) -> PathBuf {
        self.folder.join(format!("{name}.json"))
    }

    /// Loads the shape of that name, regardless of case. The user's shape comes before one that comes with the
    /// program.
    ///
    /// # Errors
    /// If there is no such shape, or if its file is broken or cannot be read.
    pub fn load(&self, name: &str) -> Result<LoadedShape, LibraryError> {
        let name = Name::new(name)?;
        let (file, content, origin) = match (self.own_name(&name)?, shipped::text(&name)) {
            (Some(own), _) => {
                let content = read(&self.path(&own))?;
                (own, content, ShapeOrigin::Own)
            }
            (None, Some((shipped, text))) => (shipped.into(), text.into(), ShapeOrigin::Shipped),
            (None, None) => return Err(LibraryError::Unknown(name.to_string())),
        };
        let refuse = |error| LibraryError::Refused(wrong(&self.path(&file), error).message);
        let shape = StoredShape::read(&content).map_err(refuse)?;
        Ok(LoadedShape {
            // A file that was renamed by hand goes by its new name.
            shape: shape.renamed(Name::new(&file)?),
            stamp: xxh3_64(&content),
            origin,
        })
    }

    /// Saves a shape under its name, and returns the stamp of its file.
    ///
    /// # Errors
    /// [`LibraryError::Exists`] if the name is taken, [`LibraryError::Changed`] if the file's stamp is not the
    /// expected one, [`LibraryError::Shipped`] for the name of a shipped shape, or the system's error.
    pub fn save(&self, shape: &StoredShape, expected: Expected) -> Result<u64, LibraryError> {
        make_folder(&self.folder)?;
        let _lock = self.lock()?;
        let own = self.own_name(&shape.name)?;
        match &own {
            Some(own) => self.check_replaceable(own, expected)?,
            None if shipped::text(&shape.name).is_some() => {
                let name = shape.name.to_string();
                return Err(LibraryError::Shipped(name));
            }
            None => {}
        }
        // A file that differs in case only has the same name: it is replaced.
        let name = own.map_or_else(|| Ok(shape.name.clone()), |own| Name::new(&own))?;
        let path = self.path(name.as_str());
        let content = shape.clone().renamed(name).write();
        file::write(&path, content.as_bytes(), Existing::Replaced)?;
        Ok(xxh3_64(content.as_bytes()))
    }

    /// Refuses to replace a file that is read-only or whose content is not as expected.
    fn check_replaceable(&self, own: &str, expected: Expected) -> Result<(), LibraryError> {
        let path = self.path(own);
        let stamp = xxh3_64(&read(&path)?);
        if (path.metadata()).is_ok_and(|found| found.permissions().readonly()) {
            let protected = io::Error::from(ErrorKind::PermissionDenied);
            return Err(FileError::cannot("replace it, it is read-only", &path)(protected).into());
        }
        let name = own.to_owned();
        match expected {
            Expected::Stamp(known) if known != stamp => Err(LibraryError::Changed { name, stamp }),
            Expected::Nothing => Err(LibraryError::Exists { name, stamp }),
            Expected::Stamp(_) | Expected::Anything => Ok(()),
        }
    }

    /// Waits for the lock of the folder, which the system releases when its program dies or the file is closed.
    fn lock(&self) -> Result<File, FileError> {
        let path = self.folder.join(LOCK);
        let refuse = FileError::cannot("lock", &path);
        let mut options = File::options();
        let opened = options.append(true).create(true).open(&path);
        // A file of another user that may only be read can be locked, too.
        let file = opened.or_else(|error| File::open(&path).map_err(|_| error));
        let file = file.map_err(&refuse)?;
        self.waits.store(true, Ordering::Relaxed);
        let locked = file.lock();
        self.waits.store(false, Ordering::Relaxed);
        locked.map_err(refuse)?;
        Ok(file)
    }

    /// The name of a shape that can be deleted, spelled as in its file.
    ///
    /// # Errors
    /// If no such shape is stored, if it comes with the program, or if the folder cannot be read.
    pub fn deletable(&self, name: &str) -> Result<String, LibraryError> {
        let name = Name::new(name)?;
        match (self.own_name(&name)?, shipped::text(&name)) {
            (Some(own), _) => Ok(own),
            (None, Some(_)) => Err(LibraryError::Refused(format!(
                "{:?} comes with taxel and cannot be deleted",
                name.as_str()
            ))),
            (None, None) => Err(LibraryError::Unknown(name.to_string())),
        }
    }

    /// Moves a shape into the trash without reading its file, and returns its name, spelled as in its file.
    ///
    /// # Errors
    /// If no such shape is stored, if it comes with the program, or if the system refuses.
    pub fn delete(&self, name: &str) -> Result<String, LibraryError> {
        // Checked before the lock is taken: the lock is a file in the folder, which may not exist.
        self.deletable(name)?;
        let _lock = self.lock()?;
        let own = self.deletable(name)?;
        let path = self.path(&own);
        self.put_into_trash(&own, |to| {
            fs::rename(&path, to).map_err(FileError::cannot("move it into the trash", &path))
        })?;
        sync_folder(&self.folder)?;
        Ok(own)
    }

    /// Puts a shape that was never saved into the trash, under its name with a free number, and returns that name.
    ///
    /// # Errors
    /// The system's error; then the shape is stored nowhere.
    pub fn throw_away(&self, shape: &StoredShape) -> Result<String, LibraryError> {
        make_folder(&self.folder)?;
        let _lock = self.lock()?;
        let taken: HashSet<String> = (self.own_names()?.into_iter())
            .chain(self.trash()?.into_iter().map(|(_, name)| name))
            .map(|name| folded(&name))
            .collect();
        let numbered = (1_u32..).map(|number| format!("{} {number}", shape.name));
        let mut free = numbered.filter(|name| !taken.contains(&folded(name)));
        let name = Name::new(&free.next().unwrap_or_default())?;
        let content = shape.clone().renamed(name.clone()).write();
        self.put_into_trash(name.as_str(), |to| {
            file::write(to, content.as_bytes(), Existing::Kept)
        })?;
        Ok(name.to_string())
    }

    /// Gives a shape the next place in the trash, and removes the oldest ones there if it is too full.
    fn put_into_trash(
        &self,
        name: &str,
        put: impl FnOnce(&Path) -> Result<(), FileError>,
    ) -> Result<(), FileError> {
        let folder = self.folder.join(TRASH);
        make_folder(&folder)?;
        let deleted = self.trash()?;
        let now = UNIX_EPOCH.elapsed().map_or(0, |now| now.as_millis());
        // Later than all others, even if the clock was set back.
        let last = deleted.first().map_or(0, |(time, _)| *time);
        put(&self.in_trash(now.max(last.saturating_add(1)), name))?;
        sync_folder(&folder)?;
        for (time, name) in deleted.iter().skip(TRASH_KEPT - 1) {
            // One too many does no harm; the next deletion tries again.
            let _ = fs::remove_file(self.in_trash(*time, name));
        }
        Ok(())
    }

    /// The times when the shapes in the trash were deleted, in milliseconds since 1970, and their names, the last deleted
    /// first.
    fn trash(&self) -> Result<Vec<(u128, String)>, FileError> {
        let deleted = |path: PathBuf| {
            let (name, time) = path.file_stem()?.to_str()?.rsplit_once('-')?;
            Some((time.parse().ok()?, Name::new(name).ok()?.to_string()))
        };
        let files = paths_in(&self.folder.join(TRASH))?.into_iter();
        let mut shapes: Vec<(u128, String)> = files.filter_map(deleted).collect();
        shapes.sort_by(|one, other| other.cmp(one));
        Ok(shapes)
    }

    fn in_trash(&self, time: u128, name: &str) -> PathBuf {
        self.folder.join(TRASH).join(format!("{name}-{time}.json"))
    }

    /// The names of the shapes in the trash, the last deleted first, each once.
    ///
    /// # Errors
    /// If the folder exists but cannot be read.
    pub fn deleted(&self) -> Result<Vec<String>, LibraryError> {
        let mut met = HashSet::new();
        let names = self.trash()?.into_iter().map(|(_, name)| name);
        Ok(names.filter(|name| met.insert(folded(name))).collect())
    }

    /// Restores the last deleted shape, or the last of that name, whether this program deleted it or another one, and
    /// returns its name.
    ///
    /// # Errors
    /// If there is no such shape in the trash, the name is taken again, or the system refuses.
    pub fn restore(&self, name: Option<&str>) -> Result<String, LibraryError> {
        let wanted = name.map(Name::new).transpose()?;
        // Without the folder, there is nowhere to lock it.
        let _lock = self.folder.is_dir().then(|| self.lock()).transpose()?;
        let is_wanted = |name: &str| wanted.as_ref().is_none_or(|wanted| wanted.same(name));
        let mut deleted = self.trash()?.into_iter();
        let Some((time, name)) = deleted.find(|(_, name)| is_wanted(name)) else {
            return Err(match wanted {
                Some(wanted) => LibraryError::NotInTrash(wanted.to_string()),
                None => LibraryError::Refused("the trash is empty".to_owned()),
            });
        };
        if let Some(name) = self.own_name(&Name::new(&name)?)? {
            self.check_replaceable(&name, Expected::Nothing)?;
        }
        let from = self.in_trash(time, &name);
        let back = fs::rename(&from, self.path(&name));
        back.map_err(FileError::cannot("bring it back", &from))?;
        sync_folder(&self.folder)?;
        sync_folder(file::folder_of(&from))?;
        Ok(name)
    }

    /// The end of a message about the unknown name of a shape, or of a shape in the trash: a suggestion of a similar
    /// name. Empty if there is none, and for other errors.
    pub fn suggestion(&self, error: &LibraryError) -> String {
        let (name, known) = match error {
            LibraryError::Unknown(name) => {
                let listed = self.list().unwrap_or_default().into_iter();
                (name, listed.map(|entry| entry.name).collect())
            }
            LibraryError::NotInTrash(name) => (name, self.deleted().unwrap_or_default()),
            _ => return String::new(),
        };
        did_you_mean(name, known.iter().map(String::as_str))
    }
}

/// Reads the content of a shape's file, at most one byte more than a shape may have.
fn read(path: &Path) -> Result<Vec<u8>, FileError> {
    let mut content = Vec::new();
    let file = open(path)?.take(MAX_BYTES as u64 + 1);
    let read = { file }.read_to_end(&mut content);
    read.map_err(FileError::cannot("read", path))?;
    Ok(content)
}

/// The name of the shape in a file; None if the file is not called `NAME.json`.
fn name_of(path: &Path) -> Option<String> {
    let name = path.file_name()?.to_str()?.strip_suffix(".json")?;
    Some(Name::new(name).ok()?.to_string())
}
