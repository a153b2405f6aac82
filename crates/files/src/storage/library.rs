//! The library: the shapes of a folder and those that come with the program. Listing, loading, saving, deleting and
//! restoring.

use std::collections::HashSet;
use std::fs;
use std::io::{self, ErrorKind};
use std::path::{Path, PathBuf};
use std::sync::Arc;
use std::sync::atomic::{AtomicBool, Ordering};
use std::time::{SystemTime, UNIX_EPOCH};

use taxel_core::quote::did_you_mean;

use crate::formats::file::is_missing;
use crate::formats::name::{Name, folded};
use crate::formats::shape::StoredShape;
use crate::storage::error::{FileError, LibraryError};
use crate::storage::file::{self, Existing, PREFIX, sync_folder};
use crate::storage::folder::{self, stamp};
use crate::storage::{journal, shipped};

const TRASH: &str = ".trash";

/// The number of deleted shapes that are kept; older ones are removed for good.
pub const TRASH_KEPT: usize = 50;

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
    /// The name inside the file; it differs from the file's own name if the file was renamed or copied by hand.
    pub written_name: Name,
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
/// library.restore_last()?;
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

    /// Whether a change, on another thread, waits because another program holds the lock. A change waits for at most
    /// five seconds.
    pub fn waits_for_lock(&self) -> bool {
        self.waits.load(Ordering::Relaxed)
    }

    /// The file, if any, in the place of a folder above the library's folder. Then only shapes that come with the
    /// program can be loaded, and none can be saved.
    pub fn file_above(&self) -> Option<&Path> {
        folder::file_above(&self.folder)
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
        let files = folder::names(&self.folder)?.into_iter();
        let own = files.filter_map(|file| Some(name_of(file.to_str()?)?.to_owned()));
        Ok(own.collect())
    }

    /// The name of the user's shape, spelled as in its file; None if the user has none of that name.
    fn own_name(&self, name: &Name) -> Result<Option<String>, LibraryError> {
        // The usual case needs no search.
        let path = self.path(name.as_str());
        match fs::symlink_metadata(&path) {
            Ok(_) => return Ok(Some(name.as_str().to_owned())),
            Err(error) if is_missing(&error) => {}
            Err(error) => return Err(FileError::new("access it", &path, error).into()),
        }
        let own = self.own_names()?;
        Ok(own.into_iter().find(|own| name.same(own)))
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
        let Some(own) = self.own_name(&name)? else {
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
        let content = folder::read(&path)?;
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

    /// The name under which a shape of that name is or would be stored: the name of its file, which may differ in
    /// case.
    ///
    /// # Errors
    /// If the folder cannot be read.
    pub fn stored_name(&self, name: &Name) -> Result<String, LibraryError> {
        Ok(self.own_name(name)?.unwrap_or_else(|| name.to_string()))
    }

    /// Saves a shape under its name, and returns the stamp of its file.
    ///
    /// # Errors
    /// [`LibraryError::Exists`] if the name is taken, [`LibraryError::Changed`] if the file's stamp is not the
    /// expected one, [`LibraryError::Shipped`] for the name of a shipped shape, or the system's error.
    pub fn save(&self, shape: &StoredShape, expected: Expected) -> Result<u64, LibraryError> {
        let name = &shape.name;
        folder::make(&self.folder)?;
        let _lock = folder::lock(&self.folder, &self.waits)?;
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
        file::write(&path, content.as_bytes(), Existing::Replaced)?;
        Ok(stamp(content.as_bytes()))
    }

    /// Refuses to replace a file that is read-only or whose content is not as expected.
    fn check_replaceable(&self, own: &str, expected: Expected) -> Result<(), LibraryError> {
        let path = self.path(own);
        let now = stamp(&folder::read(&path)?);
        if (path.metadata()).is_ok_and(|found| found.permissions().readonly()) {
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

    /// The name of a shape that can be deleted, spelled as in its file.
    ///
    /// # Errors
    /// If no such shape is stored, if it comes with the program, or if the folder cannot be read.
    pub fn deletable(&self, name: &str) -> Result<String, LibraryError> {
        let name = Name::new(name)?;
        if let Some(own) = self.own_name(&name)? {
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
    /// If no such shape is stored, if it comes with the program, or if the system refuses.
    pub fn delete(&self, name: &str) -> Result<String, LibraryError> {
        // Checked before the lock is taken: the lock is a file in the folder, which may not exist.
        self.deletable(name)?;
        let _lock = folder::lock(&self.folder, &self.waits)?;
        let own = self.deletable(name)?;
        let path = self.path(&own);
        let trash = self.made_trash()?;
        fs::rename(&path, trash.next_path(&own))
            .map_err(|error| FileError::new("move it into the trash", &path, error))?;
        sync_folder(&trash.folder)?;
        sync_folder(&self.folder)?;
        trash.forget_oldest();
        Ok(own)
    }

    /// Puts a shape that was never saved into the trash, under its name with a free number, and returns that name.
    ///
    /// # Errors
    /// The system's error; then the shape is stored nowhere.
    pub fn throw_away(&self, shape: &StoredShape) -> Result<String, LibraryError> {
        folder::make(&self.folder)?;
        let _lock = folder::lock(&self.folder, &self.waits)?;
        let trash = self.made_trash()?;
        let free = |name: &Name| {
            let thrown = trash.shapes.iter().any(|thrown| name.same(&thrown.name));
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
        let path = trash.next_path(name.as_str());
        file::write(&path, thrown.write().as_bytes(), Existing::Kept)?;
        trash.forget_oldest();
        Ok(name.to_string())
    }

    /// The end of a message about the unknown name of a shape, or of a shape in the trash: a suggestion of a similar
    /// name. Empty if there is none, and for other errors.
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

    /// The names of the shapes in the trash, the last deleted first, each once.
    ///
    /// # Errors
    /// If the folder exists but cannot be read.
    pub fn in_trash(&self) -> Result<Vec<String>, LibraryError> {
        let mut met = HashSet::new();
        let names = self.trash()?.shapes.into_iter().map(|deleted| deleted.name);
        Ok(names.filter(|name| met.insert(folded(name))).collect())
    }

    /// Restores the last deleted shape of that name, and returns its name.
    ///
    /// # Errors
    /// If no shape of that name is in the trash, the name is taken again, or the system refuses.
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
    /// If the trash is empty, the name is taken again, or the system refuses.
    pub fn restore_last(&self) -> Result<String, LibraryError> {
        self.restore_newest(|_| true, || LibraryError::TrashEmpty)
    }

    fn restore_newest(
        &self,
        is_wanted: impl Fn(&str) -> bool,
        missing: impl Fn() -> LibraryError,
    ) -> Result<String, LibraryError> {
        if !self.folder.is_dir() {
            return Err(missing());
        }
        let _lock = folder::lock(&self.folder, &self.waits)?;
        let trash = self.trash()?;
        let mut newest = trash.shapes.into_iter();
        let deleted = newest.find(|deleted| is_wanted(&deleted.name));
        let deleted = deleted.ok_or_else(missing)?;
        if let Some(name) = self.own_name(&Name::new(&deleted.name)?)? {
            let stamp = stamp(&folder::read(&self.path(&name))?);
            return Err(LibraryError::Exists { name, stamp });
        }
        fs::rename(&deleted.path, self.path(&deleted.name))
            .map_err(|error| FileError::new("bring it back", &deleted.path, error))?;
        sync_folder(&self.folder)?;
        sync_folder(&trash.folder)?;
        Ok(deleted.name)
    }

    fn trash(&self) -> Result<Trash, LibraryError> {
        let folder = self.folder.join(TRASH);
        let files = folder::names(&folder)?.into_iter();
        let mut shapes: Vec<DeletedShape> = files
            .filter_map(|file| DeletedShape::at(folder.join(file)))
            .collect();
        shapes.sort_by_key(|shape| std::cmp::Reverse(shape.time));
        Ok(Trash { folder, shapes })
    }

    fn made_trash(&self) -> Result<Trash, LibraryError> {
        folder::make(&self.folder.join(TRASH))?;
        self.trash()
    }

    /// Lists what is in the folder, its trash and its journal and is neither a shape nor one of the library's own
    /// files, by path, each with a description. None of it is harmful.
    ///
    /// # Errors
    /// If a folder exists but cannot be read.
    pub fn leftovers(&self) -> Result<Vec<(PathBuf, &'static str)>, LibraryError> {
        let mut found = Vec::new();
        let inner = [TRASH, journal::FOLDER].map(|name| self.folder.join(name));
        for folder in inner.iter().chain([&self.folder]) {
            for name in folder::names(folder)? {
                let path = folder.join(&name);
                let name = name.to_string_lossy();
                let what = if name.starts_with(PREFIX) {
                    "half-written by a program that died, or being written"
                } else if folder.ends_with(journal::FOLDER) && name.ends_with(".json") {
                    "unsaved work, of a running program or of one that died"
                } else if inner.contains(folder)
                    || name.starts_with('.')
                    || name_of(&name).is_some()
                {
                    continue;
                } else if name.ends_with(".json") {
                    "not a shape: shapes cannot have this name"
                } else {
                    "not a shape: its name is not NAME.json"
                };
                found.push((path, what));
            }
        }
        found.sort();
        Ok(found)
    }
}

struct Trash {
    folder: PathBuf,
    shapes: Vec<DeletedShape>,
}

/// A deleted shape: `NAME-TIME.json`.
struct DeletedShape {
    name: String,
    /// The time when it was deleted, in milliseconds since 1970.
    time: u64,
    path: PathBuf,
}

impl Trash {
    /// The path of the next shape, whose time is later than all others, even if the clock was set back.
    fn next_path(&self, name: &str) -> PathBuf {
        let now = SystemTime::now().duration_since(UNIX_EPOCH);
        let now = now.map_or(0, |now| u64::try_from(now.as_millis()).unwrap_or(u64::MAX));
        let last = self.shapes.first().map_or(0, |last| last.time);
        let time = now.max(last.saturating_add(1));
        self.folder.join(format!("{name}-{time}.json"))
    }

    /// Removes the oldest shapes, so that [`TRASH_KEPT`] are left, together with the one just added.
    fn forget_oldest(self) {
        for old in self.shapes.iter().skip(TRASH_KEPT - 1) {
            // One too many does no harm; the next deletion tries again.
            let _ = fs::remove_file(&old.path);
        }
    }
}

impl DeletedShape {
    /// The deleted shape at a path; None if the file's name is not that of a deleted shape.
    fn at(path: PathBuf) -> Option<Self> {
        let name = path.file_name()?.to_str()?.strip_suffix(".json")?;
        let (name, time) = name.rsplit_once('-')?;
        Some(Self {
            time: time.parse().ok()?,
            name: Name::new(name).ok()?.to_string(),
            path,
        })
    }
}

/// The name of the shape in a file with this name; None if it is not `NAME.json`.
fn name_of(file: &str) -> Option<&str> {
    let name = file.strip_suffix(".json")?;
    Name::new(name).is_ok().then_some(name)
}

/// The size, in bytes, beyond which a file is not read: a hundred commands of the longest kind are shorter.
const MOST_BYTES: u64 = 1 << 17;

/// A small file in the library's folder in which the screen keeps its memory between runs: one entry per line, the
/// newest last. Errors are ignored: a file that cannot be read counts as empty, and lines that cannot be written are
/// dropped.
#[derive(Clone, Debug)]
pub struct RememberedFile {
    path: PathBuf,
    most: usize,
}

impl RememberedFile {
    /// The file with the commands that were typed.
    pub fn commands(library: &Library) -> Self {
        Self::of(library, ".commands", 100)
    }

    /// The file with the name of the set of shapes that was recognised last.
    pub fn recognised_set(library: &Library) -> Self {
        Self::of(library, ".recognise", 1)
    }

    fn of(library: &Library, name: &str, most: usize) -> Self {
        Self {
            path: library.folder().join(name),
            most,
        }
    }

    /// The lines, the newest last, without empty lines and lines with control characters; empty if there is
    /// no such file.
    pub fn read(&self) -> Vec<String> {
        let small = fs::symlink_metadata(&self.path)
            .is_ok_and(|found| found.is_file() && found.len() <= MOST_BYTES);
        let text = small.then(|| fs::read_to_string(&self.path));
        let Some(Ok(text)) = text else {
            return Vec::new();
        };
        let clean = |line: &&str| !line.is_empty() && !line.contains(char::is_control);
        let lines: Vec<&str> = text.lines().filter(clean).collect();
        let first = lines.len().saturating_sub(self.most);
        lines[first..].iter().map(|&line| line.to_owned()).collect()
    }

    /// Adds lines to those of the file, which another program may have changed, and keeps only the last ones if there
    /// are too many.
    pub fn add(&self, lines: Vec<String>) {
        let mut all = self.read();
        all.extend(lines);
        self.write(&all);
    }

    /// Replaces the lines of the file, and keeps only the last ones if there are too many. Makes the folder if there
    /// is none.
    pub fn write(&self, lines: &[String]) {
        if let Some(folder) = self.path.parent() {
            // Without the folder nothing can be written, which does no harm.
            let _ = folder::make(folder);
        }
        let kept = &lines[lines.len().saturating_sub(self.most)..];
        let text: String = kept.iter().map(|line| format!("{line}\n")).collect();
        // On a full disk, it is not worth a message.
        let _ = file::write(&self.path, text.as_bytes(), Existing::Replaced);
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_last_lines_come_back_and_nonsense_is_left_out() {
        let folder = tempfile::tempdir().expect("a folder");
        let library = Library::open(folder.path().join("new"));
        let file = RememberedFile::commands(&library);
        assert!(file.read().is_empty());
        let lines: Vec<String> = (0..150).map(|number| format!("turn {number}")).collect();
        file.write(&lines);
        assert_eq!(file.read(), lines[50..]);
        let path = library.folder().join(".commands");
        fs::write(path, "new\n\u{1b}[31m\n\ngrab\n").expect("written");
        assert_eq!(file.read(), ["new", "grab"]);
        // Another program has written meanwhile.
        file.add(vec!["turn 20".to_owned()]);
        assert_eq!(file.read(), ["new", "grab", "turn 20"]);
        let set = RememberedFile::recognised_set(&library);
        set.write(&["my parts".to_owned()]);
        assert_eq!(
            (set.read(), file.read().len()),
            (vec!["my parts".to_owned()], 3)
        );
        let path = library.folder().join(".recognise");
        fs::write(path, "x".repeat(1 << 18)).expect("written");
        assert!(set.read().is_empty());
    }
}
