//! Reads the files of a library, and lists and creates its folders.

use std::ffi::OsString;
use std::fs::{self, File, Metadata};
use std::hash::{DefaultHasher, Hash, Hasher};
use std::io::{Error, ErrorKind, Read};
use std::path::{Path, PathBuf};

use crate::formats::shape::MAX_BYTES;
use crate::storage::access::share;
use crate::storage::atomic_file::{folder_of, kind_in_words, sync_folder};
use crate::storage::error::{FileError, LibraryError};

/// The name of the folder inside a library with its deleted shapes.
pub(crate) const TRASH: &str = ".trash";

/// The name of the folder inside a library with unsaved work.
pub(crate) const JOURNAL: &str = ".journal";

/// Returns a hash of a file's content. Two contents with the same stamp count as equal.
pub(crate) fn stamp(content: &[u8]) -> u64 {
    let mut hasher = DefaultHasher::new();
    content.hash(&mut hasher);
    hasher.finish()
}

/// Returns the metadata of a regular file. Refuses a link too: its target does not belong to the library.
pub(crate) fn regular(path: &Path) -> Result<Metadata, LibraryError> {
    let found = path.symlink_metadata();
    let found = found.map_err(|error| FileError::new("access it", path, error))?;
    check_regular(path, &found)?;
    Ok(found)
}

fn check_regular(path: &Path, found: &Metadata) -> Result<(), LibraryError> {
    if found.is_file() {
        return Ok(());
    }
    let what = kind_in_words(found.file_type());
    Err(in_the_way(path, what, "a regular file"))
}

fn in_the_way(path: &Path, what: &'static str, expected: &'static str) -> LibraryError {
    LibraryError::InTheWay {
        path: path.to_owned(),
        what,
        expected,
    }
}

/// Reads the content of a regular file, at most one byte more than a shape may have.
///
/// Uses four system calls (open, look, read, close), because a library may have 100,000 files.
pub(crate) fn read(path: &Path) -> Result<Vec<u8>, LibraryError> {
    let file = open(path)?;
    // The metadata of the open file: another file may have taken its name since.
    let found = file.metadata();
    let found = found.map_err(|error| FileError::new("access it", path, error))?;
    check_regular(path, &found)?;
    // Asks for no more bytes than the file has, so that finding the end needs no further read. A length of 0 may mean
    // that it is unknown.
    let length = usize::try_from(found.len()).unwrap_or(MAX_BYTES + 1);
    let length = if length == 0 { MAX_BYTES } else { length }.min(MAX_BYTES + 1);
    let mut content = Vec::with_capacity(length);
    file.take(length as u64)
        .read_to_end(&mut content)
        .map_err(|error| FileError::new("read", path, error))?;
    Ok(content)
}

/// Opens a file, but does not follow a link or wait for the writer of a pipe.
fn open(path: &Path) -> Result<File, LibraryError> {
    let refused = |error| FileError::new("open", path, error).into();
    #[cfg(unix)]
    {
        use std::os::unix::fs::OpenOptionsExt;

        use rustix::fs::OFlags;
        // A terminal must not become this program's.
        let flags = OFlags::NOFOLLOW | OFlags::NONBLOCK | OFlags::NOCTTY;
        let mut options = File::options();
        options.read(true).custom_flags(flags.bits().cast_signed());
        match options.open(path) {
            Ok(file) => return Ok(file),
            // The holder of a lease on it must give it up first.
            Err(error) if error.kind() == ErrorKind::WouldBlock => {}
            Err(error) => {
                regular(path)?;
                return Err(refused(error));
            }
        }
    }
    regular(path)?;
    File::open(path).map_err(refused)
}

/// Returns the names of everything in a folder; empty if the folder does not exist, or if a file is where a folder
/// above it would be.
pub(crate) fn names(folder: &Path) -> Result<Vec<OsString>, FileError> {
    let refuse = |error| FileError::new("read the folder", folder, error);
    let files = loop {
        match fs::read_dir(folder) {
            // The standard library retries opening a file after a signal, but not opening a folder.
            Err(error) if error.kind() == ErrorKind::Interrupted => {}
            Err(error) if error.kind() == ErrorKind::NotFound => return Ok(Vec::new()),
            Err(error)
                if error.kind() == ErrorKind::NotADirectory && file_above(folder).is_some() =>
            {
                return Ok(Vec::new());
            }
            Err(error) if error.kind() == ErrorKind::NotADirectory => {
                return Err(refuse(Error::new(error.kind(), "it is a file")));
            }
            files => break files.map_err(refuse)?,
        }
    };
    files
        .map(|file| Ok(file.map_err(refuse)?.file_name()))
        .collect()
}

/// Returns the file that is where a folder above `path` would be, if there is one.
pub(crate) fn file_above(path: &Path) -> Option<&Path> {
    let above = path.ancestors().skip(1);
    let mut found = above.filter(|above| !above.as_os_str().is_empty() && above.exists());
    found.next().filter(|above| !above.is_dir())
}

/// Returns true if a file in the journal's folder is called like a file of a journal: two numbers and a hyphen, then
/// an ending. A file of another name belongs to someone else.
pub(crate) fn is_journal(path: &Path) -> bool {
    let name = path.file_stem().and_then(|name| name.to_str());
    let numbers = name.and_then(|name| name.split_once('-'));
    let is_number = |text: &str| !text.is_empty() && text.bytes().all(|c| c.is_ascii_digit());
    numbers.is_some_and(|(process, number)| is_number(process) && is_number(number))
}

/// Makes a folder and the folders above it, and syncs them. A link to a folder counts as a folder.
pub(crate) fn make(path: &Path) -> Result<(), LibraryError> {
    if path.as_os_str().is_empty() || path.is_dir() {
        return Ok(());
    }
    make(path.parent().unwrap_or(Path::new("")))?;
    match fs::create_dir(path) {
        Err(error) if error.kind() == ErrorKind::AlreadyExists => {
            // Another program was faster, or something else has the name.
            if !path.is_dir() {
                let kind = |found: Metadata| kind_in_words(found.file_type());
                let what = path.metadata().map_or("a broken symbolic link", kind);
                return Err(in_the_way(path, what, "a folder"));
            }
        }
        made => made.map_err(|error| FileError::new("make the folder", path, error))?,
    }
    Ok(sync_folder(folder_of(path))?)
}

/// A folder inside the library. It is no link: a link would lead out of the library, to files of others.
#[derive(Debug)]
pub(crate) struct InnerFolder(PathBuf);

impl InnerFolder {
    /// Returns the folder of that name in a library. It may not exist yet.
    ///
    /// # Errors
    /// Returns an error if a link has the name.
    pub(crate) fn of(library: &Path, name: &str) -> Result<Self, LibraryError> {
        let path = library.join(name);
        let found = path.symlink_metadata();
        if found.is_ok_and(|found| found.file_type().is_symlink()) {
            return Err(in_the_way(&path, "a symbolic link", "a folder"));
        }
        Ok(Self(path))
    }

    /// Returns the path of the folder.
    pub(crate) fn path(&self) -> &Path {
        &self.0
    }

    /// Makes the folder if there is none, and opens it to all who may write in the library.
    pub(crate) fn make(&self) -> Result<(), LibraryError> {
        if self.0.is_dir() {
            return Ok(());
        }
        make(&self.0)?;
        if let (Some(library), Ok(folder)) = (self.0.parent(), open_unlinked(&self.0)) {
            share(&folder, library);
        }
        Ok(())
    }

    /// Returns the paths of everything in the folder; empty if the folder does not exist.
    pub(crate) fn paths(&self) -> Result<Vec<PathBuf>, FileError> {
        let names = names(&self.0)?.into_iter();
        Ok(names.map(|name| self.0.join(name)).collect())
    }
}

/// Opens a folder, but not one that a link leads to: another user may have put the link there just now.
fn open_unlinked(path: &Path) -> std::io::Result<File> {
    let mut options = File::options();
    options.read(true);
    #[cfg(unix)]
    {
        use rustix::fs::OFlags;
        use std::os::unix::fs::OpenOptionsExt;
        let flags = OFlags::NOFOLLOW | OFlags::DIRECTORY;
        options.custom_flags(flags.bits().cast_signed());
    }
    options.open(path)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_file_is_read_whole_but_no_further_than_a_shape_may_go() {
        let folder = tempfile::tempdir().expect("a folder");
        let path = folder.path().join("file");
        for (length, read_of_it) in [
            (0, 0),
            (1, 1),
            (10_000, 10_000),
            (MAX_BYTES, MAX_BYTES),
            (MAX_BYTES + 1, MAX_BYTES + 1),
            (MAX_BYTES + 5, MAX_BYTES + 1),
        ] {
            fs::write(&path, vec![b'x'; length]).expect("written");
            let content = read(&path).expect("read");
            assert_eq!(content.len(), read_of_it, "of {length} bytes");
        }
    }
}
