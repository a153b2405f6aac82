//! The commands and flags about the program itself: the look of its screen, scripts, settings, shell completions and
//! manual pages.

use std::path::PathBuf;

use clap::builder::PossibleValuesParser;
use clap::{Arg, ArgMatches, Command, value_parser};
use clap_complete::Shell;
use taxel_files::storage::Existing;

use crate::cli::arguments::flags::{self, option, switch};
use crate::cli::arguments::help::{
    COMPLETIONS_EXAMPLES, CONFIG_EXAMPLES, MAN_EXAMPLES, SCRIPT_EXAMPLES,
};
use crate::cli::input::content::InputSource;
use crate::cli::settings::file::AUTO;
use crate::tui::script::command;
use crate::tui::widget::theme::{ColorDepth, Palette};

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

pub(crate) fn completions() -> Command {
    let shell = Arg::new("shell")
        .value_name("SHELL")
        .required(true)
        .value_parser(value_parser!(Shell))
        .hide_possible_values(true)
        .help("bash, elvish, fish, powershell or zsh");
    Command::new("completions")
        .about("Print the completion script for your shell")
        .after_help(COMPLETIONS_EXAMPLES)
        .arg(shell)
}

pub(crate) fn man() -> Command {
    let folder = Arg::new("folder")
        .value_name("DIR")
        .value_parser(value_parser!(PathBuf))
        .help("Write the pages of all commands into this folder,\nin place of older ones");
    Command::new("man")
        .about("Print the man page, or write all man pages to a folder")
        .after_help(MAN_EXAMPLES)
        .arg(folder)
}

/// Defines `--color`, `--theme` and `--no-mouse`: the look of the screen, for terminals that do not describe
/// themselves well.
pub(crate) fn look() -> [Arg; 3] {
    let choice = |name: &'static str, values: Vec<&'static str>, help: &'static str| {
        let values = std::iter::once(AUTO).chain(values);
        Arg::new(name)
            .long(name)
            .value_name(name.to_ascii_uppercase())
            .value_parser(PossibleValuesParser::new(values))
            .hide_possible_values(true)
            .help(help)
    };
    let no_mouse = switch("no-mouse", "Leave the mouse to the terminal");
    let (depths, palettes) = (ColorDepth::NAMES, Palette::NAMES);
    [
        choice(
            "color",
            depths.map(|(name, _)| name).to_vec(),
            "Colours: auto, never, 16, 256 or true",
        ),
        choice(
            "theme",
            palettes.map(|(name, _)| name).to_vec(),
            "Theme: auto, dark, light or mono",
        ),
        no_mouse,
    ]
    .map(|arg| arg.help_heading("Terminal"))
}

pub(crate) fn record() -> Arg {
    option(
        "record",
        "FILE",
        "Record what you type as a script in a new file, with\nthe shapes that you use",
    )
    .value_parser(value_parser!(PathBuf))
}

pub(crate) fn config() -> Command {
    Command::new("config")
        .about("Print the settings in force, and the path of their file")
        .after_help(CONFIG_EXAMPLES)
        .args(look())
}

pub(crate) fn config_file() -> Arg {
    option(
        "config",
        "FILE",
        "Use this settings file instead of your own",
    )
    .value_parser(value_parser!(PathBuf))
}

pub(crate) fn size() -> Arg {
    option("size", "CxR", "Columns and rows of the screen").value_parser(command::size)
}

/// Defines `--ascii`, for the help and for the screen. [`Charset`](crate::cli::output::charset::Charset) looks for
/// the flag before clap does, because messages about wrong arguments need it.
pub(crate) fn ascii() -> Arg {
    switch("ascii", "Use ASCII only, as if the locale were not UTF-8")
}
