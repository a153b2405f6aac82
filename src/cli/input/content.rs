//! Reads an imprint in any format, or a stored shape, from a file or from standard input.
//!
//! The format is recognised from the content, never from the file's name ([`read_content`]). At most [`MAX_BYTES`] are read.

use std::io::{self, Read};
use std::path::{Path, PathBuf};
use std::sync::atomic::{AtomicBool, Ordering};

use crate::formats::recording::may_be_recording;
use crate::formats::shape::MAX_BYTES;
use crate::formats::{Content, ContentError, read_content};
use crate::quote::shortened_message;

/// Where to read from.
#[derive(Clone, Debug, PartialEq, Eq)]
pub(crate) enum InputSource {
    /// A file.
    File(PathBuf),
    /// Standard input, given as `-`.
    Standard,
}

impl InputSource {
    /// What an argument names: `-` is standard input.
    pub(crate) fn of(path: &Path) -> Self {
        if path.as_os_str() == "-" {
            Self::Standard
        } else {
            Self::File(path.to_owned())
        }
    }

    /// Its name for messages: the path, or `standard input`.
    pub(crate) fn name(&self) -> String {
        match self {
            Self::File(path) => path.to_string_lossy().into_owned(),
            Self::Standard => "standard input".to_owned(),
        }
    }
}

/// Standard input, for the first who asks: a second reader would take the end that the first one found for an empty input.
///
/// # Errors
/// If it was asked for before.
pub(crate) fn standard() -> io::Result<io::Stdin> {
    static IS_TAKEN: AtomicBool = AtomicBool::new(false);
    if IS_TAKEN.swap(true, Ordering::Relaxed) {
        return Err(io::Error::other("it can be read only once"));
    }
    Ok(io::stdin())
}

/// Why input cannot be used.
#[derive(Debug, thiserror::Error)]
pub(crate) enum InputError {
    /// It cannot be opened or read.
    #[error("cannot read: {0}")]
    Read(#[from] io::Error),
    /// It is larger than any imprint or shape.
    #[error("larger than 1 MiB, the limit for an imprint or a shape")]
    Large,
    /// It is neither an imprint nor a stored shape.
    #[error("{}", shortened_message(&.0.to_string()))]
    Content(#[from] ContentError),
    /// It looks like a recording.
    #[error("{0}; if this is a recording, use taxel frames")]
    Recording(Box<InputError>),
}

/// Reads an open source. If the first character is `{` it is a stored shape, otherwise an imprint.
///
/// # Errors
/// [`InputError`], without the name of the source.
pub(crate) fn read_from(source: impl Read) -> Result<Content, InputError> {
    let bytes = bytes(source)?;
    read(&bytes).map_err(|error| {
        if may_be_recording(&bytes) {
            InputError::Recording(Box::new(error))
        } else {
            error
        }
    })
}

fn read(bytes: &[u8]) -> Result<Content, InputError> {
    if bytes.len() > MAX_BYTES {
        return Err(InputError::Large);
    }
    Ok(read_content(bytes)?)
}

/// All bytes of a source, up to one more than the limit.
fn bytes(source: impl Read) -> Result<Vec<u8>, InputError> {
    let mut bytes = Vec::new();
    let limit = MAX_BYTES as u64;
    source.take(limit + 1).read_to_end(&mut bytes)?;
    Ok(bytes)
}
