//! Tips for arguments that clap refuses, added to its message.
//!
//! ```text
//! taxel sweep washer              tip: for a stored shape, use --picture washer
//! taxel frames.csv                tip: taxel frames frames.csv lists what is in it
//! ```

use std::path::Path;

use clap::builder::StyledStr;
use clap::error::{ContextKind, ContextValue, Error, ErrorKind};

use crate::figure::FigureKind;
use crate::formats::file::has_ending;
use crate::quote::{as_argument, joined};

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
