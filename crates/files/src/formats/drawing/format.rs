//! The file formats of drawings, and the methods that write every drawing.

use std::path::Path;

use crate::formats::ending::has_ending;
use crate::parameter::named;

/// A file format of drawings.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash)]
pub enum DrawingFormat {
    /// SVG 1.1: lines and texts.
    Svg,
    /// PNG: 288 pixels per inch, in 8 bits of grey.
    Png,
}

impl DrawingFormat {
    /// All formats.
    pub const ALL: &'static [Self] = &[Self::Svg, Self::Png];

    /// Returns the name of the format on the command line, which is also the ending of its files.
    pub fn name(self) -> &'static str {
        match self {
            Self::Svg => "svg",
            Self::Png => "png",
        }
    }

    /// Returns the format for the extension of a file's name, in upper or lower case; None if no format has it.
    pub fn of_path(path: impl AsRef<Path>) -> Option<Self> {
        let mut formats = Self::ALL.iter().copied();
        formats.find(|format| has_ending(&path, format.name()))
    }
}

named!(DrawingFormat, "format", DrawingFormat::ALL);

/// Adds the methods that write a type with a `page`. A trait would have to be imported by every caller.
macro_rules! written {
    ($($type:ident),+) => {$(
        impl $type {
            /// Returns the drawing as SVG 1.1.
            pub fn svg(&self) -> String {
                $crate::formats::drawing::svg::write(&self.page())
            }

            /// Returns the drawing as PNG, in 8 bits of grey. Characters beyond Latin-1 are shown as `?`.
            ///
            /// # Errors
            /// Returns the errors of the encoder; for a page in memory there are none.
            pub fn png(&self) -> std::io::Result<Vec<u8>> {
                $crate::formats::drawing::png::write(&self.page())
            }

            /// Returns the content of a file in this format.
            ///
            /// # Errors
            /// Returns the errors of the PNG encoder; SVG has no errors.
            pub fn content(&self, format: $crate::formats::DrawingFormat) -> std::io::Result<Vec<u8>> {
                match format {
                    $crate::formats::DrawingFormat::Svg => Ok(self.svg().into_bytes()),
                    $crate::formats::DrawingFormat::Png => self.png(),
                }
            }
        }
    )+};
}
pub(super) use written;
