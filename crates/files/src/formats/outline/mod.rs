//! Outlines from files of other programs: SVG, and points as a table (CSV).

mod curves;
mod points;
mod svg;
mod unite;

use taxel_core::outline::Ring;

use crate::error::ReadError;
use crate::formats::file::without_mark;

/// The size limit of a drawing's file in bytes, 8 MiB.
pub const MAX_DRAWING_BYTES: usize = 8 << 20;

/// The largest distance, in cells, between a curve and its chords, unless another one is chosen.
pub const FLATNESS: f64 = 0.001;

/// How a drawing is read.
#[derive(Clone, Copy, Debug)]
pub struct OutlineOptions {
    /// The largest distance, in cells, between a curve and its chords.
    pub flatness: f64,
    /// The side of a cell in mm; 1 if it is not known yet.
    pub pitch_mm: f64,
    /// The length of a drawing's unit in mm, if the drawing does not say it.
    pub mm_per_unit: Option<f64>,
    /// Whether y runs up; only for points, because it always runs down in SVG.
    pub y_up: bool,
}

impl Default for OutlineOptions {
    fn default() -> Self {
        Self {
            flatness: FLATNESS,
            pitch_mm: 1.0,
            mm_per_unit: None,
            y_up: false,
        }
    }
}

/// The rings of a drawing, for [`Outline::new`](taxel_core::outline::Outline::new).
#[derive(Clone, Debug, PartialEq)]
pub struct ReadOutline {
    /// The rings, y down. Those of an SVG do not cross.
    pub rings: Vec<Ring>,
    /// The unit of the rings.
    pub unit: OutlineUnit,
    /// What the drawing has in addition, and how often: `2 strokes`.
    pub left_out: Vec<String>,
}

/// The unit of an outline's points.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum OutlineUnit {
    /// Sides of a cell.
    Cells,
    /// Millimetres.
    Mm,
}

/// Returns true if a file's content is a drawing in SVG, or at least XML.
pub fn is_svg(bytes: &[u8]) -> bool {
    without_mark(bytes).trim_ascii_start().starts_with(b"<")
}

/// Reads an outline: SVG if the content is XML, otherwise points as a table.
///
/// In SVG, everything that is filled is material, whatever its colour, and paths that overlap are united. Its rings are
/// in mm if its width or height is in mm, cm, in, pt or pc, or with [`OutlineOptions::mm_per_unit`]; otherwise a user
/// unit is a cell. Coordinates are rounded to less than a thousand millionth of the drawing's size, so that decimals stay
/// decimals through all transformations.
///
/// # Errors
/// Returns the first error, with its line and column if there is one.
pub fn read_outline(bytes: &[u8], options: &OutlineOptions) -> Result<ReadOutline, ReadError> {
    if bytes.len() > MAX_DRAWING_BYTES {
        return Err(ReadError::new(
            "larger than 8 MiB, the limit for an outline",
        ));
    }
    let text = str::from_utf8(without_mark(bytes))
        .map_err(|_| ReadError::new("expected an SVG or a table of points, in UTF-8"))?;
    if is_svg(bytes) {
        svg::read(text, options)
    } else {
        points::read(text, options)
    }
}
