//! `taxel man`: the help of every command as a manual page.

use std::io;
use std::path::PathBuf;

use clap::Command;
use clap_mangen::Man as Page;
use taxel_files::formats::value::counted;
use taxel_files::storage::{self, Existing};

use crate::cli::commands::export;
use crate::cli::program::{self, EXAMPLES as PROGRAM};
use crate::cli::{Context, Failure, Named};

const EXAMPLES: &str = "\
Examples:
  taxel man | man -l -
  taxel man ~/.local/share/man/man1
  MANPATH=~/.local/share/man: man taxel-figure";

/// What only the manual page of the program says, below its help.
const ENVIRONMENT_AND_FILES: &str = "

Environment:
  TAXEL_LIBRARY    the library's folder
  TAXEL_CONFIG     the settings file
  NO_COLOR         no colours, if it is not empty
  TERM, COLORTERM  what the terminal can show
  LC_ALL, LC_CTYPE, LANG
                   ASCII only, unless the locale is UTF-8
  COLUMNS, LINES   the size of a terminal that does not report it
  RAYON_NUM_THREADS
                   threads of a command without --jobs
  XDG_CONFIG_HOME, XDG_DATA_HOME, XDG_CACHE_HOME
                   the folders in place of ~/.config, ~/.local/share, ~/.cache

Files:
  ~/.config/taxel/config.toml
                   settings; 'taxel config' prints all of them
  ~/.local/share/taxel/library
                   the shapes, one JSON file each
  ~/.local/share/taxel/models
                   your models
  ~/.cache/taxel/models
                   trained built-in models; may be deleted";

/// Print the man page, or write all man pages to a folder
#[derive(Debug, clap::Args)]
#[command(after_help = EXAMPLES)]
pub(crate) struct Man {
    /// Write the pages of all commands into this folder, in place of older ones
    #[arg(value_name = "DIR")]
    folder: Option<PathBuf>,
}

impl Man {
    pub(crate) fn run(self, cx: &Context) -> Result<(), Failure> {
        let mut program = program::definition()
            .after_help(format!("{PROGRAM}{ENVIRONMENT_AND_FILES}"))
            .disable_help_subcommand(true);
        program.build();
        let Some(folder) = self.folder else {
            return cx.write(&page(&program)?);
        };
        export::make_folder(&folder)?;
        let commands = all(&program);
        for command in &commands {
            let name = command.get_display_name().unwrap_or(command.get_name());
            let file = folder.join(format!("{name}.1"));
            let page = page(command).named(file.display())?;
            storage::write(&file, &page, Existing::Replaced)?;
        }
        let pages = counted(commands.len() as u64, "page");
        cx.print(&format!("written: {pages} in {}\n", folder.display()))
    }
}

fn all(command: &Command) -> Vec<&Command> {
    let below = command.get_subcommands().flat_map(all);
    std::iter::once(command).chain(below).collect()
}

fn page(command: &Command) -> io::Result<Vec<u8>> {
    let mut page = Vec::new();
    Page::new(command.clone())
        .manual("taxel")
        .render(&mut page)?;
    Ok(page)
}
