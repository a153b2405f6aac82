//! Parsers of values that flags have.
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
use taxel_core::parameter::{UnknownName, number};
use taxel_core::sweep::{Shard, ShardError};
use taxel_files::formats::file::has_ending;

/// Parses a name, file or other source, which must not be empty.
pub(crate) fn name_or_path() -> impl TypedValueParser<Value = OsString> {
    OsStringValueParser::new().try_map(|name| {
        let given = Some(name).filter(|name| !name.is_empty());
        given.ok_or("expected a name or a path")
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
        let is_too_large =
            matches!(&number, Err(error) if *error.kind() == IntErrorKind::PosOverflow);
        let allowed = number.ok().filter(|number| range.contains(number));
        allowed.ok_or_else(|| {
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

pub(crate) const TOO_LITTLE_MEMORY: &str =
    "take coarser steps, or work in shards (--shard 1/8, ..., then taxel merge)";

pub(crate) fn parse_probability(text: &str) -> Result<f64, String> {
    let number = Some(parse_number(text)?).filter(|number| (0.0..=1.0).contains(number));
    number.ok_or_else(|| "expected a number from 0 to 1".to_owned())
}

pub(crate) fn parse_positive(text: &str) -> Result<f64, &'static str> {
    let number = number::read(text).filter(|&number| number > 0.0);
    number.ok_or("expected a number above 0")
}

pub(crate) fn parse_shard(text: &str) -> Result<Shard, &'static str> {
    text.parse().map_err(|error: ShardError| error.expected())
}

pub(crate) fn parse_number(text: &str) -> Result<f64, String> {
    number::read(text).ok_or_else(|| number::complaint(text))
}

/// Parses the name of a file with this extension, in upper or lower case. It need not be UTF-8.
pub(crate) fn file_of(ending: &'static str) -> impl TypedValueParser<Value = PathBuf> {
    OsStringValueParser::new().try_map(move |name| {
        let path = Some(PathBuf::from(name)).filter(|path| has_ending(path, ending));
        path.ok_or_else(|| format!("expected a name that ends in .{ending}"))
    })
}

pub(crate) fn one_of<T, N>(names: N) -> impl TypedValueParser<Value = T>
where
    T: FromStr<Err = UnknownName> + Clone + Send + Sync + 'static,
    N: IntoIterator<Item = &'static str>,
{
    PossibleValuesParser::new(names).try_map(|name| name.parse())
}
