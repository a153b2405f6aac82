//! The command `script`.

use std::path::PathBuf;

use clap::{Arg, ArgMatches, Args, Command, value_parser};
use taxel_files::storage::Existing;

use crate::cli::arguments::flags::{self, option, switch};
use crate::cli::arguments::help::SCRIPT_EXAMPLES;
use crate::cli::commands::screen::Look;
use crate::cli::input::content::InputSource;
use crate::tui::script::command;

#[derive(Clone, Debug)]
pub(crate) struct Script {
    /// The source of its lines; None if only `keys` are given.
    pub(crate) source: Option<InputSource>,
    pub(crate) keys: Option<String>,
    pub(crate) size: (u16, u16),
    pub(crate) styles: bool,
    pub(crate) json: bool,
    pub(crate) drawings: Option<PathBuf>,
    pub(crate) existing: Existing,
    /// Whether the script may use any library and write anywhere.
    pub(crate) allow_outside: bool,
}

impl Script {
    pub(crate) fn of(matches: &ArgMatches) -> Self {
        let file = matches.get_one::<PathBuf>("file");
        let source = file.map(|file| InputSource::of(file));
        let keys = matches.get_one::<String>("keys").cloned();
        let source = if keys.is_none() {
            source.or(Some(InputSource::Standard))
        } else {
            source
        };
        Self {
            source,
            keys,
            size: matches.get_one("size").copied().unwrap_or((80, 24)),
            styles: matches.get_flag("styles"),
            json: matches.get_flag("json"),
            drawings: matches.get_one::<PathBuf>("svg").cloned(),
            existing: flags::existing(matches),
            allow_outside: matches.get_flag("allow-outside"),
        }
    }
}

pub(crate) fn script() -> Command {
    let file = Arg::new("file")
        .value_name("FILE")
        .value_parser(value_parser!(PathBuf))
        .help("Script to run; '-' for standard input");
    let keys = Arg::new("keys")
        .short('k')
        .long("keys")
        .value_name("KEYS")
        .help("Keys to press first; without a script, print the screen");
    let styles = switch("styles", "Add a grid of style letters to screens");
    let json = switch("json", "Print screens as lines of JSON");
    let svg = option(
        "svg",
        "DIR",
        "Draw each screen into this folder too, as NAME.svg",
    )
    .value_parser(value_parser!(PathBuf));
    let force = switch("force", "Replace existing drawings").requires("svg");
    let allow_outside = switch(
        "allow-outside",
        "Let the script write anywhere and set a library",
    );
    Command::new("script")
        .about("Drive the screen without a terminal")
        .after_help(SCRIPT_EXAMPLES)
        .args([file, keys, size(), styles, json, svg, force, allow_outside])
}

pub(crate) fn size() -> Arg {
    option("size", "CxR", "Columns and rows of the screen").value_parser(command::size)
}

pub(crate) fn look() -> Vec<Arg> {
    let look = Look::augment_args(Command::new(""));
    look.get_arguments().cloned().collect()
}
