//! Text in pixels, made of the monospaced letters that a font crate contains as images of one size.

use noto_sans_mono_bitmap::{FontWeight, RasterHeight, get_raster, get_raster_width};

use crate::formats::drawing::ink::Ink;
use crate::formats::drawing::scene::{Position, TextAnchor};

/// The only weight that is compiled in.
const WEIGHT: FontWeight = FontWeight::Regular;
/// The height of a letter: eight points at four pixels each.
const HEIGHT: RasterHeight = RasterHeight::Size32;
/// The distance of the base line from the top of a letter's image, in pixels.
const ABOVE: i32 = 26;

/// Writes a line of text; its place, in pixels, lies on its base line.
pub(super) fn write(ink: &mut Ink, text: &str, place: Position, anchor: TextAnchor, upright: bool) {
    let step = whole_of(get_raster_width(WEIGHT, HEIGHT));
    let width = step.saturating_mul(whole_of(text.chars().count()));
    let back = match anchor {
        TextAnchor::Start => 0,
        TextAnchor::Middle => width / 2,
        TextAnchor::End => width,
    };
    let (x, y) = (rounded(place.0), rounded(place.1));
    let mut along = -back;
    for letter in text.chars() {
        let raster = get_raster(letter, WEIGHT, HEIGHT);
        // The question mark always exists; if it did not, the letter would be left blank.
        if let Some(raster) = raster.or_else(|| get_raster('?', WEIGHT, HEIGHT)) {
            for (down, row) in (-ABOVE..).zip(raster.rows()) {
                for (right, &dark) in (along..).zip(row.iter()) {
                    let (across, below) = if upright {
                        (x + down, y - right)
                    } else {
                        (x + right, y + down)
                    };
                    ink.darken(across, below, dark);
                }
            }
        }
        along = along.saturating_add(step);
    }
}

/// Converts a number of characters or pixels of a label; both are far below the limit.
fn whole_of(count: usize) -> i32 {
    i32::try_from(count).unwrap_or(i32::MAX)
}

/// Returns the nearest pixel.
#[expect(
    clippy::cast_possible_truncation,
    reason = "saturates far off the page"
)]
fn rounded(pixels: f64) -> i32 {
    pixels.round() as i32
}
