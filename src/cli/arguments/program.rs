//! The commands and flags that are about the program itself: its screen, its settings, its place in a shell.

use std::path::PathBuf;

use clap::builder::PossibleValuesParser;
use clap::{Arg, ArgAction, ArgMatches, Command, value_parser};

use crate::cli::arguments::help::{
    COMPLETIONS_EXAMPLES, CONFIG_EXAMPLES, MAN_EXAMPLES, SCRIPT_EXAMPLES,
};
use crate::cli::arguments::parameters;
use crate::cli::commands::completions::Shell;
use crate::cli::input::content::InputSource;
use crate::cli::settings::file::AUTO;
use crate::storage::Existing;
use crate::tui::script::command;
use crate::tui::widget::theme::{ColorDepth, Palette};

/// A script and how it is run.
#[derive(Clone, Debug)]
pub(crate) struct Script {
    /// Where its lines are read from; none if only `keys` are given.
    pub(crate) source: Option<InputSource>,
    /// Keys to press before the script.
    pub(crate) keys: Option<String>,
    pub(crate) size: (u16, u16),
    pub(crate) styles: bool,
    pub(crate) json: bool,
    /// The folder that its screens are drawn into, if they are.
    pub(crate) drawings: Option<PathBuf>,
    /// What happens to drawings that are there already.
    pub(crate) existing: Existing,
}

impl Script {
    /// What the arguments of [`script`] ask for.
    pub(crate) fn of(matches: &ArgMatches) -> Self {
        let source = matches.get_one::<PathBuf>("file").map(|file| {
            if file.as_os_str() == "-" {
                InputSource::Standard
            } else {
                InputSource::File(file.clone())
            }
        });
        let keys = matches.get_one::<String>("keys").cloned();
        // Neither a file nor keys: the script comes on standard input.
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
            existing: parameters::existing(matches),
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
        .value_name("KEYS")
        .help("Keys to press first; without a script the screen follows");
    let styles = Arg::new("styles")
        .long("styles")
        .action(ArgAction::SetTrue)
        .help("Screens with a grid of style letters");
    let json = Arg::new("json")
        .long("json")
        .action(ArgAction::SetTrue)
        .help("Screens as lines of JSON");
    let svg = Arg::new("svg")
        .long("svg")
        .value_name("DIR")
        .value_parser(value_parser!(PathBuf))
        .help("Draw each screen into this folder too, as NAME.svg");
    let force = Arg::new("force")
        .long("force")
        .action(ArgAction::SetTrue)
        .requires("svg")
        .help("Replace drawings that are there already");
    Command::new("script")
        .about("Drive the screen without a terminal")
        .after_help(SCRIPT_EXAMPLES)
        .args([file, keys, size(), styles, json, svg, force])
}

pub(crate) fn completions() -> Command {
    let shell = Arg::new("shell")
        .value_name("SHELL")
        .required(true)
        .value_parser(parameters::one_of(
            Shell::ALL.map(Shell::name),
            Shell::from_name,
        ))
        .hide_possible_values(true)
        .help("bash, zsh or fish");
    Command::new("completions")
        .about("Print what a shell completes after 'taxel'")
        .after_help(COMPLETIONS_EXAMPLES)
        .arg(shell)
}

pub(crate) fn man() -> Command {
    let folder = Arg::new("folder")
        .value_name("DIR")
        .value_parser(value_parser!(PathBuf))
        .help("Write the pages of all commands into this folder");
    Command::new("man")
        .about("Print the manual's page, or write all of its pages")
        .after_help(MAN_EXAMPLES)
        .arg(folder)
}

/// How the screen looks, where the environment does not say it well.
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
    let no_mouse = Arg::new("no-mouse")
        .long("no-mouse")
        .action(ArgAction::SetTrue)
        .help("Leave the mouse to the terminal");
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
            "Auto, dark, light or mono",
        ),
        no_mouse,
    ]
    .map(|arg| arg.help_heading("Terminal"))
}

pub(crate) fn record() -> Arg {
    Arg::new("record")
        .long("record")
        .value_name("FILE")
        .value_parser(value_parser!(PathBuf))
        .help("Write what is typed as a script, to a new file")
}

pub(crate) fn config() -> Command {
    Command::new("config")
        .about("Print the settings and where each comes from")
        .after_help(CONFIG_EXAMPLES)
        .args(look())
}

pub(crate) fn config_file() -> Arg {
    Arg::new("config")
        .long("config")
        .value_name("FILE")
        .value_parser(value_parser!(PathBuf))
        .help("Settings in place of your own")
}

pub(crate) fn size() -> Arg {
    Arg::new("size")
        .long("size")
        .value_name("CxR")
        .value_parser(parse_size)
        .help("Columns and rows of the screen")
}

fn parse_size(text: &str) -> Result<(u16, u16), String> {
    command::size(text)
}

/// Declared for the help only: [`crate::cli::output::charset::Charset`] has seen it before.
pub(crate) fn ascii() -> Arg {
    Arg::new("ascii")
        .long("ascii")
        .action(ArgAction::SetTrue)
        .help("Keep to ASCII, as where the locale is not UTF-8")
}
