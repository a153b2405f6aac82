//! Flags that several commands have: their definitions, the parsers of their text, and functions that read their
//! values.
//!
//! A parser here returns only its reason; clap puts the flag and the given text before it:
//! `error: invalid value '7' for '--positions <N>': expected 1, 2, 4, …`.

use std::ffi::OsString;
use std::fmt::Display;
use std::num::{IntErrorKind, ParseIntError};
use std::ops::{Bound, RangeBounds};
use std::path::PathBuf;
use std::str::FromStr;

use clap::builder::{OsStringValueParser, PossibleValuesParser, TypedValueParser};
use clap::error::ErrorKind;
use clap::{Arg, ArgAction, ArgMatches};
use taxel_core::parameter::{Parameter, UnknownName, number};
use taxel_core::sweep::{Shard, ShardError};
use taxel_files::formats::Name;
use taxel_files::formats::file::has_ending;
use taxel_files::storage::Existing;

use crate::cli::arguments::parameters;
use crate::cli::error::CliError;
use crate::cli::settings::resolved::{Effective, Pitch};

pub(crate) fn switch(name: &'static str, help: &'static str) -> Arg {
    Arg::new(name)
        .long(name)
        .action(ArgAction::SetTrue)
        .help(help)
}

/// Parses a name, file or other source, which must not be empty.
pub(crate) fn name_or_path() -> impl TypedValueParser<Value = OsString> {
    OsStringValueParser::new().try_map(|name| {
        let is_empty = name.is_empty();
        (!is_empty)
            .then_some(name)
            .ok_or("expected a name or a path")
    })
}

/// Makes a parser of whole numbers within a range. Its messages say what is expected in words, where clap's own would
/// be `invalid digit found in string` or `0 is not in 1..=4096`.
pub(crate) fn whole<T>(
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

pub(crate) const TOO_LITTLE_MEMORY: &str = "take coarser steps, work in shards (--shard 1/8, ..., then taxel merge), or allow more (--memory)";

pub(crate) fn existing(matches: &ArgMatches) -> Existing {
    if matches.get_flag("force") {
        Existing::Replaced
    } else {
        Existing::Kept
    }
}

pub(crate) fn force() -> Arg {
    switch("force", "Replace an existing shape of this name")
}

pub(crate) fn name(help: &'static str) -> Arg {
    Arg::new("name")
        .value_name("NAME")
        .required(true)
        .value_parser(Name::new)
        .help(help)
}

/// Defines a positional argument that is a name or a file; [`Shelf::find`](crate::cli::input::shapes::Shelf::find)
/// decides which.
pub(crate) fn what(help: &'static str) -> Arg {
    Arg::new("what")
        .value_name("NAME|FILE")
        .required(true)
        .value_parser(name_or_path())
        .help(help)
}

pub(crate) fn json() -> Arg {
    switch("json", "Print JSON, one line per answer")
}

pub(crate) fn parse_probability(text: &str) -> Result<f64, String> {
    let number = parse_number(text)?;
    (0.0..=1.0)
        .contains(&number)
        .then_some(number)
        .ok_or_else(|| "expected a number from 0 to 1".to_owned())
}

pub(crate) fn parse_shard(text: &str) -> Result<Shard, &'static str> {
    text.parse().map_err(|error: ShardError| error.expected())
}

pub(crate) fn parse_number(text: &str) -> Result<f64, String> {
    number::read(text).ok_or_else(|| number::complaint(text))
}

pub(crate) fn report() -> impl TypedValueParser<Value = PathBuf> {
    let expected = "expected a name that ends in .csv or .svg";
    file_of(&["csv", "svg"], expected)
}

pub(crate) fn npy() -> impl TypedValueParser<Value = PathBuf> {
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

pub(crate) fn required<T: Clone + Send + Sync + 'static>(
    matches: &ArgMatches,
    id: &str,
) -> Result<T, CliError> {
    matches.get_one::<T>(id).cloned().ok_or_else(|| {
        let message = format!("the argument '{id}' is required\n");
        clap::Error::raw(ErrorKind::MissingRequiredArgument, message).into()
    })
}

/// Returns the error for a subcommand that is defined but not handled. Such a bug must not run another subcommand.
pub(crate) fn unhandled_subcommand(name: &str) -> CliError {
    let message = format!("{name:?} is not implemented; this is a bug\n");
    clap::Error::raw(ErrorKind::InvalidSubcommand, message).into()
}

// What commands need that are still read by hand.

pub(crate) use crate::cli::arguments::parameters::{Given, Group, OfSensor};

pub(crate) fn of_sensor(parameters: &[Parameter]) -> Vec<Arg> {
    let flag = |&parameter: &Parameter| arg(parameter).help_heading("Sensor");
    parameters.iter().map(flag).collect()
}

pub(crate) fn arg(parameter: Parameter) -> Arg {
    parameters::arg(parameter, &OfSensor::default(parameter))
}

pub(crate) fn wrapped(text: &str, _width: usize) -> String {
    text.to_owned()
}

pub(crate) fn one_of<T, N>(names: N) -> impl TypedValueParser<Value = T>
where
    T: FromStr<Err = UnknownName> + Clone + Send + Sync + 'static,
    N: IntoIterator<Item = &'static str>,
{
    PossibleValuesParser::new(names).try_map(|name| name.parse())
}

#[derive(Clone, Copy, Debug, PartialEq)]
pub(crate) enum Form {
    Json(Pitch),
    /// The matrix and a table, which is in mm too if the pitch is known.
    Table(Pitch),
}

impl Form {
    #[allow(dead_code, reason = "for commands that are still read by hand")]
    pub(crate) fn new(json: bool, pitch: Pitch) -> Self {
        if json {
            Self::Json(pitch)
        } else {
            Self::Table(pitch)
        }
    }

    pub(crate) fn of(matches: &ArgMatches, settings: &Effective) -> Result<Self, CliError> {
        let pitch = pitch_of(matches, settings)?;
        Ok(if matches.get_flag("json") {
            Self::Json(pitch)
        } else {
            Self::Table(pitch)
        })
    }
}

pub(crate) fn pitch_of(matches: &ArgMatches, settings: &Effective) -> Result<Pitch, CliError> {
    Ok(Given::of(matches).pitch(settings)?)
}
