//! An imprint in any format, or a stored shape; the first character shows which of the two it is.

use crate::formats::byte_order_mark::without_mark;
use crate::formats::imprint_file::{self, ImprintFormatError};
use crate::formats::shape::{ShapeError, StoredShape};
use crate::imprint::Imprint;

/// The content of a file.
#[derive(Clone, Debug)]
#[expect(clippy::large_enum_variant, reason = "there is one of these at a time")]
pub enum Content {
    /// An imprint: a matrix without a sensor or a name.
    Imprint(Imprint),
    /// A stored shape: an imprint with its name, sensor and source.
    Shape(StoredShape),
}

impl Content {
    /// Returns the imprint, or that of the stored shape.
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
    Shape(#[from] ShapeError),
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
        Ok(Content::Imprint(imprint_file::read(bytes)?))
    }
}
