//! The formats in which a plain imprint is exchanged with other programs.
//!
//! The content of a file decides its format when it is read, the ending of its name when it is written.
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
use crate::formats::{array, foreign, pbm, table, text};
use crate::imprint::Imprint;
use crate::parameter::named;

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

    /// The format of a file whose name ends like this, in upper or lower case; none of another ending.
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

named!(ImprintFormat, "format", ImprintFormat::ALL);

/// Why bytes are not an imprint.
#[derive(Clone, Debug, PartialEq, Eq)]
#[non_exhaustive]
pub enum ImprintFormatError {
    /// Too many of them.
    Large,
    /// A file of another kind.
    Foreign {
        /// What it is, with its article: "a PNG image".
        kind: &'static str,
    },
    /// No text of `#` and `.`.
    Text(TextError),
    /// No bitmap.
    Pbm(PbmError),
    /// No grey image of two shades.
    Pgm(PbmError),
    /// No table.
    Table(TableError),
    /// No array.
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

/// The imprint in any bytes, of any format.
///
/// A bitmap or greymap begins with `P` and a digit, an array with its magic bytes. Images and archives of other kinds
/// are refused by name. All else is a text of `#` and `.` or a table of numbers; a byte order mark before it is passed
/// over, and line ends may be of any system.
///
/// # Errors
/// What is wrong first, and where.
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
    let text = bytes.strip_prefix(b"\xef\xbb\xbf").unwrap_or(bytes);
    // Long ago a line ended in CR alone.
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

/// Whether a text is a table of numbers: its first line that is neither blank nor a comment is not one of taxels, and
/// there is a number, a separator or a word of a table in it.
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
