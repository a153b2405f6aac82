//! `taxel sweep` and `taxel merge`: sweeps a grid of poses or puts shards together, writes the atlas, prints
//! statistics.
//!
//! Files are written under another name in the same folder and renamed when all of them are complete. A file that
//! exists is replaced only with `--force`; this is checked before the work begins.
//!
//! SIGINT, SIGTERM and, on a terminal, SIGHUP stop a sweep within a few thousand poses and a file at its next block.
//! Incomplete files are removed, and the exit status is 128 and the number of the signal. A second signal ends the
//! program at once.
//!
//! The ways of a sweep's result: `--atlas` writes every distinct imprint with its number of poses, `--poses` for each
//! pose the number of its imprint, and standard output gets a summary. `merge` reads shards of atlases or of models and
//! checks that they are of one grid and complete.

use std::fs::File;
use std::io;
use std::path::{Path, PathBuf};
use std::sync::atomic::Ordering;
use std::time::Instant;

use crate::cli::error::CliError;
use crate::cli::output::charset::Charset;
use crate::cli::output::evaluation::{self, EvaluationJson};
use crate::cli::output::progress::Progress;
use crate::cli::output::report;
use crate::cli::output::sweep_summary::SweepSummary;
use crate::cli::signals::Signals;
use crate::formats::{ArchiveError, MODEL_FORMAT, archive, archive_format, json};
use crate::pose::{Anchor, Axis, GivenRanges, PoseGrid, Ranges, common_ranges, default_ranges};
use crate::recognition::{Evaluation, Model, TrainingError};
use crate::sensor::Sensor;
use crate::source::Source;
use crate::storage::{
    ArchiveFileError, AtlasFile, Existing, FinishedFile, PoseFile, load_model, persist_pair,
    save_model,
};
use crate::sweep::{Shard, Sweep, SweepResult};
use crate::tui::runtime::memory::{MemoryGuard, MemorySize};

/// What a sweep or a merge is to write and print.
#[derive(Clone, Debug)]
pub(crate) struct Wanted {
    /// `--atlas`: the file of all distinct imprints.
    pub(crate) atlas: Option<AtlasFile>,
    /// `--poses`: the file of each pose's imprint.
    pub(crate) poses: Option<PathBuf>,
    /// What to do about files that exist.
    pub(crate) existing: Existing,
    /// Whether the summary is one line of JSON.
    pub(crate) json: bool,
    /// Whether to show no progress.
    pub(crate) quiet: bool,
    /// `--memory`: the most that it may use.
    pub(crate) memory: Option<MemorySize>,
}

/// The error for an atlas that cannot be read.
fn refused(path: &Path, error: impl Into<ArchiveError>) -> CliError {
    CliError::Atlas {
        name: path.to_string_lossy().into_owned(),
        error: error.into(),
    }
}

/// Returns the grid to sweep, and what to say about it beforehand: the ranges of x0 and y0 that were not given, and how
/// many poses are cut off all the same.
///
/// A figure takes the paper's cell from 5 on where nothing is cut off there, a picture the cell that it lies in.
pub(crate) fn grid(
    source: Source,
    sensor: Sensor,
    anchor: Anchor,
    given: &GivenRanges,
) -> Result<(PoseGrid, Vec<String>), CliError> {
    let mut missing = vec![Axis::X0, Axis::Y0];
    missing.retain(|&axis| given[axis].is_none());
    let paper = Ranges::default();
    let usual = Ranges::from_fn(|axis| given[axis].unwrap_or(paper[axis]));
    let usual = PoseGrid::new(source.clone(), sensor, anchor, usual);
    if missing.is_empty() {
        return Ok((usual?, Vec::new()));
    }
    let whole = |grid: &PoseGrid| grid.poses_beyond_sensor() == 0;
    let grid = match usual {
        Ok(grid) if source.kind().is_some() && whole(&grid) => grid,
        _ if source.kind().is_some() => {
            let ranges = common_ranges([&source], &sensor, anchor, given)?;
            PoseGrid::new(source, sensor, anchor, ranges)?
        }
        _ => {
            let ranges = default_ranges(&source, &sensor, anchor, given)?;
            PoseGrid::new(source, sensor, anchor, ranges)?
        }
    };
    let taken = missing
        .iter()
        .map(|&axis| format!("{} {}", axis.name(), grid.ranges()[axis]));
    let mut notes = vec![format!("range: {}", taken.collect::<Vec<_>>().join(", "))];
    let cut = grid.poses_beyond_sensor();
    if cut > 0 {
        let noun = grid.source().noun();
        notes.push(format!(
            "the {noun} reaches beyond the sensor in {cut} of {} poses",
            grid.poses()
        ));
    }
    Ok((grid, notes))
}

/// Sweeps a shard of a grid on `jobs` threads (0: one per core), writes the files, and returns the summary to print.
///
/// # Errors
/// [`CliError::Stopped`] after a signal; otherwise those of the files.
pub(crate) fn sweep(
    grid: &PoseGrid,
    shard: Shard,
    jobs: usize,
    wanted: &Wanted,
    charset: Charset,
) -> Result<String, CliError> {
    let start = Instant::now();
    let signals = Signals::heard().map_err(CliError::System)?;
    let stopped = &signals.stopped;
    if let Some(file) = &wanted.atlas {
        file.check(wanted.existing)?;
    }
    let pool = rayon::ThreadPoolBuilder::new().num_threads(jobs).build();
    let pool = pool.map_err(|error| CliError::System(io::Error::other(error)))?;
    let memory = MemoryGuard::new(wanted.memory);
    memory.check(grid).map_err(CliError::Memory)?;
    let mut poses = match &wanted.poses {
        Some(path) => Some(PoseFile::new(path, grid, wanted.existing)?),
        None => None,
    };
    let rows = shard.rows(grid.rows());
    let all = (rows.end - rows.start) * grid.row_length();
    let progress = Progress::new(all, wanted.quiet, charset);
    let tell = |poses: u64| {
        progress.add(poses);
        !stopped.load(Ordering::Relaxed) && memory.allows()
    };
    let mut take = |row: u64, ids: &[u32]| {
        if let Some(file) = &mut poses {
            file.take(row, ids, stopped);
        }
    };
    let mut sweep = Sweep::new(grid).shard(shard).progress(&tell);
    if wanted.poses.is_some() {
        sweep = sweep.rows(&mut take);
    }
    let result = pool.install(|| sweep.run());
    progress.finish();
    if memory.exceeded() {
        return Err(CliError::Memory(memory.message()));
    }
    let poses = poses.map(PoseFile::finish).transpose()?;
    if !result.complete() {
        return Err(signals.failure());
    }
    leave(&result, start, wanted, poses, charset, &signals)
}

/// Merges the shards in `files`, writes the atlas, and returns the summary to print.
///
/// # Errors
/// If a file cannot be read, or the shards are not all those of one grid, each once.
pub(crate) fn merge(
    files: &[PathBuf],
    wanted: &Wanted,
    charset: Charset,
) -> Result<String, CliError> {
    let start = Instant::now();
    if let Some(file) = &wanted.atlas {
        file.check(wanted.existing)?;
    }
    if let Some(path) = files.first()
        && archive_format(open(path)?).map_err(|error| refused(path, error))? == MODEL_FORMAT
    {
        return merge_models(files, wanted, charset);
    }
    let mut results = Vec::with_capacity(files.len());
    for path in files {
        let result = archive::read(open(path)?);
        results.push(result.map_err(|error| refused(path, error))?);
    }
    let result = SweepResult::merge(results)?;
    // Until here nothing is written, so a signal may simply end the program.
    let signals = Signals::heard().map_err(CliError::System)?;
    leave(&result, start, wanted, None, charset, &signals)
}

/// Opens the file of a shard.
fn open(path: &Path) -> Result<io::BufReader<File>, CliError> {
    let file = File::open(path).map_err(|error| refused(path, error))?;
    Ok(io::BufReader::new(file))
}

/// Merges the shards of a training, and returns what is printed.
fn merge_models(files: &[PathBuf], wanted: &Wanted, charset: Charset) -> Result<String, CliError> {
    let mut shards = Vec::with_capacity(files.len());
    for path in files {
        shards.push(load_model(path)?);
    }
    let model = Model::merge(shards).map_err(TrainingError::from)?;
    let signals = Signals::heard().map_err(CliError::System)?;
    if let Some(file) = &wanted.atlas {
        let saved = save_model(&model, file.path(), wanted.existing, &signals.stopped);
        if signals.stopped.load(Ordering::Relaxed) {
            return Err(signals.failure());
        }
        saved?;
    }
    let limit = Evaluation::of(&model);
    Ok(if wanted.json {
        let line = json::text(&EvaluationJson {
            evaluation: &limit,
            peer: None,
        });
        report::ascii_json(&line) + "\n"
    } else {
        evaluation::summary(&limit, evaluation::NamedBy::Imprint, charset)
    })
}

/// Writes the atlas, gives the files their names, and returns the summary to print.
fn leave(
    result: &SweepResult,
    start: Instant,
    wanted: &Wanted,
    poses: Option<FinishedFile>,
    charset: Charset,
    signals: &Signals,
) -> Result<String, CliError> {
    let atlas = match &wanted.atlas {
        Some(file) => {
            let whole = file.prepare(result, wanted.existing, &signals.stopped);
            if signals.stopped.load(Ordering::Relaxed) {
                return Err(signals.failure());
            }
            Some(whole?)
        }
        None => None,
    };
    let named = match (atlas, poses) {
        (Some(atlas), Some(poses)) => persist_pair(atlas, poses),
        (Some(file), None) | (None, Some(file)) => file.persist(),
        (None, None) => Ok(()),
    };
    named.map_err(ArchiveFileError::from)?;
    let summary = SweepSummary::new(result, start.elapsed());
    Ok(if wanted.json {
        summary.json()
    } else {
        summary.text(charset)
    })
}
