//! The files that a sweep writes: its atlas, in the format given by the extension of the name, and the atlas number
//! of every pose.
//!
//! At any time, either the complete new file or the old one is there ([`crate::storage::atomic_file`]).

use std::fs::File;
use std::io::{self, BufReader, Seek, SeekFrom, Write};
use std::path::{Path, PathBuf};
use std::sync::atomic::{AtomicBool, Ordering};

use crate::formats::atlas::{write_csv, write_jsonl};
use crate::formats::npy::Dtype;
use crate::formats::{ArchiveError, archive, npy};
use crate::pose::PoseGrid;
use crate::storage::atomic_file::{Existing, FinishedFile, UnfinishedFile};
use crate::storage::error::FileError;
use crate::storage::first_error::FirstErrorWriter;
use crate::sweep::SweepResult;

/// The error for a file of a sweep or a model that cannot be written or read.
#[derive(Debug, thiserror::Error)]
#[non_exhaustive]
#[error("{name}: {error}")]
pub struct ArchiveFileError {
    /// The file's name.
    pub name: String,
    /// The problem.
    pub error: ArchiveError,
}

impl From<FileError> for ArchiveFileError {
    /// Converts the error of a file or folder that is written.
    fn from(error: FileError) -> Self {
        let path = error.path.clone();
        Self::doing("write", &path, &error.into_io())
    }
}

impl ArchiveFileError {
    /// Creates an error about a file.
    pub(crate) fn new(path: &Path, error: impl Into<ArchiveError>) -> Self {
        Self {
            name: path.to_string_lossy().into_owned(),
            error: error.into(),
        }
    }

    /// Creates the error for an operation that the system refused, in words that follow "cannot".
    pub(crate) fn doing(doing: &str, path: &Path, error: &io::Error) -> Self {
        let text = format!("cannot {doing}: {error}");
        Self::new(path, io::Error::new(error.kind(), text))
    }

    /// Returns true if there is no such file.
    pub fn is_missing(&self) -> bool {
        matches!(&self.error, ArchiveError::Io(error) if error.kind() == io::ErrorKind::NotFound)
    }

    /// Returns true if a file of that name is there already, and was to be kept.
    pub fn exists(&self) -> bool {
        matches!(&self.error, ArchiveError::Io(error) if error.kind() == io::ErrorKind::AlreadyExists)
    }
}

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
#[non_exhaustive]
pub struct AtlasEndingError;

impl AtlasFile {
    /// Takes a path, whose extension gives the format. Creates nothing yet.
    ///
    /// # Errors
    /// Returns an error if no format has this extension.
    pub fn new(path: impl Into<PathBuf>) -> Result<Self, AtlasEndingError> {
        let path = path.into();
        let ending = path.extension().and_then(|ending| ending.to_str());
        let ending = ending.map(str::to_ascii_lowercase);
        let format = match ending.as_deref() {
            Some("csv") => AtlasFormat::Csv,
            Some("jsonl") => AtlasFormat::JsonLines,
            Some("npz") => AtlasFormat::Archive,
            _ => return Err(AtlasEndingError),
        };
        Ok(Self { path, format })
    }

    /// Returns true if it is an archive, which can be read again.
    pub fn is_archive(&self) -> bool {
        self.format == AtlasFormat::Archive
    }

    /// Returns the path of the file.
    pub fn path(&self) -> &Path {
        &self.path
    }

    /// Checks whether a file can be begun there, so that an error comes before the work rather than after it.
    ///
    /// # Errors
    /// Returns the system's error, with the file's name; also if a file is there and is to be kept.
    pub fn check(&self, existing: Existing) -> Result<(), ArchiveFileError> {
        UnfinishedFile::new(&self.path, existing)?;
        Ok(())
    }

    /// Writes the atlas of a result. Leaves nothing behind if `stopped` becomes true on the way.
    ///
    /// # Errors
    /// Returns the system's error, with the file's name.
    pub fn write(
        &self,
        result: &SweepResult,
        existing: Existing,
        stopped: &AtomicBool,
    ) -> Result<(), ArchiveFileError> {
        Ok(self.prepare(result, existing, stopped)?.persist()?)
    }

    /// Writes the atlas without giving the file its name yet, so that several files can appear together.
    ///
    /// # Errors
    /// Returns the system's error, with the file's name.
    pub fn prepare(
        &self,
        result: &SweepResult,
        existing: Existing,
        stopped: &AtomicBool,
    ) -> Result<FinishedFile, ArchiveFileError> {
        let mut file = UnfinishedFile::new(&self.path, existing)?;
        let mut output = FirstErrorWriter::new(&mut file.output, u64::MAX, stopped);
        let written = match self.format {
            AtlasFormat::Csv => write_csv(result, &mut output).map_err(ArchiveError::from),
            AtlasFormat::JsonLines => write_jsonl(result, &mut output).map_err(ArchiveError::from),
            AtlasFormat::Archive => archive::write(result, &mut output),
        };
        let written = output.finish(written);
        written.map_err(|error| ArchiveFileError::new(&self.path, error))?;
        Ok(file.finish()?)
    }
}

/// Reads the atlas of an archive.
///
/// # Errors
/// Returns an error with the file's name if the file cannot be read or is not an atlas.
pub fn load_atlas(path: &Path) -> Result<SweepResult, ArchiveFileError> {
    let file = open_archive(path)?;
    archive::read(BufReader::new(file)).map_err(|error| ArchiveFileError::new(path, error))
}

/// Opens the file of an atlas or of a model. Refuses anything except a regular file, because opening a pipe waits for
/// a writer that may never come.
///
/// # Errors
/// Returns the system's error, with the file's name.
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

/// Returns true if a file of that name can hold the atlas number of every pose: it ends in `.npy`, in upper or lower
/// case.
pub fn is_poses(name: impl AsRef<Path>) -> bool {
    name.as_ref()
        .extension()
        .is_some_and(|ending| ending.eq_ignore_ascii_case("npy"))
}

/// A file with the atlas number of every pose: `uint32` in an array shaped angles × y0 × x0, preceded by the zooms
/// (y, then x) if there are several.
#[derive(Debug)]
pub struct PoseFile {
    file: UnfinishedFile,
    start: u64,
    /// The first error.
    error: Option<io::Error>,
    bytes: Vec<u8>,
}

impl PoseFile {
    /// Begins a file for the poses of a grid.
    ///
    /// # Errors
    /// Returns the system's error, with the file's name.
    pub fn new(
        path: impl Into<PathBuf>,
        grid: &PoseGrid,
        existing: Existing,
    ) -> Result<Self, ArchiveFileError> {
        let mut file = UnfinishedFile::new(&path.into(), existing)?;
        let mut shape = grid.counts().into_array();
        shape.reverse();
        let header = match shape {
            [1, 1, angles, rows, columns] => npy::header(Dtype::U32, &[angles, rows, columns]),
            _ => npy::header(Dtype::U32, &shape),
        };
        file.write(&header)?;
        Ok(Self {
            file,
            start: header.len() as u64,
            error: None,
            bytes: Vec::new(),
        })
    }

    /// Writes a row: its number in the grid and the atlas numbers of its poses. All rows have the same length. If the
    /// row cannot be written, `stopped` becomes true.
    pub fn take(&mut self, row: u64, ids: &[u32], stopped: &AtomicBool) {
        if self.error.is_some() {
            return;
        }
        self.bytes.clear();
        self.bytes
            .extend(ids.iter().flat_map(|id| id.to_le_bytes()));
        let place = self.start + row * self.bytes.len() as u64;
        let output = &mut self.file.output;
        let written = output
            .seek(SeekFrom::Start(place))
            .and_then(|_| output.write_all(&self.bytes));
        if let Err(error) = written {
            self.error = Some(error);
            stopped.store(true, Ordering::Relaxed);
        }
    }

    /// Completes the file when all rows were taken, without giving it its name yet. If it is dropped instead, nothing
    /// is left of it.
    ///
    /// # Errors
    /// Returns the first error, with the file's name.
    pub fn finish(self) -> Result<FinishedFile, ArchiveFileError> {
        match self.error {
            Some(error) => Err(ArchiveFileError::new(self.file.path(), error)),
            None => Ok(self.file.finish()?),
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::figure::{Figure, FigureKind};
    use crate::pose::{Anchor, Axis, Ranges};
    use crate::sensor::Sensor;
    use crate::source::Source;
    use crate::storage::persist_pair;
    use crate::sweep::Sweep;

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
            let file = AtlasFile::new(&path).expect("a format");
            let stopped = AtomicBool::new(true);
            let refused = file.write(&result, Existing::Kept, &stopped);
            let refused = refused.expect_err("stopped").to_string();
            assert!(refused.contains("stopped"), "{refused}");
            assert_eq!(files(folder.path()), [""; 0], "nothing is left");
            let going = AtomicBool::new(false);
            file.write(&result, Existing::Kept, &going)
                .expect("written");
            let first = std::fs::read(&path).expect("it is there");
            let again = file.write(&result, Existing::Kept, &going);
            assert!(again.expect_err("it is there").exists());
            file.write(&result, Existing::Replaced, &going)
                .expect("written again");
            assert_eq!(std::fs::read(&path).ok(), Some(first));
            std::fs::remove_file(&path).expect("it is there");
        }
        let refused = ["a.txt", "csv"].map(|name| AtlasFile::new(name).err());
        assert_eq!(refused, [const { Some(AtlasEndingError) }; 2]);
        let nowhere = folder.path().join("nowhere/a.csv");
        let nowhere = AtlasFile::new(nowhere).expect("a format");
        let going = AtomicBool::new(false);
        let error = nowhere.write(&result, Existing::Kept, &going);
        let error = error.expect_err("there is no such folder").to_string();
        assert!(
            error.ends_with("a.csv: cannot write: No such file or directory (os error 2)"),
            "{error}"
        );
    }

    #[test]
    fn a_pair_is_never_of_two_sweeps() {
        let folder = tempfile::tempdir().expect("a folder");
        let result = result();
        let going = AtomicBool::new(false);
        let (atlas, poses) = (folder.path().join("a.csv"), folder.path().join("a.npy"));
        let pair = |existing| {
            let file = AtlasFile::new(&atlas).expect("a format");
            let first = file.prepare(&result, existing, &going).expect("written");
            let second = PoseFile::new(&poses, &result.grid, existing).expect("begun");
            (first, second.finish().expect("written"))
        };
        let (first, second) = pair(Existing::Kept);
        std::fs::write(&poses, "theirs").expect("written");
        let refused = persist_pair(first, second).expect_err("one is there");
        assert!(refused.exists() && !atlas.exists(), "neither is named");
        std::fs::write(&atlas, "old").expect("written");
        let (first, second) = pair(Existing::Replaced);
        // The program dies after the first step: the old poses are gone, the old atlas is there.
        std::fs::remove_file(&poses).expect("there");
        assert_eq!(std::fs::read_to_string(&atlas).ok().as_deref(), Some("old"));
        persist_pair(first, second).expect("named");
        assert!(std::fs::read(&poses).is_ok_and(|bytes| bytes.starts_with(b"\x93NUMPY")));
        assert!(std::fs::read_to_string(&atlas).is_ok_and(|text| text.starts_with("id,")));
    }

    /// Programs that replace one pair at once take turns.
    #[test]
    fn a_pair_comes_from_one_program_even_if_several_write_it_at_once() {
        let folder = tempfile::tempdir().expect("a folder");
        let paths = [folder.path().join("a.csv"), folder.path().join("a.npy")];
        let write = |number: u32| {
            let [first, second] = paths.each_ref().map(|path| {
                let mut file = UnfinishedFile::new(path, Existing::Replaced).expect("begun");
                file.write(number.to_string().as_bytes()).expect("written");
                file.finish().expect("synced")
            });
            persist_pair(first, second).expect("named");
        };
        for round in 0..20 {
            std::thread::scope(|scope| {
                for thread in 0..4 {
                    let write = &write;
                    scope.spawn(move || write(4 * round + thread));
                }
            });
            let [first, second] = paths.each_ref().map(std::fs::read_to_string);
            assert_eq!(first.expect("there"), second.expect("there"));
        }
    }

    #[test]
    fn a_pair_whose_second_file_cannot_be_named_leaves_neither() {
        let folder = tempfile::tempdir().expect("a folder");
        let (atlas, elsewhere) = (folder.path().join("a.csv"), folder.path().join("gone"));
        let (result, going) = (result(), AtomicBool::new(false));
        for existing in [Existing::Kept, Existing::Replaced] {
            std::fs::create_dir(&elsewhere).expect("made");
            let file = AtlasFile::new(&atlas).expect("a format");
            let first = file.prepare(&result, existing, &going).expect("written");
            let second = PoseFile::new(elsewhere.join("a.npy"), &result.grid, existing);
            let second = second.expect("begun").finish().expect("written");
            std::fs::remove_dir_all(&elsewhere).expect("removed");
            let refused = persist_pair(first, second).expect_err("its folder is gone");
            assert!(refused.is_missing(), "{refused}");
            assert_eq!(files(folder.path()), [""; 0], "neither is there");
        }
    }

    #[test]
    fn a_pair_that_cannot_be_named_leaves_the_old_files() {
        let (result, going) = (result(), AtomicBool::new(false));
        for (first, second) in [("gone/a.csv", "a.npy"), ("a.csv", "gone/a.npy")] {
            let folder = tempfile::tempdir().expect("a folder");
            let (atlas, poses) = (folder.path().join(first), folder.path().join(second));
            let elsewhere = folder.path().join("gone");
            std::fs::create_dir(&elsewhere).expect("made");
            for path in [&atlas, &poses] {
                std::fs::write(path, "old").expect("written");
            }
            let file = AtlasFile::new(&atlas).expect("a format");
            let first = file.prepare(&result, Existing::Replaced, &going);
            let second = PoseFile::new(&poses, &result.grid, Existing::Replaced);
            let second = second.expect("begun").finish().expect("written");
            std::fs::remove_dir_all(&elsewhere).expect("removed");
            let refused = persist_pair(first.expect("written"), second);
            let refused = refused.expect_err("a folder is gone");
            assert!(refused.is_missing(), "{refused}");
            let left = if atlas.exists() { atlas } else { poses };
            assert_eq!(std::fs::read_to_string(left).ok().as_deref(), Some("old"));
            assert_eq!(files(folder.path()).len(), 1, "nothing else is there");
        }
    }

    #[test]
    fn a_file_that_came_meanwhile_is_kept() {
        let folder = tempfile::tempdir().expect("a folder");
        let path = folder.path().join("poses.npy");
        let result = result();
        let file = PoseFile::new(&path, &result.grid, Existing::Kept).expect("begun");
        std::fs::write(&path, "mine").expect("written");
        let whole = file.finish().expect("written");
        assert!(whole.persist().expect_err("it is there").exists());
        assert_eq!(std::fs::read(&path).ok().as_deref(), Some(&b"mine"[..]));
        assert_eq!(files(folder.path()), ["poses.npy"]);
    }
}
