//! Opens a file or standard input, and reads an imprint in any format, or a stored shape, from it. The format is
//! recognised by the content, never by the file's name.

use std::fs::File;
use std::io::{self, Read};
use std::path::{Path, PathBuf};
use std::sync::atomic::{AtomicBool, Ordering};

use serde::Deserialize;
use serde::de::IgnoredAny;
use taxel_files::ReadError;
use taxel_files::formats::file::without_mark;
use taxel_files::formats::imprint_file::MAX_BYTES;
use taxel_files::formats::recording::may_be_recording;
use taxel_files::formats::{Content, read_content};

use crate::cli::failure::{Failure, Named};

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

/// An open file or standard input.
pub(crate) struct Input {
    pub(crate) name: String,
    pub(crate) read: Box<dyn Read>,
}

impl Input {
    /// Opens a file; `-` is standard input.
    pub(crate) fn open(path: &Path) -> Result<Self, Failure> {
        let source = InputSource::of(path);
        let name = source.name();
        let read = source.open().map_err(ReadError::from).named(&name)?;
        Ok(Self { name, read })
    }

    /// Reads an imprint or a stored shape. If another command reads what is there, the error names it.
    pub(crate) fn content(self) -> Result<Content, Failure> {
        let mut bytes = Vec::new();
        let mut limited = self.read.take(MAX_BYTES as u64 + 1);
        let read = limited.read_to_end(&mut bytes).map_err(ReadError::from);
        read.and_then(|_| read_content(&bytes))
            .named(&self.name)
            .map_err(|failure| {
                let other = if may_be_recording(&bytes) {
                    Some(("a recording", "frames"))
                } else {
                    let mut lines = without_mark(&bytes).split(|&byte| byte == b'\n');
                    let first = lines.find(|line| !line.trim_ascii().is_empty());
                    first.and_then(line_of_sources)
                };
                match other {
                    Some((what, command)) => {
                        failure.with_hint(format!("; if this is {what}, use taxel {command}"))
                    }
                    None => failure,
                }
            })
    }
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
