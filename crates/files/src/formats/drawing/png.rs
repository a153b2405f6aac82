//! A page as PNG: four pixels per point, 8 bits of grey.

use std::io;

use png::{BitDepth, ColorType, Encoder, PixelDimensions, Unit};

use crate::formats::drawing::glyph;
use crate::formats::drawing::ink::Ink;
use crate::formats::drawing::scene::{DrawingPage, Element, Position, Stroke};

/// The pixels per point.
const SCALE: f64 = 4.0;
/// The resolution: 288 dots per inch.
const DOTS_A_METRE: u32 = 11_339;

/// Returns the content of the file.
pub(super) fn write(page: &DrawingPage) -> io::Result<Vec<u8>> {
    let place = |(x, y): Position| (x * SCALE, y * SCALE);
    let plane = (place(page.plane.0), place(page.plane.1));
    let mut ink = Ink::new(pixels(page.size.0), pixels(page.size.1));
    for mark in &page.marks {
        match mark {
            Element::Fill {
                rectangles, grey, ..
            } => {
                let scaled = rectangles
                    .iter()
                    .map(|&(low, high)| (place(low), place(high)));
                ink.fill(&scaled.collect::<Vec<_>>(), *grey);
            }
            Element::Line {
                steps,
                line,
                clipped,
                ..
            } => {
                let steps: Vec<_> = steps.iter().map(|step| step.map(place)).collect();
                let line = Stroke {
                    width: line.width * SCALE,
                    dash: line.dash.map(|dash| dash.map(|length| length * SCALE)),
                    ..*line
                };
                ink.stroke(&steps, line, clipped.then_some(plane));
            }
            Element::Text {
                text,
                place: at,
                anchor,
                upright,
            } => glyph::write(&mut ink, text, place(*at), *anchor, *upright),
        }
    }
    encode(&ink)
}

/// Encodes the page in eight-bit grey, compressed; with the resolution, so that it is printed at the size of the SVG.
fn encode(ink: &Ink) -> io::Result<Vec<u8>> {
    let mut file = Vec::new();
    let mut encoder = Encoder::new(&mut file, ink.width(), ink.height());
    encoder.set_color(ColorType::Grayscale);
    encoder.set_depth(BitDepth::Eight);
    encoder.set_pixel_dims(Some(PixelDimensions {
        xppu: DOTS_A_METRE,
        yppu: DOTS_A_METRE,
        unit: Unit::Meter,
    }));
    let mut writer = encoder.write_header()?;
    writer.write_image_data(ink.pixels())?;
    writer.finish()?;
    Ok(file)
}

/// Converts points to pixels, rounded up so that nothing at the edge is lost.
#[expect(
    clippy::cast_possible_truncation,
    clippy::cast_sign_loss,
    reason = "a page is above 0 and some thousand pixels at most: its texts are short"
)]
fn pixels(points: f64) -> u32 {
    (points * SCALE).ceil() as u32
}
