//! Reads an imprint in any format, or a stored shape, from a file or standard input.
//!
//! The format is recognised by the content, never by the file's name ([`read_content`]). At most [`MAX_BYTES`] are
//! read.

use std::fs::File;
use std::io::{self, Read};
use std::path::{Path, PathBuf};
use std::sync::atomic::{AtomicBool, Ordering};

use serde::Deserialize;
use serde::de::IgnoredAny;
use taxel_files::ReadError;
use taxel_files::formats::file::{system_reason, without_mark};
use taxel_files::formats::imprint_file::MAX_BYTES;
use taxel_files::formats::recording::may_be_recording;
use taxel_files::formats::{Content, read_content};

#[derive(Clone, Debug, PartialEq, Eq)]
pub(crate) enum InputSource {
    File(PathBuf),
    Standard,
}

impl InputSource {
    pub(crate) fn of(path: &Path) -> Self {
        if path.as_os_str() == "-" {
            Self::Standard
        } else {
            Self::File(path.to_owned())
        }
    }

    pub(crate) fn name(&self) -> String {
        match self {
            Self::File(path) => path.to_string_lossy().into_owned(),
            Self::Standard => "standard input".to_owned(),
        }
    }

    pub(crate) fn open(&self) -> io::Result<Box<dyn Read>> {
        Ok(match self {
            Self::File(path) => Box::new(File::open(path)?),
            Self::Standard => Box::new(standard()?),
        })
    }
}

/// Returns standard input, but only once: a second reader would find only its end, and take it for an empty input.
pub(crate) fn standard() -> io::Result<io::Stdin> {
    static IS_TAKEN: AtomicBool = AtomicBool::new(false);
    if IS_TAKEN.swap(true, Ordering::Relaxed) {
        return Err(io::Error::other("it can be read only once"));
    }
    Ok(io::stdin())
}

#[derive(Debug, thiserror::Error)]
pub(crate) enum InputError {
    #[error("cannot read: {}", system_reason(.0))]
    Read(#[from] io::Error),
    #[error("{0}")]
    Content(#[from] ReadError),
    #[error("{error}; if this is {what}, use taxel {command}")]
    Elsewhere {
        error: Box<InputError>,
        what: &'static str,
        command: &'static str,
    },
}

pub(crate) fn read_from(source: impl Read) -> Result<Content, InputError> {
    let bytes = bytes(source)?;
    read_content(&bytes).map_err(|error| {
        let error = error.into();
        let other = may_be_recording(&bytes).then_some(("a recording", "frames"));
        match other.or_else(|| lines_of(&bytes)) {
            Some((what, command)) => InputError::Elsewhere {
                error: Box::new(error),
                what,
                command,
            },
            None => error,
        }
    })
}

/// Returns what JSON lines are if not imprints, a list of poses or a set of shapes, and the command that reads them.
/// The first line decides.
fn lines_of(bytes: &[u8]) -> Option<(&'static str, &'static str)> {
    let bytes = without_mark(bytes);
    let mut lines = bytes.split(|&byte| byte == b'\n');
    let first = lines.find(|line| !line.trim_ascii().is_empty())?;
    line_of_sources(first)
}

/// Returns what a JSON line is, a pose or a shape of a set, and the command that reads it; None if it is neither. A
/// stored shape has neither of the keys `figure` and `picture`.
pub(crate) fn line_of_sources(line: &[u8]) -> Option<(&'static str, &'static str)> {
    #[derive(Deserialize)]
    struct SourceKeys {
        figure: Option<IgnoredAny>,
        picture: Option<IgnoredAny>,
        name: Option<IgnoredAny>,
    }
    let keys: SourceKeys = serde_json::from_slice(line).ok()?;
    keys.figure.or(keys.picture)?;
    Some(match keys.name {
        Some(_) => ("a set of shapes", "model train"),
        None => ("a list of poses", "batch"),
    })
}

fn bytes(source: impl Read) -> Result<Vec<u8>, InputError> {
    let mut bytes = Vec::new();
    let limit = MAX_BYTES as u64;
    source.take(limit + 1).read_to_end(&mut bytes)?;
    Ok(bytes)
}
