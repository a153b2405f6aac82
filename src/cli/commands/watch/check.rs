//! Refuses sources that cannot be watched, and flags that have no effect for a source, before it is opened.

use std::path::Path;

use crate::acquire::{FrameSource, Playback};
use crate::cli::arguments::watch::WatchArguments;
use crate::cli::error::CliError;
use crate::cli::input::recording::RecordingFile;
use crate::formats::recording::{ReadOptions, no_channel};
use crate::tui::runtime::check_source;

/// Refuses a source that cannot be read even if one waits, and the user's own terminal.
pub(super) fn check_readable(source: &FrameSource) -> Result<(), CliError> {
    check_source(source).map_err(|message| CliError::Frames {
        name: source.name(),
        message,
    })
}

/// Refuses flags that have no effect for a source: those of serial lines for others, those of playing for a stream,
/// and a channel that a recording does not have.
pub(super) fn check(source: &FrameSource, asked: &WatchArguments) -> Result<(), CliError> {
    if let Some(reason) = source.unused_baud().filter(|_| asked.baud_named) {
        let flag = "baud";
        return Err(CliError::Unused { flag, reason });
    }
    // A source that cannot be read is reported when it is watched.
    if let Playback::Paced { repeat, .. } = asked.options.playback
        && matches!(source.recording(&asked.options), Ok(None))
    {
        let flag = if repeat { "loop" } else { "speed" };
        let reason = "on a stream: it is for recordings".to_owned();
        return Err(CliError::Unused { flag, reason });
    }
    check_channel(source, asked)
}

/// Refuses a channel that a recording does not have, by reading the recording until the channel occurs. Otherwise the
/// recording would be played to its end without an answer.
fn check_channel(source: &FrameSource, asked: &WatchArguments) -> Result<(), CliError> {
    let (FrameSource::File(path), None, Some(wanted)) =
        (source, asked.options.format, &asked.processing.channel)
    else {
        return Ok(());
    };
    let (names, is_whole) = channels(path, asked, Some(wanted))?;
    // A stream, or a damage, which is reported when the source is watched.
    if names.contains(wanted) || !is_whole {
        return Ok(());
    }
    let names: Vec<&str> = names.iter().map(String::as_str).collect();
    Err(CliError::Frames {
        name: source.name(),
        message: no_channel(wanted, &names),
    })
}

pub(super) fn channels(
    path: &Path,
    asked: &WatchArguments,
    up_to: Option<&str>,
) -> Result<(Vec<String>, bool), CliError> {
    let options = ReadOptions {
        size: asked.options.size,
        ..ReadOptions::default()
    };
    Ok(RecordingFile::open(path, options)?.channel_names(up_to))
}
