//! `taxel sweep`: sweeps a grid of poses, writes the atlas, and prints statistics.
//!
//! Files are written under another name in the same folder and renamed when all of them are complete. A file that
//! exists is replaced only with `--force`; this is checked before the work begins.
//!
//! SIGINT, SIGTERM and SIGHUP, unless they are ignored, stop a sweep within a few thousand poses and a file at its next
//! block. Incomplete files are removed, and the exit status is 128 plus the number of the signal. A second signal
//! ends the program at once.
//!
//! The result of a sweep: `--atlas` writes every distinct imprint with its number of poses, `--poses` writes the
//! number of its imprint for each pose, and standard output gets a summary.

use std::collections::HashSet;
use std::fmt;
use std::io::BufReader;
use std::path::{Path, PathBuf};
use std::time::Instant;

use taxel_core::pose::{Anchor, Axis, GivenRanges, PoseGrid, default_ranges, figure_ranges};
use taxel_core::recognition::{Evaluation, Model, ModelError, ModelMerge, TrainingError};
use taxel_core::sensor::Sensor;
use taxel_core::source::Source;
use taxel_core::sweep::{MergeError, Shard, ShardOrderError, Sweep, SweepMerge, SweepResult};
use taxel_files::formats::value::{counted, grouped};
use taxel_files::formats::{MODEL_FORMAT, archive_kind, json};
use taxel_files::memory::MemoryGuard;
use taxel_files::storage::{
    self, FileError, NewFile, PoseFile, check_writable, load_atlas, load_model, save_model,
    write_atlas,
};

use crate::cli::arguments::flags::TOO_LITTLE_MEMORY;
use crate::cli::arguments::sweep::Wanted;
use crate::cli::commands::export::written;
use crate::cli::commands::model::{fits_in_table, model_file};
use crate::cli::commands::{Summary, unless_stopped};
use crate::cli::error::CliError;
use crate::cli::output::charset::{Charset, note};
use crate::cli::output::evaluation::{self, EvaluationJson};
use crate::cli::output::progress::ProgressDisplay;
use crate::cli::output::sweep_summary;
use crate::cli::signals::{self, Signals};

impl Wanted {
    pub(super) fn note_written(&self, summary: &Summary, charset: Charset) {
        let files = self.atlas.iter().chain(&self.poses);
        for path in files.filter(|_| summary.written.is_ok() && !self.quiet) {
            note(&written(path), charset);
        }
    }
}

/// Returns the grid to sweep, and notes about the ranges of x0 and y0 that were not given: whether they span less than
/// a cell, and how many poses are cut off nevertheless. The summary names the ranges.
///
/// A figure on the command line has no position, so it is swept in the [`figure_ranges`]; a picture is swept in the
/// cell that it lies in.
pub(crate) fn grid(
    source: Source,
    sensor: Sensor,
    anchor: Anchor,
    given: &GivenRanges,
) -> Result<(PoseGrid, Vec<String>), CliError> {
    let mut missing = vec![Axis::X0, Axis::Y0];
    missing.retain(|&axis| given[axis].is_none());
    let ranges = match source {
        Source::Figure(_) => figure_ranges(&source, &sensor, anchor, given)?,
        Source::Picture(_) => default_ranges(&source, &sensor, anchor, given)?,
    };
    let grid = PoseGrid::new(source, sensor, anchor, ranges)?;
    if missing.is_empty() {
        return Ok((grid, Vec::new()));
    }
    let mut notes = Vec::new();
    let zoomed = [(Axis::X0, Axis::ZoomX), (Axis::Y0, Axis::ZoomY)];
    let mut zoomed = zoomed.iter().filter(|(axis, _)| missing.contains(axis));
    if anchor == Anchor::Corner && zoomed.any(|&(_, zoom)| grid.ranges()[zoom].value(0) < 1.0) {
        let note = "the corner is zoomed, too: it moves by less than a cell; '--anchor centre' moves the shape by a cell";
        notes.push(note.to_owned());
    }
    let cut = grid.poses_beyond_sensor();
    if cut > 0 {
        let noun = grid.source().noun();
        notes.push(format!(
            "the {noun} reaches beyond the sensor in {} of {}",
            grouped(cut),
            counted(grid.poses(), "pose")
        ));
    }
    Ok((grid, notes))
}

pub(crate) fn sweep(
    grid: &PoseGrid,
    shard: Shard,
    jobs: usize,
    wanted: &Wanted,
    charset: Charset,
) -> Result<Summary, CliError> {
    let start = Instant::now();
    let signals = Signals::catch()?;
    if let Some(file) = &wanted.atlas {
        check_writable(file, wanted.existing)?;
    }
    let pool = signals::pool(jobs)?;
    let memory = MemoryGuard::new(wanted.memory, TOO_LITTLE_MEMORY);
    let new = |path| PoseFile::new(path, grid, wanted.existing);
    let mut poses = wanted.poses.as_ref().map(new).transpose()?;
    let display = ProgressDisplay::new(shard.poses(grid), wanted.quiet, charset);
    let result = memory.limit(&signals.progress(&display), |progress| {
        let sweep = Sweep::new(grid).with_shard(shard).with_progress(progress);
        pool.install(|| match &mut poses {
            Some(file) => sweep.run_with_rows(&mut |row, ids| file.take(row, ids)),
            None => sweep.run(),
        })
    });
    drop(display);
    let result = result.map_err(CliError::Memory)?;
    let poses = poses.map(PoseFile::finish).transpose().map(Option::flatten);
    if !result.complete() {
        poses?;
        return Err(signals.failure());
    }
    let left = leave(&result, start, wanted, poses, charset, &signals)?;
    wanted.note_written(&left, charset);
    Ok(left)
}

/// Writes the atlas, gives the files their names, and returns the summary to print, with the error if there are no
/// files.
pub(super) fn leave(
    result: &SweepResult,
    start: Instant,
    wanted: &Wanted,
    poses: Result<Option<NewFile>, FileError>,
    charset: Charset,
    signals: &Signals,
) -> Result<Summary, CliError> {
    let poses = poses.map_err(CliError::from);
    let written = poses.and_then(|poses| write(result, wanted, poses, signals));
    Ok(Summary {
        text: text(result, start, wanted, charset),
        written: unless_stopped(written)?,
    })
}

fn write(
    result: &SweepResult,
    wanted: &Wanted,
    poses: Option<NewFile>,
    signals: &Signals,
) -> Result<(), CliError> {
    let atlas = match &wanted.atlas {
        Some(file) => {
            let whole = write_atlas(file, result, wanted.existing);
            if !signals.goes_on() {
                return Err(signals.failure());
            }
            Some(whole?)
        }
        None => None,
    };
    for file in [atlas, poses].into_iter().flatten() {
        file.persist()?;
    }
    Ok(())
}

fn text(result: &SweepResult, start: Instant, wanted: &Wanted, charset: Charset) -> String {
    if wanted.json {
        sweep_summary::json(result, start.elapsed())
    } else {
        sweep_summary::text(result, start.elapsed(), charset)
    }
}

struct Part {
    path: PathBuf,
    format: String,
    shard: Shard,
}

impl Part {
    fn of(path: &Path) -> Result<Self, CliError> {
        let read = |error: FileError| CliError::Archive(error.into());
        let kind = archive_kind(BufReader::new(storage::open(path).map_err(read)?));
        let (format, shard) = kind.map_err(|error| CliError::Shard {
            path: path.to_owned(),
            reason: error.to_string(),
        })?;
        Ok(Self {
            path: path.to_owned(),
            format,
            shard,
        })
    }

    fn refused(&self, error: &dyn fmt::Display) -> CliError {
        CliError::Shard {
            path: self.path.clone(),
            reason: error.to_string(),
        }
    }

    fn other_study(&self, first: &Self) -> CliError {
        self.refused(&format_args!(
            "shard {}, but {} is shard {}: not the same study",
            self.shard,
            first.path.display(),
            first.shard
        ))
    }
}

/// Refuses to replace one of the shards by the result: the shards could not be merged again.
fn check_no_shard(files: &[PathBuf], wanted: &Wanted) -> Result<(), CliError> {
    let written = wanted.atlas.iter().chain(&wanted.poses);
    for written in written.filter_map(|path| path.canonicalize().ok()) {
        let own = |path: &&PathBuf| path.canonicalize().is_ok_and(|path| path == written);
        if let Some(path) = files.iter().find(own) {
            return Err(CliError::Shard {
                path: path.clone(),
                reason: "one of the shards; write to another file".to_owned(),
            });
        }
    }
    Ok(())
}

const MOST_LISTED: usize = 10;

fn check_one_kind(parts: &[Part]) -> Result<(), CliError> {
    let noun = |part: &Part| match part.format.as_str() {
        MODEL_FORMAT => "a model",
        _ => "an atlas",
    };
    let Some((first, others)) = parts.split_first() else {
        return Ok(());
    };
    match others.iter().find(|part| noun(part) != noun(first)) {
        Some(other) => Err(other.refused(&format_args!(
            "{}, but {} is {}; give the shards of one sweep or of one training",
            noun(other),
            first.path.display(),
            noun(first),
        ))),
        None => Ok(()),
    }
}

/// Refuses shards of which two or more are missing, and lists these. The merge names a single one, and reports shards
/// of different numbers of shards.
fn check_all_there(parts: &[Part]) -> Result<(), CliError> {
    let Some(of) = parts.first().map(|part| part.shard.of()) else {
        return Ok(());
    };
    if parts.iter().any(|part| part.shard.of() != of) {
        return Ok(());
    }
    let given: HashSet<u32> = parts.iter().map(|part| part.shard.number()).collect();
    let count = u64::from(of) - given.len() as u64;
    // The merge also names a shard that is given twice.
    if count < 2 || given.len() < parts.len() {
        return Ok(());
    }
    let missing = (1..=of).filter(|number| !given.contains(number));
    let mut numbers: Vec<String> = missing.take(MOST_LISTED).map(|it| it.to_string()).collect();
    if count > MOST_LISTED as u64 {
        numbers.push("…".to_owned());
    }
    let numbers = numbers.join(", ");
    Err(CliError::MissingShards { count, of, numbers })
}

pub(crate) fn merge(
    files: &[PathBuf],
    wanted: &Wanted,
    charset: Charset,
) -> Result<Summary, CliError> {
    let start = Instant::now();
    if let Some(file) = &wanted.atlas {
        check_writable(file, wanted.existing)?;
    }
    check_no_shard(files, wanted)?;
    let parts = files.iter().map(|path| Part::of(path));
    let mut parts = parts.collect::<Result<Vec<_>, _>>()?;
    let is_model = parts
        .first()
        .is_some_and(|part| part.format == MODEL_FORMAT);
    check_one_kind(&parts)?;
    if is_model {
        check_model_file(wanted)?;
    }
    parts.sort_by_key(|part| part.shard.number());
    check_all_there(&parts)?;
    let memory = MemoryGuard::new(
        wanted.memory,
        "allow more (--memory), or merge on a machine that has more",
    );
    let summary = if is_model {
        leave_model(&models(&parts, wanted, &memory)?, wanted)
    } else {
        let result = sweeps(&parts, &memory)?;
        // Until here nothing is written, so a signal may just end the program.
        let signals = Signals::catch()?;
        leave(&result, start, wanted, Ok(None), charset, &signals)?
    };
    wanted.note_written(&summary, charset);
    Ok(summary)
}

fn check_model_file(wanted: &Wanted) -> Result<(), CliError> {
    match &wanted.atlas {
        Some(file) => Ok(model_file(file)?),
        None => Ok(()),
    }
}

fn sweeps(parts: &[Part], memory: &MemoryGuard) -> Result<SweepResult, CliError> {
    let mut merge = SweepMerge::default();
    for part in parts {
        let shard = load_atlas(&part.path).map_err(CliError::Archive)?;
        merge.add(shard).map_err(|error| match error {
            MergeError::Foreign { .. } if part.shard.of() != parts[0].shard.of() => {
                part.other_study(&parts[0])
            }
            MergeError::Foreign { difference, .. } => part.refused(&format_args!(
                "differs from {} in {difference}",
                parts[0].path.display()
            )),
            MergeError::Order(ShardOrderError::Twice(_)) => part.refused(&error),
            other => other.into(),
        })?;
        memory.check().map_err(CliError::Memory)?;
    }
    Ok(merge.finish()?)
}

/// Merges the shards of a training. They are refused at the first one if the result has too many shapes for what is to
/// be printed.
fn models(parts: &[Part], wanted: &Wanted, memory: &MemoryGuard) -> Result<Model, CliError> {
    let mut merge = ModelMerge::default();
    for part in parts {
        let model = load_model(&part.path).map_err(CliError::Archive)?;
        if wanted.json {
            fits_in_table("confusion matrix", model.shapes().len())?;
        }
        merge.add(&model).map_err(|error| match error {
            ModelError::Foreign { .. } if part.shard.of() != parts[0].shard.of() => {
                part.other_study(&parts[0])
            }
            ModelError::Foreign { .. } => part.refused(&format_args!(
                "belongs to another training than {}",
                parts[0].path.display()
            )),
            ModelError::Shards(ShardOrderError::Twice(_)) => part.refused(&error),
            other => TrainingError::from(other).into(),
        })?;
        memory.check().map_err(CliError::Memory)?;
    }
    Ok(merge.finish().map_err(TrainingError::from)?)
}

fn leave_model(model: &Model, wanted: &Wanted) -> Summary {
    let save = |file: &PathBuf| Ok(save_model(model, file, wanted.existing)?);
    let written = wanted.atlas.as_ref().map_or(Ok(()), save);
    let limit = Evaluation::of(model);
    let text = if wanted.json {
        json::ascii(&EvaluationJson {
            evaluation: &limit,
            classifier: None,
        }) + "\n"
    } else {
        evaluation::summary(&limit, evaluation::NamedBy::Imprint)
    };
    Summary { text, written }
}
