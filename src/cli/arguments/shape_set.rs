//! The shapes of a set and their positions, for `model train` and `model separate`.

use std::ffi::OsString;

use clap::{Arg, ArgAction, ArgMatches};

/// A set of shapes.
#[derive(Clone, Debug)]
pub(crate) struct SetArguments {
    /// Files of JSON lines, or names of the library.
    pub(crate) what: Vec<OsString>,
    /// Shapes in words.
    pub(crate) shapes: Vec<String>,
    /// Whether all shapes of the library belong to the set.
    pub(crate) library_all: bool,
}

/// `--shape`, a shape in words.
pub(super) fn shape() -> Arg {
    Arg::new("shape")
        .long("shape")
        .value_name("NAME=KIND...")
        .action(ArgAction::Append)
        .help("A shape: 'disc=ellipse radius_x=3 radius_y=3'")
}

/// `--positions`, for a coarser grid without naming a cell.
pub(super) fn positions() -> Arg {
    Arg::new("positions")
        .long("positions")
        .value_name("N")
        .value_parser(parse_positions)
        .help_heading("Grid")
        .help("Positions of a cell each way; default 100")
}

/// `--library-all`.
pub(super) fn library_all() -> Arg {
    Arg::new("library-all")
        .long("library-all")
        .action(ArgAction::SetTrue)
        .help("All shapes of the library")
}

/// A number of positions whose step is a whole number of hundredths.
fn parse_positions(text: &str) -> Result<u8, &'static str> {
    let number = text.trim().parse::<u8>().ok();
    number
        .filter(|&number| number > 0 && 100_u8.is_multiple_of(number))
        .ok_or("expected 1, 2, 4, 5, 10, 20, 25, 50 or 100")
}

/// The shapes of a set.
pub(super) fn set_arguments(matches: &ArgMatches) -> SetArguments {
    let what = matches.get_many::<OsString>("set").into_iter().flatten();
    let shapes = matches.get_many::<String>("shape").into_iter().flatten();
    SetArguments {
        what: what.cloned().collect(),
        shapes: shapes.cloned().collect(),
        library_all: matches.get_flag("library-all"),
    }
}
