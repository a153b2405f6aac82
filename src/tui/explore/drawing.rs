//! The drawing of a page of the results, for a file.

use std::path::Path;

use crate::formats::{DrawingFormat, PointPlot, PoseMap};

/// What a page is drawn as.
#[derive(Clone, Debug)]
pub enum PageDrawing {
    /// Points or curves between two axes.
    Points(PointPlot),
    /// A map of positions.
    Map(PoseMap),
}

/// The format that the ending of a name asks for; None where no drawing has it.
pub fn drawn_format(name: &str) -> Option<DrawingFormat> {
    DrawingFormat::of_ending(Path::new(name).extension()?.to_str()?)
}

impl PageDrawing {
    /// The content of a file in a format.
    ///
    /// # Errors
    /// Those of the encoder.
    pub fn content(&self, format: DrawingFormat) -> Result<Vec<u8>, String> {
        let content = match self {
            Self::Points(plot) => plot.content(format),
            Self::Map(map) => map.content(format),
        };
        content.map_err(|error| error.to_string())
    }
}
