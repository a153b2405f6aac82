//! The commands grouped by purpose, as the program's help lists them.

use clap::Command;

use crate::cli::arguments::parameters;

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

const WIDTH: usize = 65;

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
                let about = parameters::wrapped(&about.to_string(), WIDTH);
                let indent = format!("\n  {:COLUMN$}", "");
                template += &format!("  {name:<COLUMN$}{}\n", about.replace('\n', &indent));
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
    use super::GROUPS;
    use crate::cli::arguments::definitions;

    #[test]
    fn every_command_is_in_one_group() {
        for command in definitions::all().get_subcommands() {
            let name = command.get_name();
            let lists = GROUPS.iter().filter(|(_, own)| own.contains(&name)).count();
            assert_eq!(lists, 1, "{name}");
        }
    }
}
