//! `taxel completions`: prints the completion script for a shell.

use clap_complete::Shell;

use crate::cli::Context;
use crate::cli::failure::Failure;
use crate::cli::program;

const EXAMPLES: &str = "\
Write the script to a file that your shell reads, as in the examples, and start
a new shell. In bash, this needs the package bash-completion; without it, put
'source <(taxel completions bash)' into ~/.bashrc. zsh needs the line
'fpath+=~/.zfunc' in ~/.zshrc, above the line that runs compinit.

Examples:
  taxel completions bash > ~/.local/share/bash-completion/completions/taxel
  taxel completions zsh > ~/.zfunc/_taxel
  taxel completions fish > ~/.config/fish/completions/taxel.fish";

/// Print the completion script for your shell
#[derive(Debug, clap::Args)]
#[command(after_help = EXAMPLES)]
pub(crate) struct Completions {
    /// bash, elvish, fish, powershell or zsh
    #[arg(hide_possible_values = true)]
    shell: Shell,
}

impl Completions {
    pub(crate) fn run(self, cx: &Context) -> Result<(), Failure> {
        let mut script = Vec::new();
        clap_complete::generate(self.shell, &mut program::definition(), "taxel", &mut script);
        cx.write(&script)
    }
}
