//! Writes files so that none is ever half-written: under a temporary name `.taxel-XXXXXXXX` in the same folder, synced,
//! renamed into place, and the folder synced.
//!
//! Whenever the program dies or the power fails, either the complete old file or the complete new one exists. A program
//! that is killed leaves its temporary file; a program that writes into the folder a day later removes it.

use std::collections::BTreeSet;
use std::fs::{self, File, FileType, Metadata};
use std::io::{self, BufWriter, ErrorKind, Write};
use std::path::{Path, PathBuf};
use std::sync::Mutex;
use std::time::Duration;

use taxel_core::lock::locked;
use tempfile::{Builder, TempPath};

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
    path: PathBuf,
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
        // Reported before the work, not after it.
        let old = replaced(path, existing)?;
        remove_abandoned(folder);
        let options = options(old.is_some());
        let mut builder = Builder::new();
        builder.prefix(PREFIX).rand_bytes(8);
        // Not with the builder's own method: its error names the temporary file.
        let made = builder.make_in(folder, |path| options.open(path));
        let made = made.map_err(|error| FileError::new("write into its folder", path, error))?;
        let (file, temporary) = made.into_parts();
        if let Some(old) = old {
            keep_mode(&file, &old);
        }
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
        written.map_err(|error| FileError::new("write it", path, error))?;
        file.finish()?;
        Ok(file)
    }

    /// The path that the file will have.
    pub fn path(&self) -> &Path {
        &self.path
    }

    /// Writes out and syncs the content, so that naming the file hardly ever fails.
    ///
    /// # Errors
    /// The system's error.
    pub fn finish(&mut self) -> Result<(), FileError> {
        let refuse = |doing| {
            let path = &self.path;
            move |error| FileError::new(doing, path, error)
        };
        self.output.flush().map_err(refuse("write it"))?;
        self.output.get_ref().sync_all().map_err(refuse("sync it"))
    }

    /// Finishes the file, gives it its name and syncs the folder. Returns the open file.
    ///
    /// # Errors
    /// [`ErrorKind::AlreadyExists`] if a file that must be kept has appeared meanwhile, or the system's error. The old
    /// file is unchanged, unless only syncing the folder failed.
    pub fn persist(mut self) -> Result<File, FileError> {
        self.finish()?;
        let Self {
            path,
            existing,
            output,
            temporary,
        } = self;
        let named = match existing {
            Existing::Replaced => temporary.persist(&path),
            Existing::Kept => temporary.persist_noclobber(&path),
        };
        named.map_err(|failed| FileError::new("move it into place", &path, failed.error))?;
        sync_folder(folder_of(&path))?;
        let file = output.into_inner();
        file.map_err(|error| FileError::new("write it", &path, error.into_error()))
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
        let is_temporary = file
            .file_name()
            .as_encoded_bytes()
            .starts_with(PREFIX.as_bytes());
        let age = || file.metadata().ok()?.modified().ok()?.elapsed().ok();
        if is_temporary && age().is_some_and(|age| age > ABANDONED) {
            // What cannot be removed does no harm.
            let _ = fs::remove_file(file.path());
        }
    }
}

/// The options to create a temporary file; a private one cannot be opened by others until it has its mode.
#[cfg_attr(
    not(unix),
    expect(unused_variables, reason = "files have no modes there")
)]
fn options(is_private: bool) -> fs::OpenOptions {
    let mut options = File::options();
    options.read(true).write(true).create_new(true);
    #[cfg(unix)]
    if is_private {
        std::os::unix::fs::OpenOptionsExt::mode(&mut options, 0o600);
    }
    options
}

/// Gives a new file the mode of the one that it replaces. Bits that make a file run as its owner or group are dropped:
/// it has other content, and perhaps another owner. On a file system without modes it stays as it is.
fn keep_mode(file: &File, old: &Metadata) {
    #[cfg(unix)]
    {
        use std::os::unix::fs::PermissionsExt;
        let mode = old.permissions().mode() & 0o777;
        let _ = file.set_permissions(fs::Permissions::from_mode(mode));
    }
    #[cfg(not(unix))]
    let _ = file.set_permissions(old.permissions());
}

/// The metadata of the file to replace; None if there is none. An error if it must be kept or is not a regular file.
fn replaced(path: &Path, existing: Existing) -> Result<Option<Metadata>, FileError> {
    let Ok(found) = path.symlink_metadata() else {
        return Ok(None);
    };
    if !found.is_file() {
        let kind = kind_in_words(found.file_type());
        let error = format!("it is {kind}, and only regular files are replaced");
        return Err(FileError::new("replace it", path, io::Error::other(error)));
    }
    if existing == Existing::Kept {
        let error = ErrorKind::AlreadyExists.into();
        return Err(FileError::new("create it", path, error));
    }
    Ok(Some(found))
}

pub(super) fn kind_in_words(kind: FileType) -> &'static str {
    #[cfg(unix)]
    if std::os::unix::fs::FileTypeExt::is_fifo(&kind) {
        return "a FIFO";
    }
    if kind.is_symlink() {
        "a symbolic link"
    } else if kind.is_dir() {
        "a folder"
    } else if kind.is_file() {
        "a file"
    } else {
        "a device or a socket"
    }
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
    // On other systems a folder cannot be opened, and renaming is all that can be done.
    if !cfg!(unix) {
        return Ok(());
    }
    let synced = File::open(folder).and_then(|folder| folder.sync_all());
    match synced {
        // A folder that may be written to but not read cannot be synced; some file systems cannot sync any.
        Err(error)
            if !matches!(
                error.kind(),
                ErrorKind::PermissionDenied | ErrorKind::InvalidInput | ErrorKind::Unsupported
            ) =>
        {
            let doing = "sync the folder; it was changed, but a power cut may undo that";
            Err(FileError::new(doing, folder, error))
        }
        _ => Ok(()),
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

    /// The identity of the file that a stream, such as standard input, reads or writes.
    ///
    /// # Errors
    /// The system's error.
    #[cfg(unix)]
    pub fn of_stream(stream: impl std::os::fd::AsFd) -> io::Result<Self> {
        Self::of(&File::from(stream.as_fd().try_clone_to_owned()?))
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
            refused.to_string().contains("write into its folder"),
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
            for (old, kept) in [(0o640, 0o640), (0o600, 0o600), (0o4755, 0o755)] {
                fs::set_permissions(&path, fs::Permissions::from_mode(old)).expect("set");
                write("three", Existing::Replaced).expect("replaced");
                assert_eq!(mode(), kept);
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
