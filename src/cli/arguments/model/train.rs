//! The flags of `taxel model train`, and how they are read.

use std::path::{Path, PathBuf};

use clap::{Arg, ArgGroup, ArgMatches, Command, value_parser};

use crate::cli::arguments::flags::{
    self, anchor, jobs, json, memory, of_sensor, option, quiet, range, replace, shard, switch,
};
use crate::cli::arguments::help::MODEL_TRAIN_EXAMPLES;
use crate::cli::arguments::model::shape_set::{self, SetArguments};
use crate::cli::arguments::parameters::{self, Given};
use crate::cli::error::CliError;
use crate::formats::Name;
use crate::formats::file::has_ending;
use crate::memory::MemorySize;
use crate::parameter::Parameter;
use crate::pose::{Anchor, Axis, GivenRanges, SensorSides};
use crate::recognition::{CellPositions, LEAST_SIDE};
use crate::sensor::Sensor;
use crate::storage::Existing;
use crate::sweep::Shard;

#[derive(Clone, Debug)]
pub(crate) struct TrainArguments {
    pub(crate) set: SetArguments,
    /// The point of a shape that x0 and y0 place; None for the corner if x0 or y0 is given, else the centre.
    pub(crate) anchor: Option<Anchor>,
    /// The axes of the grid that are given. The others are chosen so that the sensor does not cut off any shape.
    pub(crate) ranges: GivenRanges,
    pub(crate) positions: Option<CellPositions>,
    /// The sides of the sensor that are given. The others are chosen so that it does not cut off any shape.
    pub(crate) sides: SensorSides,
    pub(crate) given: Given,
    pub(crate) shard: Shard,
    pub(crate) jobs: usize,
    /// The most memory that the training may use, if given.
    pub(crate) memory: Option<MemorySize>,
    /// Whether poses at which the sensor cuts a shape off are learned too; otherwise they are an error.
    pub(crate) allow_cut: bool,
    pub(crate) to: ModelTarget,
    pub(crate) existing: Existing,
    pub(crate) json: bool,
    pub(crate) quiet: bool,
}

#[derive(Clone, Debug)]
pub(crate) enum ModelTarget {
    File(PathBuf),
    Named(Name),
}

pub(super) fn command() -> Command {
    let out = option("out", "FILE.npz", "Write the model to this file")
        .value_parser(value_parser!(PathBuf));
    let name = option(
        "name",
        "NAME",
        "Keep the model under this name, beside the library",
    )
    .value_parser(Name::new);
    let allow_cut = switch("allow-cut", "Also take poses that the sensor cuts off");
    let anchor = anchor().help(
        "Point that x0 and y0 place: corner or centre;\n\
         default corner with --x0 or --y0, else centre",
    );
    Command::new("train")
        .about("Learn every imprint of a set of shapes")
        .override_usage("taxel model train [OPTIONS] <--out FILE|--name NAME> [FILE|NAME]...")
        .after_help(MODEL_TRAIN_EXAMPLES)
        .args(shape_set::args(
            "FILE.jsonl|NAME",
            "Shapes: files of JSON lines, '-' for standard input,\nor names of the library",
        ))
        .args([out, name])
        .group(shape_set::group())
        .group(ArgGroup::new("target").args(["out", "name"]).required(true))
        .args(Axis::ALL.map(|axis| match axis {
            Axis::X0 | Axis::Y0 => range(axis, "one cell in which no shape is cut off"),
            _ => range(axis, ""),
        }))
        .arg(shape_set::positions())
        .arg(anchor)
        .args([Parameter::Columns, Parameter::Rows].map(fitting))
        .args(of_sensor(&[Parameter::Threshold]))
        .args([
            allow_cut,
            jobs(),
            memory(),
            shard(),
            replace(),
            json(),
            quiet(),
        ])
}

fn fitting(side: Parameter) -> Arg {
    parameters::arg_fitting(side).help_heading("Sensor")
}

impl TrainArguments {
    pub(super) fn of(matches: &ArgMatches) -> Result<Self, CliError> {
        let given = Given::of(matches);
        let sensor = given.sensor(Sensor::default())?;
        let sides = SensorSides::at_least(LEAST_SIDE).with_sides_of(&sensor, |axis| {
            given.has(match axis {
                Axis::Y0 => Parameter::Rows,
                _ => Parameter::Columns,
            })
        });
        let to = match matches.get_one::<Name>("name") {
            Some(name) => ModelTarget::Named(name.clone()),
            None => ModelTarget::File(matches.get_one("out").cloned().unwrap_or_default()),
        };
        if let ModelTarget::File(path) = &to {
            model_file(path)?;
        }
        let ranges = flags::ranges_of(matches);
        let positions = matches.get_one::<CellPositions>("positions").copied();
        if positions.is_some() && ranges[Axis::X0].is_some() && ranges[Axis::Y0].is_some() {
            let (flag, reason) = ("positions", "with both --x0 and --y0".to_owned());
            return Err(CliError::Unused { flag, reason });
        }
        Ok(Self {
            set: SetArguments::of(matches),
            anchor: matches.get_one::<Anchor>("anchor").copied(),
            ranges,
            positions,
            sides,
            given,
            shard: flags::shard_of(matches),
            jobs: flags::jobs_of(matches),
            memory: flags::memory_of(matches),
            allow_cut: matches.get_flag("allow-cut"),
            to,
            existing: flags::existing(matches),
            json: matches.get_flag("json"),
            quiet: matches.get_flag("quiet"),
        })
    }
}

/// Refuses a file name without the extension of a model: such a file would be taken for something else when it is
/// read.
pub(crate) fn model_file(path: &Path) -> Result<(), CliError> {
    if has_ending(path, "npz") {
        return Ok(());
    }
    Err(CliError::Ending {
        name: path.to_string_lossy().into_owned(),
        what: "a model",
        expected: ".npz",
    })
}
