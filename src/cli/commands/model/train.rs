//! `taxel model train`.

use std::path::PathBuf;

use clap::ArgGroup;
use taxel_core::parameter::Parameter;
use taxel_core::pose::{Anchor, Axis, DecimalRange, Ranges, Reach, SensorSides, check_given};
use taxel_core::recognition::{CellPositions, Evaluation, LEAST_SIDE, NamedShape, Training};
use taxel_core::sensor::Sensor;
use taxel_core::source::Source;
use taxel_core::sweep::Shard;
use taxel_files::formats::{Name, json};
use taxel_files::memory::MemoryGuard;
use taxel_files::storage::{ModelChoice, check_writable, save_model};

use crate::cli::Context;
use crate::cli::arguments::flags::{TOO_LITTLE_MEMORY, one_of, parse_shard, whole};
use crate::cli::arguments::parameters::{FittingSensorFlags, RangeFlags};
use crate::cli::commands::export::replacing;
use crate::cli::commands::model::keeping::card;
use crate::cli::commands::model::{SetFlags, folder, model_file, positions, trained};
use crate::cli::commands::sweep::ranges_in_words;
use crate::cli::failure::{Failure, Named};
use crate::cli::input::shapes;
use crate::cli::output::charset::Charset;
use crate::cli::output::evaluation::{self, NamedBy};

const EXAMPLES: &str = r#"A line of JSON is a shape as for 'taxel batch', but with a name and no pose:
  {"name":"disc","figure":"ellipse","radius_x":3,"radius_y":3}
  {"name":"ring","picture":"washer"}
  {"name":"plate","outline":[[[0,0],[15,0],[15,10]]],"unit":"mm"}
An SVG, or a CSV of points, is a shape named like its file. What is in mm is
divided by --pitch; a stored outline in mm has its own pitch without it. Of other
stored shapes, only the taxels count; a taxel is one cell. By default, every shape is touched at 100 x 100 positions inside one
cell and at every whole degree. The sensor is the smallest that holds all
shapes, at least 16 x 16; taxel prints its size. taxel refuses poses that the
sensor would cut off, since a cut imprint depends on where the rim is;
--allow-cut permits them. 'taxel merge' merges shards.

Examples:
  taxel model train parts.jsonl --name parts
  taxel model train parts/*.svg --pitch 2.5 --out outlines.npz
  taxel model train washer key gear --out shipped.npz
  taxel model train parts.jsonl --shard 1/4 --out part-1.npz"#;

/// Learn every imprint of a set of shapes
#[expect(clippy::struct_excessive_bools, reason = "flags")]
#[derive(Debug, clap::Args)]
#[command(
    after_help = EXAMPLES,
    override_usage = "taxel model train [OPTIONS] <--out FILE|--name NAME> [FILE|NAME]...",
    group = ArgGroup::new("target").args(["out", "name"]).required(true),
)]
pub(crate) struct Train {
    #[command(flatten)]
    set: SetFlags,
    /// Write the model to this file
    #[arg(long, value_name = "FILE.npz")]
    out: Option<PathBuf>,
    /// Keep the model under this name, in the library
    #[arg(long, value_parser = Name::new)]
    name: Option<Name>,
    #[command(flatten)]
    ranges: RangeFlags,
    /// Positions per cell along x and y: 1, 2, 4, 5, 10, 20, 25, 50 or 100; default 100
    #[arg(long, value_name = "N", value_parser = positions, help_heading = "Grid")]
    positions: Option<CellPositions>,
    /// Point that x0 and y0 place: corner or centre; default corner with --x0 or --y0, else centre
    #[arg(long, value_name = "POINT", value_parser = one_of::<Anchor, _>(Anchor::ALL.iter().map(|own| own.name())))]
    #[arg(hide_possible_values = true, help_heading = "Grid")]
    anchor: Option<Anchor>,
    #[command(flatten)]
    sensor: FittingSensorFlags,
    /// Also take poses that the sensor cuts off
    #[arg(long)]
    allow_cut: bool,
    /// Threads; default all cores
    #[arg(long, value_name = "N", value_parser = whole::<u16>(1..=1024))]
    jobs: Option<u16>,
    /// Compute only shard K of N of the grid
    #[arg(long, value_name = "K/N", value_parser = parse_shard)]
    shard: Option<Shard>,
    /// Replace an existing file
    #[arg(long)]
    force: bool,
    /// Print JSON, one line per answer
    #[arg(long)]
    json: bool,
    /// Show no progress and no notes
    #[arg(long)]
    quiet: bool,
}

impl Train {
    /// The place is tried before the work begins. A signal stops the training and leaves no file.
    pub(super) fn run(self, cx: &Context) -> Result<(), Failure> {
        self.check()?;
        let pitch = self.sensor.pitch(&cx.settings)?;
        let shapes = shapes::read_set(&self.set, pitch, &cx.shelf)?;
        for shape in &shapes {
            shape
                .source
                .check_size(&Sensor::LARGEST)
                .named(&shape.name)?;
        }
        let (sensor, anchor, ranges) = self.grid(&shapes)?;
        let training = Training::new(shapes, sensor, anchor, ranges)?
            .with_shard(self.shard.unwrap_or(Shard::WHOLE))
            .allow_cut(self.allow_cut);
        let existing = replacing(self.force);
        match (&self.name, &self.out) {
            (Some(name), _) => folder(&cx.shelf)?.check(name, existing)?,
            (None, Some(path)) => check_writable(path, existing)?,
            (None, None) => {}
        }
        let memory = MemoryGuard::new(TOO_LITTLE_MEMORY);
        let by = (self.jobs, memory, self.quiet);
        let model = trained(training.poses(), by, |progress| {
            if !self.quiet {
                cx.note(&grid_text(&sensor, anchor, &ranges));
            }
            training.with_progress(progress).run()
        })?;
        let written = match (self.name, self.out) {
            (Some(name), _) => folder(&cx.shelf)?.save(&model, &name, existing),
            (None, path) => {
                let path = path.unwrap_or_default();
                save_model(&model, &path, existing).map(|()| path)
            }
        };
        // The work is not lost if the file cannot be written.
        let file = written.as_ref().ok().map(|path| path.to_string_lossy());
        let limit = Evaluation::of(&model);
        let text = if self.json {
            let mut card = card(&model, &limit);
            card["file"] = file.into();
            json::ascii(&card) + "\n"
        } else {
            let file = file.filter(|_| !self.quiet);
            let file = file.map(|file| format!("written: {}\n", Charset::current().line(&file)));
            file.unwrap_or_default() + &evaluation::summary(&limit, NamedBy::Imprint)
        };
        cx.print(&text)?;
        written?;
        Ok(())
    }

    fn check(&self) -> Result<(), Failure> {
        let given = &self.ranges.0;
        if self.positions.is_some() && given[Axis::X0].is_some() && given[Axis::Y0].is_some() {
            let text = "--positions has no effect with both --x0 and --y0";
            return Err(Failure::usage(text));
        }
        if let Some(name) = &self.name
            && !ModelChoice::from_name(name.clone()).is_read()
        {
            let text = format!("{name} is the name of a built-in model; choose another name");
            return Err(Failure::new(text));
        }
        self.out.as_deref().map_or(Ok(()), model_file)
    }

    /// The grid for some shapes. If neither x0 nor y0 is given, the anchor is the centre, since a shape's centre stays
    /// in place when it turns: one cell is then enough for all positions.
    fn grid(&self, shapes: &[NamedShape]) -> Result<(Sensor, Anchor, Ranges), Failure> {
        let given = &self.ranges.0;
        let usual = match given[Axis::X0].or(given[Axis::Y0]) {
            Some(_) => Anchor::Corner,
            None => Anchor::Centre,
        };
        let anchor = self.anchor.unwrap_or(usual);
        let sensor = self.sensor.sensor(Sensor::default())?;
        let is_given = |side| self.sensor.has(side);
        let sides = SensorSides {
            columns: is_given(Parameter::Columns).then(|| sensor.columns()),
            rows: is_given(Parameter::Rows).then(|| sensor.rows()),
            ..SensorSides::at_least(LEAST_SIDE)
        };
        check_given(given, &sides.largest())?;
        let sources: Vec<&Source> = shapes.iter().map(|shape| &shape.source).collect();
        let reach = Reach::of_all(sources.iter().copied(), anchor, given)?;
        let step = self.positions.unwrap_or(CellPositions::FINE).step();
        let (sensor, ranges) = reach.best_sensor(&sources, given, sides, step);
        Ok((self.sensor.sensor(sensor)?, anchor, ranges))
    }
}

/// Describes the grid of a training in a line, such as `16 × 16 sensor, threshold 0.5, centre at x0 7:7.8:0.2 cells,
/// y0 7:7.8:0.2 cells, angle 0:355:5°`. A zoom of 1 is left out.
pub(super) fn grid_text(sensor: &Sensor, anchor: Anchor, ranges: &Ranges) -> String {
    let is_unzoomed = |axis: Axis| axis.is_zoom() && ranges[axis] == DecimalRange::whole(1);
    let axes = Axis::ALL.into_iter().filter(|&axis| !is_unzoomed(axis));
    format!(
        "{} sensor, threshold {}, {} at {}",
        sensor.size(),
        sensor.threshold(),
        anchor.name(),
        ranges_in_words(axes, ranges)
    )
}
