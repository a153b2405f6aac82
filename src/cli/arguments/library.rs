//! The command `library` and its subcommands.

use std::ffi::OsString;

use clap::{ArgMatches, Command};
use taxel_core::parameter::Parameter;
use taxel_files::formats::Name;
use taxel_files::storage::Existing;

use crate::cli::arguments::flags::{
    Form, existing, force, json, name, of_sensor, required, unhandled_subcommand, what,
};
use crate::cli::arguments::help::{
    CHECK_EXAMPLES, DELETE_EXAMPLES, LIBRARY_EXAMPLES, LIST_EXAMPLES, PATH_EXAMPLES,
    RESTORE_EXAMPLES, SAVE_EXAMPLES, SHOW_EXAMPLES,
};
use crate::cli::error::CliError;
use crate::cli::settings::resolved::Effective;

#[derive(Clone, Debug)]
pub(crate) enum LibraryCommand {
    List(bool),
    Show(Name, Form),
    Save(Name, Existing, OsString),
    Delete(Name),
    Restore(Name),
    Path,
    Check(bool),
}

pub(super) fn command() -> Command {
    let command = |name: &'static str, about: &'static str, examples: &'static str| {
        Command::new(name).about(about).after_help(examples)
    };
    let list = command("list", "List all shapes", LIST_EXAMPLES).arg(json());
    let show = command("show", "Show a shape and describe it", SHOW_EXAMPLES)
        .arg(name("Name of the shape"))
        .args(of_sensor(&[Parameter::Pitch]))
        .arg(json());
    let save = command("save", "Store a shape under a name", SAVE_EXAMPLES)
        .arg(name("Name to store it under"))
        .arg(what(
            "Shape of the library, or file; '-' for standard input",
        ))
        .arg(force());
    let delete = command("delete", "Move a shape to the trash", DELETE_EXAMPLES);
    let restore = command("restore", "Restore a deleted shape", RESTORE_EXAMPLES);
    Command::new("library")
        .about("List, show, save, delete and check stored shapes")
        .after_help(LIBRARY_EXAMPLES)
        .subcommand_required(true)
        .subcommand(list)
        .subcommand(show)
        .subcommand(save)
        .subcommand(delete.arg(name("Name of the shape")))
        .subcommand(restore.arg(name("Name of the shape")))
        .subcommand(command("path", "Print the library's folder", PATH_EXAMPLES))
        .subcommand(
            command(
                "check",
                "Find broken shapes and stray files",
                CHECK_EXAMPLES,
            )
            .arg(json()),
        )
}

impl LibraryCommand {
    pub(super) fn of(matches: &ArgMatches, settings: &Effective) -> Result<Self, CliError> {
        let Some((command, own)) = matches.subcommand() else {
            // clap requires a subcommand, so there is always one.
            return Err(unhandled_subcommand("library"));
        };
        let name = own.try_get_one::<Name>("name").ok().flatten().cloned();
        Ok(match (command, name) {
            ("list", _) => Self::List(own.get_flag("json")),
            ("show", Some(name)) => Self::Show(name, Form::of(own, settings)?),
            ("save", Some(name)) => {
                let existing = existing(own);
                Self::Save(name, existing, required(own, "what")?)
            }
            ("delete", Some(name)) => Self::Delete(name),
            ("restore", Some(name)) => Self::Restore(name),
            ("check", _) => Self::Check(own.get_flag("json")),
            ("path", _) => Self::Path,
            (other, _) => return Err(unhandled_subcommand(other)),
        })
    }
}
