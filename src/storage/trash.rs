//! The trash inside a library: deleted shapes as `NUMBER NAME.json`, the newest with the highest number.

use std::fs;
use std::path::{Path, PathBuf};

use crate::formats::name::Name;
use crate::storage::error::FileError;
use crate::storage::folder;

/// The number of deleted shapes that are kept; older ones are removed for good.
pub const TRASH_KEPT: usize = 50;

/// A deleted shape's file.
pub(crate) struct DeletedShape {
    number: u64,
    /// The name it had.
    pub(crate) name: String,
    /// Its file in the trash.
    pub(crate) path: PathBuf,
}

/// The shapes in a trash when its folder was read.
pub(crate) struct Trash {
    folder: PathBuf,
    /// The oldest first.
    shapes: Vec<DeletedShape>,
}

impl Trash {
    /// Reads a trash; empty if its folder does not exist.
    pub(crate) fn read(folder: PathBuf) -> Result<Self, FileError> {
        let names = folder::names(&folder)?.into_iter();
        let shapes = names.filter_map(|name| DeletedShape::at(&folder.join(name)));
        let mut shapes: Vec<DeletedShape> = shapes.collect();
        shapes.sort_by_key(|shape| shape.number);
        Ok(Self { folder, shapes })
    }

    /// The shapes, the one deleted last first.
    pub(crate) fn newest_first(&self) -> impl Iterator<Item = &DeletedShape> {
        self.shapes.iter().rev()
    }

    /// The path for the next shape.
    pub(crate) fn next_path(&self, name: &str) -> PathBuf {
        let number = self.shapes.last().map_or(1, |last| last.number + 1);
        self.folder.join(format!("{number:010} {name}.json"))
    }

    /// Removes the oldest shapes, so that with the one just added [`TRASH_KEPT`] are left.
    pub(crate) fn forget_oldest(self) {
        let excess = self.shapes.len().saturating_sub(TRASH_KEPT - 1);
        for old in &self.shapes[..excess] {
            // One too many does no harm; the next deletion tries again.
            let _ = fs::remove_file(&old.path);
        }
    }
}

impl DeletedShape {
    /// None if the file's name is not that of a deleted shape.
    fn at(path: &Path) -> Option<Self> {
        let name = path.file_name()?.to_str()?.strip_suffix(".json")?;
        let (number, name) = name.split_once(' ')?;
        Some(Self {
            // There is always a next number.
            number: number.parse().ok().filter(|&number| number < u64::MAX)?,
            name: Name::new(name).ok()?.to_string(),
            path: path.to_owned(),
        })
    }
}
