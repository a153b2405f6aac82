//! Flags that several commands have: their definitions, the parsers of their text, and functions that read their
//! values.
//!
//! A parser here returns only its reason; clap puts the flag and the given text before it:
//! `error: invalid value '7' for '--positions <N>': expected 1, 2, 4, …`.
//!
//! A row of the table of parameters gives a flag its name, value name and help with range and default. clap only checks
//! that a value is a number. Its range depends on the sensor, which other flags may change, so [`Given`] collects the
//! numbers, and they are checked when a sensor, figure or picture is made from them.

use std::ffi::OsString;
use std::fmt::Display;
use std::num::{IntErrorKind, ParseIntError};
use std::ops::{Bound, RangeBounds};
use std::path::PathBuf;
use std::str::FromStr;

use clap::builder::{OsStringValueParser, PossibleValuesParser, StyledStr, TypedValueParser};
use clap::error::ErrorKind;
use clap::{Arg, ArgAction, ArgGroup, ArgMatches, Command};
use taxel_core::figure::{Figure, FigureKind};
use taxel_core::parameter::{PARAMETERS, Parameter, ParameterError, Unit, UnknownName, number};
use taxel_core::picture::{PICTURE_PARAMETERS, Picture};
use taxel_core::pose::{Anchor, Axis, DecimalRange, GivenRanges, RangeError, Ranges};
use taxel_core::sensor::{SENSOR_PARAMETERS, Sensor};
use taxel_core::sweep::{Shard, ShardError};
use taxel_files::formats::Name;
use taxel_files::formats::file::has_ending;
use taxel_files::memory::MemorySize;
use taxel_files::storage::Existing;

use crate::cli::error::CliError;
use crate::cli::settings::resolved::{Effective, Pitch};
use crate::tui::widget::write::broken;

pub(super) fn switch(name: &'static str, help: &'static str) -> Arg {
    Arg::new(name)
        .long(name)
        .action(ArgAction::SetTrue)
        .help(help)
}

pub(super) fn option(name: &'static str, value: &'static str, help: impl Into<StyledStr>) -> Arg {
    Arg::new(name)
        .long(name)
        .value_name(value)
        .help(help.into())
}

/// Groups a single flag, so that other flags can require the group. clap lets a required flag be missing if a flag
/// that excludes it is given, and would then ignore the flags that require it; a required group is always checked.
pub(super) fn alone(group: &'static str, flag: &'static str) -> ArgGroup {
    ArgGroup::new(group).arg(flag)
}

/// Parses a name, file or other source, which must not be empty.
pub(super) fn name_or_path() -> impl TypedValueParser<Value = OsString> {
    OsStringValueParser::new().try_map(|name| {
        let is_empty = name.is_empty();
        (!is_empty)
            .then_some(name)
            .ok_or("expected a name or a path")
    })
}

/// Makes a parser of whole numbers within a range. Its messages say what is expected in words, where clap's own would
/// be `invalid digit found in string` or `0 is not in 1..=4096`.
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

/// Defines the flag of an axis of the grid, which takes a range. `default` describes the default in the help; if
/// empty, it is the range of the paper.
pub(super) fn range(axis: Axis, default: &str) -> Arg {
    let (row, flag) = (axis.parameter().row(), axis.parameter().flag());
    let paper = Ranges::default()[axis].to_string();
    let help = format!(
        "{}; default {}",
        capitalised(row.meaning),
        if default.is_empty() { &paper } else { default }
    );
    Arg::new(format!("range_{}", row.key))
        .long(flag)
        .value_name("START:END:STEP")
        .allow_hyphen_values(true)
        .value_parser(parse_range)
        .help_heading("Grid")
        .help(wrapped(&help, 46))
}

pub(super) fn ranges_of(matches: &ArgMatches) -> GivenRanges {
    GivenRanges::from_fn(|axis| {
        let range = matches.get_one(&format!("range_{}", axis.name()));
        range.copied()
    })
}

pub(super) fn anchor() -> Arg {
    option(
        "anchor",
        "POINT",
        "Point that x0 and y0 place: corner (default)\nor centre",
    )
    .value_parser(one_of::<Anchor, _>(Anchor::NAMES))
    .hide_possible_values(true)
    .help_heading("Grid")
}

pub(super) fn jobs() -> Arg {
    option("jobs", "N", "Threads; default all cores").value_parser(whole::<u16>(1..=1024))
}

pub(super) fn jobs_of(matches: &ArgMatches) -> usize {
    matches
        .get_one::<u16>("jobs")
        .map_or(0, |&jobs| jobs.into())
}

pub(super) fn memory() -> Arg {
    option(
        "memory",
        "SIZE",
        "Most memory to use, such as 500M or 2G;\ndefault all that is free",
    )
    .value_parser(|text: &str| text.parse::<MemorySize>())
}

pub(crate) const TOO_LITTLE_MEMORY: &str = "take coarser steps, work in shards (--shard 1/8, ..., then taxel merge), or allow more (--memory)";

pub(super) fn memory_of(matches: &ArgMatches) -> Option<MemorySize> {
    matches.get_one("memory").copied()
}

pub(super) fn shard() -> Arg {
    option("shard", "K/N", "Compute only shard K of N of the grid").value_parser(parse_shard)
}

pub(super) fn shard_of(matches: &ArgMatches) -> Shard {
    matches.get_one("shard").copied().unwrap_or(Shard::WHOLE)
}

pub(super) fn replace() -> Arg {
    force().help("Replace an existing file")
}

pub(crate) fn existing(matches: &ArgMatches) -> Existing {
    if matches.get_flag("force") {
        Existing::Replaced
    } else {
        Existing::Kept
    }
}

pub(super) fn quiet() -> Arg {
    switch("quiet", "Show no progress and no notes")
}

pub(super) fn force() -> Arg {
    switch("force", "Replace an existing shape of this name")
}

pub(super) fn sensor() -> Vec<Arg> {
    of_sensor(SENSOR_PARAMETERS)
}

pub(super) fn sensor_of_imprints() -> Vec<Arg> {
    let own = SENSOR_PARAMETERS.iter().copied();
    let own = own.filter(|&parameter| parameter != Parameter::Pitch);
    of_sensor(&own.collect::<Vec<_>>())
}

pub(super) fn of_sensor(parameters: &[Parameter]) -> Vec<Arg> {
    let flag = |&parameter: &Parameter| arg(parameter).help_heading("Sensor");
    parameters.iter().map(flag).collect()
}

pub(super) fn name(help: &'static str) -> Arg {
    Arg::new("name")
        .value_name("NAME")
        .required(true)
        .value_parser(Name::new)
        .help(help)
}

/// Returns the name or file that an argument gives, with any bytes. It is empty if the argument is not given; one
/// that clap requires is always given.
pub(super) fn word(matches: &ArgMatches, id: &str) -> OsString {
    let word = matches.get_one::<OsString>(id);
    word.map_or_else(OsString::new, Clone::clone)
}

/// Defines a positional argument that is a name or a file; [`Shelf::find`](crate::cli::input::shapes::Shelf::find)
/// decides which.
pub(super) fn what(help: &'static str) -> Arg {
    Arg::new("what")
        .value_name("NAME|FILE")
        .required(true)
        .value_parser(name_or_path())
        .help(help)
}

pub(super) fn json() -> Arg {
    switch("json", "Print JSON, one line per answer")
}

#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(crate) enum EvaluationForm {
    Text,
    Csv,
    Json,
}

impl EvaluationForm {
    pub(super) fn of(matches: &ArgMatches) -> Self {
        match (matches.get_flag("json"), matches.get_flag("csv")) {
            (true, _) => Self::Json,
            (false, true) => Self::Csv,
            (false, false) => Self::Text,
        }
    }
}

pub(super) fn parse_probability(text: &str) -> Result<f64, String> {
    let number = parse_number(text)?;
    (0.0..=1.0)
        .contains(&number)
        .then_some(number)
        .ok_or_else(|| "expected a number from 0 to 1".to_owned())
}

/// Parses a range. clap quotes the argument, so the message does not quote the whole of it again.
pub(super) fn parse_range(text: &str) -> Result<DecimalRange, String> {
    text.parse().map_err(|error: RangeError| match &error {
        RangeError::Form(_) => error.expected(),
        RangeError::Number(part) if part == text => number::complaint(text),
        _ => error.to_string(),
    })
}

fn parse_shard(text: &str) -> Result<Shard, &'static str> {
    text.parse().map_err(|error: ShardError| error.expected())
}

pub(super) fn parse_number(text: &str) -> Result<f64, String> {
    number::read(text).ok_or_else(|| number::complaint(text))
}

pub(super) fn report() -> impl TypedValueParser<Value = PathBuf> {
    let expected = "expected a name that ends in .csv or .svg";
    file_of(&["csv", "svg"], expected)
}

pub(super) fn npy() -> impl TypedValueParser<Value = PathBuf> {
    file_of(&["npy"], "expected a name that ends in .npy")
}

/// Parses the name of a file with one of these extensions, in upper or lower case. It need not be UTF-8.
fn file_of(
    endings: &'static [&'static str],
    expected: &'static str,
) -> impl TypedValueParser<Value = PathBuf> {
    OsStringValueParser::new().try_map(move |name| {
        let path = PathBuf::from(name);
        let known = endings.iter().any(|ending| has_ending(&path, ending));
        known.then_some(path).ok_or(expected)
    })
}

pub(super) fn required<T: Clone + Send + Sync + 'static>(
    matches: &ArgMatches,
    id: &str,
) -> Result<T, CliError> {
    matches.get_one::<T>(id).cloned().ok_or_else(|| {
        let message = format!("the argument '{id}' is required\n");
        clap::Error::raw(ErrorKind::MissingRequiredArgument, message).into()
    })
}

/// Returns the error for a subcommand that is defined but not handled. Such a bug must not run another subcommand.
pub(super) fn unhandled_subcommand(name: &str) -> CliError {
    let message = format!("{name:?} is not implemented; this is a bug\n");
    clap::Error::raw(ErrorKind::InvalidSubcommand, message).into()
}

pub(super) fn which_model() -> Arg {
    Arg::new("model")
        .value_name("MODEL")
        .required(true)
        .value_parser(name_or_path())
        .help("Name of a model, or its file")
}

pub(super) fn seed() -> Arg {
    option("seed", "N", "Seed of the random numbers; default 0")
        .value_parser(whole::<u64>(0..))
        .default_value("0")
        .hide_default_value(true)
}

pub(super) fn number_of<T: Copy + Send + Sync + 'static>(
    matches: &ArgMatches,
    id: &str,
    default: T,
) -> T {
    matches.get_one(id).copied().unwrap_or(default)
}

pub(super) fn misused(command: &mut Command, name: &str, message: &str) -> CliError {
    let error = command.find_subcommand_mut(name).map_or_else(
        || clap::Error::raw(ErrorKind::ArgumentConflict, format!("{message}\n")),
        |command| command.error(ErrorKind::ArgumentConflict, message),
    );
    error.into()
}

const HELP_WIDTH: usize = 52;

#[derive(Clone, Debug)]
struct Number {
    text: String,
    value: f64,
}

pub(crate) fn figure_parameters() -> impl Iterator<Item = Parameter> {
    PARAMETERS
        .iter()
        .map(|row| row.parameter)
        .filter(|&parameter| kinds_with(parameter).next().is_some())
}

fn kinds_with(parameter: Parameter) -> impl Iterator<Item = FigureKind> {
    FigureKind::ALL
        .iter()
        .copied()
        .filter(move |kind| kind.parameters().contains(&parameter))
}

pub(crate) fn arg(parameter: Parameter) -> Arg {
    let default = match parameter {
        Parameter::Thickness | Parameter::Pitch => String::new(),
        _ => format!("; default {}", Sensor::default().default_value(parameter)),
    };
    arg_with(parameter, &default)
}

pub(crate) fn arg_with_own(parameter: Parameter) -> Arg {
    match parameter {
        Parameter::Angle | Parameter::ZoomX | Parameter::ZoomY | Parameter::Pitch => arg(parameter),
        _ => arg_with(parameter, "; default the shape's"),
    }
}

pub(crate) fn arg_fitting(side: Parameter) -> Arg {
    arg_with(side, "; default large enough for all shapes, at least 16")
}

fn arg_with(parameter: Parameter, default: &str) -> Arg {
    let row = parameter.row();
    let unit = match row.unit {
        Unit::Ratio => String::new(),
        unit => format!("{}, ", unit.name()),
    };
    let also = match parameter {
        Parameter::Pitch => "; adds mm to tables and drawings, not to JSON",
        _ => "",
    };
    let range = Sensor::default().range(parameter);
    let meaning = capitalised(row.meaning);
    let help = format!("{meaning}{also} ({unit}{range}{default})");
    Arg::new(row.key)
        .long(parameter.flag())
        .value_name(match row.unit {
            Unit::Ratio => "NUMBER".to_owned(),
            unit => unit.name().to_ascii_uppercase(),
        })
        .help(wrapped(&help, HELP_WIDTH))
        // A minus sign starts a number here, not a flag.
        .allow_hyphen_values(true)
        .value_parser(parse)
}

fn parse(text: &str) -> Result<Number, String> {
    let value = number::read(text).ok_or_else(|| number::complaint(text))?;
    let text = text.trim().to_owned();
    Ok(Number { text, value })
}

pub(super) fn one_of<T, N>(names: N) -> impl TypedValueParser<Value = T>
where
    T: FromStr<Err = UnknownName> + Clone + Send + Sync + 'static,
    N: IntoIterator<Item = &'static str>,
{
    PossibleValuesParser::new(names).try_map(|name| name.parse())
}

pub(crate) fn capitalised(text: &str) -> String {
    let mut characters = text.chars();
    let first = characters.next().map(|first| first.to_ascii_uppercase());
    first.into_iter().chain(characters).collect()
}

pub(crate) fn wrapped(text: &str, width: usize) -> String {
    broken(text, width).join("\n")
}

/// The values given by flags. They are numbers, but may be out of range.
#[derive(Clone, Debug, Default)]
pub(crate) struct Given(Vec<(Parameter, Number)>);

impl Given {
    pub(crate) fn of(matches: &ArgMatches) -> Self {
        let given = |parameter: Parameter| {
            let number = matches.try_get_one::<Number>(parameter.row().key);
            Some((parameter, number.ok().flatten()?.clone()))
        };
        let parameters = PARAMETERS.iter().map(|row| row.parameter);
        Self(parameters.filter_map(given).collect())
    }

    pub(crate) fn first(&self) -> Option<String> {
        self.0.first().map(|(parameter, _)| parameter.flag())
    }

    pub(crate) fn has(&self, parameter: Parameter) -> bool {
        self.0.iter().any(|(given, _)| *given == parameter)
    }

    fn fold<T>(
        &self,
        own: &[Parameter],
        mut thing: T,
        with: impl Fn(T, Parameter, f64) -> Result<T, ParameterError>,
    ) -> Result<T, CliError> {
        for (parameter, number) in &self.0 {
            if own.contains(parameter) {
                thing = with(thing, *parameter, number.value).map_err(|error| CliError::Range {
                    flag: parameter.flag(),
                    text: number.text.clone(),
                    complaint: error.complaint(),
                })?;
            }
        }
        Ok(thing)
    }

    pub(crate) fn sensor(&self, sensor: Sensor) -> Result<Sensor, CliError> {
        self.fold(SENSOR_PARAMETERS, sensor, Sensor::with)
    }

    pub(crate) fn pitch(&self) -> Result<Option<f64>, CliError> {
        self.fold(&[Parameter::Pitch], None, |_, parameter, value| {
            Sensor::LARGEST.check(parameter, value).map(Some)
        })
    }

    pub(crate) fn foreign(&self, kind: FigureKind) -> Option<Parameter> {
        figure_parameters()
            .filter(|&parameter| !kind.parameters().contains(&parameter))
            .find(|&parameter| self.0.iter().any(|(given, _)| *given == parameter))
    }

    pub(crate) fn figure(&self, kind: FigureKind, sensor: &Sensor) -> Result<Figure, CliError> {
        let figure = Figure::default_of(kind, sensor);
        self.fold(kind.parameters(), figure, |figure, parameter, value| {
            figure.with(parameter, value, sensor)
        })
    }

    pub(crate) fn picture(&self, picture: Picture, sensor: &Sensor) -> Result<Picture, CliError> {
        self.fold(PICTURE_PARAMETERS, picture, |picture, parameter, value| {
            picture.with(parameter, value, sensor)
        })
    }
}

#[derive(Clone, Copy, Debug, PartialEq)]
pub(crate) enum Form {
    Json(Pitch),
    /// The matrix and a table, which is in mm too if the pitch is known.
    Table(Pitch),
}

impl Form {
    pub(super) fn of(matches: &ArgMatches, settings: &Effective) -> Result<Self, CliError> {
        let pitch = pitch_of(matches, settings)?;
        Ok(if matches.get_flag("json") {
            Self::Json(pitch)
        } else {
            Self::Table(pitch)
        })
    }
}

pub(super) fn pitch_of(matches: &ArgMatches, settings: &Effective) -> Result<Pitch, CliError> {
    Ok(Pitch {
        given: Given::of(matches).pitch()?,
        usual: settings.pitch,
    })
}
