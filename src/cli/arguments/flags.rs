//! Flags that several commands have.

use std::ffi::OsString;
use std::path::PathBuf;

use clap::{Arg, ArgAction, ArgMatches, value_parser};

use crate::cli::arguments::parameters;
use crate::formats::{Name, NameError};
use crate::parameter::Parameter;
use crate::pose::{Anchor, Axis, DecimalRange, RangeError, Ranges};
use crate::sensor::SENSOR_PARAMETERS;
use crate::sweep::{Shard, ShardError};

/// The flag of an axis of the grid, which takes a range. `default` says what is taken without it; empty for the range of
/// the paper.
pub(super) fn range(axis: Axis, default: &str) -> Arg {
    let (row, flag) = (axis.parameter().row(), axis.parameter().flag());
    let paper = Ranges::default()[axis].to_string();
    let help = format!(
        "{}; default {}",
        parameters::capitalised(row.meaning),
        if default.is_empty() { &paper } else { default }
    );
    Arg::new(format!("range_{}", row.key))
        .long(flag)
        .value_name("START:END:STEP")
        .allow_hyphen_values(true)
        .value_parser(parse_range)
        .help_heading("Grid")
        .help(parameters::wrapped(&help, 46))
}

/// `--anchor`, the point of a shape that the ranges of x0 and y0 place.
pub(super) fn anchor() -> Arg {
    Arg::new("anchor")
        .long("anchor")
        .value_name("POINT")
        .value_parser(parameters::one_of(Anchor::NAMES, Anchor::from_name))
        .hide_possible_values(true)
        .help_heading("Grid")
        .help("What x0 and y0 place: corner or centre")
}

/// `--jobs`, the number of threads.
pub(super) fn jobs() -> Arg {
    Arg::new("jobs")
        .long("jobs")
        .value_name("N")
        .value_parser(value_parser!(u16).range(1..=1024))
        .help("Threads; default all cores")
}

/// `--shard`, for work that several machines share.
pub(super) fn shard() -> Arg {
    Arg::new("shard")
        .long("shard")
        .value_name("K/N")
        .value_parser(parse_shard)
        .help("Do this piece of the grid only")
}

/// A range of the grid, such as `5:5.99:0.01`.
pub(super) fn parse_range(text: &str) -> Result<DecimalRange, RangeError> {
    text.parse()
}

/// A piece of the grid, such as `3/40`.
fn parse_shard(text: &str) -> Result<Shard, ShardError> {
    text.parse()
}

/// `--force`, for commands that write a file.
pub(super) fn replace() -> Arg {
    force().help("Replace a file that is there already")
}

/// `--quiet`.
pub(super) fn quiet() -> Arg {
    Arg::new("quiet")
        .long("quiet")
        .action(ArgAction::SetTrue)
        .help("Show no progress")
}

/// `--force`, for commands that store a shape.
pub(super) fn force() -> Arg {
    Arg::new("force")
        .long("force")
        .action(ArgAction::SetTrue)
        .help("Replace a shape that has the name already")
}

/// All flags of the sensor.
pub(super) fn sensor() -> Vec<Arg> {
    of_sensor(&SENSOR_PARAMETERS)
}

/// The flags of the sensor without `--pitch`, for commands that show no lengths.
pub(super) fn sensor_of_imprints() -> Vec<Arg> {
    let own = SENSOR_PARAMETERS.into_iter();
    let own = own.filter(|&parameter| parameter != Parameter::Pitch);
    of_sensor(&own.collect::<Vec<_>>())
}

/// The flags of some parameters of the sensor.
pub(super) fn of_sensor(parameters: &[Parameter]) -> Vec<Arg> {
    let flag = |&parameter: &Parameter| parameters::arg(parameter).help_heading("Sensor");
    parameters.iter().map(flag).collect()
}

/// A positional argument that is the name of a stored shape.
pub(super) fn name(help: &'static str) -> Arg {
    Arg::new("name")
        .value_name("NAME")
        .required(true)
        .value_parser(parse_name)
        .help(help)
}

/// The name of a shape; see [`Name`] for which are allowed.
pub(super) fn parse_name(text: &str) -> Result<Name, NameError> {
    Name::new(text)
}

/// A positional argument that is a name or a file; [`Shelf::find`](crate::cli::input::shapes::Shelf::find) tells which.
pub(super) fn what(help: &'static str) -> Arg {
    Arg::new("what")
        .value_name("NAME|FILE")
        .required(true)
        .value_parser(value_parser!(OsString))
        .help(help)
}

/// `--json`.
pub(super) fn json() -> Arg {
    Arg::new("json")
        .long("json")
        .action(ArgAction::SetTrue)
        .help("Answer in one line of JSON")
}

/// How an evaluation is printed.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(crate) enum EvaluationForm {
    Text,
    Csv,
    Json,
}

/// How an evaluation is printed.
pub(super) fn form_of(matches: &ArgMatches) -> EvaluationForm {
    if matches.get_flag("json") {
        EvaluationForm::Json
    } else if matches.get_flag("csv") {
        EvaluationForm::Csv
    } else {
        EvaluationForm::Text
    }
}

/// A number from 0 to 1.
pub(super) fn parse_probability(text: &str) -> Result<f64, &'static str> {
    let number = text.trim().parse().ok();
    number
        .filter(|number| (0.0..=1.0).contains(number))
        .ok_or("expected a number from 0 to 1")
}

/// A file of numbers or of a drawing, which its ending tells.
pub(super) fn parse_report(text: &str) -> Result<PathBuf, &'static str> {
    let path = PathBuf::from(text);
    let ending = path.extension().and_then(|ending| ending.to_str());
    let known = ending.is_some_and(|ending| {
        ["csv", "svg", "png"].contains(&ending.to_ascii_lowercase().as_str())
    });
    known
        .then_some(path)
        .ok_or("expected a name that ends in .csv, .svg or .png")
}
