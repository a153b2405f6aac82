//! The trash inside a library: deleted shapes as `NUMBER NAME.json`, the newest with the highest number.

use std::fs;
use std::path::{Path, PathBuf};

use crate::formats::name::Name;
use crate::storage::error::{FileError, LibraryError};
use crate::storage::folder::{InnerFolder, TRASH};

/// The number of deleted shapes that are kept; older ones are removed for good.
pub const TRASH_KEPT: usize = 50;

/// The highest number of a deleted shape: ten digits, so that names sort by number. No trash comes near it, but anyone
/// can put a file there.
const LAST_NUMBER: u64 = 9_999_999_999;

/// The file of a deleted shape.
pub(crate) struct DeletedShape {
    number: u64,
    /// The name of the shape.
    pub(crate) name: String,
    /// The path of its file in the trash.
    pub(crate) path: PathBuf,
}

/// The shapes that were in a trash when its folder was read.
pub(crate) struct Trash {
    folder: InnerFolder,
    /// The shapes, the oldest first.
    shapes: Vec<DeletedShape>,
}

impl Trash {
    /// Reads the trash of a library; empty if its folder does not exist.
    ///
    /// # Errors
    /// Returns an error if the folder is a link or cannot be read.
    pub(crate) fn read(library: &Path) -> Result<Self, LibraryError> {
        Self::in_folder(InnerFolder::of(library, TRASH)?)
    }

    /// Reads the trash of a library, and makes its folder if there is none.
    ///
    /// # Errors
    /// Returns an error if the folder is a link or cannot be made or read.
    pub(crate) fn made(library: &Path) -> Result<Self, LibraryError> {
        let folder = InnerFolder::of(library, TRASH)?;
        folder.make()?;
        Self::in_folder(folder)
    }

    fn in_folder(folder: InnerFolder) -> Result<Self, LibraryError> {
        let paths = folder.paths()?.into_iter();
        let mut shapes: Vec<DeletedShape> = paths.filter_map(DeletedShape::at).collect();
        shapes.sort_by_key(|shape| shape.number);
        Ok(Self { folder, shapes })
    }

    /// Returns the path of the folder.
    pub(crate) fn folder(&self) -> &Path {
        self.folder.path()
    }

    /// Iterates over the shapes, the last deleted first.
    pub(crate) fn newest_first(&self) -> impl Iterator<Item = &DeletedShape> {
        self.shapes.iter().rev()
    }

    /// Returns the path for the next shape. If the highest number is taken, the shapes are renumbered from 1.
    ///
    /// # Errors
    /// Returns the system's error for a file that could not be renamed.
    pub(crate) fn next_path(&mut self, name: &str) -> Result<PathBuf, FileError> {
        let last = self.shapes.last().map_or(0, |last| last.number);
        if last >= LAST_NUMBER {
            self.renumber()?;
        }
        let number = self.shapes.last().map_or(1, |last| last.number + 1);
        Ok(self.path(number, name))
    }

    fn path(&self, number: u64, name: &str) -> PathBuf {
        let file = format!("{number:010} {name}.json");
        self.folder().join(file)
    }

    /// Numbers the shapes from 1, the oldest first.
    fn renumber(&mut self) -> Result<(), FileError> {
        let paths: Vec<PathBuf> = (1..)
            .zip(&self.shapes)
            .map(|(number, shape)| self.path(number, &shape.name))
            .collect();
        for ((number, shape), path) in (1..).zip(&mut self.shapes).zip(paths) {
            // In this order no file is replaced: a number never rises, and lower ones have moved already.
            if shape.number > number {
                fs::rename(&shape.path, &path)
                    .map_err(|error| FileError::new("renumber it", &shape.path, error))?;
                (shape.number, shape.path) = (number, path);
            }
        }
        Ok(())
    }

    /// Removes the oldest shapes, so that [`TRASH_KEPT`] are left, together with the one just added.
    pub(crate) fn forget_oldest(self) {
        let excess = self.shapes.len().saturating_sub(TRASH_KEPT - 1);
        for old in &self.shapes[..excess] {
            // One too many does no harm; the next deletion tries again.
            let _ = fs::remove_file(&old.path);
        }
    }
}

impl DeletedShape {
    /// Returns the deleted shape at a path; None if the file's name is not that of a deleted shape.
    fn at(path: PathBuf) -> Option<Self> {
        let name = path.file_name()?.to_str()?.strip_suffix(".json")?;
        let (number, name) = name.split_once(' ')?;
        Some(Self {
            number: number
                .parse()
                .ok()
                .filter(|number| *number <= LAST_NUMBER)?,
            name: Name::new(name).ok()?.to_string(),
            path,
        })
    }
}
