//! Draws the elements of a page on grey pixels: upright rectangles, lines, and the pixels of letters. A library for
//! paths would be the natural choice, but each of the two candidates made the program larger by a tenth, 280 and 230
//! KB.
//!
//! A pixel's share of a rectangle is the product of two overlaps. Its share of a line depends on its distance: within
//! half a pixel of the edge it falls from 1 to 0, so ends and corners are round.

use std::ops::Range;

use crate::formats::drawing::scene::{Position, Segment, Stroke};
use crate::index::wide;

/// The number of straight pieces in which a cubic curve is drawn. An ellipse has eight curves; if it is 600 pixels
/// large, a piece is off by at most 0.04 pixels.
const PIECES: u8 = 32;

/// A page of pixels. Positions are in pixels from its top left corner.
#[derive(Clone, Debug)]
pub(super) struct Ink {
    /// The greys, row by row: 0 is black, 255 white.
    pixels: Vec<u8>,
    /// The number of pixels in a row.
    width: u32,
    /// The number of rows.
    height: u32,
}

impl Ink {
    /// Makes a white page.
    pub(super) fn new(width: u32, height: u32) -> Self {
        Self {
            pixels: vec![255; wide(width) * wide(height)],
            width,
            height,
        }
    }

    /// Returns all greys, row by row, as PNG stores them.
    pub(super) fn pixels(&self) -> &[u8] {
        &self.pixels
    }

    /// Returns the number of pixels in a row.
    pub(super) fn width(&self) -> u32 {
        self.width
    }

    /// Returns the number of rows.
    pub(super) fn height(&self) -> u32 {
        self.height
    }

    /// Returns two opposite corners of the page.
    fn all(&self) -> (Position, Position) {
        ((0.0, 0.0), (self.width.into(), self.height.into()))
    }

    /// Makes a pixel at least this dark; positions beyond the page are ignored.
    pub(super) fn darken(&mut self, x: i32, y: i32, by: u8) {
        let (Ok(x), Ok(y)) = (u32::try_from(x), u32::try_from(y)) else {
            return;
        };
        if x < self.width
            && let Some(pixel) = self.pixels.get_mut(index(x, y, self.width))
        {
            *pixel = (*pixel).min(255 - by);
        }
    }

    /// Fills rectangles that do not overlap; where they touch, no seam is left.
    pub(super) fn fill(&mut self, rectangles: &[(Position, Position)], grey: u8) {
        let areas = rectangles.iter();
        let areas = areas.map(|&area| Area::touched(area, self.all()));
        let mut shares = Shares::new(areas.collect());
        for &(low, high) in rectangles {
            let overlap = |at: u32, low: f64, high: f64| {
                let at = f64::from(at);
                (high.min(at + 1.0) - low.max(at)).clamp(0.0, 1.0)
            };
            shares.each(&Area::touched((low, high), self.all()), |share, x, y| {
                share + overlap(x, low.0, high.0) * overlap(y, low.1, high.1)
            });
        }
        self.blend(&shares, grey);
    }

    /// Draws the line of a path, only inside `within` if that is given.
    pub(super) fn stroke(
        &mut self,
        steps: &[Segment],
        line: Stroke,
        within: Option<(Position, Position)>,
    ) {
        let (least, most) = self.all();
        let within = within.map_or((least, most), |(low, high)| {
            (larger(low, least), smaller(high, most))
        });
        let mut pieces = flat(steps);
        if let Some(dash) = line.dash {
            pieces = dashed(&pieces, dash);
        }
        let half = line.width / 2.0;
        let reach = half + 1.0;
        let area = |from: Position, to: Position| {
            let (low, high) = (smaller(from, to), larger(from, to));
            let low = (low.0 - reach, low.1 - reach);
            Area::touched((low, (high.0 + reach, high.1 + reach)), within)
        };
        let lines = || {
            let pairs = pieces.iter().flat_map(|piece| piece.windows(2));
            pairs.map(|pair| (pair[0], pair[1]))
        };
        let mut shares = Shares::new(lines().map(|(from, to)| area(from, to)).collect());
        for (from, to) in lines() {
            shares.each(&area(from, to), |share, x, y| {
                let middle = (f64::from(x) + 0.5, f64::from(y) + 0.5);
                let off = distance(middle, from, to);
                share.max((half + 0.5 - off).clamp(0.0, 1.0))
            });
        }
        self.blend(&shares, line.grey);
    }

    /// Mixes a grey into each pixel by its share: 0 leaves it, 1 replaces it.
    #[expect(
        clippy::cast_possible_truncation,
        clippy::cast_sign_loss,
        reason = "between two greys"
    )]
    fn blend(&mut self, shares: &Shares, grey: u8) {
        let Area { columns, rows } = &shares.area;
        let width = columns.len();
        for (row, y) in shares.values.chunks(width.max(1)).zip(rows.clone()) {
            let first = index(columns.start, y, self.width);
            let pixels = self.pixels.iter_mut().skip(first);
            for (pixel, &share) in pixels.zip(row) {
                let (old, share) = (f64::from(*pixel), f64::from(share).min(1.0));
                *pixel = (old + (f64::from(grey) - old) * share).round() as u8;
            }
        }
    }
}

/// Returns the index of a pixel.
fn index(x: u32, y: u32, width: u32) -> usize {
    wide(y).saturating_mul(wide(width)).saturating_add(wide(x))
}

/// Returns the smaller of both coordinates each.
fn smaller(one: Position, other: Position) -> Position {
    (one.0.min(other.0), one.1.min(other.1))
}

/// Returns the larger of both coordinates each.
fn larger(one: Position, other: Position) -> Position {
    (one.0.max(other.0), one.1.max(other.1))
}

/// A rectangle of pixels.
#[derive(Default)]
struct Area {
    columns: Range<u32>,
    rows: Range<u32>,
}

impl Area {
    /// Returns the pixels that a rectangle touches inside another one, which lies on the page.
    #[expect(
        clippy::cast_possible_truncation,
        clippy::cast_sign_loss,
        reason = "saturates: what is beyond the page has no pixels"
    )]
    fn touched((low, high): (Position, Position), (least, most): (Position, Position)) -> Self {
        let (low, high) = (larger(low, least), smaller(high, most));
        let pixels = |low: f64, high: f64| low.floor() as u32..high.ceil() as u32;
        Self {
            columns: pixels(low.0, high.0),
            rows: pixels(low.1, high.1),
        }
    }

    /// Returns the smallest area that holds both.
    fn with(self, other: Self) -> Self {
        if self.is_empty() {
            return other;
        }
        if other.is_empty() {
            return self;
        }
        let both =
            |one: Range<u32>, other: Range<u32>| one.start.min(other.start)..one.end.max(other.end);
        Self {
            columns: both(self.columns, other.columns),
            rows: both(self.rows, other.rows),
        }
    }

    fn is_empty(&self) -> bool {
        self.columns.is_empty() || self.rows.is_empty()
    }
}

impl FromIterator<Area> for Area {
    fn from_iter<I: IntoIterator<Item = Area>>(areas: I) -> Self {
        areas.into_iter().fold(Self::default(), Self::with)
    }
}

/// The share of each pixel near a mark that the mark covers. Most marks are far smaller than the page.
struct Shares {
    /// The shares, row by row.
    values: Vec<f32>,
    /// The pixels of the shares.
    area: Area,
}

impl Shares {
    /// Makes shares of 0.
    fn new(area: Area) -> Self {
        Self {
            values: vec![0.0; area.columns.len() * area.rows.len()],
            area,
        }
    }

    /// Replaces the share of each pixel in a part of the area.
    #[expect(
        clippy::cast_possible_truncation,
        reason = "a share needs no more digits"
    )]
    fn each(&mut self, part: &Area, share: impl Fn(f64, u32, u32) -> f64) {
        let Area { columns, rows } = &self.area;
        let (left, top) = (columns.start, rows.start);
        let Ok(width) = u32::try_from(columns.len()) else {
            return;
        };
        // A part without pixels may lie outside the area.
        if part.is_empty() {
            return;
        }
        for y in part.rows.clone() {
            for x in part.columns.clone() {
                if let Some(slot) = self.values.get_mut(index(x - left, y - top, width)) {
                    *slot = share(f64::from(*slot), x, y) as f32;
                }
            }
        }
    }
}

/// Returns the distance from a point to a straight piece.
fn distance(place: Position, from: Position, to: Position) -> f64 {
    let (way, off) = (
        (to.0 - from.0, to.1 - from.1),
        (place.0 - from.0, place.1 - from.1),
    );
    let length = way.0 * way.0 + way.1 * way.1;
    let along = if length > 0.0 {
        ((off.0 * way.0 + off.1 * way.1) / length).clamp(0.0, 1.0)
    } else {
        0.0
    };
    libm::hypot(off.0 - way.0 * along, off.1 - way.1 * along)
}

/// Returns the corners of each piece of a path.
fn flat(steps: &[Segment]) -> Vec<Vec<Position>> {
    let mut pieces: Vec<Vec<Position>> = Vec::new();
    for step in steps {
        if let Segment::Move(to) = step {
            pieces.push(vec![*to]);
            continue;
        }
        // A path begins with a move, so there is a piece with a corner.
        let Some(piece) = pieces.last_mut() else {
            continue;
        };
        let (Some(&start), Some(&from)) = (piece.first(), piece.last()) else {
            continue;
        };
        match *step {
            Segment::Curve(first, second, to) => piece.extend((1..=PIECES).map(|part| {
                let ahead = f64::from(part) / f64::from(PIECES);
                let behind = 1.0 - ahead;
                let shares = [
                    behind * behind * behind,
                    3.0 * behind * behind * ahead,
                    3.0 * behind * ahead * ahead,
                    ahead * ahead * ahead,
                ];
                let corners = [from, first, second, to];
                let along = |of: fn(Position) -> f64| -> f64 {
                    let terms = shares.iter().zip(corners);
                    terms.map(|(share, corner)| share * of(corner)).sum()
                };
                (along(|place| place.0), along(|place| place.1))
            })),
            Segment::Close => piece.push(start),
            Segment::Line(to) | Segment::Move(to) => piece.push(to),
        }
    }
    pieces
}

/// Cuts pieces into dashes; each piece begins with a dash.
fn dashed(pieces: &[Vec<Position>], [dash, gap]: [f64; 2]) -> Vec<Vec<Position>> {
    let mut dashes = Vec::new();
    for piece in pieces {
        let (mut left, mut drawn) = (dash, true);
        let mut open: Vec<Position> = piece.first().copied().into_iter().collect();
        for pair in piece.windows(2) {
            let (mut from, to) = (pair[0], pair[1]);
            loop {
                let length = libm::hypot(to.0 - from.0, to.1 - from.1);
                // A length that is not a number ends the piece, too.
                if length <= left || !length.is_finite() {
                    left -= length;
                    open.push(to);
                    break;
                }
                let share = left / length;
                from = (
                    from.0 + (to.0 - from.0) * share,
                    from.1 + (to.1 - from.1) * share,
                );
                open.push(from);
                let done = std::mem::replace(&mut open, vec![from]);
                if drawn {
                    dashes.push(done);
                }
                drawn = !drawn;
                left = if drawn { dash } else { gap };
            }
        }
        if drawn {
            dashes.push(open);
        }
    }
    dashes
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn rectangles_cover_their_share_and_leave_no_seam() {
        let mut page = Ink::new(4, 1);
        page.fill(&[((0.5, 0.0), (1.25, 1.0)), ((1.25, 0.0), (3.0, 1.0))], 0);
        assert_eq!(page.pixels(), [128, 0, 0, 255]);
    }

    #[test]
    fn lines_have_their_width_and_stay_within() {
        let line = vec![Segment::Move((-5.0, 2.0)), Segment::Line((50.0, 2.0))];
        let mut page = Ink::new(3, 4);
        page.stroke(&line, Stroke::black(2.0), Some(((1.0, 0.0), (2.0, 4.0))));
        let column = |x: usize| (0..4).map(|y| page.pixels()[y * 3 + x]).collect::<Vec<_>>();
        assert_eq!(column(1), [255, 0, 0, 255]);
        assert_eq!((column(0), column(2)), (vec![255; 4], vec![255; 4]));
    }

    /// Blends a mark over the whole page, to compare with blending only its own pixels.
    fn blended(page: &Ink, grey: u8, share: impl Fn(f64, f64) -> f64) -> Vec<u8> {
        let pixels = page.pixels().iter().zip(0_u32..);
        let blend = |(&old, at): (&u8, u32)| {
            let (x, y) = (at % page.width(), at / page.width());
            let old = f64::from(old);
            let share = share(f64::from(x), f64::from(y));
            format!("{:.0}", (old + (f64::from(grey) - old) * share).round())
        };
        let pixels = pixels.map(blend).map(|pixel| pixel.parse());
        pixels.collect::<Result<_, _>>().expect("between two greys")
    }

    #[test]
    fn a_mark_has_the_same_pixels_as_when_the_whole_page_is_blended() {
        let places = [
            (-3.5, -2.0),
            (1.25, 0.5),
            (4.5, 6.75),
            (11.0, 3.0),
            (30.0, 9.5),
        ];
        let mut page = Ink::new(13, 9);
        for (&from, grey) in places.iter().zip([0, 200, 90, 255, 30]) {
            for &to in &places {
                let (low, high) = (smaller(from, to), larger(from, to));
                let overlap = |at: f64, low: f64, high: f64| {
                    (high.min(at + 1.0) - low.max(at)).clamp(0.0, 1.0)
                };
                let filled = blended(&page, grey, |x, y| {
                    overlap(x, low.0, high.0) * overlap(y, low.1, high.1)
                });
                page.fill(&[(low, high)], grey);
                assert_eq!(page.pixels(), filled, "{low:?} {high:?}");
                let line = Stroke {
                    grey,
                    ..Stroke::black(1.5)
                };
                let drawn = blended(&page, grey, |x, y| {
                    (1.25 - distance((x + 0.5, y + 0.5), from, to)).clamp(0.0, 1.0)
                });
                page.stroke(&[Segment::Move(from), Segment::Line(to)], line, None);
                assert_eq!(page.pixels(), drawn, "{from:?} {to:?}");
            }
        }
    }

    #[test]
    fn shares_cover_only_the_pixels_that_a_mark_touches() {
        let page = Ink::new(4000, 4000);
        let touched = |low, high| Area::touched((low, high), page.all());
        let areas = [
            touched((3.5, 1.0), (5.5, 2.0)),
            touched((4.0, 3.5), (5.0, 4.5)),
        ];
        let shares = Shares::new(areas.into_iter().collect());
        assert_eq!(
            (&shares.area.columns, &shares.area.rows),
            (&(3..6), &(1..5))
        );
        assert_eq!(shares.values.len(), 3 * 4);
        assert!(touched((-9.0, 1.0), (-2.0, 2.0)).is_empty());
    }

    #[test]
    fn dashes_and_gaps_add_up() {
        let corner = vec![vec![(0.0, 0.0), (5.0, 0.0), (5.0, 5.0)]];
        let dashes = dashed(&corner, [4.0, 2.0]);
        assert_eq!(
            dashes,
            [vec![(0.0, 0.0), (4.0, 0.0)], vec![(5.0, 1.0), (5.0, 5.0)]]
        );
    }

    #[test]
    fn positions_far_away_or_not_finite_draw_nothing() {
        let mut page = Ink::new(2, 2);
        for far in [1e300, -1e300, f64::NAN, f64::INFINITY] {
            let line = [
                Segment::Move((far, far)),
                Segment::Line((far, 1.0)),
                Segment::Close,
            ];
            page.stroke(&line, Stroke::black(1.0), None);
            page.darken(i32::MAX, -1, 255);
        }
        assert_eq!(page.pixels().len(), 4);
    }
}
