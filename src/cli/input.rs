//! What the commands read: an imprint as text or a stored shape, from a file or from standard input.

use std::fs::File;
use std::io::{self, Read};
use std::path::PathBuf;

use crate::formats::shape::{MAX_BYTES, Shape, ShapeError};
use crate::imprint::{Imprint, ImprintError};

/// Where input comes from.
#[derive(Clone, Debug, PartialEq, Eq)]
pub(super) enum Place {
    /// A file.
    File(PathBuf),
    /// Standard input, written `-`.
    Standard,
}

impl Place {
    /// Its name in messages.
    pub(super) fn name(&self) -> String {
        match self {
            Self::File(path) => path.to_string_lossy().into_owned(),
            Self::Standard => "standard input".to_owned(),
        }
    }
}

/// What was read.
#[derive(Clone, Debug)]
#[expect(clippy::large_enum_variant, reason = "there is one of these at a time")]
pub(super) enum Content {
    /// Rows of `#` and `.`.
    Text(Imprint),
    /// A stored shape.
    Shape(Shape),
}

/// Why a file cannot be described. Lines and columns count from 1.
#[derive(Debug, thiserror::Error)]
pub(super) enum InputError {
    /// It cannot be opened or read.
    #[error("cannot read: {0}")]
    Read(#[from] io::Error),
    /// No imprint and no shape is as large.
    #[error("larger than 1 MiB, which neither an imprint nor a shape is")]
    Large,
    /// A byte that is no text.
    #[error("line {line}, column {column}: found byte 0x{byte:02x}, expected '#' or '.'")]
    Byte {
        line: usize,
        column: usize,
        byte: u8,
    },
    /// A character that is no taxel.
    #[error("line {line}, column {column}: found {found:?}, expected '#' or '.'")]
    Character {
        line: usize,
        column: usize,
        found: char,
    },
    /// A line of another length than the first.
    #[error("line {line}, column {column}: found {found} taxels, expected {expected} as in line 1")]
    Ragged {
        line: usize,
        column: usize,
        found: usize,
        expected: u8,
    },
    /// An empty line, or one with too many taxels.
    #[error("line {line}, column {column}: found {found} taxels, expected 1 to 64")]
    Columns {
        line: usize,
        column: usize,
        found: usize,
    },
    /// No lines, or too many.
    #[error("found {found} lines, expected 1 to 64")]
    Lines { found: usize },
    /// JSON, but no shape.
    #[error("{}", shortened(&.0.to_string()))]
    Shape(#[from] ShapeError),
}

/// Reads the content of a place: a stored shape where its first character is `{`, an imprint as text otherwise.
pub(super) fn read(place: &Place) -> Result<Content, InputError> {
    let bytes = match place {
        Place::File(path) => bytes(File::open(path)?)?,
        Place::Standard => bytes(io::stdin().lock())?,
    };
    if bytes.trim_ascii_start().starts_with(b"{") {
        Ok(Content::Shape(Shape::read(&bytes)?))
    } else {
        imprint(&bytes).map(Content::Text)
    }
}

fn bytes(source: impl Read) -> Result<Vec<u8>, InputError> {
    let mut bytes = Vec::new();
    let limit = u64::try_from(MAX_BYTES).unwrap_or(u64::MAX);
    source.take(limit + 1).read_to_end(&mut bytes)?;
    if bytes.len() > MAX_BYTES {
        return Err(InputError::Large);
    }
    Ok(bytes)
}

/// The imprint in a text; lines may end in CRLF, and blank ones may follow the last row.
fn imprint(bytes: &[u8]) -> Result<Imprint, InputError> {
    let text = str::from_utf8(bytes).map_err(|error| {
        let valid = &bytes[..error.valid_up_to()];
        let start = valid.iter().rposition(|&byte| byte == b'\n');
        let before = &valid[start.map_or(0, |start| start + 1)..];
        InputError::Byte {
            line: valid.split(|&byte| byte == b'\n').count(),
            column: 1 + String::from_utf8_lossy(before).chars().count(),
            byte: bytes[error.valid_up_to()],
        }
    })?;
    let blank = |line: &str| line.trim_end().is_empty();
    let mut rows: Vec<&str> = text
        .split('\n')
        .map(|line| line.strip_suffix('\r').unwrap_or(line))
        .collect();
    while rows.last().is_some_and(|line| blank(line)) {
        rows.pop();
    }
    Imprint::from_rows(rows.iter().copied()).map_err(|error| match error {
        ImprintError::Rows => InputError::Lines { found: rows.len() },
        ImprintError::Columns { row, found } => InputError::Columns {
            line: row,
            column: found.min(64) + 1,
            found,
        },
        ImprintError::Ragged {
            row,
            found,
            expected,
        } => InputError::Ragged {
            line: row,
            column: found.min(usize::from(expected)) + 1,
            found,
            expected,
        },
        ImprintError::Character { row, column, found } => InputError::Character {
            line: row,
            column,
            found,
        },
    })
}

/// A message that quotes its input, which may be a megabyte long, at a length that can be read.
pub(super) fn shortened(message: &str) -> String {
    const LENGTH: usize = 400;
    match message.char_indices().nth(LENGTH) {
        Some((end, _)) => format!("{}…", &message[..end]),
        None => message.to_owned(),
    }
}
