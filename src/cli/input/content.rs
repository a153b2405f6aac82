//! Opens a file or standard input, and reads an imprint in any format, or a stored shape, from it. The format is
//! recognised by the content, never by the file's name.

use std::fs::File;
use std::io::{self, Read};
use std::path::{Path, PathBuf};
use std::sync::atomic::{AtomicBool, Ordering};

use taxel_files::ReadError;
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

    /// Reads an imprint or a stored shape.
    pub(crate) fn content(self) -> Result<Content, Failure> {
        let mut bytes = Vec::new();
        let mut limited = self.read.take(MAX_BYTES as u64 + 1);
        let read = limited.read_to_end(&mut bytes).map_err(ReadError::from);
        let content = read.and_then(|_| read_content(&bytes)).named(&self.name);
        content.map_err(|failure| {
            let hint = "; if this is a recording, use taxel frames";
            failure.with_hint(if may_be_recording(&bytes) { hint } else { "" })
        })
    }
}
