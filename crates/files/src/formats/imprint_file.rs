//! The formats in which a plain imprint is exchanged with other programs: text, PBM, CSV and NPY.
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

use std::path::Path;

use taxel_core::imprint::Imprint;
use taxel_core::parameter::named;

use crate::error::ReadError;
use crate::formats::file::{has_ending, without_mark};
use crate::formats::shape::StoredShape;
use crate::formats::{array, pbm, table};

/// The size limit of an imprint's file in bytes, 1 MiB; a larger file is refused unread.
pub const MAX_BYTES: usize = 1 << 20;

/// A format in which an imprint is written.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash)]
pub enum ImprintFormat {
    /// A line per row, `#` for an active taxel, `.` for an inactive one.
    Text,
    /// A raw portable bitmap, `P4`.
    Pbm,
    /// A plain portable bitmap, `P1`.
    PlainPbm,
    /// A table of 0 and 1.
    Csv,
    /// A numpy array of `bool`, rows × columns.
    Npy,
}

impl ImprintFormat {
    /// All formats.
    pub const ALL: &'static [Self] = &[Self::Text, Self::Pbm, Self::PlainPbm, Self::Csv, Self::Npy];

    /// The name on the command line.
    pub fn name(self) -> &'static str {
        match self {
            Self::Text => "txt",
            Self::Pbm => "pbm",
            Self::PlainPbm => "pbm-plain",
            Self::Csv => "csv",
            Self::Npy => "npy",
        }
    }

    /// The format for the extension of a file's name, in upper or lower case; None if no format has it.
    pub fn of_path(path: impl AsRef<Path>) -> Option<Self> {
        // The plain bitmap has no ending of its own.
        let formats = Self::ALL.iter().copied();
        formats
            .filter(|format| *format != Self::PlainPbm)
            .find(|format| has_ending(&path, format.name()))
    }

    /// The content of a file in this format.
    pub fn write(self, imprint: &Imprint) -> Vec<u8> {
        match self {
            Self::Text => format!("{imprint}\n").into_bytes(),
            Self::Pbm => pbm::raw(imprint),
            Self::PlainPbm => pbm::plain(imprint).into_bytes(),
            Self::Csv => table::write(imprint).into_bytes(),
            Self::Npy => array::write(imprint),
        }
    }
}

named!(ImprintFormat, "format", ImprintFormat::ALL);

/// The error for bytes that are not an imprint.
#[derive(Clone, Debug, PartialEq, Eq, thiserror::Error)]
pub enum ImprintFormatError {
    /// More than [`MAX_BYTES`] bytes.
    #[error("larger than 1 MiB, the limit for an imprint")]
    Large,
    /// A file of another kind.
    #[error("not an imprint: expected rows of '#' and '.', a table (CSV), PBM or NPY")]
    Unknown,
    /// A mistake in a file of one of the formats: where, what was found, what was expected.
    #[error("{0}")]
    Invalid(String),
}

/// Reads an imprint from any bytes, in any of the formats.
///
/// A bitmap begins with `P1` or `P4`, an array with its magic bytes. Everything else is a text of `#` and `.` or a table
/// of numbers; a byte order mark before it is skipped. In errors, lines and columns count from 1.
///
/// # Errors
/// Returns the first error and its place.
pub fn read(bytes: &[u8]) -> Result<Imprint, ImprintFormatError> {
    if bytes.len() > MAX_BYTES {
        return Err(ImprintFormatError::Large);
    }
    let named = |format: &'static str| {
        move |message: String| ImprintFormatError::Invalid(format!("{format}: {message}"))
    };
    match bytes {
        [0x93, ..] => return array::read(bytes).map_err(named("NPY")),
        // Tables may name their columns P1, P2.
        [b'P', b'0'..=b'9', b',' | b';' | b'\t', ..] => {}
        [b'P', b'1' | b'4', ..] => return pbm::read(bytes).map_err(named("PBM")),
        [b'P', b'0'..=b'9', ..] => return Err(ImprintFormatError::Unknown),
        _ => {}
    }
    let text = str::from_utf8(without_mark(bytes)).ok();
    let is_plain = |sign: char| !sign.is_control() || matches!(sign, '\t' | '\r' | '\n');
    let text = text.filter(|text| text.chars().all(is_plain));
    let text = text.ok_or(ImprintFormatError::Unknown)?;
    if is_table(text.as_bytes()) {
        table::read(text).map_err(named("CSV"))
    } else {
        of_text(text).map_err(ImprintFormatError::Invalid)
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

/// Reads rows of `#` and `.`. Lines may end in blanks and in CRLF, and blank lines may follow the last row.
fn of_text(text: &str) -> Result<Imprint, String> {
    let lines = text.split('\n').map(|line| {
        let line = line.strip_suffix('\r').unwrap_or(line);
        line.trim_end_matches([' ', '\t'])
    });
    let mut rows: Vec<&str> = lines.collect();
    while rows.last().is_some_and(|row| row.trim_end().is_empty()) {
        rows.pop();
    }
    Imprint::from_rows(rows.iter().copied()).map_err(|error| ReadError::from(error).to_string())
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

/// The error for bytes that are neither an imprint nor a stored shape.
#[derive(Debug, thiserror::Error)]
pub enum ContentError {
    /// Not an imprint in any known format.
    #[error(transparent)]
    Imprint(#[from] ImprintFormatError),
    /// Text that starts like JSON, but is not a stored shape.
    #[error(transparent)]
    Shape(#[from] ReadError),
}

/// Reads any bytes: a stored shape if the first character is `{`, otherwise an imprint as text, PBM, CSV or NPY. A
/// byte order mark, which some editors put before every text, is skipped.
///
/// # Errors
/// Returns the first error and its place.
pub fn read_content(bytes: &[u8]) -> Result<Content, ContentError> {
    let bytes = without_mark(bytes);
    if bytes.trim_ascii_start().starts_with(b"{") {
        Ok(Content::Shape(StoredShape::read(bytes)?))
    } else {
        Ok(Content::Imprint(read(bytes)?))
    }
}
