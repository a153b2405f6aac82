//! The drawing of a page of the results, for a file.

use crate::formats::{PointPlot, PoseMap};

/// What a page is drawn as.
#[derive(Clone, Debug)]
pub enum PageDrawing {
    /// Points or curves between two axes.
    Points(PointPlot),
    /// A map of positions.
    Map(PoseMap),
}

/// The format that the ending of a name asks for, in small letters; None where no drawing has it.
pub fn drawn_format(name: &str) -> Option<&'static str> {
    let ending = std::path::Path::new(name).extension()?.to_str()?;
    let mut formats = FORMATS.iter().copied();
    formats.find(|format| format.eq_ignore_ascii_case(ending))
}

/// The formats of drawings, by the endings of names.
const FORMATS: &[&str] = if cfg!(feature = "png") {
    &["svg", "png"]
} else {
    &["svg"]
};

impl PageDrawing {
    /// The content of a file in a format.
    ///
    /// # Errors
    /// Those of the encoder.
    pub fn content(&self, format: &str) -> Result<Vec<u8>, String> {
        match (self, format) {
            #[cfg(feature = "png")]
            (Self::Points(plot), "png") => plot.png().map_err(|error| error.to_string()),
            #[cfg(feature = "png")]
            (Self::Map(map), "png") => map.png().map_err(|error| error.to_string()),
            (Self::Points(plot), _) => Ok(plot.svg().into_bytes()),
            (Self::Map(map), _) => Ok(map.svg().into_bytes()),
        }
    }
}
