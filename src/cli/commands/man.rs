//! `taxel man`: the help of every command as a manual page.

use std::io;
use std::path::Path;

use clap::Command;
use clap_mangen::Man;
use taxel_files::formats::value::counted;
use taxel_files::storage::Existing;

use crate::cli::arguments::definitions;
use crate::cli::arguments::help::{ENVIRONMENT, EXAMPLES, FILES};
use crate::cli::commands::export;
use crate::cli::error::CliError;

pub(crate) fn main_page() -> Result<Vec<u8>, CliError> {
    page(&built()).map_err(CliError::Write)
}

pub(crate) fn write(folder: &Path) -> Result<String, CliError> {
    export::make_folder(folder)?;
    let built = built();
    let commands = all(&built);
    for command in &commands {
        let name = command.get_display_name().unwrap_or(command.get_name());
        let file = folder.join(format!("{name}.1"));
        let page = page(command).map_err(|error| CliError::of_file(&file, error))?;
        // Pages of an earlier version are replaced.
        export::put(&file, &page, Existing::Replaced)?;
    }
    let pages = counted(commands.len() as u64, "page");
    Ok(format!("written: {pages} in {}", folder.display()))
}

fn built() -> Command {
    let notes = format!("{EXAMPLES}\n\nEnvironment:{ENVIRONMENT}\n\nFiles:{FILES}");
    let mut all = definitions::all()
        .after_help(notes)
        .disable_help_subcommand(true);
    all.build();
    all
}

fn all(command: &Command) -> Vec<&Command> {
    let below = command.get_subcommands().flat_map(all);
    std::iter::once(command).chain(below).collect()
}

fn page(command: &Command) -> io::Result<Vec<u8>> {
    let mut page = Vec::new();
    Man::new(command.clone())
        .manual("taxel")
        .render(&mut page)?;
    Ok(page)
}
