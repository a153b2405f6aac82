//! `taxel sweep` and `taxel merge`: a grid gone through, its atlas written, its statistics shown.
//!
//! Files are written under another name in the same folder and renamed when they are whole. An interrupt
//! stops a sweep at its next task; a second one ends the program at once.

use std::fs::File;
use std::io::{self, BufWriter, Seek, SeekFrom, Write};
use std::path::{Path, PathBuf};
use std::sync::Arc;
use std::sync::atomic::{AtomicBool, Ordering};
use std::time::Instant;

use tempfile::NamedTempFile;

use super::failure::Failure;
use super::locale::Charset;
use super::progress::Progress;
use super::summary::Summary;
use crate::formats::archive::{self, ArchiveError};
use crate::formats::atlas::{write_csv, write_jsonl};
use crate::formats::npy::{self, Kind};
use crate::sweep::grid::Grid;
use crate::sweep::plan::Shard;
use crate::sweep::survey::{Survey, Watch};

/// What a sweep or a merge is to leave.
#[derive(Clone, Debug)]
pub(super) struct Wanted {
    pub(super) atlas: Option<Table>,
    pub(super) poses: Option<PathBuf>,
    pub(super) json: bool,
    pub(super) quiet: bool,
}

/// Where an atlas goes, in the form that the name's ending tells.
#[derive(Clone, Debug)]
pub(super) struct Table {
    path: PathBuf,
    form: TableForm,
}

#[derive(Clone, Copy, Debug)]
enum TableForm {
    Csv,
    JsonLines,
    Archive,
}

impl Table {
    /// Reads a flag.
    pub(super) fn parse(text: &str) -> Result<Self, &'static str> {
        let path = PathBuf::from(text);
        let ending = path.extension().and_then(|ending| ending.to_str());
        let form = match ending {
            Some("csv") => TableForm::Csv,
            Some("jsonl") => TableForm::JsonLines,
            Some("npz") => TableForm::Archive,
            _ => return Err("expected a name that ends in .csv, .jsonl or .npz"),
        };
        Ok(Self { path, form })
    }

    fn write(&self, survey: &Survey) -> Result<(), Failure> {
        let mut file = Unfinished::new(&self.path)?;
        let written = match self.form {
            TableForm::Csv => write_csv(survey, &mut file.output).map_err(ArchiveError::from),
            TableForm::JsonLines => {
                write_jsonl(survey, &mut file.output).map_err(ArchiveError::from)
            }
            TableForm::Archive => archive::write(survey, &mut file.output),
        };
        written.map_err(|error| refused(&self.path, error))?;
        file.finish()
    }
}

fn refused(path: &Path, error: impl Into<ArchiveError>) -> Failure {
    Failure::Atlas {
        name: path.to_string_lossy().into_owned(),
        error: error.into(),
    }
}

/// A file that has another name until it is whole.
struct Unfinished<'a> {
    path: &'a Path,
    output: BufWriter<NamedTempFile>,
}

impl<'a> Unfinished<'a> {
    fn new(path: &'a Path) -> Result<Self, Failure> {
        let folder = match path.parent() {
            Some(folder) if !folder.as_os_str().is_empty() => folder,
            _ => Path::new("."),
        };
        let file = tempfile::Builder::new()
            .prefix(".taxel-")
            .permissions(permissions())
            .tempfile_in(folder);
        let output = BufWriter::new(file.map_err(|error| refused(path, error))?);
        Ok(Self { path, output })
    }

    fn finish(self) -> Result<(), Failure> {
        let path = self.path;
        let file = self
            .output
            .into_inner()
            .map_err(io::IntoInnerError::into_error);
        let file = file.map_err(|error| refused(path, error))?;
        file.as_file()
            .sync_all()
            .map_err(|error| refused(path, error))?;
        file.persist(path)
            .map_err(|error| refused(path, error.error))?;
        Ok(())
    }
}

/// As files usually have them; those of temporary files are tighter.
fn permissions() -> std::fs::Permissions {
    use std::os::unix::fs::PermissionsExt;
    std::fs::Permissions::from_mode(0o666)
}

/// Sweeps a shard of a grid on so many threads, and gives what is to be printed.
pub(super) fn sweep(
    grid: &Grid,
    shard: Shard,
    jobs: usize,
    wanted: &Wanted,
    charset: Charset,
) -> Result<String, Failure> {
    let start = Instant::now();
    let stopped = interrupts().map_err(Failure::Screen)?;
    let pool = rayon::ThreadPoolBuilder::new().num_threads(jobs).build();
    let pool = pool.map_err(|error| Failure::Screen(io::Error::other(error)))?;
    let mut poses = match &wanted.poses {
        Some(path) => Some(PoseFile::new(path, grid)?),
        None => None,
    };
    let rows = shard.rows(grid.rows());
    let all = (rows.end - rows.start) * grid.ranges().x0.count();
    let progress = Progress::new(all, wanted.quiet, charset);
    let tell = |poses: u64| {
        progress.add(poses);
        !stopped.load(Ordering::Relaxed)
    };
    let mut take = |row: u64, ids: &[u32]| {
        if let Some(file) = &mut poses {
            file.take(row, ids, &stopped);
        }
    };
    let watch = Watch {
        progress: &tell,
        rows: match wanted.poses {
            Some(_) => Some(&mut take),
            None => None,
        },
    };
    let survey = pool.install(|| Survey::of(grid, shard, watch));
    progress.finish();
    if let Some(file) = poses {
        file.finish(survey.complete())?;
    }
    if !survey.complete() {
        return Err(Failure::Stopped);
    }
    leave(&survey, start, wanted, charset)
}

/// Puts shards together, and gives what is to be printed.
pub(super) fn merge(
    files: &[PathBuf],
    wanted: &Wanted,
    charset: Charset,
) -> Result<String, Failure> {
    let start = Instant::now();
    let mut surveys = Vec::with_capacity(files.len());
    for path in files {
        let file = File::open(path).map_err(|error| refused(path, error))?;
        let survey = archive::read(io::BufReader::new(file));
        surveys.push(survey.map_err(|error| refused(path, error))?);
    }
    let survey = Survey::merge(surveys)?;
    leave(&survey, start, wanted, charset)
}

fn leave(
    survey: &Survey,
    start: Instant,
    wanted: &Wanted,
    charset: Charset,
) -> Result<String, Failure> {
    if let Some(table) = &wanted.atlas {
        table.write(survey)?;
    }
    let summary = Summary::new(survey, start.elapsed());
    Ok(if wanted.json {
        summary.json()
    } else {
        summary.text(charset)
    })
}

/// Set by an interrupt or a request to end; a second one ends the program as if nobody listened.
fn interrupts() -> io::Result<Arc<AtomicBool>> {
    use signal_hook::consts::{SIGINT, SIGTERM};
    let stopped = Arc::new(AtomicBool::new(false));
    for signal in [SIGINT, SIGTERM] {
        signal_hook::flag::register_conditional_shutdown(signal, 130, Arc::clone(&stopped))?;
        signal_hook::flag::register(signal, Arc::clone(&stopped))?;
    }
    Ok(stopped)
}

/// The atlas number of every pose, in an array shaped angles × y0 × x0, before that zooms where there are several.
struct PoseFile<'a> {
    file: Unfinished<'a>,
    start: u64,
    /// What went wrong first.
    error: Option<io::Error>,
    bytes: Vec<u8>,
}

impl<'a> PoseFile<'a> {
    fn new(path: &'a Path, grid: &Grid) -> Result<Self, Failure> {
        let mut file = Unfinished::new(path)?;
        let ranges = grid.ranges();
        let mut shape = [
            ranges.zoom_y,
            ranges.zoom_x,
            ranges.angle,
            ranges.y0,
            ranges.x0,
        ]
        .map(|range| range.count())
        .to_vec();
        if shape[..2] == [1, 1] {
            shape.drain(..2);
        }
        let header = npy::header(Kind::U32, &shape);
        file.output
            .write_all(&header)
            .map_err(|error| refused(path, error))?;
        Ok(Self {
            file,
            start: header.len() as u64,
            error: None,
            bytes: Vec::new(),
        })
    }

    fn take(&mut self, row: u64, ids: &[u32], stopped: &AtomicBool) {
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

    fn finish(self, complete: bool) -> Result<(), Failure> {
        match self.error {
            Some(error) => Err(refused(self.file.path, error)),
            None if complete => self.file.finish(),
            None => Ok(()),
        }
    }
}
