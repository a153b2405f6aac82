//! Writes files so that none is ever half-written: under a temporary name in the same folder, synced, renamed into
//! place, and the folder synced.
//!
//! Whenever the program dies or the power fails, either the complete old file or the complete new one exists;
//! [`persist_pair`] says which of two files that belong together exist. The stages are types: content goes into an
//! [`UnfinishedFile`]; a [`FinishedFile`] is on disk and lacks only its name. Either one removes its temporary file
//! when it is dropped, so an error or an early return leaves nothing behind. If a program is killed, the next writer
//! removes the file that it left: see [`crate::storage::temporary`] for files from [`UnfinishedFile::new`]; the name
//! given to [`UnfinishedFile::with_temporary`] is taken over by the next caller.

use std::fs::{self, File, FileType, Metadata, TryLockError};
use std::io::{self, BufWriter, ErrorKind, Write};
use std::path::{Path, PathBuf};
use std::time::{Duration, Instant};

use crate::storage::access::{check_replaceable, keep_access};
use crate::storage::error::FileError;
use crate::storage::file_id::FileId;
use crate::storage::temporary::{OldFile, TemporaryFile};

/// The handling of an existing file.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash)]
pub enum Existing {
    /// The file is replaced if it is a regular file. A folder, a device or a link is never replaced.
    Replaced,
    /// The file stays, and nothing is written.
    Kept,
}

/// A file under a temporary name, still being written.
#[derive(Debug)]
#[must_use = "only `finish` and `persist` make a file of it"]
pub struct UnfinishedFile {
    path: PathBuf,
    existing: Existing,
    /// The writer for the content.
    pub(super) output: BufWriter<TemporaryFile>,
}

impl UnfinishedFile {
    /// Begins the file at `path`, under no name or a random one.
    ///
    /// # Errors
    /// Returns [`ErrorKind::AlreadyExists`] if a file exists and must be kept, [`ErrorKind::Other`] if it is not a
    /// regular file, [`ErrorKind::PermissionDenied`] if this user cannot replace it, or the system's error.
    pub fn new(path: &Path, existing: Existing) -> Result<Self, FileError> {
        Self::begin(path, existing, |is_private| {
            TemporaryFile::new(folder_of(path), is_private)
        })
    }

    /// Begins a file that replaces `path`, under a temporary name that only the holder of a lock uses. A file of that
    /// name was left by a program that died, and is removed. If something else has the name, a random one is used.
    ///
    /// # Errors
    /// Returns the errors of [`UnfinishedFile::new`].
    pub fn with_temporary(path: &Path, temporary: &Path) -> Result<Self, FileError> {
        Self::begin(
            path,
            Existing::Replaced,
            |is_private| match TemporaryFile::at(temporary, is_private) {
                Err(error) if error.kind() == ErrorKind::AlreadyExists => {
                    let removed = fs::remove_file(temporary);
                    let again = removed.and_then(|()| TemporaryFile::at(temporary, is_private));
                    again.or_else(|_| TemporaryFile::new(folder_of(path), is_private))
                }
                made => made,
            },
        )
    }

    /// Begins a file with one that `create` makes: a private one if it is given true.
    fn begin(
        path: &Path,
        existing: Existing,
        create: impl FnOnce(bool) -> io::Result<TemporaryFile>,
    ) -> Result<Self, FileError> {
        let refuse = |doing| move |error| FileError::new(doing, path, error);
        // Reported before the work, not after it.
        let old = replaced(path, existing)?;
        // The system reports a missing folder here, rather than a temporary file that could not be made.
        folder_of(path)
            .metadata()
            .map_err(refuse("write into its folder"))?;
        // The old file may be for fewer people than the umask says.
        let file = create(old.is_some()).map_err(refuse("write into its folder"))?;
        if let Some(old) = old {
            keep_access(file.file(), path, &old).map_err(refuse("set its permissions"))?;
        }
        Ok(Self {
            path: path.to_owned(),
            existing,
            output: BufWriter::new(file),
        })
    }

    /// Returns the path that the file will have.
    pub fn path(&self) -> &Path {
        &self.path
    }

    /// Returns another handle of the open file, for changes before the file has its name.
    ///
    /// # Errors
    /// Returns the system's error.
    pub fn handle(&self) -> Result<File, FileError> {
        let handle = self.output.get_ref().file().try_clone();
        handle.map_err(|error| FileError::new("open", &self.path, error))
    }

    /// Writes a part of the content.
    ///
    /// # Errors
    /// Returns the system's error.
    pub fn write(&mut self, content: &[u8]) -> Result<(), FileError> {
        let written = self.output.write_all(content);
        written.map_err(|error| FileError::new("write it", &self.path, error))
    }

    /// Writes out and syncs the content.
    ///
    /// # Errors
    /// Returns the system's error.
    pub fn finish(self) -> Result<FinishedFile, FileError> {
        let path = &self.path;
        let refuse = |doing| move |error| FileError::new(doing, path, error);
        let file = self
            .output
            .into_inner()
            .map_err(io::IntoInnerError::into_error);
        let file = file.map_err(refuse("write it"))?;
        file.file().sync_all().map_err(refuse("sync it"))?;
        Ok(FinishedFile {
            path: self.path,
            existing: self.existing,
            file,
        })
    }
}

/// A file that is on disk and lacks only its name.
#[derive(Debug)]
#[must_use = "only `persist` gives the file its name"]
pub struct FinishedFile {
    path: PathBuf,
    existing: Existing,
    file: TemporaryFile,
}

impl FinishedFile {
    /// Writes the content of a file, which does not have its name yet.
    ///
    /// # Errors
    /// Returns the errors of [`UnfinishedFile::new`] and [`UnfinishedFile::finish`].
    pub fn new(path: &Path, content: &[u8], existing: Existing) -> Result<Self, FileError> {
        let mut file = UnfinishedFile::new(path, existing)?;
        file.write(content)?;
        file.finish()
    }

    /// Returns the path that the file will have.
    pub fn path(&self) -> &Path {
        &self.path
    }

    /// Returns the same file, with another treatment of a file that has its name by then.
    pub fn with_existing(self, existing: Existing) -> Self {
        Self { existing, ..self }
    }

    /// Gives the file its name and syncs the folder.
    ///
    /// # Errors
    /// Returns [`ErrorKind::AlreadyExists`] if a file that must be kept has appeared meanwhile, or the system's error.
    /// The old file is unchanged, unless syncing the folder failed ([`FileError::is_in_place`]).
    pub fn persist(self) -> Result<(), FileError> {
        let folder = folder_of(&self.path).to_owned();
        self.take_name()?;
        sync_folder(&folder)
    }

    /// Returns true if it replaces a file.
    ///
    /// # Errors
    /// Returns an error if the existing file must be kept, or is not a regular file.
    fn is_replaced(&self) -> Result<bool, FileError> {
        Ok(replaced(&self.path, self.existing)?.is_some())
    }

    /// Gives the file its name. Returns the open file, for further writing.
    ///
    /// # Errors
    /// Returns the errors of [`Self::persist`].
    fn take_name(self) -> Result<File, FileError> {
        let folder = folder_of(&self.path);
        let replace = self.existing == Existing::Replaced;
        let named = self.file.persist(folder, &self.path, replace);
        named.map_err(|error| FileError::new("move it into place", &self.path, error))
    }
}

/// Checks whether a file can be begun at a path, so that an error comes before the work rather than after it. Leaves
/// nothing behind.
///
/// # Errors
/// Returns the errors of [`UnfinishedFile::new`].
pub fn check_writable(path: &Path, existing: Existing) -> Result<(), FileError> {
    UnfinishedFile::new(path, existing).map(drop)
}

/// Returns the metadata of the file to replace; None if there is none.
///
/// # Errors
/// Returns an error if it must be kept, is not a regular file, or cannot be replaced by this user.
fn replaced(path: &Path, existing: Existing) -> Result<Option<Metadata>, FileError> {
    let old = path.symlink_metadata().ok();
    match (existing, &old) {
        (_, Some(found)) if !found.file_type().is_file() => {
            let kind = kind_in_words(found.file_type());
            let error = format!("it is {kind}, and only regular files are replaced");
            Err(FileError::new("replace it", path, io::Error::other(error)))
        }
        (Existing::Kept, Some(_)) => {
            let error = ErrorKind::AlreadyExists.into();
            Err(FileError::new("create it", path, error))
        }
        (Existing::Replaced, Some(found)) => {
            let checked = check_replaceable(path, folder_of(path), found);
            checked.map_err(|error| FileError::new("replace it", path, error))?;
            Ok(old)
        }
        (_, None) => Ok(None),
    }
}

/// Returns the kind of a file in words, with its article.
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

/// Gives two files that belong together their names: both, or neither. If the program dies, a new file never stands
/// beside an old version of the other one: the file that has the second name is moved away first, and the second name
/// is given last. So a program that dies in between leaves no file of the second name. The old one is then called
/// `.taxel-tmp-XXXXXXXXXXXXXXXX`, until a program that writes into the folder a minute later or more removes it. Of two
/// programs that name such files in one folder at once, one waits for the other, for two seconds at most. Returns the
/// first file, open, for further writing, and the error if a folder cannot be synced
/// ([`FileError::is_in_place`]).
///
/// # Errors
/// Returns the errors of [`FinishedFile::persist`] if one of the files got no name. The old files are restored then;
/// the message says what could not be restored.
pub fn persist_pair(
    first: FinishedFile,
    second: FinishedFile,
) -> Result<(File, Result<(), FileError>), FileError> {
    let _lock = lock_folder(folder_of(&first.path));
    let (path, beside) = (first.path.clone(), second.path.clone());
    let is_replaced = first.is_replaced()?;
    // On a file system without links, nothing is kept.
    let kept = is_replaced.then(|| OldFile::linked(folder_of(&path), &path));
    let kept = kept.and_then(Result::ok);
    let moved = if second.is_replaced()? {
        Some(move_away(&beside)?)
    } else {
        None
    };
    let put_back = |old: Option<OldFile>| old.and_then(|old| old.put_back().err());
    let file = match first.take_name() {
        Ok(file) => file,
        Err(error) => return Err(error.and(put_back(moved))),
    };
    // Before the second file gets its name, so that a power cut keeps their order, too.
    let synced = sync_folder(folder_of(&path));
    if let Err(error) = second.take_name() {
        // The new first file would be taken for complete on its own.
        let lost = if kept.is_some() {
            put_back(kept)
        } else {
            let _ = fs::remove_file(&path);
            is_replaced.then(|| format!("the old {} is lost", path.display()))
        };
        let _ = sync_folder(folder_of(&path));
        return Err(error.and(lost).and(put_back(moved)));
    }
    Ok((file, synced.and_then(|()| sync_folder(folder_of(&beside)))))
}

/// Gives the second of two files that belong together its name again, unless another file has the name of the first
/// one by now. Returns whether it did. Of two programs that name such files in one folder at once, one waits for the
/// other, for two seconds at most.
///
/// # Errors
/// Returns the errors of [`FinishedFile::persist`].
pub(crate) fn persist_beside(
    (first, path): (FileId, &Path),
    second: FinishedFile,
) -> Result<bool, FileError> {
    let _lock = lock_folder(folder_of(path));
    if !first.is_at(path) {
        return Ok(false);
    }
    second.persist().map(|()| true)
}

/// Moves a file that will be replaced to a temporary name.
fn move_away(path: &Path) -> Result<OldFile, FileError> {
    let refuse = |error| FileError::new("replace it", path, error);
    let moved = OldFile::moved(folder_of(path), path).map_err(refuse)?;
    match sync(folder_of(path)) {
        Ok(()) => Ok(moved),
        Err(error) => Err(refuse(error).and(moved.put_back().err())),
    }
}

/// Locks a folder, so that two programs do not rename pairs of files in it at the same time. Waits for two seconds at
/// most; others wait as long as the file that is returned is open. The folder itself is locked, so nothing is left in
/// it. None if the wait is over, or on a system that cannot lock a folder: the files are named all the same.
fn lock_folder(folder: &Path) -> Option<File> {
    // Tests wait longer: on a slow disk, several of their threads may take seconds.
    const PATIENCE: Duration = Duration::from_secs(if cfg!(test) { 120 } else { 2 });
    const PAUSE: Duration = Duration::from_millis(2);
    let folder = File::open(folder).ok()?;
    let start = Instant::now();
    loop {
        match folder.try_lock() {
            Ok(()) => return Some(folder),
            Err(TryLockError::WouldBlock) if start.elapsed() < PATIENCE => {
                std::thread::sleep(PAUSE);
            }
            Err(_) => return None,
        }
    }
}

/// Writes a file that replaces `path`: under a temporary name that only the holder of a lock uses, or without a lock
/// as [`UnfinishedFile::new`] does.
///
/// # Errors
/// Returns the errors of [`UnfinishedFile::new`] and [`FinishedFile::persist`].
pub(crate) fn write(
    path: &Path,
    temporary: Option<&Path>,
    content: &[u8],
) -> Result<(), FileError> {
    let mut file = match temporary {
        Some(temporary) => UnfinishedFile::with_temporary(path, temporary)?,
        None => UnfinishedFile::new(path, Existing::Replaced)?,
    };
    file.write(content)?;
    file.finish()?.persist()
}

/// Returns the folder that contains a file: `.` if the path is only a name.
pub fn folder_of(path: &Path) -> &Path {
    match path.parent() {
        Some(folder) if !folder.as_os_str().is_empty() => folder,
        _ => Path::new("."),
    }
}

/// Syncs a folder, so that files renamed in it stay renamed.
///
/// # Errors
/// Returns the system's error, for which [`FileError::is_in_place`] is true.
pub(crate) fn sync_folder(folder: &Path) -> Result<(), FileError> {
    sync(folder).map_err(|error| FileError::syncing(folder, error))
}

fn sync(folder: &Path) -> io::Result<()> {
    // On other systems a folder cannot be opened, and renaming is all that can be done.
    if !cfg!(unix) {
        return Ok(());
    }
    let opened = match File::open(folder) {
        // A folder that may be written to but not read cannot be synced.
        Err(error) if error.kind() == ErrorKind::PermissionDenied => return Ok(()),
        opened => opened,
    };
    match opened.and_then(|folder| folder.sync_all()) {
        // Some file systems cannot sync a folder.
        Err(error)
            if matches!(
                error.kind(),
                ErrorKind::InvalidInput | ErrorKind::Unsupported
            ) =>
        {
            Ok(())
        }
        synced => synced,
    }
}

#[cfg(test)]
mod tests {
    use super::*;

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
        assert!(
            fs::read_dir(folder.path())
                .expect("a folder")
                .next()
                .is_none()
        );
        fs::write(path("old"), "").expect("written");
        assert!(check_writable(&path("old"), Existing::Kept).is_err());
        assert!(check_writable(&path("old"), Existing::Replaced).is_ok());
    }
}
