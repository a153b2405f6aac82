//! A folder for the temporary files of a running program.

use std::fs::{self, File};
use std::io;
use std::path::Path;

use crate::storage::error::FileError;
use crate::storage::temporary::{builder, is_left_over, plain, temporaries};

/// The name of the file in a temporary folder on which its program holds a lock. No library has such a file.
const SCRATCH_MARK: &str = ".taxel-scratch";

/// A folder that only its owner can look into, removed when this is dropped. Its program holds the lock on the file
/// [`SCRATCH_MARK`] in it: a folder whose lock is free was left by a program that died, and the next program removes
/// it. A folder without this file is something else, and stays.
#[derive(Debug)]
pub struct ScratchFolder {
    folder: tempfile::TempDir,
    /// The file with the lock; closing it releases the lock.
    _lock: File,
}

impl ScratchFolder {
    /// Creates a folder where the system keeps temporary ones.
    ///
    /// # Errors
    /// Returns the system's error.
    pub fn new() -> io::Result<Self> {
        Self::in_place(&std::env::temp_dir())
    }

    fn in_place(place: &Path) -> io::Result<Self> {
        for path in temporaries(place) {
            if path.is_dir() && is_left_over(&path.join(SCRATCH_MARK)).unwrap_or(false) {
                let _ = fs::remove_dir_all(path);
            }
        }
        let mut builder = builder();
        #[cfg(unix)]
        builder.permissions(std::os::unix::fs::PermissionsExt::from_mode(0o700));
        // The message names the folder that the user can change, not the temporary one.
        let refuse = |error: io::Error| {
            let doing = "make a folder for temporary files";
            let refused = FileError::new(doing, place, plain(&error));
            io::Error::new(refused.error.kind(), refused.to_string())
        };
        place.metadata().map_err(refuse)?;
        let folder = builder.tempdir_in(place).map_err(refuse)?;
        let lock = File::create(folder.path().join(SCRATCH_MARK))?;
        let _ = lock.try_lock();
        Ok(Self {
            folder,
            _lock: lock,
        })
    }

    /// Returns the path of the folder.
    pub fn path(&self) -> &Path {
        self.folder.path()
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::storage::lock::LOCK;
    use std::time::{Duration, SystemTime};

    /// A library has a lock, too, and perhaps a name like that of a temporary folder.
    #[test]
    fn a_library_is_not_taken_for_a_scratch_folder() {
        let place = tempfile::tempdir().expect("a folder");
        for name in [".taxel-shapes", ".taxel-tmp-AbC123AbC123AbC1"] {
            let library = place.path().join(name);
            fs::create_dir(&library).expect("made");
            let lock = File::create(library.join(LOCK)).expect("made");
            let hour = Duration::from_secs(3600);
            lock.set_modified(SystemTime::now() - hour).expect("aged");
            drop(ScratchFolder::in_place(place.path()).expect("made"));
            assert!(library.exists(), "{name}");
        }
    }

    #[cfg(unix)]
    #[test]
    fn only_its_owner_can_look_into_a_scratch_folder() {
        use std::os::unix::fs::PermissionsExt;
        let folder = ScratchFolder::new().expect("made");
        let path = folder.path().to_owned();
        let mode = path.metadata().expect("there").permissions().mode();
        assert_eq!(mode & 0o777, 0o700);
        drop(folder);
        assert!(!path.exists());
    }

    #[test]
    fn a_missing_folder_for_temporary_files_is_named() {
        let folder = tempfile::tempdir().expect("a folder");
        let place = folder.path().join("missing");
        let refused = ScratchFolder::in_place(&place).expect_err("refused");
        let expected = format!("{}: cannot make a folder", place.display());
        assert!(refused.to_string().starts_with(&expected), "{refused}");
        assert!(!refused.to_string().contains(".taxel-tmp"), "{refused}");
    }
}
