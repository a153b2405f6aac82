//! Flags that several commands have: how they are defined, how their text is parsed, and how their values are read
//! back.
//!
//! A parser here returns its reason as a text; clap puts the flag and the given text before it:
//! `error: invalid value '7' for '--positions <N>': expected 1, 2, 4, …`.

use std::ffi::{OsStr, OsString};
use std::fmt::Display;
use std::num::{IntErrorKind, ParseIntError};
use std::ops::{Bound, RangeBounds};
use std::path::PathBuf;
use std::str::FromStr;

use clap::builder::{OsStringValueParser, TypedValueParser};
use clap::error::ErrorKind;
use clap::{Arg, ArgAction, ArgGroup, ArgMatches};

use crate::cli::arguments::parameters;
use crate::cli::error::CliError;
use crate::formats::{Name, NameError};
use crate::memory::MemorySize;
use crate::parameter::{Parameter, number};
use crate::pose::{Anchor, Axis, DecimalRange, GivenRanges, RangeError, Ranges};
use crate::sensor::SENSOR_PARAMETERS;
use crate::sweep::{Shard, ShardError};

/// A flag without a value, `--NAME`.
pub(super) fn switch(name: &'static str, help: &'static str) -> Arg {
    Arg::new(name)
        .long(name)
        .action(ArgAction::SetTrue)
        .help(help)
}

/// A flag with a value, `--NAME VALUE`. Without a parser of its own the value is a text.
pub(super) fn option(name: &'static str, value: &'static str, help: &'static str) -> Arg {
    Arg::new(name).long(name).value_name(value).help(help)
}

/// A group of one flag, for others that require it but would accept, by themselves, what it excludes. clap waives a required
/// flag where one is given that excludes it, and would ignore the others; it does not waive a required group.
pub(super) fn alone(group: &'static str, flag: &'static str) -> ArgGroup {
    ArgGroup::new(group).arg(flag)
}

/// A parser of the name of something stored, of a file or of another source, which is not empty.
pub(super) fn name_or_path() -> impl TypedValueParser<Value = OsString> {
    OsStringValueParser::new().try_map(|name| {
        let is_empty = name.is_empty();
        (!is_empty)
            .then_some(name)
            .ok_or("expected a name or a path")
    })
}

/// A parser of whole numbers within a range. It says what is expected in words, where clap's own would say
/// `invalid digit found in string` or `0 is not in 1..=4096`.
pub(super) fn whole<T>(
    range: impl RangeBounds<T> + Clone,
) -> impl Fn(&str) -> Result<T, String> + Clone
where
    T: FromStr<Err = ParseIntError> + PartialOrd + Display,
{
    move |text| {
        let number = text.trim().parse::<T>();
        let is_too_large = number
            .as_ref()
            .is_err_and(|error| *error.kind() == IntErrorKind::PosOverflow);
        number
            .ok()
            .filter(|number| range.contains(number))
            .ok_or_else(|| {
                let bounds = match (range.start_bound(), range.end_bound()) {
                    (Bound::Included(least), Bound::Included(most)) => {
                        format!(" from {least} to {most}")
                    }
                    _ if is_too_large => return "the number is too large".to_owned(),
                    (Bound::Included(least), _) => format!(", {least} or more"),
                    _ => String::new(),
                };
                format!("expected a whole number{bounds}")
            })
    }
}

/// The flag of an axis of the grid, which takes a range. `default` says what is taken without it; empty for the range
/// of the paper.
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

/// The axes of the grid whose flags, made by [`range`], are given.
pub(super) fn ranges_of(matches: &ArgMatches) -> GivenRanges {
    GivenRanges::from_fn(|axis| {
        let range = matches.get_one(&format!("range_{}", axis.name()));
        range.copied()
    })
}

/// `--anchor`, the point of a shape that the ranges of x0 and y0 place.
pub(super) fn anchor() -> Arg {
    option(
        "anchor",
        "POINT",
        "What x0 and y0 set: corner (default) or centre",
    )
    .value_parser(parameters::one_of(Anchor::NAMES, Anchor::from_name))
    .hide_possible_values(true)
    .help_heading("Grid")
}

/// `--jobs`, the number of threads.
pub(super) fn jobs() -> Arg {
    option("jobs", "N", "Threads; default all cores").value_parser(whole::<u16>(1..=1024))
}

/// The value of [`jobs`]; 0, which means a thread for each core, if it is not given.
pub(super) fn jobs_of(matches: &ArgMatches) -> usize {
    matches
        .get_one::<u16>("jobs")
        .map_or(0, |&jobs| jobs.into())
}

/// `--memory`, the most that a sweep or a training may use.
pub(super) fn memory() -> Arg {
    option(
        "memory",
        "SIZE",
        "Stop before using more memory: 500M, 2G;\ndefault all that is free",
    )
    .value_parser(|text: &str| text.parse::<MemorySize>())
}

/// What to do where memory does not suffice for work that has the flags [`memory`] and [`shard`].
pub(crate) const TOO_LITTLE_MEMORY: &str = "take coarser steps, work in shards (--shard 1/8, ..., then taxel merge), or allow more (--memory)";

/// The value of [`memory`], if it is given.
pub(super) fn memory_of(matches: &ArgMatches) -> Option<MemorySize> {
    matches.get_one("memory").copied()
}

/// `--shard`, for work that several machines share.
pub(super) fn shard() -> Arg {
    option("shard", "K/N", "Compute only shard K of N of the grid").value_parser(parse_shard)
}

/// The value of [`shard`]; the whole grid if it is not given.
pub(super) fn shard_of(matches: &ArgMatches) -> Shard {
    matches.get_one("shard").copied().unwrap_or(Shard::WHOLE)
}

/// `--resume`, for shards of a study that was interrupted.
pub(super) fn resume() -> Arg {
    switch(
        "resume",
        "Skip the shard if its file is complete and belongs\nto this study; refuse any other file",
    )
    .conflicts_with("force")
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
    force().help("Replace an existing file")
}

/// `--quiet`.
pub(super) fn quiet() -> Arg {
    switch("quiet", "Show no progress and no notes")
}

/// `--force`, for commands that store a shape.
pub(super) fn force() -> Arg {
    switch("force", "Replace an existing shape of this name")
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

/// The name or the file that an argument gives, whatever its bytes are. Empty if it is not given: an argument that
/// clap requires is always there.
pub(super) fn word(matches: &ArgMatches, id: &str) -> OsString {
    let word = matches.get_one::<OsString>(id);
    word.map_or_else(OsString::new, Clone::clone)
}

/// A positional argument that is a name or a file; [`Shelf::find`](crate::cli::input::shapes::Shelf::find) tells which.
pub(super) fn what(help: &'static str) -> Arg {
    Arg::new("what")
        .value_name("NAME|FILE")
        .required(true)
        .value_parser(name_or_path())
        .help(help)
}

/// `--json`.
pub(super) fn json() -> Arg {
    switch("json", "Print JSON, one line per answer")
}

/// How an evaluation is printed.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(crate) enum EvaluationForm {
    /// Tables and bars for people.
    Text,
    /// A table of commas with a first row of names: `--csv`.
    Csv,
    /// One line of JSON: `--json`.
    Json,
}

impl EvaluationForm {
    /// The form that `--json` or `--csv` asks for; these exclude each other.
    pub(super) fn of(matches: &ArgMatches) -> Self {
        match (matches.get_flag("json"), matches.get_flag("csv")) {
            (true, _) => Self::Json,
            (false, true) => Self::Csv,
            (false, false) => Self::Text,
        }
    }
}

/// A number from 0 to 1.
pub(super) fn parse_probability(text: &str) -> Result<f64, String> {
    let number = parse_number(text)?;
    (0.0..=1.0)
        .contains(&number)
        .then_some(number)
        .ok_or_else(|| "expected a number from 0 to 1".to_owned())
}

/// A finite number, with a point as the decimal sign.
pub(super) fn parse_number(text: &str) -> Result<f64, String> {
    number::read(text).ok_or_else(|| number::complaint(text))
}

/// A parser of a file of numbers or of a drawing, by its ending.
pub(super) fn report() -> impl TypedValueParser<Value = PathBuf> {
    let expected = "expected a name that ends in .csv, .svg or .png";
    file_of(&["csv", "svg", "png"], expected)
}

/// A parser of a file that numpy reads: all poses of a sweep, or recorded frames.
pub(super) fn npy() -> impl TypedValueParser<Value = PathBuf> {
    file_of(&["npy"], "expected a name that ends in .npy")
}

/// A parser of a file with one of these endings, in capitals or not. Its name need not be UTF-8.
fn file_of(
    endings: &'static [&'static str],
    expected: &'static str,
) -> impl TypedValueParser<Value = PathBuf> {
    OsStringValueParser::new().try_map(move |name| {
        let path = PathBuf::from(name);
        let is_known = |ending: &OsStr| endings.iter().any(|own| ending.eq_ignore_ascii_case(own));
        let known = path.extension().is_some_and(is_known);
        known.then_some(path).ok_or(expected)
    })
}

/// The value of an argument that clap makes sure of: without it the command is refused before this is called.
pub(super) fn required<T: Clone + Send + Sync + 'static>(
    matches: &ArgMatches,
    id: &str,
) -> Result<T, CliError> {
    matches.get_one::<T>(id).cloned().ok_or_else(|| {
        let message = format!("the argument '{id}' is required\n");
        clap::Error::raw(ErrorKind::MissingRequiredArgument, message).into()
    })
}

/// The error for a subcommand that is defined but not handled. Such a bug must not run another subcommand.
pub(super) fn unhandled_subcommand(name: &str) -> CliError {
    let message = format!("{name:?} is not implemented; this is a bug\n");
    clap::Error::raw(ErrorKind::InvalidSubcommand, message).into()
}
