//! `taxel man`: the help of every command as a manual page.
//!
//! A page has the same texts as the help, in the sections NAME, SYNOPSIS, DESCRIPTION, OPTIONS, SUBCOMMANDS, EXIT
//! STATUS, EXAMPLES and SEE ALSO; the program's own page also has ENVIRONMENT and FILES. In the text below the flags,
//! indented lines are kept as they are and others are filled; `Examples:` starts the section of that name.

use std::io;
use std::path::Path;

use clap::Command;
use clap_mangen::Man;
use clap_mangen::roff::{Roff, roman};

use crate::cli::arguments::definitions;
use crate::cli::arguments::help::{ENVIRONMENT, EXAMPLES, FILES};
use crate::cli::commands::export;
use crate::cli::error::CliError;
use crate::formats::value::counted;
use crate::storage::Existing;

/// Returns the page of the program itself.
///
/// # Errors
/// None in practice: the page is written to memory.
pub(crate) fn main_page() -> Result<Vec<u8>, CliError> {
    page(&built()).map_err(CliError::Write)
}

/// Writes the pages of all commands into a folder, which is created if necessary. Returns the text to print.
///
/// # Errors
/// Returns an error if the folder cannot be created or a file cannot be written.
pub(crate) fn write(folder: &Path) -> Result<String, CliError> {
    export::make_folder(folder)?;
    let built = built();
    let commands = all(&built);
    for command in &commands {
        let file = folder.join(format!("{}.1", name(command)));
        let page = page(command).map_err(|error| CliError::of_file(&file, error))?;
        // Pages of an earlier version are replaced.
        export::put(&file, &page, Existing::Replaced)?;
    }
    let pages = counted(commands.len() as u64, "page");
    Ok(format!("written: {pages} in {}", folder.display()))
}

/// Returns the commands with everything that clap adds to them, except its `help`, which needs no page.
fn built() -> Command {
    let mut all = definitions::all().disable_help_subcommand(true);
    all.build();
    all
}

/// Returns a command and all its subcommands, at any depth.
fn all(command: &Command) -> Vec<&Command> {
    let below = command.get_subcommands().flat_map(all);
    std::iter::once(command).chain(below).collect()
}

/// Returns the name of a command's page, such as `taxel-library-list`.
fn name(command: &Command) -> &str {
    command
        .get_display_name()
        .unwrap_or_else(|| command.get_name())
}

/// Returns the page of a command, in roff.
fn page(command: &Command) -> io::Result<Vec<u8>> {
    let mut page = Vec::new();
    let about = command
        .get_about()
        .map(ToString::to_string)
        .unwrap_or_default();
    let (short, long) = about.split_once('\n').unwrap_or((&about, ""));
    let man = Man::new(command.clone())
        .source(concat!("taxel ", env!("CARGO_PKG_VERSION")))
        .manual("taxel");
    man.render_title(&mut page)?;
    let mut roff = Roff::new();
    // A hyphen at the end of a line would change a key or a flag that is copied from there.
    roff.control("nh", [])
        .control("SH", ["NAME"])
        .text([roman(format!("{} - {short}", name(command)))]);
    let usage = command.clone().render_usage().to_string();
    roff.control("SH", ["SYNOPSIS"]).control("nf", []);
    for line in usage.lines() {
        let line = line.strip_prefix("Usage: ").unwrap_or(line.trim_start());
        roff.text([roman(line)]);
    }
    roff.control("fi", []).control("SH", ["DESCRIPTION"]);
    filled(&mut roff, if long.is_empty() { short } else { long });
    let after = command.get_after_help().map(ToString::to_string);
    let after = after.unwrap_or_default();
    let (notes, examples) = after.split_once("Examples:\n").unwrap_or((&after, ""));
    // A command with exit statuses of its own has them in its help; the others have those of the program.
    let (notes, own) = without_exit_status(notes);
    let status = own.or_else(|| without_exit_status(EXAMPLES).1);
    roff.control("PP", []);
    filled(&mut roff, &notes);
    roff.to_writer(&mut page)?;
    man.render_options_section(&mut page)?;
    if command.has_subcommands() {
        man.render_subcommands_section(&mut page)?;
    }
    let mut roff = Roff::new();
    if let Some(status) = status {
        roff.control("SH", ["EXIT STATUS"]);
        filled(&mut roff, &status);
    }
    if name(command) == "taxel" {
        for (heading, text) in [("ENVIRONMENT", ENVIRONMENT), ("FILES", FILES)] {
            roff.control("SH", [heading]);
            filled(&mut roff, text);
        }
    }
    roff.control("SH", ["EXAMPLES"]);
    filled(&mut roff, examples);
    roff.control("SH", ["SEE ALSO"])
        .text([roman(see_also(command).join(", "))]);
    roff.to_writer(&mut page)?;
    Ok(page)
}

/// Splits the sentence about the exit status from the notes of a command; the sentence ends with `.` at the end of a
/// line.
fn without_exit_status(notes: &str) -> (String, Option<String>) {
    let Some((before, rest)) = notes.split_once("Exit status: ") else {
        return (notes.to_owned(), None);
    };
    let (status, after) = rest.split_once(".\n").unwrap_or((rest, ""));
    (format!("{before}{after}"), Some(format!("{status}.")))
}

/// Returns the pages above that of a command, `taxel(1)` first, or for the program those of its commands.
fn see_also(command: &Command) -> Vec<String> {
    let own = name(command);
    let above: Vec<String> = own
        .match_indices('-')
        .map(|(end, _)| format!("{}(1)", &own[..end]))
        .collect();
    if above.is_empty() {
        let below = command.get_subcommands();
        return below
            .map(|command| format!("{}(1)", name(command)))
            .collect();
    }
    above
}

/// Writes a text: paragraphs, which are filled and end at an empty line, and indented lines, which are kept as they
/// are.
fn filled(roff: &mut Roff, text: &str) {
    let mut as_it_is = false;
    for line in text.trim_matches('\n').lines() {
        let indented = line.starts_with(' ');
        if indented != as_it_is {
            roff.control(if indented { "nf" } else { "fi" }, []);
            as_it_is = indented;
        }
        if line.is_empty() {
            roff.control("PP", []);
        } else {
            roff.text([roman(line)]);
        }
    }
    if as_it_is {
        roff.control("fi", []);
    }
}
