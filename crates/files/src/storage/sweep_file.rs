//! The files that a sweep writes: its atlas, in the format given by the extension of the name, and the atlas number
//! of every pose.
//!
//! At any time, either the complete new file or the complete old one exists ([`NewFile`]).

use std::ffi::OsString;
use std::io::{self, BufReader, Cursor, Seek, SeekFrom, Write};
use std::ops::ControlFlow;
use std::path::{Path, PathBuf};

use taxel_core::pose::PoseGrid;
use taxel_core::progress::stop_if;
use taxel_core::sweep::SweepResult;

use crate::error::ReadError;
use crate::formats::atlas::{self, write_csv, write_jsonl};
use crate::formats::file::has_ending;
use crate::formats::numpy::{self, Number};
use crate::storage::error::FileError;
use crate::storage::file::{Existing, NewFile, open, wrong};

/// The path of an atlas; its extension gives the format.
///
/// # Errors
/// If no format has this extension.
pub fn atlas_path(path: impl Into<OsString>) -> Result<PathBuf, &'static str> {
    let path = PathBuf::from(path.into());
    let endings = ["csv", "jsonl", "npz"];
    if endings.iter().any(|ending| has_ending(&path, ending)) {
        return Ok(path);
    }
    Err("expected a name that ends in .csv, .jsonl or .npz")
}

/// Writes the atlas of a result without giving the file its name yet, so that several files can appear together.
///
/// # Errors
/// The system's error.
pub fn write_atlas(
    path: &Path,
    result: &SweepResult,
    existing: Existing,
) -> Result<NewFile, FileError> {
    let mut file = NewFile::begin(path, existing)?;
    let written = if has_ending(path, "csv") {
        write_csv(result, &mut file.output)
    } else if has_ending(path, "jsonl") {
        write_jsonl(result, &mut file.output)
    } else {
        let mut archive = Cursor::new(Vec::new());
        // Made in memory: if the disk is full, a zip complains on standard error, where the screen is.
        let made = atlas::write(result, &mut archive).map_err(io::Error::other);
        made.and_then(|()| file.output.write_all(archive.get_ref()))
    };
    written.map_err(FileError::cannot("write", path))?;
    file.finish()?;
    Ok(file)
}

/// Reads the atlas of an archive.
///
/// # Errors
/// Returns an error with the file's name if the file cannot be read or is not an atlas.
pub fn load_atlas(path: &Path) -> Result<SweepResult, ReadError> {
    let file = open(path)?;
    atlas::read(BufReader::new(file)).map_err(|error| wrong(path, error))
}

/// A file with the atlas number of every pose: `uint32` in an array shaped angles × y0 × x0, preceded by the zooms
/// (y, then x) if there are several.
///
/// The array is that of a whole grid, so the rows must come from a sweep of the whole grid, not of a shard.
///
/// ```
/// use taxel_core::prelude::*;
/// use taxel_files::storage::{Existing, PoseFile};
///
/// # let folder = tempfile::tempdir()?;
/// # let path = folder.path().join("poses.npy");
/// let hexagon = Source::Figure(Figure::default_of(FigureKind::Hexagon, &Sensor::default()));
/// let ranges = Ranges::default().with(Axis::Angle, "0".parse()?);
/// let grid = PoseGrid::new(hexagon, Sensor::default(), Anchor::Centre, ranges)?;
/// let mut file = PoseFile::new(&path, &grid, Existing::Kept)?;
/// let result = Sweep::new(&grid).run_with_rows(&mut |row, ids| file.take(row, ids));
/// if let Some(whole) = file.finish()? {
///     whole.persist()?;
/// }
/// # assert!(result.complete() && path.exists());
/// # Ok::<(), Box<dyn std::error::Error>>(())
/// ```
#[derive(Debug)]
pub struct PoseFile {
    file: NewFile,
    start: u64,
    missing: u64,
    error: Option<io::Error>,
}

impl PoseFile {
    /// Begins a file for the poses of a grid.
    ///
    /// # Errors
    /// The system's error.
    pub fn new(
        path: impl Into<PathBuf>,
        grid: &PoseGrid,
        existing: Existing,
    ) -> Result<Self, FileError> {
        let mut file = NewFile::begin(&path.into(), existing)?;
        let mut shape = grid.counts().into_array();
        shape.reverse();
        let header = match shape {
            [1, 1, angles, rows, columns] => numpy::header(Number::U32, &[angles, rows, columns]),
            _ => numpy::header(Number::U32, &shape),
        };
        let error = file.output.write_all(&header).err();
        Ok(Self {
            file,
            start: header.len() as u64,
            missing: grid.rows(),
            error,
        })
    }

    /// Writes a row of the grid: its number and the atlas numbers of its poses. Takes each row once, in any order. If
    /// it cannot be written, returns `Break`, as for each row from then on, and [`Self::finish`] returns the error.
    pub fn take(&mut self, row: u64, ids: &[u32]) -> ControlFlow<()> {
        if self.error.is_none() {
            self.error = self.write_row(row, ids).err();
            self.missing = self.missing.saturating_sub(1);
        }
        stop_if(self.error.is_some())
    }

    fn write_row(&mut self, row: u64, ids: &[u32]) -> io::Result<()> {
        let output = &mut self.file.output;
        output.seek(SeekFrom::Start(self.start + row * ids.len() as u64 * 4))?;
        ids.iter()
            .try_for_each(|id| output.write_all(&id.to_le_bytes()))
    }

    /// Completes the file, without giving it its name yet. Returns None if rows are missing, because the sweep was
    /// stopped or was one of a shard; then nothing is left of the file, and neither is if it is dropped instead.
    ///
    /// # Errors
    /// The first error.
    pub fn finish(mut self) -> Result<Option<NewFile>, FileError> {
        match self.error {
            Some(error) => Err(FileError::cannot("write", &self.file.path)(error)),
            None if self.missing > 0 => Ok(None),
            None => {
                self.file.finish()?;
                Ok(Some(self.file))
            }
        }
    }
}

#[cfg(test)]
mod tests {
    use taxel_core::figure::{Figure, FigureKind};
    use taxel_core::pose::{Anchor, Axis, Ranges};
    use taxel_core::sensor::Sensor;
    use taxel_core::source::Source;
    use taxel_core::sweep::{Shard, Sweep};

    use super::*;

    fn result() -> SweepResult {
        let ranges = Ranges::default().with(Axis::Angle, "0".parse().expect("a range"));
        let source = Source::Figure(Figure::default_of(FigureKind::Hexagon, &Sensor::default()));
        let grid = PoseGrid::new(source, Sensor::default(), Anchor::Corner, ranges);
        Sweep::new(&grid.expect("in range")).run()
    }

    fn files(folder: &Path) -> Vec<String> {
        let names = std::fs::read_dir(folder).expect("a folder").flatten();
        names
            .map(|file| file.file_name().to_string_lossy().into_owned())
            .collect()
    }

    #[test]
    fn a_file_is_whole_or_not_there() {
        let folder = tempfile::tempdir().expect("a folder");
        let result = result();
        for name in ["a.csv", "a.jsonl", "a.npz"] {
            let path = folder.path().join(name);
            assert_eq!(atlas_path(&path).as_ref(), Ok(&path));
            let write = |existing| {
                write_atlas(&path, &result, existing)
                    .and_then(NewFile::persist)
                    .map(drop)
            };
            let dropped = write_atlas(&path, &result, Existing::Kept).expect("written");
            drop(dropped);
            assert_eq!(files(folder.path()), [""; 0], "nothing is left");
            write(Existing::Kept).expect("written");
            let first = std::fs::read(&path).expect("it is there");
            assert!(write(Existing::Kept).expect_err("it is there").exists());
            write(Existing::Replaced).expect("written again");
            assert_eq!(std::fs::read(&path).ok(), Some(first));
            std::fs::remove_file(&path).expect("it is there");
        }
        assert!(atlas_path("a.txt").is_err() && atlas_path("csv").is_err());
        let nowhere = folder.path().join("nowhere/a.csv");
        let error = write_atlas(&nowhere, &result, Existing::Kept);
        let error = error.expect_err("there is no such folder").to_string();
        assert!(
            error.ends_with("a.csv: cannot write: no such folder"),
            "{error}"
        );
    }

    #[test]
    fn a_pose_file_without_all_rows_is_not_finished() {
        let folder = tempfile::tempdir().expect("a folder");
        let path = folder.path().join("poses.npy");
        let grid = result().grid;
        let swept = |shard: &str, go_on: bool| {
            let mut file = PoseFile::new(&path, &grid, Existing::Kept).expect("begun");
            let mut take = |row: u64, ids: &[u32]| file.take(row, ids);
            let shard: Shard = shard.parse().expect("a shard");
            let progress = |_| stop_if(!go_on);
            let sweep = Sweep::new(&grid).with_shard(shard).with_progress(&progress);
            sweep.run_with_rows(&mut take);
            file.finish().expect("no error").is_some()
        };
        let cases = [("1/1", true), ("1/1", false), ("1/2", true), ("2/2", true)];
        let finished = cases.map(|(shard, go_on)| swept(shard, go_on));
        assert_eq!(finished, [true, false, false, false]);
        assert_eq!(files(folder.path()), [""; 0], "nothing was named");
    }
}
