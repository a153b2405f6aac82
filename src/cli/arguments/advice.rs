//! Tips for arguments that clap refuses, added to its message, and messages that replace it.
//!
//! ```text
//! taxel picture washer --side 3   '--side' does not belong to 'picture'; its parameters are --x0, …
//! taxel sweep washer              tip: for a stored shape, use --picture washer
//! taxel frames.csv                tip: taxel frames frames.csv lists what is in it
//! ```

use std::path::Path;

use clap::Command;
use clap::builder::StyledStr;
use clap::error::{ContextKind, ContextValue, Error, ErrorKind};

use crate::figure::FigureKind;
use crate::formats::ending::has_ending;
use crate::parameter::PARAMETERS;
use crate::quote::{as_argument, joined};

/// Extensions of files that contain frames. `.txt` and `.json` are left out: such files may be imprints and shapes.
const RECORDINGS: [&str; 8] = ["apd", "asf", "csv", "jsonl", "lst", "mcap", "npy", "npz"];

/// The most commands that a message about a flag lists.
const MOST_NAMED: usize = 4;

/// Returns the error with tips, or with a better message.
pub(super) fn with_tips(mut error: Error, program: &mut Command) -> Error {
    let tips = match error.kind() {
        ErrorKind::UnknownArgument => return unknown_flag(error, program),
        ErrorKind::InvalidSubcommand => for_recording(&error),
        ErrorKind::InvalidValue => for_no_figure(&error),
        ErrorKind::MissingRequiredArgument => for_missing(&error),
        _ => Vec::new(),
    };
    if !tips.is_empty() {
        // A misspelt word is less likely then: a circle is not a misspelt rectangle.
        error.remove(ContextKind::SuggestedValue);
    }
    suggest(&mut error, tips.into_iter().map(StyledStr::from).collect());
    error
}

/// Ends the message with tips, if there are any.
fn suggest(error: &mut Error, tips: Vec<StyledStr>) {
    if !tips.is_empty() {
        error.insert(ContextKind::Suggested, ContextValue::StyledStrs(tips));
    }
}

/// Returns a text that the error quotes.
fn quoted(error: &Error, kind: ContextKind) -> Option<&str> {
    match error.get(kind) {
        Some(ContextValue::String(text)) => Some(text),
        _ => None,
    }
}

/// Returns the error for a flag that the command does not have. If another command has it, the message says so;
/// otherwise it is clap's. clap's advice to pass the flag as a value is kept only for flags with one dash: a value
/// that begins with two is rarer than a misspelt flag.
fn unknown_flag(mut error: Error, program: &mut Command) -> Error {
    if let Some((names, message)) = misplaced(&error, program) {
        let refusing = names.iter().try_fold(program, |command, name| {
            command.find_subcommand_mut(name.as_str())
        });
        if let Some(command) = refusing {
            return command.error(ErrorKind::UnknownArgument, message);
        }
    } else if quoted(&error, ContextKind::InvalidArg) == Some("--radius") {
        let both =
            "an ellipse has two radii, '--radius-x' and '--radius-y'; a circle has equal ones";
        error.remove(ContextKind::SuggestedArg);
        suggest(&mut error, vec![StyledStr::from(both)]);
    } else if quoted(&error, ContextKind::InvalidArg).is_some_and(|flag| flag.starts_with("--"))
        && let Some(ContextValue::StyledStrs(mut tips)) = error.remove(ContextKind::Suggested)
    {
        tips.retain(|tip| !tip.to_string().contains("' as a value, use '"));
        suggest(&mut error, tips);
    }
    error
}

/// Returns the command that refuses a flag of another command, and the message about it.
fn misplaced(error: &Error, program: &Command) -> Option<(Vec<String>, String)> {
    let flag = quoted(error, ContextKind::InvalidArg)?.strip_prefix("--")?;
    let names = refusing(error, program);
    if names.is_empty() {
        return None;
    }
    let own = names
        .iter()
        .try_fold(program, |command, name| command.find_subcommand(name))?;
    // If a subcommand of this command takes the flag, clap says so: the flag only has to come later. A flag of the
    // command itself is one argument too many after `--`.
    if has(own, flag) || own.get_subcommands().any(|inner| has(inner, flag)) {
        return None;
    }
    let mut owners = Vec::new();
    add_owners(program, flag, "", &mut owners);
    // A flag of the program itself is for the screen, except `--version`.
    if has(program, flag) && flag != "version" {
        owners.push("the screen".to_owned());
    }
    if owners.is_empty() {
        return None;
    }
    let flags = PARAMETERS.iter().map(|row| row.parameter.flag());
    let (own_flags, others): (Vec<String>, Vec<String>) = flags.partition(|flag| has(own, flag));
    let mut message = format!("'--{flag}' does not belong to '{}'", names.join(" "));
    // The command's own parameters are a useful hint only if the command places a shape.
    let places = own_flags.iter().any(|own| own == "x0");
    if places && others.iter().any(|other| other == flag) {
        let own_flags = own_flags.iter().map(|own| format!("--{own}"));
        let own_flags = joined(own_flags, "and");
        message += &format!("; its parameters are {own_flags}");
    } else {
        let more = owners.len().saturating_sub(MOST_NAMED);
        owners.truncate(MOST_NAMED);
        if more > 0 {
            owners.push(format!("{more} more"));
        }
        message += &format!(", but to {}", joined(owners, "and"));
    }
    Some((names, message))
}

/// Returns the path of the command whose arguments are refused, such as `model`, `train`. Only the error's usage line
/// has it.
fn refusing(error: &Error, program: &Command) -> Vec<String> {
    let mut names = Vec::new();
    let Some(ContextValue::StyledStr(usage)) = error.get(ContextKind::Usage) else {
        return names;
    };
    let mut command = program;
    // Skips `Usage:` and the name of the program.
    for word in usage.to_string().split_whitespace().skip(2) {
        let Some(inner) = command.find_subcommand(word) else {
            break;
        };
        names.push(word.to_owned());
        command = inner;
    }
    names
}

/// Returns true if the help of a command shows a flag.
fn has(command: &Command, flag: &str) -> bool {
    let mut shown = command.get_arguments().filter(|arg| !arg.is_hide_set());
    shown.any(|arg| arg.get_long() == Some(flag))
}

/// Adds all subcommands that have a flag, each as a quoted path.
fn add_owners(command: &Command, flag: &str, path: &str, owners: &mut Vec<String>) {
    for inner in command.get_subcommands() {
        let path = format!("{path}{}", inner.get_name());
        if has(inner, flag) {
            owners.push(format!("'{path}'"));
        }
        add_owners(inner, flag, &format!("{path} "), owners);
    }
}

/// Returns tips if a recording is given in place of a command: the commands that read it.
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

/// Returns tips for a word that is not a kind of figure. For a misspelt kind, clap has a tip.
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

/// Returns tips for missing arguments whose names do not explain them.
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
