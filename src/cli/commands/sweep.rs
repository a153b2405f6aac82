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

use std::time::Instant;

use crate::cli::arguments::flags::TOO_LITTLE_MEMORY;
use crate::cli::arguments::sweep::Wanted;
use crate::cli::commands::export::written;
use crate::cli::commands::{Summary, unless_stopped};
use crate::cli::error::CliError;
use crate::cli::output::charset::Charset;
use crate::cli::output::note::note;
use crate::cli::output::progress::ProgressDisplay;
use crate::cli::output::sweep_summary::SweepSummary;
use crate::cli::signals::Signals;
use crate::cli::threads;
use crate::formats::value::{counted, grouped};
use crate::memory::MemoryGuard;
use crate::pose::{Anchor, Axis, GivenRanges, PoseGrid, default_ranges, figure_ranges};
use crate::sensor::Sensor;
use crate::source::Source;
use crate::storage::{ArchiveFileError, AtlasFile, FinishedFile, PoseFile, persist_pair};
use crate::sweep::{Shard, Sweep, SweepResult};

impl Wanted {
    pub(super) fn note_written(&self, summary: &Summary, charset: Charset) {
        let atlas = self.atlas.as_ref().map(AtlasFile::path);
        let files = atlas.into_iter().chain(self.poses.as_deref());
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
        file.check(wanted.existing)?;
    }
    let pool = threads::pool(jobs)?;
    let memory = MemoryGuard::new(wanted.memory, TOO_LITTLE_MEMORY);
    memory.check(grid).map_err(CliError::Memory)?;
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
    poses: Result<Option<FinishedFile>, ArchiveFileError>,
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
    poses: Option<FinishedFile>,
    signals: &Signals,
) -> Result<(), CliError> {
    let atlas = match &wanted.atlas {
        Some(file) => {
            let whole = file.prepare(result, wanted.existing, &signals.stopped);
            if !signals.goes_on() {
                return Err(signals.failure());
            }
            Some(whole?)
        }
        None => None,
    };
    let named = match (atlas, poses) {
        (Some(atlas), Some(poses)) => persist_pair(atlas, poses).and_then(|(_, synced)| synced),
        (Some(file), None) | (None, Some(file)) => file.persist(),
        (None, None) => Ok(()),
    };
    Ok(named.map_err(ArchiveFileError::from)?)
}

fn text(result: &SweepResult, start: Instant, wanted: &Wanted, charset: Charset) -> String {
    let summary = SweepSummary::new(result, start.elapsed());
    if wanted.json {
        summary.json()
    } else {
        summary.text(charset)
    }
}
