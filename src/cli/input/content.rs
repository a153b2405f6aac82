//! What the commands read: an imprint in any form or a stored shape, from a file or from standard input.

use std::fs::File;
use std::io::{self, Read};
use std::path::PathBuf;

use crate::formats::shape::MAX_BYTES;
use crate::formats::{ImprintFormatError, ShapeError, StoredShape, imprint_file};
use crate::imprint::Imprint;
use crate::quote::legible;

/// Where input comes from.
#[derive(Clone, Debug, PartialEq, Eq)]
pub(crate) enum InputSource {
    /// A file.
    File(PathBuf),
    /// Standard input, written `-`.
    Standard,
}

impl InputSource {
    /// Its name in messages.
    pub(crate) fn name(&self) -> String {
        match self {
            Self::File(path) => path.to_string_lossy().into_owned(),
            Self::Standard => "standard input".to_owned(),
        }
    }
}

/// What was read.
#[derive(Clone, Debug)]
#[expect(clippy::large_enum_variant, reason = "there is one of these at a time")]
pub(crate) enum Content {
    /// An imprint alone.
    Imprint(Imprint),
    /// A stored shape.
    Shape(StoredShape),
}

/// Why a file cannot be described.
#[derive(Debug, thiserror::Error)]
pub(crate) enum InputError {
    /// It cannot be opened or read.
    #[error("cannot read: {0}")]
    Read(#[from] io::Error),
    /// No imprint and no shape is as large.
    #[error("larger than 1 MiB, which neither an imprint nor a shape is")]
    Large,
    /// No imprint.
    #[error(transparent)]
    Imprint(#[from] ImprintFormatError),
    /// JSON, but no shape.
    #[error("{}", legible(&.0.to_string()))]
    Shape(#[from] ShapeError),
}

/// Reads a source: a stored shape where its first character is `{`, an imprint otherwise.
pub(crate) fn read(source: &InputSource) -> Result<Content, InputError> {
    let bytes = match source {
        InputSource::File(path) => bytes(File::open(path)?)?,
        InputSource::Standard => bytes(io::stdin().lock())?,
    };
    // Some editors begin every text with a byte order mark.
    let bytes = bytes.strip_prefix(b"\xef\xbb\xbf").unwrap_or(&bytes);
    if bytes.trim_ascii_start().starts_with(b"{") {
        Ok(Content::Shape(StoredShape::read(bytes)?))
    } else {
        Ok(Content::Imprint(imprint_file::read(bytes)?))
    }
}

fn bytes(source: impl Read) -> Result<Vec<u8>, InputError> {
    let mut bytes = Vec::new();
    let limit = MAX_BYTES as u64;
    source.take(limit + 1).read_to_end(&mut bytes)?;
    if bytes.len() > MAX_BYTES {
        return Err(InputError::Large);
    }
    Ok(bytes)
}
