//! The formats in which a plain imprint is exchanged with other programs: text, CSV and NPY.
//!
//! When a file is read, its content decides the format; when it is written, the ending of its name does.
//!
//! ```
//! use taxel_files::formats::{Drawing, ExportFormat, read_imprint};
//! let cup = read_imprint(b"#.#\n###\n")?;
//! let format = ExportFormat::of_path("imprint.csv").unwrap();
//! assert_eq!((format.write)(&Drawing::new(&cup)), b"1,0,1\n1,1,1\n");
//! # Ok::<(), taxel_files::ReadError>(())
//! ```

use std::path::Path;

use taxel_core::imprint::Imprint;

use crate::error::{ReadError, ReadErrorKind};
use crate::formats::drawing::Drawing;
use crate::formats::file::{has_ending, without_mark};
use crate::formats::shape::StoredShape;
use crate::formats::{numpy, table};

/// The size limit of an imprint's file in bytes, 1 MiB; a larger file is refused unread.
pub const MAX_BYTES: usize = 1 << 20;

/// A format in which an imprint is written, or drawn.
#[derive(Clone, Copy, Debug)]
pub struct ExportFormat {
    /// The name on the command line, and the extension of files.
    pub name: &'static str,
    /// Returns the content of a file. Only a drawing shows more than the imprint.
    pub write: fn(&Drawing) -> Vec<u8>,
}

impl ExportFormat {
    /// All formats.
    pub const ALL: &'static [Self] = &[
        Self {
            name: "txt",
            write: |drawing| format!("{}\n", drawing.imprint).into_bytes(),
        },
        Self {
            name: "csv",
            write: |drawing| table::write(&drawing.imprint),
        },
        Self {
            name: "npy",
            write: |drawing| numpy::imprint::write(&drawing.imprint),
        },
        Self {
            name: Self::SVG,
            write: |drawing| drawing.svg().into_bytes(),
        },
    ];

    /// The name of the only format that is a drawing.
    pub const SVG: &'static str = "svg";

    /// The format for the extension of a file's name, in upper or lower case; None if no format has it.
    pub fn of_path(path: impl AsRef<Path>) -> Option<&'static Self> {
        let mut formats = Self::ALL.iter();
        formats.find(|format| has_ending(&path, format.name))
    }
}

type Begins = fn(&[u8]) -> bool;
type Reader = fn(&[u8]) -> Result<Imprint, ReadError>;

/// How each format begins, and how it is read.
const READERS: [(Begins, Reader); 3] = [
    (is_text, read_text),
    (table::begins, table::read),
    (
        |bytes| bytes.starts_with(numpy::MAGIC),
        |bytes| numpy::imprint::read(bytes).map_err(|error| error.of_key("NPY")),
    ),
];

/// Reads an imprint from any bytes, in any of the formats. A byte order mark before them is skipped.
///
/// # Errors
/// Returns the first error, with its line and column if the format has any; [`ReadErrorKind::UnknownFormat`] for
/// anything else.
pub fn read(bytes: &[u8]) -> Result<Imprint, ReadError> {
    if bytes.len() > MAX_BYTES {
        let text = "larger than 1 MiB, the limit for an imprint or a shape";
        return Err(ReadError::new(text));
    }
    let bytes = without_mark(bytes);
    match READERS.iter().find(|(begins, _)| begins(bytes)) {
        Some((_, read)) => read(bytes),
        None => Err(unknown()),
    }
}

fn unknown() -> ReadError {
    let text = "not an imprint: expected rows of '#' and '.', a table of 0 and 1 (CSV), or NPY";
    ReadError::new(text).of_kind(ReadErrorKind::UnknownFormat)
}

/// Returns the text of a file, in UTF-8.
pub(super) fn text(bytes: &[u8]) -> Result<&str, ReadError> {
    str::from_utf8(bytes).map_err(|_| unknown())
}

fn is_text(bytes: &[u8]) -> bool {
    // A comment, before a table, has a blank behind its sign.
    !bytes.starts_with(b"# ")
        && matches!(bytes.trim_ascii_start().first(), None | Some(b'#' | b'.'))
}

/// Reads rows of `#` and `.`. Lines may end in blanks and in CRLF, and blank lines may follow the last row.
fn read_text(bytes: &[u8]) -> Result<Imprint, ReadError> {
    let rows = text(bytes)?.trim_end().lines().map(str::trim_end);
    Ok(Imprint::from_rows(rows)?)
}

/// Whether a number in a table or an array means an active taxel; None for a number that means neither.
pub(super) fn is_active(number: f64) -> Option<bool> {
    match number {
        0.0 => Some(false),
        1.0 | 255.0 => Some(true),
        _ => None,
    }
}

/// The content of a file that may be an imprint or a stored shape.
#[derive(Clone, Debug)]
#[expect(clippy::large_enum_variant, reason = "there is one of these at a time")]
pub enum Content {
    /// An imprint: a matrix without a sensor or a name.
    Imprint(Imprint),
    /// A stored shape: an imprint with its name, sensor and source.
    Shape(StoredShape),
}

impl Content {
    /// The imprint, or that of the stored shape.
    pub fn imprint(&self) -> &Imprint {
        match self {
            Self::Imprint(imprint) => imprint,
            Self::Shape(shape) => &shape.imprint,
        }
    }
}

/// Reads any bytes: a stored shape if the first character is `{`, otherwise an imprint as text, CSV or NPY. A byte
/// order mark, which some editors put before every text, is skipped.
///
/// # Errors
/// Returns the first error and its place.
pub fn read_content(bytes: &[u8]) -> Result<Content, ReadError> {
    if without_mark(bytes).trim_ascii_start().starts_with(b"{") {
        Ok(Content::Shape(StoredShape::read(bytes)?))
    } else {
        Ok(Content::Imprint(read(bytes)?))
    }
}
