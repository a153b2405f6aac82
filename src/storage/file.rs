//! Files that are whole or not there: reading with a limit, writing by rename.

use std::ffi::OsString;
use std::fs::{self, File, Metadata};
use std::hash::{DefaultHasher, Hash, Hasher};
use std::io::{self, ErrorKind, Read, Write};
use std::path::Path;

use crate::formats::shape::MAX_BYTES;
use crate::storage::LibraryError;

/// Puts the place and the doing to an error of the system.
pub(crate) fn system(doing: &'static str, path: &Path) -> impl FnOnce(io::Error) -> LibraryError {
    let path = path.to_owned();
    move |error| LibraryError::System { doing, path, error }
}

/// What a file holds, in a number: two contents with the same number are taken for the same.
pub(crate) fn stamp(content: &[u8]) -> u64 {
    let mut hasher = DefaultHasher::new();
    content.hash(&mut hasher);
    hasher.finish()
}

/// What is at a path, if it is a regular file. A link is refused too: what it leads to is not the library's.
pub(crate) fn regular(path: &Path) -> Result<Metadata, LibraryError> {
    let found = fs::symlink_metadata(path).map_err(system("look at it", path))?;
    let kind = found.file_type();
    let what = if kind.is_file() {
        return Ok(found);
    } else if kind.is_symlink() {
        "a symbolic link"
    } else if kind.is_dir() {
        "a folder"
    } else {
        "a device, a pipe or a socket"
    };
    let (path, expected) = (path.to_owned(), "a regular file");
    Err(LibraryError::InTheWay {
        path,
        what,
        expected,
    })
}

/// A regular file's content, or one byte more than a shape may have.
pub(crate) fn read(path: &Path) -> Result<Vec<u8>, LibraryError> {
    // Before it is opened: opening a pipe waits for somebody to write into it.
    regular(path)?;
    let mut content = Vec::new();
    let limit = u64::try_from(MAX_BYTES).unwrap_or(u64::MAX) + 1;
    let file = File::open(path).map_err(system("open it", path))?;
    file.take(limit)
        .read_to_end(&mut content)
        .map_err(system("read it", path))?;
    Ok(content)
}

/// The names of what is in a folder; none where there is no folder.
pub(crate) fn names(folder: &Path) -> Result<Vec<OsString>, LibraryError> {
    let files = loop {
        match fs::read_dir(folder) {
            // Not tried again by itself, as opening a file is.
            Err(error) if error.kind() == ErrorKind::Interrupted => {}
            Err(error) if error.kind() == ErrorKind::NotFound => return Ok(Vec::new()),
            files => break files.map_err(system("read the folder", folder))?,
        }
    };
    files
        .map(|file| Ok(file.map_err(system("read the folder", folder))?.file_name()))
        .collect()
}

/// Puts a file in its place, whole: written and synced under another name in the same folder, then renamed, then the
/// folder synced. Nobody else may use that other name meanwhile; what lies there was left by a program that died.
///
/// After an error the old file is there as before, unless only the last step failed: then the new one is, but may be
/// gone after a power cut.
pub(crate) fn write(path: &Path, temporary: &Path, content: &[u8]) -> Result<(), LibraryError> {
    let written = write_new(temporary, path, content)
        .and_then(|()| fs::rename(temporary, path).map_err(system("put it in its place", path)));
    if let Err(error) = written {
        // What cannot be removed is swept away later.
        let _ = fs::remove_file(temporary);
        return Err(error);
    }
    sync(path.parent().unwrap_or(Path::new(".")))
}

/// A new file, synced. `path` is what it will be, which messages name.
fn write_new(temporary: &Path, path: &Path, content: &[u8]) -> Result<(), LibraryError> {
    let create = || File::options().write(true).create_new(true).open(temporary);
    let mut file = match create() {
        Err(error) if error.kind() == ErrorKind::AlreadyExists => {
            fs::remove_file(temporary).and_then(|()| create())
        }
        file => file,
    }
    .map_err(system("write into its folder", path))?;
    // A file that is replaced keeps who may read it.
    if let Ok(old) = fs::symlink_metadata(path) {
        file.set_permissions(old.permissions())
            .map_err(system("give it its permissions", path))?;
    }
    file.write_all(content).map_err(system("write it", path))?;
    file.sync_all().map_err(system("sync it", path))
}

/// Syncs a folder, so that what was renamed in it stays renamed.
pub(crate) fn sync(folder: &Path) -> Result<(), LibraryError> {
    // Only here can a folder be opened; elsewhere renaming is all that can be done.
    if !cfg!(unix) {
        return Ok(());
    }
    match File::open(folder).and_then(|opened| opened.sync_all()) {
        // A file system whose folders cannot be synced.
        Err(error)
            if matches!(
                error.kind(),
                ErrorKind::InvalidInput | ErrorKind::Unsupported
            ) =>
        {
            Ok(())
        }
        synced => synced.map_err(system(
            "sync the folder; it was changed, but a power cut may undo that",
            folder,
        )),
    }
}

/// Makes a folder with those above it, so that they last. A link to a folder is as good as one.
pub(crate) fn make_folder(path: &Path) -> Result<(), LibraryError> {
    if path.as_os_str().is_empty() || path.is_dir() {
        return Ok(());
    }
    let parent = path.parent().unwrap_or(Path::new(""));
    make_folder(parent)?;
    match fs::create_dir(path) {
        Err(error) if error.kind() == ErrorKind::AlreadyExists => {
            // Another program was faster, or something else has the name.
            if !path.is_dir() {
                let (path, what) = (path.to_owned(), "no folder");
                return Err(LibraryError::InTheWay {
                    path,
                    what,
                    expected: "a folder",
                });
            }
        }
        made => made.map_err(system("make the folder", path))?,
    }
    if parent.as_os_str().is_empty() {
        return sync(Path::new("."));
    }
    sync(parent)
}

/// The same for a folder inside the library, which must not lead out of it.
pub(crate) fn make_inner_folder(path: &Path) -> Result<(), LibraryError> {
    if fs::symlink_metadata(path).is_ok_and(|found| found.file_type().is_symlink()) {
        let (path, what) = (path.to_owned(), "a symbolic link");
        return Err(LibraryError::InTheWay {
            path,
            what,
            expected: "a folder",
        });
    }
    make_folder(path)
}
