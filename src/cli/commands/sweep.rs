//! `taxel sweep`: sweeps a grid of poses, writes the atlas, and prints statistics.
//!
//! `--atlas` writes every distinct imprint with its number of poses, `--poses` the number of its imprint for each pose.
//! Files get their names when all of them are complete. SIGINT, SIGTERM and SIGHUP, unless they are ignored, stop a
//! sweep within a few thousand poses; then there are no files, and the exit status is 128 plus the number of the
//! signal. A second signal ends the program at once.

use std::ffi::OsString;
use std::iter;
use std::path::{Path, PathBuf};
use std::time::{Duration, Instant};

use clap::ArgGroup;
use clap::builder::{OsStringValueParser, TypedValueParser};
use serde::Serialize;
use taxel_core::atlas::{STATISTIC_COLUMNS, StatisticColumn};
use taxel_core::figure::FigureKind;
use taxel_core::pose::{Anchor, Axis, PoseGrid, Ranges, default_ranges, figure_ranges};
use taxel_core::sensor::Sensor;
use taxel_core::source::Source;
use taxel_core::sweep::{Shard, Sweep as Sweeping, SweepResult};
use taxel_files::formats::json;
use taxel_files::formats::value::{counted, grouped};
use taxel_files::memory::MemoryGuard;
use taxel_files::storage::{Existing, NewFile, PoseFile, atlas_path, check_writable, write_atlas};

use crate::cli::Context;
use crate::cli::arguments::flags::{
    TOO_LITTLE_MEMORY, file_of, name_or_path, one_of, parse_shard, whole,
};
use crate::cli::arguments::parameters::{Given, RangeFlags, SensorFlags, SizeFlags};
use crate::cli::commands::export::{replacing, written};
use crate::cli::failure::Failure;
use crate::cli::input::outlines::OutlineFlags;
use crate::cli::output::charset::Charset;
use crate::cli::output::table::{Record, table};
use crate::cli::signals::{Signals, on_threads};

const EXAMPLES: &str = "\
A range is START:END:STEP with the end included, or one number; decimals are
exact. By default, x0 and y0 run over one cell in steps of 0.01, at every whole
degree: 3.6 million poses. The cell of a figure starts at x0 = y0 = 5; that of a
picture or an outline is the cell that it lies in. If the sensor would cut off
the shape there at some angle, taxel takes the cell nearest to the middle of the
sensor in which nothing is cut off. The summary states the ranges. Figures are
solid without --thickness. A picture keeps its own sensor, unless flags change
it.

Examples:
  taxel sweep rectangle --length 6 --width 3
  taxel sweep ellipse --radius-x 4 --radius-y 4 --thickness 2 --angle 0 --json
  taxel sweep --picture key --columns 32 --rows 32 --x0 11:11.9:0.1 \\
    --y0 11:11.9:0.1 --zoom-x 0.8:1.2:0.1 --atlas key.csv
  taxel sweep --picture parts/bracket.svg --pitch 2.5 --angle 0:355:5
  taxel sweep hexagon --side 12 --columns 64 --rows 64 --x0 20:20.99:0.01 \\
    --shard 3/40 --atlas hexagon-3.npz --quiet";

/// Find every imprint that a shape can leave
#[derive(Debug, clap::Args)]
#[command(after_help = EXAMPLES)]
#[command(group = ArgGroup::new("shape").args(["kind", "picture"]).required(true))]
#[command(group = ArgGroup::new("files").args(["atlas", "poses"]).multiple(true))]
pub(crate) struct Sweep {
    /// Kind of figure, as in 'taxel figure'; or --picture
    #[arg(value_name = "KIND", value_parser = one_of::<FigureKind, _>(FigureKind::names()))]
    #[arg(hide_possible_values = true)]
    kind: Option<FigureKind>,
    /// Sweep a stored shape or an outline instead
    #[arg(long, value_name = "NAME|FILE", value_parser = name_or_path())]
    picture: Option<OsString>,
    #[command(flatten)]
    sizes: SizeFlags,
    #[command(flatten)]
    ranges: RangeFlags,
    /// Point that x0 and y0 place: corner (default) or centre
    #[arg(long, value_name = "POINT", value_parser = one_of::<Anchor, _>(Anchor::ALL.iter().map(|own| own.name())))]
    #[arg(hide_possible_values = true, help_heading = "Grid")]
    anchor: Option<Anchor>,
    #[command(flatten)]
    sensor: SensorFlags,
    #[command(flatten)]
    outlines: OutlineFlags,
    /// Write the atlas, a list of all imprints found, as .csv, .jsonl or .npz
    #[arg(long, value_name = "FILE", value_parser = atlas())]
    atlas: Option<PathBuf>,
    /// Write which imprint each pose leaves
    #[arg(long, value_name = "FILE.npy", value_parser = file_of("npy"), conflicts_with = "shard")]
    poses: Option<PathBuf>,
    /// Replace an existing file
    #[arg(long, requires = "files")]
    force: bool,
    /// Threads; default all cores
    #[arg(long, value_name = "N", value_parser = whole::<u16>(1..=1024))]
    jobs: Option<u16>,
    /// Compute only shard K of N of the grid
    #[arg(long, value_name = "K/N", value_parser = parse_shard)]
    shard: Option<Shard>,
    /// Print JSON, one line per answer
    #[arg(long)]
    json: bool,
    /// Show no progress and no notes
    #[arg(long)]
    quiet: bool,
}

/// The name of an atlas. Its extension decides the format, so there is no flag for this.
pub(crate) fn atlas() -> impl TypedValueParser<Value = PathBuf> {
    OsStringValueParser::new().try_map(atlas_path)
}

impl Sweep {
    pub(crate) fn run(self, cx: &Context) -> Result<(), Failure> {
        let grid = self.grid(cx)?;
        let start = Instant::now();
        let signals = Signals::catch()?;
        let existing = replacing(self.force);
        if let Some(file) = &self.atlas {
            check_writable(file, existing)?;
        }
        let memory = MemoryGuard::new(TOO_LITTLE_MEMORY);
        let new = |path| PoseFile::new(path, &grid, existing);
        let mut poses = self.poses.as_ref().map(new).transpose()?;
        let shard = self.shard.unwrap_or(Shard::WHOLE);
        let by = (self.jobs, memory, self.quiet);
        let result = on_threads(&signals, shard.poses(&grid), by, |progress| {
            let sweep = Sweeping::new(&grid)
                .with_shard(shard)
                .with_progress(progress);
            match &mut poses {
                Some(file) => sweep.run_with_rows(&mut |row, ids| file.take(row, ids)),
                None => sweep.run(),
            }
        })?;
        let poses = poses.map(PoseFile::finish).transpose().map(Option::flatten);
        // A sweep that was stopped leaves no file and no answer; why a file failed says more than the signal.
        if !result.complete() {
            poses?;
            return Err(signals.failure());
        }
        let write = |poses| write(&result, self.atlas.as_deref(), existing, poses, &signals);
        let done = poses.map_err(Failure::from).and_then(write);
        if done.is_err() && !signals.goes_on() {
            return done;
        }
        // The work is not lost if its files cannot be written.
        let took = start.elapsed();
        cx.write(summary(&result, took, self.json).as_bytes())?;
        done?;
        let files = self.atlas.iter().chain(&self.poses);
        for path in files.filter(|_| !self.quiet) {
            cx.note(&written(path));
        }
        Ok(())
    }

    /// Returns the grid to sweep. If x0 or y0 was not given, a note says how many poses are cut off nevertheless.
    fn grid(&self, cx: &Context) -> Result<PoseGrid, Failure> {
        let (source, sensor) = self.shape(cx)?;
        let (anchor, given) = (self.anchor.unwrap_or_default(), &self.ranges.0);
        let ranges = match source {
            // A figure on the command line has no position; another shape is swept in the cell that it lies in.
            Source::Figure(_) => figure_ranges(&source, &sensor, anchor, given),
            _ => default_ranges(&source, &sensor, anchor, given),
        };
        let grid = PoseGrid::new(source, sensor, anchor, ranges?)?;
        if self.quiet || given[Axis::X0].and(given[Axis::Y0]).is_some() {
            return Ok(grid);
        }
        let cut = grid.poses_beyond_sensor();
        if cut > 0 {
            let (noun, cut) = (grid.source().noun(), grouped(cut));
            let poses = counted(grid.poses(), "pose");
            cx.note(&format!(
                "the {noun} reaches beyond the sensor in {cut} of {poses}"
            ));
        }
        Ok(grid)
    }

    fn shape(&self, cx: &Context) -> Result<(Source, Sensor), Failure> {
        if let Some(picture) = &self.picture {
            if let Some(size) = self.sizes.first() {
                let text = format!("'--{size}' does not belong to a picture");
                return Err(Failure::usage(text));
            }
            let values = Given::default();
            return self.outlines.placed(picture, &values, &self.sensor, cx);
        }
        self.outlines.refuse()?;
        let sensor = self.sensor.sensor(cx.settings.sensor.sensor)?;
        let kind = self.kind.unwrap_or(FigureKind::Ellipse);
        Ok((Source::Figure(self.sizes.figure(kind, &sensor)?), sensor))
    }
}

/// Writes the atlas and gives the files their names.
fn write(
    result: &SweepResult,
    atlas: Option<&Path>,
    existing: Existing,
    poses: Option<NewFile>,
    signals: &Signals,
) -> Result<(), Failure> {
    let atlas = atlas.map(|file| write_atlas(file, result, existing));
    if !signals.goes_on() {
        return Err(signals.failure());
    }
    for file in [atlas.transpose()?, poses].into_iter().flatten() {
        file.persist()?;
    }
    Ok(())
}

#[derive(Serialize)]
struct SummaryJson<'a> {
    poses: u64,
    ranges: Record<'a, String>,
    shard: String,
    distinct: usize,
    distinct_shifts: usize,
    distinct_symmetry: usize,
    partly_off: u64,
    empty: u64,
    seconds: f64,
    descriptors: Record<'a, Record<'a, Option<f64>>>,
}

/// The summary of a sweep or a merge as a line of JSON.
fn summary_json(result: &SweepResult, took: Duration) -> String {
    let SweepResult { grid, atlas, .. } = result;
    let range = |axis: Axis| (axis.name(), grid.ranges()[axis].to_string());
    let classes = atlas.distinct_classes();
    let descriptors = result.statistics.iter().map(|row| {
        let value = |column: &StatisticColumn| (column.key, (column.value)(row));
        let values = STATISTIC_COLUMNS.iter().map(value).collect();
        (&*row.feature.key, Record(values))
    });
    let summary = SummaryJson {
        poses: result.poses,
        ranges: Record(grid.axes().map(range).collect()),
        shard: result.shard.to_string(),
        distinct: atlas.len(),
        distinct_shifts: classes.up_to_shifts,
        distinct_symmetry: classes.up_to_symmetry,
        partly_off: result.partly_off,
        empty: atlas.empty_poses(),
        seconds: took.as_secs_f64(),
        descriptors: Record(descriptors.collect()),
    };
    json::text(&summary) + "\n"
}

/// The summary of a sweep or a merge: for people, or as a line of JSON.
pub(crate) fn summary(result: &SweepResult, took: Duration, as_json: bool) -> String {
    if as_json {
        return summary_json(result, took);
    }
    let SweepResult { grid, atlas, .. } = result;
    let part = match result.shard {
        Shard::WHOLE => String::new(),
        shard => format!(", shard {shard}"),
    };
    // A picture is swept at its own size unless zooms are given, so zooms of one value are not shown.
    let ranges = grid.axes();
    let ranges = ranges.filter(|&axis| grid.counts()[axis] > 1 || !axis.is_zoom());
    let classes = atlas.distinct_classes();
    let text = format!(
        "{}{part}: {}\n\
         {}, {} up to shifts, {} up to quarter turns and mirror images too\n\
         {} cut off by the sensor, {} without an imprint; {:.2} s\n\n",
        counted(result.poses, "pose"),
        ranges_in_words(ranges, grid.ranges()),
        counted(atlas.len() as u64, "distinct imprint"),
        grouped(classes.up_to_shifts as u64),
        grouped(classes.up_to_symmetry as u64),
        counted(result.partly_off, "pose"),
        counted(atlas.empty_poses(), "pose"),
        took.as_secs_f64(),
    );
    let mut rows = vec![vec![String::new()]];
    rows[0].extend(
        STATISTIC_COLUMNS
            .iter()
            .map(|column| column.title.to_owned()),
    );
    for row in &result.statistics {
        let values = STATISTIC_COLUMNS.iter().map(|column| (column.value)(row));
        let values = values.map(|own| own.map_or("–".to_owned(), |own| format!("{own:.4}")));
        rows.push(iter::once(row.feature.key.clone()).chain(values).collect());
    }
    Charset::current().lines(&text) + &table(&rows, &[0])
}

pub(crate) fn ranges_in_words(axes: impl Iterator<Item = Axis>, ranges: &Ranges) -> String {
    let words = axes.map(|axis| {
        let unit = axis.parameter().row().unit;
        format!("{} {}", axis.name(), unit.after(&ranges[axis].to_string()))
    });
    words.collect::<Vec<_>>().join(", ")
}
