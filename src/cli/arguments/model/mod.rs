//! `taxel model`: its subcommands, with a file for the flags of each.
//!
//! | file | holds |
//! |---|---|
//! | `shape_set` | the shapes of a set, for `train` and `separate` |
//! | `train` | `taxel model train` |
//! | `separate` | `taxel model separate` |
//! | `confusion` | `taxel model confusion` |
//! | `touches` | `taxel model touches` |
//!
//! `show`, `list` and `delete` are small and defined here. A model is named as in `taxel recognise --model`: a
//! built-in set such as `figures` ([`DEFAULT_MODEL`]) takes precedence over a model beside the library, and that over
//! a file.

use std::ffi::OsString;

use clap::{ArgMatches, Command};

use crate::cli::arguments::flags::{self, json, required, unhandled_subcommand};
use crate::cli::arguments::help::{
    MODEL_DELETE_EXAMPLES, MODEL_EXAMPLES, MODEL_LIST_EXAMPLES, MODEL_SHOW_EXAMPLES,
};
use crate::cli::error::CliError;
use crate::formats::Name;

pub(in crate::cli) mod shape_set;

pub(in crate::cli) mod train;

pub(in crate::cli) mod separate;

pub(in crate::cli) mod confusion;

pub(in crate::cli) mod touches;

/// The model that is used if none is named: the seven figures at their default sizes.
pub(crate) const DEFAULT_MODEL: &str = "figures";

#[derive(Clone, Debug)]
pub(crate) enum ModelRequest {
    Train(Box<train::TrainArguments>),
    Show(OsString, bool),
    List(bool),
    Delete(Name),
    Confusion(Box<confusion::ConfusionArguments>),
    Touches(touches::TouchesArguments),
    Separate(Box<separate::SeparateArguments>),
}

impl ModelRequest {
    pub(super) fn of(matches: &ArgMatches) -> Result<Self, CliError> {
        let Some((command, own)) = matches.subcommand() else {
            // clap requires a subcommand, so there is always one.
            return Err(unhandled_subcommand("model"));
        };
        Ok(match command {
            "train" => Self::Train(Box::new(train::TrainArguments::of(own)?)),
            "show" => Self::Show(flags::word(own, "model"), own.get_flag("json")),
            "delete" => Self::Delete(required(own, "name")?),
            "touches" => Self::Touches(touches::TouchesArguments::of(own)),
            "confusion" => Self::Confusion(Box::new(confusion::ConfusionArguments::of(own)?)),
            "separate" => Self::Separate(Box::new(separate::SeparateArguments::of(own)?)),
            "list" => Self::List(own.get_flag("json")),
            other => return Err(unhandled_subcommand(other)),
        })
    }
}

pub(super) fn command() -> Command {
    let show = Command::new("show")
        .about("Show what a model was trained on, and its error")
        .after_help(MODEL_SHOW_EXAMPLES)
        .args([flags::which_model(), json()]);
    let list = Command::new("list")
        .about("List the models")
        .after_help(MODEL_LIST_EXAMPLES)
        .arg(json());
    let delete = Command::new("delete")
        .about("Delete a model")
        .after_help(MODEL_DELETE_EXAMPLES)
        .arg(flags::name("Name of the model"));
    Command::new("model")
        .about("Train models, and measure how well one touch tells shapes apart")
        .after_help(MODEL_EXAMPLES)
        .subcommand_required(true)
        .subcommand(train::command())
        .subcommand(show)
        .subcommand(list)
        .subcommand(delete)
        .subcommand(confusion::command())
        .subcommand(touches::command())
        .subcommand(separate::command())
}
