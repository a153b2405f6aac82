//! Writes files so that none is ever half-written: under a temporary name `.taxel-XXXXXXXX` in the same folder, synced,
//! renamed into place, and the folder synced.
//!
//! Whenever the program dies or the power fails, either the complete old file or the complete new one exists. A program
//! that is killed leaves its temporary file; a program that writes into the folder a day later removes it.

use std::collections::BTreeSet;
use std::fmt::Display;
use std::fs::{self, File, Metadata};
use std::io::{self, BufWriter, ErrorKind, Write};
use std::path::{Path, PathBuf};
use std::sync::Mutex;
use std::time::Duration;

use taxel_core::lock::locked;
use tempfile::{Builder, TempPath};

use crate::error::ReadError;
use crate::formats::file::is_missing;
use crate::storage::error::FileError;

/// The beginning of the name of a temporary file.
pub(crate) const PREFIX: &str = ".taxel-";

/// The age from which a temporary file belongs to a program that has died.
const ABANDONED: Duration = Duration::from_secs(24 * 60 * 60);

/// The handling of an existing file.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash)]
pub enum Existing {
    /// The file is replaced if it is a regular file. A folder, a device or a link is never replaced.
    Replaced,
    /// The file stays, and nothing is written.
    Kept,
}

/// Writes a file, with the mode of the one that it replaces.
///
/// # Errors
/// Those of [`NewFile`]; then the old file is as it was.
pub fn write(path: &Path, content: &[u8], existing: Existing) -> Result<(), FileError> {
    NewFile::with_content(path, content, existing)?.persist()?;
    Ok(())
}

/// Checks whether a file can be begun at a path, so that an error comes before the work rather than after it. Leaves
/// nothing behind.
///
/// # Errors
/// Those of [`NewFile::begin`].
pub fn check_writable(path: &Path, existing: Existing) -> Result<(), FileError> {
    NewFile::begin(path, existing).map(drop)
}

/// A file under a temporary name, still being written. Dropped instead of persisted, it leaves nothing.
#[derive(Debug)]
#[must_use = "only `persist` gives the file its name"]
pub struct NewFile {
    /// The path that the file will have.
    pub path: PathBuf,
    existing: Existing,
    /// What is written here is the content.
    pub output: BufWriter<File>,
    temporary: TempPath,
}

impl NewFile {
    /// Begins the file at `path`. It will have the mode of the file that it replaces.
    ///
    /// # Errors
    /// [`ErrorKind::AlreadyExists`] if a file exists and must be kept, [`ErrorKind::Other`] if it is not a regular
    /// file, or the system's error.
    pub fn begin(path: &Path, existing: Existing) -> Result<Self, FileError> {
        let folder = folder_of(path);
        remove_abandoned(folder);
        let begin = || {
            // Reported before the work, not after it.
            let old = replaced(path, existing)?;
            let mut builder = Builder::new();
            builder.prefix(PREFIX).rand_bytes(8);
            // Not with the builder's own method: its error names the temporary file.
            let made = builder.make_in(folder, |path| {
                let mut options = File::options();
                options.read(true).write(true).create_new(true).open(path)
            })?;
            if let Some(old) = old {
                // On a file system without modes it stays as it is.
                let _ = made.as_file().set_permissions(old.permissions());
            }
            Ok(made.into_parts())
        };
        let (file, temporary) = begin().map_err(FileError::cannot("write", path))?;
        Ok(Self {
            path: path.to_owned(),
            existing,
            output: BufWriter::new(file),
            temporary,
        })
    }

    /// Writes and syncs a whole file that does not have its name yet.
    ///
    /// # Errors
    /// Those of [`Self::begin`] and [`Self::finish`].
    pub fn with_content(
        path: &Path,
        content: &[u8],
        existing: Existing,
    ) -> Result<Self, FileError> {
        let mut file = Self::begin(path, existing)?;
        let written = file.output.write_all(content);
        written.map_err(FileError::cannot("write", path))?;
        file.finish()?;
        Ok(file)
    }

    /// Writes out and syncs the content, so that naming the file hardly ever fails.
    ///
    /// # Errors
    /// The system's error.
    pub fn finish(&mut self) -> Result<(), FileError> {
        let written = self.output.flush();
        let synced = written.and_then(|()| self.output.get_ref().sync_all());
        synced.map_err(FileError::cannot("write", &self.path))
    }

    /// Finishes the file, gives it its name and syncs the folder. Returns the open file.
    ///
    /// # Errors
    /// [`ErrorKind::AlreadyExists`] if a file that must be kept has appeared meanwhile, or the system's error. The old
    /// file is unchanged, unless only syncing the folder failed.
    pub fn persist(mut self) -> Result<File, FileError> {
        self.finish()?;
        let path = &self.path;
        let refuse = FileError::cannot("write", path);
        let file = self.output.into_inner();
        let file = file.map_err(|error| refuse(error.into_error()))?;
        let named = match self.existing {
            Existing::Replaced => self.temporary.persist(path),
            Existing::Kept => self.temporary.persist_noclobber(path),
        };
        named.map_err(|failed| refuse(failed.error))?;
        sync_folder(folder_of(path))?;
        Ok(file)
    }
}

/// Removes temporary files that programs which were killed have left in a folder more than a day ago. Looks once in
/// each folder: thousands of files may be written there.
fn remove_abandoned(folder: &Path) {
    static SEEN: Mutex<BTreeSet<PathBuf>> = Mutex::new(BTreeSet::new());
    if !locked(&SEEN).insert(folder.to_owned()) {
        return;
    }
    for file in fs::read_dir(folder).into_iter().flatten().flatten() {
        let name = file.file_name();
        let is_temporary = name.as_encoded_bytes().starts_with(PREFIX.as_bytes());
        let age = || file.metadata().ok()?.modified().ok()?.elapsed().ok();
        if is_temporary && age().is_some_and(|age| age > ABANDONED) {
            // What cannot be removed does no harm.
            let _ = fs::remove_file(file.path());
        }
    }
}

/// The metadata of the file to replace; None if there is none. An error if it must be kept or is not a regular file.
fn replaced(path: &Path, existing: Existing) -> io::Result<Option<Metadata>> {
    match path.symlink_metadata() {
        Err(_) => Ok(None),
        Ok(found) if !found.is_file() => Err(io::Error::other("only regular files are replaced")),
        Ok(_) if existing == Existing::Kept => Err(ErrorKind::AlreadyExists.into()),
        Ok(found) => Ok(Some(found)),
    }
}

/// Opens a file to read it. Refuses anything except a regular file: opening a pipe waits for a writer that may never
/// come.
///
/// # Errors
/// The system's error.
pub fn open(path: &Path) -> Result<File, FileError> {
    let opened = path.metadata().and_then(|found| {
        if found.is_file() {
            File::open(path)
        } else {
            Err(io::Error::other("not a regular file"))
        }
    });
    opened.map_err(FileError::cannot("read", path))
}

/// The error for a file whose content is wrong.
pub(crate) fn wrong(path: &Path, error: impl Display) -> ReadError {
    ReadError::new(format!("{}: {error}", path.display()))
}

/// The paths of everything in a folder, sorted; none if the folder does not exist, or if a file is where a folder above
/// it would be.
pub(crate) fn paths_in(folder: &Path) -> Result<Vec<PathBuf>, FileError> {
    let paths: io::Result<Vec<PathBuf>> = match fs::read_dir(folder) {
        Err(error) if is_missing(&error) && !folder.exists() => return Ok(Vec::new()),
        files => files.and_then(|files| files.map(|file| Ok(file?.path())).collect()),
    };
    let mut paths = paths.map_err(FileError::cannot("read the folder", folder))?;
    paths.sort();
    Ok(paths)
}

/// Makes a folder and the folders above it, and syncs the one that it is in.
pub(crate) fn make_folder(path: &Path) -> Result<(), FileError> {
    if path.is_dir() {
        return Ok(());
    }
    fs::create_dir_all(path).map_err(FileError::cannot("make the folder", path))?;
    sync_folder(folder_of(path))
}

/// The folder that contains a file: `.` if the path is only a name.
pub fn folder_of(path: &Path) -> &Path {
    match path.parent() {
        Some(folder) if !folder.as_os_str().is_empty() => folder,
        _ => Path::new("."),
    }
}

/// Syncs a folder, so that files renamed in it stay renamed.
pub(crate) fn sync_folder(folder: &Path) -> Result<(), FileError> {
    use ErrorKind::{InvalidInput, PermissionDenied, Unsupported};
    let synced = File::open(folder).and_then(|folder| folder.sync_all());
    match synced.map_err(|error| (error.kind(), error)) {
        // A folder that may be written to but not read cannot be synced; some file systems cannot sync any.
        Ok(()) | Err((PermissionDenied | InvalidInput | Unsupported, _)) => Ok(()),
        Err((_, error)) => {
            let doing = "sync the folder; it was changed, but a power cut may undo that";
            Err(FileError::cannot(doing, folder)(error))
        }
    }
}

/// The identity of a file, which it keeps when it is renamed: whether a name still belongs to it. It stays unique as
/// long as the file is open.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct FileId(u64, u64);

impl FileId {
    /// The identity of the file that this metadata describes.
    #[cfg(unix)]
    pub fn in_metadata(found: &Metadata) -> Self {
        use std::os::unix::fs::MetadataExt;
        Self(found.dev(), found.ino())
    }

    /// The same for every file: an open file keeps its name on these systems.
    #[cfg(not(unix))]
    pub fn in_metadata(_: &Metadata) -> Self {
        Self(0, 0)
    }

    /// The identity of an open file.
    ///
    /// # Errors
    /// The system's error.
    pub fn of(file: &File) -> io::Result<Self> {
        file.metadata().map(|found| Self::in_metadata(&found))
    }

    /// The identity of the file at a path; of a link, that of the file that it leads to.
    ///
    /// # Errors
    /// The system's error.
    pub fn behind(path: &Path) -> io::Result<Self> {
        path.metadata().map(|found| Self::in_metadata(&found))
    }

    /// Whether the file has this path.
    pub fn is_at(self, path: &Path) -> bool {
        let found = path.symlink_metadata();
        found.is_ok_and(|found| Self::in_metadata(&found) == self)
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn files(folder: &Path) -> usize {
        fs::read_dir(folder).expect("a folder").count()
    }

    #[test]
    fn a_file_can_be_checked_before_it_is_written() {
        let folder = tempfile::tempdir().expect("a folder");
        let path = |name: &str| folder.path().join(name);
        assert!(check_writable(&path("new"), Existing::Kept).is_ok());
        let refused = check_writable(&path("no/folder"), Existing::Kept).expect_err("no folder");
        assert!(
            refused.to_string().contains("cannot write: no such folder"),
            "{refused}"
        );
        assert_eq!(files(folder.path()), 0);
        fs::write(path("old"), "").expect("written");
        assert!(check_writable(&path("old"), Existing::Kept).is_err());
        assert!(check_writable(&path("old"), Existing::Replaced).is_ok());
    }

    #[test]
    fn a_file_is_kept_or_replaced_with_its_mode() {
        let folder = tempfile::tempdir().expect("a folder");
        let path = folder.path().join("file");
        let write = |content: &str, existing| write(&path, content.as_bytes(), existing);
        // One that came meanwhile is kept, too.
        let late = NewFile::with_content(&path, b"late", Existing::Kept).expect("written");
        write("one", Existing::Kept).expect("a new name");
        assert!(write("two", Existing::Kept).expect_err("there").exists());
        assert!(late.persist().expect_err("there").exists());
        assert_eq!(fs::read(&path).ok().as_deref(), Some(&b"one"[..]));
        #[cfg(unix)]
        {
            use std::os::unix::fs::PermissionsExt;
            let mode = || path.metadata().expect("there").permissions().mode() & 0o7777;
            for old in [0o640, 0o600, 0o755] {
                fs::set_permissions(&path, fs::Permissions::from_mode(old)).expect("set");
                write("three", Existing::Replaced).expect("replaced");
                assert_eq!(mode(), old);
            }
        }
        assert!(check_writable(folder.path(), Existing::Replaced).is_err());
        assert_eq!(files(folder.path()), 1, "nothing else is left");
    }

    #[test]
    fn the_next_writer_removes_what_a_killed_one_left_a_day_ago() {
        let folder = tempfile::tempdir().expect("a folder");
        let (old, new) = (
            folder.path().join(".taxel-old"),
            folder.path().join(".taxel-new"),
        );
        for path in [&old, &new] {
            fs::write(path, "half").expect("written");
        }
        let file = File::options().write(true).open(&old).expect("there");
        let before = std::time::SystemTime::now() - ABANDONED - Duration::from_secs(1);
        file.set_modified(before).expect("set");
        write(&folder.path().join("a"), b"whole", Existing::Kept).expect("written");
        assert!(!old.exists() && new.exists());
        assert_eq!(files(folder.path()), 2);
    }
}
