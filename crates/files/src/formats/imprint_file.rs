//! The formats in which a plain imprint is exchanged with other programs: text, PBM, CSV and NPY.
//!
//! When a file is read, its content decides the format; when it is written, the ending of its name does.
//!
//! ```
//! use taxel_files::formats::imprint_file::{ImprintFormat, read};
//! let cup = read(b"P1\n3 2\n101\n111\n")?;
//! let format = ImprintFormat::of_path("imprint.csv").unwrap();
//! assert_eq!((format.write)(&cup), b"1,0,1\n1,1,1\n");
//! for format in ImprintFormat::ALL {
//!     assert_eq!(read(&(format.write)(&cup))?, cup);
//! }
//! # Ok::<(), taxel_files::ReadError>(())
//! ```

use std::path::Path;

use taxel_core::imprint::Imprint;

use crate::error::{ReadError, ReadErrorKind};
use crate::formats::file::{has_ending, without_mark};
use crate::formats::shape::StoredShape;
use crate::formats::{numpy, pbm, table};

/// The size limit of an imprint's file in bytes, 1 MiB; a larger file is refused unread.
pub const MAX_BYTES: usize = 1 << 20;

/// A format of imprints.
#[derive(Clone, Copy, Debug)]
pub struct ImprintFormat {
    /// The name on the command line.
    pub name: &'static str,
    /// The extension of files that are written in this format, if it has one of its own.
    pub ending: Option<&'static str>,
    /// Whether a file of this format may begin like this.
    begins: fn(&[u8]) -> bool,
    read: fn(&[u8]) -> Result<Imprint, ReadError>,
    /// Returns the content of a file.
    pub write: fn(&Imprint) -> Vec<u8>,
}

impl ImprintFormat {
    /// All formats.
    pub const ALL: &'static [Self] = &[
        Self {
            name: "txt",
            ending: Some("txt"),
            begins: is_text,
            read: read_text,
            write: |imprint| format!("{imprint}\n").into_bytes(),
        },
        Self {
            name: "pbm",
            ending: Some("pbm"),
            begins: |bytes| bytes.starts_with(b"P4"),
            read: pbm::read,
            write: pbm::raw,
        },
        Self {
            name: "pbm-plain",
            ending: None,
            begins: |bytes| bytes.starts_with(b"P1"),
            read: pbm::read,
            write: pbm::plain,
        },
        Self {
            name: "csv",
            ending: Some("csv"),
            begins: table::begins,
            read: table::read,
            write: table::write,
        },
        Self {
            name: "npy",
            ending: Some("npy"),
            begins: |bytes| bytes.starts_with(b"\x93"),
            read: |bytes| numpy::imprint::read(bytes).map_err(|error| error.of_key("NPY")),
            write: numpy::imprint::write,
        },
    ];

    /// The format for the extension of a file's name, in upper or lower case; None if no format has it.
    pub fn of_path(path: impl AsRef<Path>) -> Option<&'static Self> {
        let has_ending = |ending| has_ending(&path, ending);
        Self::ALL
            .iter()
            .find(|format| format.ending.is_some_and(has_ending))
    }
}

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
    let formats = ImprintFormat::ALL;
    match formats.iter().find(|format| (format.begins)(bytes)) {
        Some(format) => (format.read)(bytes),
        None => Err(unknown()),
    }
}

fn unknown() -> ReadError {
    let text = "not an imprint: expected rows of '#' and '.', a table of 0 and 1 (CSV), PBM or NPY";
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

/// Decides which of two values is active: masks of other programs consist of 0 and 1, 0 and 255, or 0 and any other
/// number.
pub(crate) struct Mask<T> {
    other: Option<T>,
    zero: bool,
}

impl<T: Copy + PartialEq> Mask<T> {
    pub(crate) fn new() -> Self {
        Self {
            other: None,
            zero: false,
        }
    }

    /// Takes the next value, `None` for 0, and returns true if its taxel is active. The error for a third value is the
    /// second one, which is not 0.
    pub(crate) fn take(&mut self, value: Option<T>) -> Result<bool, T> {
        let Some(value) = value else {
            self.zero = true;
            return Ok(false);
        };
        let other = *self.other.get_or_insert(value);
        if value == other { Ok(true) } else { Err(other) }
    }

    /// The mask's only value, if it is not 0 and not among `active`, the values that are known to mean active.
    pub(crate) fn unclear(&self, active: &[T]) -> Option<T> {
        self.other
            .filter(|other| !self.zero && !active.contains(other))
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

/// Reads any bytes: a stored shape if the first character is `{`, otherwise an imprint as text, PBM, CSV or NPY. A
/// byte order mark, which some editors put before every text, is skipped.
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
