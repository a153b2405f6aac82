//! The formats in which a plain imprint is exchanged with other programs.
//!
//! When a file is read, its content decides the format; when it is written, the ending of its name does.
//!
//! ```
//! use taxel_files::formats::imprint_file::{ImprintFormat, read};
//! let cup = read(b"P1\n3 2\n101\n111\n")?;
//! let format = ImprintFormat::of_path("imprint.csv").unwrap();
//! assert_eq!(format.write(&cup), b"1,0,1\n1,1,1\n");
//! for format in ImprintFormat::ALL {
//!     assert_eq!(read(&format.write(&cup))?, cup);
//! }
//! # Ok::<(), taxel_files::formats::ImprintFormatError>(())
//! ```

use std::fmt;
use std::path::Path;

use crate::formats::array::ArrayError;
use crate::formats::byte_order_mark::without_mark;
use crate::formats::ending::has_ending;
use crate::formats::pbm::PbmError;
use crate::formats::table::TableError;
use crate::formats::text::TextError;
use crate::formats::{array, foreign, pbm, table, text};
use crate::imprint::Imprint;
use crate::parameter::named;

/// The size limit of an imprint's file in bytes, 1 MiB; a larger file is refused unread.
pub const MAX_BYTES: usize = 1 << 20;

/// A format in which an imprint is written.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash)]
pub enum ImprintFormat {
    /// Rows of `#` and `.`.
    Text,
    /// A raw portable bitmap, `P4`.
    Pbm,
    /// A plain portable bitmap, `P1`.
    PlainPbm,
    /// A table of 0 and 1.
    Csv,
    /// A numpy array.
    Npy,
}

impl ImprintFormat {
    /// All formats.
    pub const ALL: &'static [Self] = &[Self::Text, Self::Pbm, Self::PlainPbm, Self::Csv, Self::Npy];

    /// Returns the name of the format on the command line.
    pub fn name(self) -> &'static str {
        match self {
            Self::Text => "txt",
            Self::Pbm => "pbm",
            Self::PlainPbm => "pbm-plain",
            Self::Csv => "csv",
            Self::Npy => "npy",
        }
    }

    /// Returns the format for the extension of a file's name, in upper or lower case; None if no format has it.
    pub fn of_path(path: impl AsRef<Path>) -> Option<Self> {
        // The plain bitmap has no ending of its own.
        let formats = Self::ALL.iter().copied();
        formats
            .filter(|format| *format != Self::PlainPbm)
            .find(|format| has_ending(&path, format.name()))
    }

    /// Returns the content of a file in this format.
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

named!(ImprintFormat, "format", ImprintFormat::ALL);

/// The error for bytes that are not an imprint.
#[derive(Clone, Debug, PartialEq, Eq)]
pub enum ImprintFormatError {
    /// More than [`MAX_BYTES`] bytes.
    Large,
    /// A file of another kind.
    Foreign {
        /// The kind of file, with its article: "a PNG image".
        kind: &'static str,
    },
    /// Not a valid text of `#` and `.`.
    Text(TextError),
    /// Not a valid bitmap.
    Pbm(PbmError),
    /// Not a valid greymap of two shades.
    Pgm(PbmError),
    /// Not a valid table.
    Table(TableError),
    /// Not a valid array.
    Array(ArrayError),
}

impl fmt::Display for ImprintFormatError {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        match self {
            Self::Large => f.write_str("larger than 1 MiB, the limit for an imprint"),
            Self::Foreign { kind } => write!(
                f,
                "{kind}, expected rows of '#' and '.', a table (CSV), PBM, PGM of two shades or NPY"
            ),
            Self::Text(error) => error.fmt(f),
            Self::Pbm(error) => write!(f, "PBM: {error}"),
            Self::Pgm(error) => write!(f, "PGM: {error}"),
            Self::Table(error) => write!(f, "CSV: {error}"),
            Self::Array(error) => write!(f, "NPY: {error}"),
        }
    }
}

impl std::error::Error for ImprintFormatError {}

/// Reads an imprint from any bytes, in any of the formats.
///
/// A bitmap or greymap begins with `P` and a digit, an array with its magic bytes. Images and archives of other kinds
/// are refused by name. Everything else is a text of `#` and `.` or a table of numbers; a byte order mark before it
/// is skipped, and line ends may be those of any system.
///
/// # Errors
/// Returns the first error and its place.
pub fn read(bytes: &[u8]) -> Result<Imprint, ImprintFormatError> {
    if bytes.len() > MAX_BYTES {
        return Err(ImprintFormatError::Large);
    }
    if let Some(kind) = foreign::kind(bytes) {
        return Err(ImprintFormatError::Foreign { kind });
    }
    match bytes {
        [0x93, ..] => return array::read(bytes).map_err(ImprintFormatError::Array),
        // Tables may name their columns P1, P2.
        [b'P', b'0'..=b'9', b',' | b';' | b'\t', ..] => {}
        [b'P', b'2' | b'5', ..] => return pbm::read(bytes).map_err(ImprintFormatError::Pgm),
        [b'P', b'0'..=b'9', ..] => return pbm::read(bytes).map_err(ImprintFormatError::Pbm),
        _ => {}
    }
    let text = without_mark(bytes);
    // Files of the classic Mac OS have lines that end in CR alone.
    let lines;
    let text = if text.contains(&b'\r') && !text.contains(&b'\n') {
        let unix = |&byte: &u8| if byte == b'\r' { b'\n' } else { byte };
        lines = text.iter().map(unix).collect::<Vec<u8>>();
        &lines
    } else {
        text
    };
    if let Some(imprint) = text::of_other_signs(text) {
        Ok(imprint)
    } else if is_table(text) {
        table::read(text).map_err(ImprintFormatError::Table)
    } else {
        text::read(text).map_err(ImprintFormatError::Text)
    }
}

/// Returns true if a text is a table of numbers: its first line that is neither blank nor a comment is not a row of
/// taxels, and there is a digit, a separator or a word of a table.
fn is_table(text: &[u8]) -> bool {
    let lines = text.split(|&byte| byte == b'\n').map(<[u8]>::trim_ascii);
    let mut lines = lines.filter(|line| !line.is_empty());
    let taxels = |line: &[u8]| {
        let taxels = line.iter().filter(|byte| matches!(byte, b'#' | b'.'));
        2 * taxels.count() >= line.len()
    };
    let first = lines.find(|line| taxels(line) || !line.starts_with(b"#"));
    first.is_some_and(|line| {
        let begins = |word: &str| {
            let start = line.get(..word.len());
            start.is_some_and(|start| start.eq_ignore_ascii_case(word.as_bytes()))
        };
        let sign = |byte: &u8| byte.is_ascii_digit() || matches!(byte, b',' | b';' | b'\t' | b'"');
        !taxels(line) && (begins("true") || begins("false") || text.iter().any(sign))
    })
}
