//! The forms in which an imprint alone goes to other programs and comes from them.
//!
//! Which form a file has is told by its first bytes when it is read, by the ending of its name when it is written.
//!
//! ```
//! use taxel::formats::imprint_file::{ImprintFormat, read};
//! let cup = read(b"P1\n3 2\n101\n111\n")?;
//! let format = ImprintFormat::of_ending("csv").unwrap();
//! assert_eq!(format.write(&cup), b"1,0,1\n1,1,1\n");
//! for format in ImprintFormat::ALL {
//!     assert_eq!(read(&format.write(&cup))?, cup);
//! }
//! # Ok::<(), taxel::formats::ImprintFormatError>(())
//! ```

use std::fmt;

use crate::formats::array::ArrayError;
use crate::formats::pbm::PbmError;
use crate::formats::table::TableError;
use crate::formats::text::TextError;
use crate::formats::{array, pbm, table, text};
use crate::imprint::Imprint;

/// No file of an imprint is larger; a larger one is refused unread. 1 MiB.
pub const MAX_BYTES: usize = 1 << 20;

/// How an imprint is written.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash)]
#[non_exhaustive]
pub enum ImprintFormat {
    /// Rows of `#` and `.`.
    Text,
    /// A raw portable bitmap, `P4`.
    Pbm,
    /// A plain one, `P1`.
    PlainPbm,
    /// A table of 0 and 1.
    Csv,
    /// An array of numpy.
    Npy,
}

impl ImprintFormat {
    /// All of them.
    pub const ALL: &'static [Self] = &[Self::Text, Self::Pbm, Self::PlainPbm, Self::Csv, Self::Npy];

    /// What it is called on the command line.
    pub fn name(self) -> &'static str {
        match self {
            Self::Text => "txt",
            Self::Pbm => "pbm",
            Self::PlainPbm => "pbm-plain",
            Self::Csv => "csv",
            Self::Npy => "npy",
        }
    }

    /// The form of a file whose name ends like this, in upper or lower case; none of another ending.
    pub fn of_ending(ending: &str) -> Option<Self> {
        // The plain bitmap has no ending of its own.
        let formats = Self::ALL.iter().copied();
        formats
            .filter(|format| *format != Self::PlainPbm)
            .find(|format| format.name().eq_ignore_ascii_case(ending))
    }

    /// A file's content.
    pub fn write(self, imprint: &Imprint) -> Vec<u8> {
        match self {
            Self::Text => text::write(imprint).into_bytes(),
            Self::Pbm => pbm::raw(imprint),
            Self::PlainPbm => pbm::plain(imprint).into_bytes(),
            Self::Csv => table::write(imprint).into_bytes(),
            Self::Npy => array::write(imprint),
        }
    }
}

/// Why bytes are no imprint.
#[derive(Clone, Debug, PartialEq, Eq)]
#[non_exhaustive]
pub enum ImprintFormatError {
    /// Too many of them.
    Large,
    /// No text of `#` and `.`.
    Text(TextError),
    /// No bitmap.
    Pbm(PbmError),
    /// No table.
    Table(TableError),
    /// No array.
    Array(ArrayError),
}

impl fmt::Display for ImprintFormatError {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        match self {
            Self::Large => f.write_str("larger than 1 MiB, which no imprint is"),
            Self::Text(error) => error.fmt(f),
            Self::Pbm(error) => write!(f, "PBM: {error}"),
            Self::Table(error) => write!(f, "CSV: {error}"),
            Self::Array(error) => write!(f, "NPY: {error}"),
        }
    }
}

impl std::error::Error for ImprintFormatError {}

/// The imprint in any bytes, of any form.
///
/// A bitmap begins with `P` and a digit, an array with its magic bytes, a table with a digit, a quote, a sign or a word;
/// all else is text. A byte order mark before a table or a text is passed over.
///
/// # Errors
/// What is wrong first, and where.
pub fn read(bytes: &[u8]) -> Result<Imprint, ImprintFormatError> {
    if bytes.len() > MAX_BYTES {
        return Err(ImprintFormatError::Large);
    }
    let text = bytes.strip_prefix(b"\xef\xbb\xbf").unwrap_or(bytes);
    match (bytes, text.trim_ascii_start()) {
        ([0x93, ..], _) => array::read(bytes).map_err(ImprintFormatError::Array),
        ([b'P', b'0'..=b'9', ..], _) => pbm::read(bytes).map_err(ImprintFormatError::Pbm),
        (
            _,
            [
                b'0'..=b'9' | b'"' | b'+' | b'-' | b'T' | b't' | b'F' | b'f',
                ..,
            ],
        ) => table::read(text).map_err(ImprintFormatError::Table),
        _ => text::read(text).map_err(ImprintFormatError::Text),
    }
}
