//! The files that a sweep writes: its atlas, in the format given by the extension of the name, and the atlas number
//! of every pose.
//!
//! At any time, either the complete new file or the complete old one exists ([`crate::storage::file`]).

use std::fs::File;
use std::io::{self, BufReader, Seek, SeekFrom, Write};
use std::ops::ControlFlow;
use std::path::{Path, PathBuf};
use std::sync::atomic::{AtomicBool, Ordering};

use taxel_core::pose::PoseGrid;
use taxel_core::progress::stop_if;
use taxel_core::sweep::SweepResult;

use crate::formats::ArchiveError;
use crate::formats::atlas::{self, write_csv, write_jsonl};
use crate::formats::file::has_ending;
use crate::formats::npy::{self, Dtype};
use crate::storage::error::{ArchiveFileError, FileError};
use crate::storage::file::{Existing, NewFile, check_writable};

/// The file for an atlas: its path and its format.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct AtlasFile {
    path: PathBuf,
    format: AtlasFormat,
}

#[derive(Clone, Copy, Debug, PartialEq, Eq)]
enum AtlasFormat {
    Csv,
    JsonLines,
    Archive,
}

/// The error for a name without the ending of an atlas format.
#[derive(Clone, Debug, PartialEq, Eq, thiserror::Error)]
#[error("expected a name that ends in .csv, .jsonl or .npz")]
pub struct AtlasEndingError;

impl AtlasFile {
    /// Takes a path, whose extension gives the format. Creates nothing yet.
    ///
    /// # Errors
    /// If no format has this extension.
    pub fn new(path: impl Into<PathBuf>) -> Result<Self, AtlasEndingError> {
        let path = path.into();
        let formats = [
            ("csv", AtlasFormat::Csv),
            ("jsonl", AtlasFormat::JsonLines),
            ("npz", AtlasFormat::Archive),
        ];
        let mut formats = formats.into_iter();
        let found = formats.find(|(ending, _)| has_ending(&path, ending));
        let (_, format) = found.ok_or(AtlasEndingError)?;
        Ok(Self { path, format })
    }

    /// The path of the file.
    pub fn path(&self) -> &Path {
        &self.path
    }

    /// Checks whether a file can be begun there, so that an error comes before the work rather than after it.
    ///
    /// # Errors
    /// The system's error, with the file's name; also if a file exists and must be kept.
    pub fn check(&self, existing: Existing) -> Result<(), ArchiveFileError> {
        Ok(check_writable(&self.path, existing)?)
    }

    /// Writes the atlas of a result. Leaves nothing behind if `stopped` becomes true on the way.
    ///
    /// # Errors
    /// The system's error, with the file's name.
    pub fn write(
        &self,
        result: &SweepResult,
        existing: Existing,
        stopped: &AtomicBool,
    ) -> Result<(), ArchiveFileError> {
        self.prepare(result, existing, stopped)?.persist()?;
        Ok(())
    }

    /// Writes the atlas without giving the file its name yet, so that several files can appear together.
    ///
    /// # Errors
    /// The system's error, with the file's name.
    pub fn prepare(
        &self,
        result: &SweepResult,
        existing: Existing,
        stopped: &AtomicBool,
    ) -> Result<NewFile, ArchiveFileError> {
        let mut file = NewFile::begin(&self.path, existing)?;
        let mut output = FirstErrorWriter::new(&mut file.output, stopped);
        let written = match self.format {
            AtlasFormat::Csv => write_csv(result, &mut output).map_err(ArchiveError::from),
            AtlasFormat::JsonLines => write_jsonl(result, &mut output).map_err(ArchiveError::from),
            AtlasFormat::Archive => atlas::write(result, &mut output),
        };
        let written = output.finish(written);
        written.map_err(|error| ArchiveFileError::new(&self.path, error))?;
        file.finish()?;
        Ok(file)
    }
}

/// Reads the atlas of an archive.
///
/// # Errors
/// Returns an error with the file's name if the file cannot be read or is not an atlas.
pub fn load_atlas(path: &Path) -> Result<SweepResult, ArchiveFileError> {
    let file = open_archive(path)?;
    atlas::read(BufReader::new(file)).map_err(|error| ArchiveFileError::new(path, error))
}

/// Opens the file of an atlas or of a model. Refuses anything except a regular file, because opening a pipe waits for
/// a writer that may never come.
///
/// # Errors
/// The system's error, with the file's name.
pub fn open_archive(path: &Path) -> Result<File, ArchiveFileError> {
    let opened = path.metadata().and_then(|metadata| {
        if metadata.is_file() {
            File::open(path)
        } else {
            Err(io::Error::other("not a regular file"))
        }
    });
    opened.map_err(|error| ArchiveFileError::doing("read", path, &error))
}

/// Whether a file of that name can hold the atlas number of every pose: it ends in `.npy`, in upper or lower
/// case.
pub fn is_poses(name: impl AsRef<Path>) -> bool {
    has_ending(name, "npy")
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
    rows: u64,
    row_length: u64,
    missing: u64,
    error: Option<io::Error>,
    bytes: Vec<u8>,
}

impl PoseFile {
    /// Begins a file for the poses of a grid.
    ///
    /// # Errors
    /// The system's error, with the file's name.
    pub fn new(
        path: impl Into<PathBuf>,
        grid: &PoseGrid,
        existing: Existing,
    ) -> Result<Self, ArchiveFileError> {
        let mut file = NewFile::begin(&path.into(), existing)?;
        let mut shape = grid.counts().into_array();
        shape.reverse();
        let header = match shape {
            [1, 1, angles, rows, columns] => npy::header(Dtype::U32, &[angles, rows, columns]),
            _ => npy::header(Dtype::U32, &shape),
        };
        let begun = file.output.write_all(&header);
        begun.map_err(|error| FileError::new("write it", file.path(), error))?;
        Ok(Self {
            file,
            start: header.len() as u64,
            rows: grid.rows(),
            row_length: grid.row_length(),
            missing: grid.rows(),
            error: None,
            bytes: Vec::new(),
        })
    }

    /// Writes a row: its number in the grid and the atlas numbers of its poses. Takes each row once, in any order. If
    /// the row cannot be written, or is not one of the grid, returns `Break`, as for each row from then on, and
    /// [`Self::finish`] returns the error.
    pub fn take(&mut self, row: u64, ids: &[u32]) -> ControlFlow<()> {
        if self.error.is_none() {
            match self.write_row(row, ids) {
                Ok(()) => self.missing = self.missing.saturating_sub(1),
                Err(error) => self.error = Some(error),
            }
        }
        stop_if(self.error.is_some())
    }

    fn write_row(&mut self, row: u64, ids: &[u32]) -> io::Result<()> {
        let (rows, row_length) = (self.rows, self.row_length);
        let length = ids.len() as u64;
        if row >= rows || length != row_length {
            let error = format!(
                "row {row} with {length} numbers, expected {rows} rows of {row_length} numbers"
            );
            return Err(io::Error::new(io::ErrorKind::InvalidInput, error));
        }
        self.bytes.clear();
        self.bytes
            .extend(ids.iter().flat_map(|id| id.to_le_bytes()));
        let place = self.start + row * self.bytes.len() as u64;
        let output = &mut self.file.output;
        output.seek(SeekFrom::Start(place))?;
        output.write_all(&self.bytes)
    }

    /// Completes the file, without giving it its name yet. Returns None if rows are missing, because the sweep was
    /// stopped or was one of a shard; then nothing is left of the file, and neither is if it is dropped instead.
    ///
    /// # Errors
    /// The first error, with the file's name.
    pub fn finish(mut self) -> Result<Option<NewFile>, ArchiveFileError> {
        match self.error {
            Some(error) => Err(ArchiveFileError::new(self.file.path(), error)),
            None if self.missing > 0 => Ok(None),
            None => {
                self.file.finish()?;
                Ok(Some(self.file))
            }
        }
    }
}

/// A writer that stops writing at the first error, or when it is to stop. From then on it only counts what would have
/// been written, since a zip whose writer fails complains on standard error, where the screen is.
pub(crate) struct FirstErrorWriter<'a, W> {
    output: W,
    stopped: &'a AtomicBool,
    error: Option<io::Error>,
    place: u64,
    end: u64,
}

impl<'a, W: Write + Seek> FirstErrorWriter<'a, W> {
    pub(crate) fn new(output: W, stopped: &'a AtomicBool) -> Self {
        Self {
            output,
            stopped,
            error: None,
            place: 0,
            end: 0,
        }
    }

    /// The first error of the system or of stopping, otherwise `written`, the result of the function that
    /// wrote: it may not have noticed that error.
    pub(crate) fn finish<E: From<io::Error>>(self, written: Result<(), E>) -> Result<(), E> {
        match self.error {
            Some(error) => Err(error.into()),
            None => written,
        }
    }

    fn attempt<T>(&mut self, act: impl FnOnce(&mut W) -> io::Result<T>) -> Option<T> {
        if self.stopped.load(Ordering::Relaxed) && self.error.is_none() {
            self.error = Some(io::Error::other("stopped"));
        }
        if self.error.is_some() {
            return None;
        }
        act(&mut self.output)
            .map_err(|error| self.error = Some(error))
            .ok()
    }
}

impl<W: Write + Seek> Write for FirstErrorWriter<'_, W> {
    fn write(&mut self, bytes: &[u8]) -> io::Result<usize> {
        let _ = self.attempt(|output| output.write_all(bytes));
        self.place += bytes.len() as u64;
        self.end = self.end.max(self.place);
        Ok(bytes.len())
    }

    fn flush(&mut self) -> io::Result<()> {
        let _ = self.attempt(Write::flush);
        Ok(())
    }
}

impl<W: Write + Seek> Seek for FirstErrorWriter<'_, W> {
    fn seek(&mut self, to: SeekFrom) -> io::Result<u64> {
        let _ = self.attempt(|output| output.seek(to));
        let place = match to {
            SeekFrom::Start(place) => Some(place),
            SeekFrom::End(by) => self.end.checked_add_signed(by),
            SeekFrom::Current(by) => self.place.checked_add_signed(by),
        };
        self.place = place.ok_or(io::ErrorKind::InvalidInput)?;
        Ok(self.place)
    }
}

#[cfg(test)]
mod tests {
    use taxel_core::figure::{Figure, FigureKind};
    use taxel_core::index::index;
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

    fn whole(path: &Path, grid: &PoseGrid, existing: Existing) -> NewFile {
        let mut file = PoseFile::new(path, grid, existing).expect("begun");
        let ids = vec![7; index(grid.row_length())];
        let taken = (0..grid.rows()).try_for_each(|row| file.take(row, &ids));
        assert!(taken.is_continue());
        file.finish().expect("written").expect("all rows")
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
            let file = AtlasFile::new(&path).expect("a format");
            let stopped = AtomicBool::new(true);
            let refused = file.write(&result, Existing::Kept, &stopped);
            let refused = refused.expect_err("stopped").to_string();
            assert!(refused.contains("stopped"), "{refused}");
            assert_eq!(files(folder.path()), [""; 0], "nothing is left");
            let stopped = AtomicBool::new(false);
            file.write(&result, Existing::Kept, &stopped)
                .expect("written");
            let first = std::fs::read(&path).expect("it is there");
            let again = file.write(&result, Existing::Kept, &stopped);
            assert!(again.expect_err("it is there").exists());
            file.write(&result, Existing::Replaced, &stopped)
                .expect("written again");
            assert_eq!(std::fs::read(&path).ok(), Some(first));
            std::fs::remove_file(&path).expect("it is there");
        }
        let refused = ["a.txt", "csv"].map(|name| AtlasFile::new(name).err());
        assert_eq!(refused, [const { Some(AtlasEndingError) }; 2]);
        let nowhere = folder.path().join("nowhere/a.csv");
        let nowhere = AtlasFile::new(nowhere).expect("a format");
        let stopped = AtomicBool::new(false);
        let error = nowhere.write(&result, Existing::Kept, &stopped);
        let error = error.expect_err("there is no such folder").to_string();
        assert!(
            error.ends_with("a.csv: cannot write: no such folder"),
            "{error}"
        );
    }

    #[test]
    fn a_file_that_came_meanwhile_is_kept() {
        let folder = tempfile::tempdir().expect("a folder");
        let path = folder.path().join("poses.npy");
        let result = result();
        let whole = whole(&path, &result.grid, Existing::Kept);
        std::fs::write(&path, "mine").expect("written");
        assert!(whole.persist().expect_err("it is there").exists());
        assert_eq!(std::fs::read(&path).ok().as_deref(), Some(&b"mine"[..]));
        assert_eq!(files(folder.path()), ["poses.npy"]);
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

    #[test]
    fn a_row_that_the_grid_does_not_have_is_an_error() {
        let folder = tempfile::tempdir().expect("a folder");
        let path = folder.path().join("poses.npy");
        let grid = result().grid;
        for (row, length) in [(100, 100), (u64::MAX, 100), (0, 99), (0, 0)] {
            let mut file = PoseFile::new(&path, &grid, Existing::Kept).expect("begun");
            assert!(file.take(row, &vec![0; length]).is_break());
            let first = vec![0; index(grid.row_length())];
            assert!(file.take(0, &first).is_break(), "it stays so");
            let error = file.finish().expect_err("no such row").to_string();
            let expected = format!(
                "poses.npy: row {row} with {length} numbers, expected 100 rows of 100 numbers"
            );
            assert!(error.ends_with(&expected), "{error}");
        }
    }
}
