//! Turns the arguments that clap has parsed into a [`Request`]: plain values, typed and checked. Only this module and
//! those beside it know clap.
//!
//! Settings are resolved here, since they provide defaults: the sensor of a figure, the pitch of a table.

use std::ffi::OsString;
use std::path::Path;

use clap::builder::StyledStr;
use clap::error::{ContextKind, ContextValue, Error, ErrorKind};
use clap::parser::ValueSource;
use clap::{ArgMatches, Command};
use taxel_core::figure::FigureKind;
use taxel_core::quote::{as_argument, joined};
use taxel_files::formats::file::has_ending;

use crate::cli::arguments::definitions;
use crate::cli::arguments::flags::{Given, unhandled_subcommand};
use crate::cli::arguments::library::LibraryCommand;
use crate::cli::error::CliError;
use crate::cli::settings::resolved::Effective;

/// A command that is read by hand.
#[derive(Clone, Debug)]
pub(crate) enum Request {
    Library(LibraryCommand),
}

/// Leaves out the texts below the flags in the help of a command and of its subcommands: `-h` prints usage and flags
/// only.
fn without_notes(command: Command) -> Command {
    command
        .after_help("'--help' also explains and gives examples.")
        .mut_subcommands(without_notes)
}

/// What clap makes of the arguments; or the help, if it is asked for.
pub(crate) fn read(arguments: Vec<OsString>) -> Result<ArgMatches, clap::Error> {
    let has = |flag: &str| arguments.iter().any(|argument| argument == flag);
    let is_short = has("-h") && !has("--help");
    let all = definitions::all();
    let all = if is_short { without_notes(all) } else { all };
    let mut command = definitions::grouped(all);
    let matches = command
        .try_get_matches_from_mut(arguments)
        .map_err(with_tips)?;
    if let Some((name, own)) = matches.subcommand() {
        if let Some(flag) = Given::of(&matches).first().or(of_screen(&matches)) {
            let message = too_early(&flag, name, &command);
            return Err(command.error(ErrorKind::ArgumentConflict, message));
        }
        if let Some(message) = shared_input(deepest(own)) {
            return Err(command.error(ErrorKind::ArgumentConflict, message));
        }
    }
    Ok(matches)
}

fn deepest(matches: &ArgMatches) -> &ArgMatches {
    matches
        .subcommand()
        .map_or(matches, |(_, own)| deepest(own))
}

/// Returns the message that two arguments both stand for standard input, which can be read only once; None if at most
/// one does.
fn shared_input(matches: &ArgMatches) -> Option<String> {
    let inputs = ["file", "what", "set", "source", "mask", "gain"];
    let mut standard = inputs.into_iter().flat_map(|id| {
        let given = matches.try_get_raw(id).ok().flatten();
        let standard = given.into_iter().flatten().filter(|value| *value == "-");
        standard.map(move |_| id)
    });
    let text = |id: &str| match id {
        "mask" | "gain" => format!("--{id} -"),
        _ => "-".to_owned(),
    };
    let (one, other) = (standard.next()?, standard.next()?);
    Some(format!(
        "'{}' and '{}' both stand for standard input, which can be read only once",
        text(one),
        text(other)
    ))
}

/// Returns the first given flag of the screen. Before a command such a flag would have no effect, so it is refused.
fn of_screen(matches: &ArgMatches) -> Option<String> {
    let flags = ["color", "theme", "no_mouse", "size", "record"];
    let given = |flag: &&str| matches.value_source(flag) == Some(ValueSource::CommandLine);
    flags
        .into_iter()
        .find(given)
        .map(|flag| flag.replace('_', "-"))
}

fn too_early(flag: &str, name: &str, command: &Command) -> String {
    let has_flag = |own: &Command| own.get_arguments().any(|own| own.get_long() == Some(flag));
    if command.find_subcommand(name).is_some_and(has_flag) {
        format!("'--{flag}' must come after '{name}'; before it, it is a flag of the screen")
    } else {
        format!(
            "the subcommand '{name}' cannot be used with '--{flag}', which is only for the screen"
        )
    }
}

pub(crate) fn request(
    name: &str,
    own: &ArgMatches,
    settings: &Effective,
) -> Result<Request, CliError> {
    Ok(match name {
        "library" => Request::Library(LibraryCommand::of(own, settings)?),
        other => return Err(unhandled_subcommand(other)),
    })
}

/// Extensions of files that contain frames. `.txt` and `.json` are left out: such files may be imprints and shapes.
const RECORDINGS: [&str; 8] = ["apd", "asf", "csv", "jsonl", "lst", "mcap", "npy", "npz"];

pub(super) fn with_tips(mut error: Error) -> Error {
    let tips = match error.kind() {
        ErrorKind::InvalidSubcommand => for_recording(&error),
        ErrorKind::InvalidValue => for_no_figure(&error),
        ErrorKind::MissingRequiredArgument => for_missing(&error),
        _ => Vec::new(),
    };
    if !tips.is_empty() {
        // A misspelt word is less likely then: a circle is not a misspelt rectangle.
        error.remove(ContextKind::SuggestedValue);
        let tips = tips.into_iter().map(StyledStr::from).collect();
        error.insert(ContextKind::Suggested, ContextValue::StyledStrs(tips));
    }
    error
}

fn quoted(error: &Error, kind: ContextKind) -> Option<&str> {
    match error.get(kind) {
        Some(ContextValue::String(text)) => Some(text),
        _ => None,
    }
}

fn for_recording(error: &Error) -> Vec<String> {
    let Some(given) = quoted(error, ContextKind::InvalidSubcommand) else {
        return Vec::new();
    };
    let path = Path::new(given);
    let is_recording = RECORDINGS.iter().any(|ending| has_ending(path, ending));
    if !is_recording || !path.is_file() {
        return Vec::new();
    }
    let typed = as_argument(given);
    vec![
        format!("taxel frames {typed} lists what is in it"),
        format!("taxel watch {typed} plays it"),
    ]
}

fn for_no_figure(error: &Error) -> Vec<String> {
    let argument = quoted(error, ContextKind::InvalidArg);
    let given = quoted(error, ContextKind::InvalidValue).filter(|given| !given.is_empty());
    let (Some(argument), Some(given)) = (argument, given) else {
        return Vec::new();
    };
    let is_kind = ["<KIND>", "[KIND]"].contains(&argument);
    if let Some(known) = FigureKind::of_other_name(given).filter(|_| is_kind) {
        return vec![known.to_owned()];
    }
    if error.get(ContextKind::SuggestedValue).is_some() {
        return Vec::new();
    }
    let shape = as_argument(given);
    match argument {
        // 'sweep' also takes a stored shape, so its kind is optional.
        "[KIND]" => vec![format!("for a stored shape, use --picture {shape}")],
        "<KIND>" => vec![format!("for a stored shape, use taxel picture {shape}")],
        _ => Vec::new(),
    }
}

fn for_missing(error: &Error) -> Vec<String> {
    let Some(ContextValue::Strings(missing)) = error.get(ContextKind::InvalidArg) else {
        return Vec::new();
    };
    let lacks = |word: &str| missing.iter().any(|argument| argument.contains(word));
    let mut tips = Vec::new();
    if lacks("KIND") {
        let kinds = joined(FigureKind::names(), "or");
        tips.push(format!("KIND is {kinds}"));
    }
    if lacks("--peak") {
        tips.push("to describe frames, choose some, such as '--peak' or '--all'".to_owned());
    }
    tips
}
