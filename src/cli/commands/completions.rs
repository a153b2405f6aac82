//! `taxel completions`: writes a shell's completions for `taxel`, made from the definitions of the commands.

use clap::Command;
use clap::builder::PossibleValue;
use clap_complete::generate;
use clap_complete::shells::{Bash, Fish, Zsh};

/// A shell with completions.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(crate) enum Shell {
    Bash,
    Zsh,
    Fish,
}

impl Shell {
    /// All of them.
    pub(crate) const ALL: [Self; 3] = [Self::Bash, Self::Zsh, Self::Fish];

    /// Its name, as in the argument.
    pub(crate) fn name(self) -> &'static str {
        match self {
            Self::Bash => "bash",
            Self::Zsh => "zsh",
            Self::Fish => "fish",
        }
    }

    /// The shell of that name; None for any other word.
    pub(crate) fn from_name(name: &str) -> Option<Self> {
        Self::ALL.into_iter().find(|shell| shell.name() == name)
    }
}

/// The completions of all commands, as a script for the shell.
pub(crate) fn script(shell: Shell, mut all: Command) -> Vec<u8> {
    let (mut script, name) = (Vec::new(), "taxel");
    match shell {
        Shell::Bash => generate(Bash, &mut all, name, &mut script),
        Shell::Zsh => generate(Zsh, &mut all, name, &mut script),
        Shell::Fish => {
            generate(Fish, &mut all, name, &mut script);
            script.extend(words_of_fish(&all).into_bytes());
        }
    }
    script
}

/// The words that commands take as arguments, for fish: clap's generator writes only commands and flags for it.
fn words_of_fish(all: &Command) -> String {
    let mut lines = String::new();
    for command in all.get_subcommands() {
        for argument in command.get_positionals() {
            let values = argument.get_possible_values();
            let words: Vec<&str> = values.iter().map(PossibleValue::get_name).collect();
            if !words.is_empty() {
                lines += &format!(
                    "complete -c taxel -n \"__fish_taxel_using_subcommand {}\" -f -a \"{}\"\n",
                    command.get_name(),
                    words.join(" ")
                );
            }
        }
    }
    lines
}
