//! The program with all its commands and flags, for clap. The order of the calls is the order in the help.

use clap::{Command, CommandFactory};

use crate::cli::Program;
use crate::cli::arguments::library;

/// Defines the program with all its commands. Completions and manual pages are made from this too, so a new command
/// appears in them by itself.
pub(crate) fn all() -> Command {
    let program = Program::command()
        .term_width(80)
        .subcommand(library::command());
    in_order(with_negative_numbers(program))
}

/// Flags that several commands have. The help of a command lists them in this order, after the command's own flags.
const SHARED: [&str; 17] = [
    "out", "name", "atlas", "poses", "write", "export", "svg", "format", "force", "shard", "jobs",
    "memory", "json", "csv", "quiet", "config", "ascii",
];

/// Lists the flags of [`SHARED`] in one order in the help of a command and of its subcommands. Flags under a heading
/// of their own keep their place there.
fn in_order(command: Command) -> Command {
    command
        .mut_args(|arg| {
            let flag = arg.get_long().filter(|_| arg.get_help_heading().is_none());
            match flag.and_then(|flag| SHARED.iter().position(|shared| *shared == flag)) {
                // After flags that are ordered only by their place in the command, before --help and --version.
                Some(position) => arg.display_order(500 + position),
                None => arg,
            }
        })
        .mut_subcommands(in_order)
}

/// Lets every argument of a command and its subcommands take `-1`, so that the argument's own parser tells what it
/// expects. Otherwise clap would take `-1` for a flag and advise `-- -1`, which no flag accepts.
fn with_negative_numbers(command: Command) -> Command {
    command
        .mut_args(|arg| {
            let takes = arg.get_action().takes_values();
            arg.allow_negative_numbers(takes)
        })
        .mut_subcommands(with_negative_numbers)
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

const COLUMN: usize = 13;

/// Makes the help list the commands by groups. It is used only for reading arguments: it hides the commands, and
/// completions and the manual would leave out hidden ones.
pub(crate) fn grouped(mut all: Command) -> Command {
    let mut template = String::from("{about-with-newline}\n{usage-heading} {usage}\n");
    all.build();
    for (heading, commands) in GROUPS {
        template += &format!("\n{heading}:\n");
        for name in commands {
            let about = all.find_subcommand(name).and_then(Command::get_about);
            if let Some(about) = about {
                template += &format!("  {name:<COLUMN$}{about}\n");
            }
        }
    }
    template += "\n{all-args}{after-help}";
    let names: Vec<String> = all
        .get_subcommands()
        .map(|command| command.get_name().to_owned())
        .collect();
    let usage = all.render_usage().to_string();
    let usage = usage.trim_start_matches("Usage: ").to_owned();
    for name in names {
        all = all.mut_subcommand(name, |command| command.hide(true));
    }
    all.help_template(template).override_usage(usage)
}

#[cfg(test)]
mod tests {
    use clap::builder::NonEmptyStringValueParser;
    use clap::error::{ContextKind, ContextValue, ErrorKind};
    use clap::{Arg, Command, Error};

    use super::GROUPS;
    use crate::cli::arguments::definitions;

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
        for command in innermost(&super::all()) {
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
                needy += 1;
                let missing = missing.join(" ");
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
        for command in definitions::all().get_subcommands() {
            let name = command.get_name();
            let lists = GROUPS.iter().filter(|(_, own)| own.contains(&name)).count();
            assert_eq!(lists, 1, "{name}");
        }
    }
}
