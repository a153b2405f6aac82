//! The formats of drawings in files, and the methods that every drawing is written by.

use crate::parameter::named;

/// How a drawing is written.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash)]
#[non_exhaustive]
pub enum DrawingFormat {
    /// Lines and texts, SVG 1.1.
    Svg,
    /// Pixels, 288 an inch, in 8 bits of grey.
    #[cfg(feature = "png")]
    Png,
}

impl DrawingFormat {
    /// All of them.
    pub const ALL: &'static [Self] = &[
        Self::Svg,
        #[cfg(feature = "png")]
        Self::Png,
    ];

    /// What it is called on the command line, and the ending of its files.
    pub fn name(self) -> &'static str {
        match self {
            Self::Svg => "svg",
            #[cfg(feature = "png")]
            Self::Png => "png",
        }
    }

    /// The format of a file whose name ends like this, in upper or lower case; None of another ending.
    pub fn of_ending(ending: &str) -> Option<Self> {
        let mut formats = Self::ALL.iter().copied();
        formats.find(|format| format.name().eq_ignore_ascii_case(ending))
    }
}

named!(DrawingFormat, "format", DrawingFormat::ALL);

/// Gives types with a `page` their methods for writing it. A trait would have to be imported by every caller.
macro_rules! written {
    ($($type:ident),+) => {$(
        impl $type {
            /// As SVG 1.1.
            pub fn svg(&self) -> String {
                $crate::formats::drawing::svg::write(&self.page())
            }

            /// As PNG, 8 bits of grey. Characters beyond Latin-1 are shown as `?`.
            ///
            /// # Errors
            /// Those of the encoder, which has none for a page in memory.
            #[cfg(feature = "png")]
            pub fn png(&self) -> std::io::Result<Vec<u8>> {
                $crate::formats::drawing::png::write(&self.page())
            }

            /// The content of a file in this format.
            ///
            /// # Errors
            /// Those of the encoder of PNG; SVG has none.
            pub fn content(&self, format: $crate::formats::DrawingFormat) -> std::io::Result<Vec<u8>> {
                match format {
                    $crate::formats::DrawingFormat::Svg => Ok(self.svg().into_bytes()),
                    #[cfg(feature = "png")]
                    $crate::formats::DrawingFormat::Png => self.png(),
                }
            }
        }
    )+};
}
pub(super) use written;
