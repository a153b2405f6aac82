//! The program's arguments for clap: its flags, its commands in the order of the manual, and the layout of its help.

use std::ffi::OsString;
use std::path::PathBuf;

use clap::error::{ContextKind, ContextValue, Error, ErrorKind};
use clap::parser::ValueSource;
use clap::{ArgMatches, Args, Command, CommandFactory, Parser, Subcommand};
use taxel_core::quote::other_figure;

use crate::cli::Context;
use crate::cli::commands::batch::Batch;
use crate::cli::commands::completions::Completions;
use crate::cli::commands::config::Config;
use crate::cli::commands::describe::Describe;
use crate::cli::commands::export::ExportCommand;
use crate::cli::commands::figure::Figure;
use crate::cli::commands::frames::Frames;
use crate::cli::commands::library::LibraryCommand;
use crate::cli::commands::man::Man;
use crate::cli::commands::merge::Merge;
use crate::cli::commands::model::ModelCommand;
use crate::cli::commands::picture::Picture;
use crate::cli::commands::recognise::Recognise;
use crate::cli::commands::screen::Screen;
use crate::cli::commands::script::Script;
use crate::cli::commands::sweep::Sweep;
use crate::cli::commands::watch::Watch;
use crate::cli::failure::Failure;

const ABOUT: &str = "\
Which shapes can a robot recognise by touching them once?

taxel simulates how a tactile sensor touches flat shapes, computes their exact
imprints and describes them. Without a command, it opens the screen, where you
can do all of this and see the result as you type.";

pub(super) const EXAMPLES: &str = "\
Lengths are in cells: 1 is the side of a cell of the sensor. x runs to the
right, y down.
Exit status: 0 success, 1 wrong input, 2 wrong command line, 3 not the expected
answer, 128 + n ended by signal n.
Settings: 'taxel config'. Environment and files: 'taxel man | man -l -'.

Examples:
  taxel
  taxel figure ellipse --x0 1.99 --y0 1.47 --thickness 2
  taxel figure hexagon --side 3 --angle 17 --json
  taxel picture washer --x0 6 --angle 30 --save \"turned washer\"
  taxel library list
  taxel describe imprint.txt
  taxel export washer washer.svg
  taxel batch < poses.jsonl > answers.jsonl";

#[derive(Debug, Parser)]
#[command(name = "taxel", version = env!("TAXEL_VERSION"), about = ABOUT, after_help = EXAMPLES)]
pub(super) struct Program {
    #[command(flatten)]
    pub(super) screen: Screen,
    #[command(flatten)]
    pub(super) global: Global,
    #[command(subcommand)]
    pub(super) command: Option<Subcommands>,
}

/// The flags of all commands.
#[derive(Debug, Args)]
pub(super) struct Global {
    /// The library's folder
    #[arg(long, global = true, value_name = "DIR", display_order = 900)]
    #[arg(help_heading = "Library")]
    pub(super) library: Option<PathBuf>,
    /// Use this settings file instead of your own
    #[arg(long, global = true, value_name = "FILE", display_order = 901)]
    pub(super) config: Option<PathBuf>,
    /// Use ASCII only, as if the locale were not UTF-8
    #[arg(long, global = true, display_order = 902)]
    pub(super) ascii: bool,
}

#[derive(Debug, Subcommand)]
pub(super) enum Subcommands {
    Figure(Figure),
    Picture(Picture),
    Describe(Describe),
    #[command(name = "export")]
    Export(ExportCommand),
    Batch(Batch),
    Sweep(Box<Sweep>),
    Merge(Merge),
    /// Train models, and measure how well one touch tells shapes apart
    #[command(subcommand)]
    Model(ModelCommand),
    #[command(alias = "recognize")]
    Recognise(Box<Recognise>),
    Frames(Box<Frames>),
    Watch(Box<Watch>),
    Library(LibraryCommand),
    Script(Script),
    Config(Config),
    Completions(Completions),
    Man(Man),
}

impl Subcommands {
    pub(super) fn run(self, cx: &Context) -> Result<(), Failure> {
        match self {
            Self::Figure(command) => command.run(cx),
            Self::Picture(command) => command.run(cx),
            Self::Describe(command) => command.run(cx),
            Self::Export(command) => command.run(cx),
            Self::Batch(command) => command.run(cx),
            Self::Sweep(command) => command.run(cx),
            Self::Merge(command) => command.run(cx),
            Self::Model(command) => command.run(cx),
            Self::Recognise(command) => command.run(cx),
            Self::Frames(command) => command.run(cx),
            Self::Watch(command) => command.run(cx),
            Self::Library(command) => command.run(cx),
            Self::Script(command) => command.run(cx),
            Self::Config(command) => command.run(cx),
            Self::Completions(command) => command.run(cx),
            Self::Man(command) => command.run(cx),
        }
    }
}

/// The program with all its commands. Completions and manual pages are made from this too.
pub(super) fn definition() -> Command {
    strict(Program::command().term_width(80))
}

/// Lets every argument take `-1`, so that the argument's own parser tells what it expects; otherwise clap would take
/// `-1` for a flag and advise `-- -1`, which no flag accepts. A subcommand that is missing is an error, not the help.
fn strict(command: Command) -> Command {
    command
        .arg_required_else_help(false)
        .mut_args(|arg| {
            let takes = arg.get_action().takes_values();
            arg.allow_negative_numbers(takes)
        })
        .mut_subcommands(strict)
}

/// What clap makes of the arguments; the error is the help if it is asked for.
pub(super) fn read(arguments: Vec<OsString>) -> Result<ArgMatches, Error> {
    let has = |flag: &str| arguments.iter().any(|argument| argument == flag);
    let mut program = definition();
    if has("-h") && !has("--help") {
        program = without_notes(program);
    }
    let mut program = grouped(program);
    let matches = program
        .try_get_matches_from_mut(arguments)
        .map_err(with_tip)?;
    let Some((name, own)) = matches.subcommand() else {
        return Ok(matches);
    };
    // A flag of the screen would have no effect before a command.
    let unused = program.get_arguments().find(|arg| {
        let source = matches.value_source(arg.get_id().as_str());
        source == Some(ValueSource::CommandLine) && !arg.is_global_set()
    });
    if let Some(flag) = unused.and_then(|arg| arg.get_long()) {
        let message = format!("'--{flag}' before '{name}' is only for the screen");
        return Err(program.error(ErrorKind::ArgumentConflict, message));
    }
    let mut innermost = own;
    while let Some((_, own)) = innermost.subcommand() {
        innermost = own;
    }
    let inputs = ["file", "what", "set", "source", "mask", "gain"].into_iter();
    let given = inputs.filter_map(|id| innermost.try_get_raw(id).ok().flatten());
    if given.flatten().filter(|value| *value == "-").count() > 1 {
        let message = "standard input can be read only once, so only one argument can be '-'";
        return Err(program.error(ErrorKind::ArgumentConflict, message));
    }
    Ok(matches)
}

/// Adds what figure a word such as `circle` may mean.
fn with_tip(mut error: Error) -> Error {
    if let Some(ContextValue::String(given)) = error.get(ContextKind::InvalidValue)
        && let Some(tip) = other_figure(given)
    {
        error.remove(ContextKind::SuggestedValue);
        let tips = ContextValue::StyledStrs(vec![tip.into()]);
        error.insert(ContextKind::Suggested, tips);
    }
    error
}

/// Leaves out the texts below the flags: `-h` prints usage and flags only.
fn without_notes(command: Command) -> Command {
    command
        .after_help("'--help' also explains and gives examples.")
        .mut_subcommands(without_notes)
}

const GROUPS: [(&str, &[&str]); 5] = [
    (
        "Touch",
        &["figure", "picture", "describe", "export", "batch"],
    ),
    ("Recognise", &["sweep", "merge", "model", "recognise"]),
    ("Sensors", &["frames", "watch"]),
    ("Library", &["library"]),
    (
        "Program",
        &["script", "config", "completions", "man", "help"],
    ),
];

/// Makes the help list the commands by groups. It is used only for reading arguments: it hides the commands, and
/// completions and the manual would leave out hidden ones.
fn grouped(mut program: Command) -> Command {
    program.build();
    let mut template = String::from("{about-with-newline}\n{usage-heading} {usage}\n");
    for (heading, commands) in GROUPS {
        template += &format!("\n{heading}:\n");
        for name in commands {
            let command = program.find_subcommand(name);
            if let Some(about) = command.and_then(Command::get_about) {
                template += &format!("  {name:<13}{about}\n");
            }
        }
    }
    template += "\n{all-args}{after-help}";
    let usage = program.render_usage().to_string();
    program
        .mut_subcommands(|command| command.hide(true))
        .help_template(template)
        .override_usage(usage.trim_start_matches("Usage: ").to_owned())
}

#[cfg(test)]
mod tests {
    use clap::builder::NonEmptyStringValueParser;
    use clap::error::{ContextKind, ContextValue, Error, ErrorKind};
    use clap::{Arg, Command};

    use super::GROUPS;

    fn innermost(command: &Command) -> Vec<Command> {
        let own: Vec<_> = command.get_subcommands().collect();
        if own.is_empty() {
            let any = |arg: Arg| {
                let takes = arg.get_action().takes_values();
                let any = NonEmptyStringValueParser::new();
                if takes { arg.value_parser(any) } else { arg }
            };
            return vec![command.clone().mut_args(any)];
        }
        own.into_iter().flat_map(innermost).collect()
    }

    fn given(arg: &Arg) -> Vec<String> {
        let flag = arg.get_long().map(|long| format!("--{long}"));
        let short = arg.get_short().map(|short| format!("-{short}"));
        let value = arg.get_action().takes_values().then(|| "1".to_owned());
        flag.or(short).into_iter().chain(value).collect()
    }

    fn parsed(command: &Command, args: &[&Arg]) -> Result<(), Error> {
        let is_given = |id: &clap::Id| args.iter().any(|arg| arg.get_id() == id);
        let mut all = args.to_vec();
        let required = |arg: &&Arg| arg.is_required_set() && !is_given(arg.get_id());
        all.extend(command.get_arguments().filter(required));
        let groups = command.get_groups().filter(|group| group.is_required_set());
        for group in groups {
            let own: Vec<_> = group.get_args().collect();
            if !own.iter().any(|id| is_given(id)) {
                let is_first = |arg: &&Arg| own.first() == Some(&arg.get_id());
                all.extend(command.get_arguments().find(is_first));
            }
        }
        let line = all.into_iter().flat_map(given);
        let line = std::iter::once("taxel".to_owned()).chain(line);
        command.clone().try_get_matches_from(line).map(|_| ())
    }

    /// If a flag requires a second one and a third flag excludes the second, clap lets the second be missing. The
    /// first flag would be ignored.
    #[test]
    fn a_flag_that_needs_another_is_refused_without_it_whatever_else_is_given() {
        let mut needy = 0;
        for command in innermost(&super::definition()) {
            for arg in command.get_arguments() {
                let alone = parsed(&command, &[arg]).err();
                let alone =
                    alone.filter(|error| error.kind() == ErrorKind::MissingRequiredArgument);
                let Some(ContextValue::Strings(missing)) = alone
                    .as_ref()
                    .and_then(|error| error.get(ContextKind::InvalidArg))
                else {
                    continue;
                };
                let missing = missing.join(" ");
                // Another flag may take the place of an argument, as --library-all that of shapes.
                if missing.contains("FILE|NAME") {
                    continue;
                }
                needy += 1;
                for other in command.get_arguments() {
                    let is_missing = other.get_long().is_some_and(|flag| missing.contains(flag));
                    let (name, own, other_id) = (command.get_name(), arg.get_id(), other.get_id());
                    assert!(
                        is_missing || parsed(&command, &[arg, other]).is_err(),
                        "{name}: {own} needs {missing}, but is accepted with {other_id} alone"
                    );
                }
            }
        }
        assert!(needy > 30, "{needy}");
    }

    #[test]
    fn every_command_is_in_one_group() {
        for command in super::definition().get_subcommands() {
            let name = command.get_name();
            let lists = GROUPS.iter().filter(|(_, own)| own.contains(&name)).count();
            assert_eq!(lists, 1, "{name}");
        }
    }
}
