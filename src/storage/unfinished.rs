//! Files that are whole or not there: written under another name in the same folder, and renamed when they are whole.

use std::fs::Permissions;
use std::io::{self, BufWriter};
use std::os::unix::fs::PermissionsExt;
use std::path::{Path, PathBuf};

use tempfile::NamedTempFile;

/// What happens to a file that is there already.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
#[non_exhaustive]
pub enum Existing {
    /// It is replaced. What is no regular file, a folder, a device or a link, never is.
    Replaced,
    /// It stays, and nothing is written.
    Kept,
}

/// A file that has another name until it is whole. Dropped, nothing is left of it.
#[derive(Debug)]
pub struct UnfinishedFile {
    path: PathBuf,
    existing: Existing,
    /// What is written here is its content.
    pub output: BufWriter<NamedTempFile>,
}

impl UnfinishedFile {
    /// Begins a file that will be at the path.
    ///
    /// # Errors
    /// Those of the system; [`io::ErrorKind::AlreadyExists`] where a file is there and is kept.
    pub fn new(path: &Path, existing: Existing) -> io::Result<Self> {
        // As files usually have them; those of temporary files are tighter.
        let mut permissions = Permissions::from_mode(0o666);
        // Said before the work rather than after it.
        match (existing, path.symlink_metadata()) {
            (_, Ok(found)) if !found.file_type().is_file() => {
                let message = "not a regular file, and only such a one is replaced";
                return Err(io::Error::other(message));
            }
            (Existing::Kept, Ok(_)) => return Err(io::ErrorKind::AlreadyExists.into()),
            // What others may not read they may not read afterwards either.
            (Existing::Replaced, Ok(found)) => permissions = found.permissions(),
            _ => {}
        }
        let folder = match path.parent() {
            Some(folder) if !folder.as_os_str().is_empty() => folder,
            _ => Path::new("."),
        };
        // A folder that is not there is told of without the name that the file would have had in it.
        folder.metadata()?;
        let file = tempfile::Builder::new()
            .prefix(".taxel-")
            .permissions(permissions)
            .tempfile_in(folder)
            // Its message would name a file that nobody has asked for.
            .map_err(|error| io::Error::from(error.kind()))?;
        Ok(Self {
            path: path.to_owned(),
            existing,
            output: BufWriter::new(file),
        })
    }

    /// Where it will be.
    pub fn path(&self) -> &Path {
        &self.path
    }

    /// The file, written and synced.
    ///
    /// # Errors
    /// Those of the system.
    pub fn finish(self) -> io::Result<FinishedFile> {
        let file = self.output.into_inner();
        let file = file.map_err(io::IntoInnerError::into_error)?;
        file.as_file().sync_all()?;
        Ok(FinishedFile {
            path: self.path,
            existing: self.existing,
            file,
        })
    }
}

/// A file that lacks only its name. Dropped, nothing is left of it.
#[derive(Debug)]
pub struct FinishedFile {
    path: PathBuf,
    existing: Existing,
    file: NamedTempFile,
}

impl FinishedFile {
    /// Where it will be.
    pub fn path(&self) -> &Path {
        &self.path
    }

    /// The file takes its name.
    ///
    /// # Errors
    /// Those of the system.
    pub fn persist(self) -> io::Result<()> {
        let named = match self.existing {
            Existing::Replaced => self.file.persist(&self.path),
            Existing::Kept => self.file.persist_noclobber(&self.path),
        };
        named.map(drop).map_err(|failed| failed.error)
    }
}
