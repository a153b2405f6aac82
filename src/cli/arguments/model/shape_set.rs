//! The shapes of a set and their positions, for `model train` and `model separate`.
//!
//! A set combines shapes from two sources, at least one of which must be given:
//! ```text
//! taxel model train shapes.jsonl washer      lines of JSON, '-' for standard input; names of the library
//!                   --library-all            all shapes of the library
//! ```
//! [`input::shape_set`](crate::cli::input::shape_set) reads them.

use std::ffi::OsString;

use clap::{Arg, ArgGroup, ArgMatches};

use crate::cli::arguments::flags::{name_or_path, option, switch};
use crate::recognition::CellPositions;

#[derive(Clone, Debug)]
pub(crate) struct SetArguments {
    pub(crate) what: Vec<OsString>,
    pub(crate) library_all: bool,
}

impl SetArguments {
    pub(super) fn of(matches: &ArgMatches) -> Self {
        let what = matches.get_many::<OsString>("set").into_iter().flatten();
        Self {
            what: what.cloned().collect(),
            library_all: matches.get_flag("library-all"),
        }
    }
}

pub(super) fn args(value: &'static str, help: &'static str) -> [Arg; 2] {
    let what = Arg::new("set")
        .value_name(value)
        .num_args(0..)
        .value_parser(name_or_path())
        .help(help);
    let all = switch("library-all", "All shapes of the library");
    [what, all]
}

pub(super) fn group() -> ArgGroup {
    ArgGroup::new("shapes")
        .args(["set", "library-all"])
        .multiple(true)
        .required(true)
}

pub(super) fn positions() -> Arg {
    option(
        "positions",
        "N",
        "Positions per cell along x and y; default 100",
    )
    .value_parser(parse_positions)
    .help_heading("Grid")
}

/// Parses a number of positions per cell. Their distance must be a whole number of hundredths of a cell, since ranges
/// are exact in hundredths. Angles have ranges of their own.
fn parse_positions(text: &str) -> Result<CellPositions, &'static str> {
    let number = text.trim().parse::<u8>().ok();
    number
        .and_then(|number| CellPositions::new(number).ok())
        .ok_or("expected 1, 2, 4, 5, 10, 20, 25, 50 or 100")
}
