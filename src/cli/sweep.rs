//! `taxel sweep` and `taxel merge`: a grid gone through, its atlas written, its statistics shown.
//!
//! Files are written under another name in the same folder and renamed when they are whole. An interrupt stops a
//! sweep within some thousand poses and a file at its next block, and what is not whole is taken away; a second one
//! ends the program at once.

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

    /// Writes all of it under another name.
    fn write(&self, survey: &Survey, stopped: &Arc<AtomicBool>) -> Result<Whole<'_>, Failure> {
        let heeded = match self.form {
            // Written in a moment, and its library complains aloud of a file that takes no more.
            TableForm::Archive => Arc::default(),
            TableForm::Csv | TableForm::JsonLines => Arc::clone(stopped),
        };
        let mut file = Unfinished::new(&self.path, heeded)?;
        let written = match self.form {
            TableForm::Csv => write_csv(survey, &mut file.output).map_err(ArchiveError::from),
            TableForm::JsonLines => {
                write_jsonl(survey, &mut file.output).map_err(ArchiveError::from)
            }
            TableForm::Archive => archive::write(survey, &mut file.output),
        };
        if stopped.load(Ordering::Relaxed) {
            return Err(Failure::Stopped);
        }
        written.map_err(|error| refused(&self.path, error))?;
        file.whole()
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
    output: BufWriter<Stoppable>,
}

/// A file that takes nothing more after an interrupt.
struct Stoppable {
    file: NamedTempFile,
    stopped: Arc<AtomicBool>,
}

impl Write for Stoppable {
    fn write(&mut self, bytes: &[u8]) -> io::Result<usize> {
        if self.stopped.load(Ordering::Relaxed) {
            return Err(io::Error::other("interrupted"));
        }
        self.file.write(bytes)
    }

    fn flush(&mut self) -> io::Result<()> {
        self.file.flush()
    }
}

impl Seek for Stoppable {
    fn seek(&mut self, place: SeekFrom) -> io::Result<u64> {
        self.file.seek(place)
    }
}

impl<'a> Unfinished<'a> {
    fn new(path: &'a Path, stopped: Arc<AtomicBool>) -> Result<Self, Failure> {
        let folder = match path.parent() {
            Some(folder) if !folder.as_os_str().is_empty() => folder,
            _ => Path::new("."),
        };
        let file = tempfile::Builder::new()
            .prefix(".taxel-")
            .permissions(permissions())
            .tempfile_in(folder);
        let file = Stoppable {
            file: file.map_err(|error| refused(path, error))?,
            stopped,
        };
        Ok(Self {
            path,
            output: BufWriter::new(file),
        })
    }

    fn whole(self) -> Result<Whole<'a>, Failure> {
        let path = self.path;
        let output = self.output.into_inner();
        let file = output
            .map_err(|error| refused(path, error.into_error()))?
            .file;
        file.as_file()
            .sync_all()
            .map_err(|error| refused(path, error))?;
        Ok(Whole { path, file })
    }
}

/// A file that only its name is missing of.
struct Whole<'a> {
    path: &'a Path,
    file: NamedTempFile,
}

impl Whole<'_> {
    fn keep(self) -> Result<(), Failure> {
        let path = self.path;
        let kept = self.file.persist(path);
        kept.map(drop).map_err(|error| refused(path, error.error))
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
    let stopped = interrupts()?;
    let pool = rayon::ThreadPoolBuilder::new().num_threads(jobs).build();
    let pool = pool.map_err(|error| Failure::Screen(io::Error::other(error)))?;
    let mut poses = match &wanted.poses {
        Some(path) => Some(PoseFile::new(path, grid, &stopped)?),
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
    let poses = poses.map(PoseFile::whole).transpose()?.flatten();
    if !survey.complete() || stopped.load(Ordering::Relaxed) {
        return Err(Failure::Stopped);
    }
    leave(&survey, start, wanted, poses, charset, &stopped)
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
    // Until here an interrupt ends the program, which has left nothing.
    leave(&survey, start, wanted, None, charset, &interrupts()?)
}

fn leave(
    survey: &Survey,
    start: Instant,
    wanted: &Wanted,
    poses: Option<Whole<'_>>,
    charset: Charset,
    stopped: &Arc<AtomicBool>,
) -> Result<String, Failure> {
    let table = wanted.atlas.as_ref();
    let table = table
        .map(|table| table.write(survey, stopped))
        .transpose()?;
    // All files or none, as far as a machine can be asked for that.
    for file in table.into_iter().chain(poses) {
        file.keep()?;
    }
    let summary = Summary::new(survey, start.elapsed());
    Ok(if wanted.json {
        summary.json()
    } else {
        summary.text(charset)
    })
}

/// Set by an interrupt or a request to end; a second one ends the program as if nobody listened.
fn interrupts() -> Result<Arc<AtomicBool>, Failure> {
    use signal_hook::consts::{SIGINT, SIGTERM};
    use signal_hook::flag::{register, register_conditional_shutdown};
    let stopped = Arc::new(AtomicBool::new(false));
    for signal in [SIGINT, SIGTERM] {
        register_conditional_shutdown(signal, 130, Arc::clone(&stopped))
            .map_err(Failure::Screen)?;
        register(signal, Arc::clone(&stopped)).map_err(Failure::Screen)?;
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
    fn new(path: &'a Path, grid: &Grid, stopped: &Arc<AtomicBool>) -> Result<Self, Failure> {
        let mut file = Unfinished::new(path, Arc::clone(stopped))?;
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
        // What is refused after an interrupt is no error.
        if stopped.load(Ordering::Relaxed) {
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
        if let Err(error) = written
            && !stopped.swap(true, Ordering::Relaxed)
        {
            self.error = Some(error);
        }
    }

    /// None after an interrupt.
    fn whole(self) -> Result<Option<Whole<'a>>, Failure> {
        match self.error {
            Some(error) => Err(refused(self.file.path, error)),
            None if self.file.output.get_ref().stopped.load(Ordering::Relaxed) => Ok(None),
            None => self.file.whole().map(Some),
        }
    }
}
