//! An outline: a shape bounded by closed rings, each a polygon or an ellipse.
//!
//! The rings may be nested, and material lies where a point is inside an odd number of them (even–odd rule), so an
//! outline may have holes and several pieces. Rings do not cross; what was drawn with crossing ones is united first.
//!
//! An outline is placed like a picture ([`crate::picture`]): the top left corner of its bounding rectangle goes to
//! (`x0`, `y0`), everything is scaled about the origin of the plane, and then it is turned **counter-clockwise** as seen
//! about the centre of the scaled rectangle.

use std::sync::Arc;

use crate::geometry::{Double, Ellipse, Extent, Pen, Point, Real, Side, Solid, Turn};
use crate::parameter::Parameter;
use crate::picture::PICTURE_PARAMETERS;
use crate::sensor::Sensor;
use crate::values::Values;

/// The largest number of points of all polygons of an outline together.
pub const MOST_POINTS: usize = 20_000;

/// The largest coordinate of a ring, so that no digit that decides a tie is lost.
const LARGEST: f64 = 1e6;

/// A closed ring. Coordinates are in cell sides or mm, y down; where the ring lies does not matter, only the rings among each
/// other.
#[derive(Clone, Debug, PartialEq)]
pub enum Ring {
    /// A polygon through at least three points.
    Polygon(Vec<[f64; 2]>),
    /// An ellipse.
    Ellipse(EllipseRing),
}

/// An ellipse as a ring.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct EllipseRing {
    /// The centre.
    pub centre: [f64; 2],
    /// The radii along x and y before it is turned; above 0.
    pub radii: [f64; 2],
    /// Degrees by which it is turned clockwise as seen, as for figures.
    pub angle: f64,
}

/// The error for rings that do not make an outline; the message says which and why.
#[derive(Clone, Debug, PartialEq, Eq, thiserror::Error)]
#[error("{0}")]
pub struct OutlineError(pub(crate) String);

/// A shape of rings and its placement. The values are always finite, and the zooms above 0.
///
/// An outline may carry the name under which it is stored. The name is displayed, but neither compared nor written to
/// files.
///
/// ```
/// use taxel_core::prelude::*;
/// use taxel_core::outline::{EllipseRing, Outline, Ring};
///
/// // A plate with a round hole.
/// let plate = Ring::Polygon(vec![[0.0, 0.0], [6.0, 0.0], [6.0, 4.0], [0.0, 4.0]]);
/// let hole = Ring::Ellipse(EllipseRing { centre: [2.0, 2.0], radii: [1.0, 1.0], angle: 0.0 });
/// let sensor = Sensor::default();
/// let outline: Source = Outline::new(vec![plate, hole], None)?.into();
/// let outline = outline.with(Parameter::X0, 5.0, &sensor)?;
/// let mut plane = Plane::new(sensor);
/// plane.touch(&outline);
/// let covered: f64 = plane.coverages().values().iter().sum();
/// assert!((covered - (24.0 - std::f64::consts::PI)).abs() < 1e-9);
/// # Ok::<(), Box<dyn std::error::Error>>(())
/// ```
#[derive(Clone, Debug)]
pub struct Outline {
    form: Arc<Form>,
    pub(crate) values: Values,
    pub(crate) name: Option<Arc<str>>,
}

impl PartialEq for Outline {
    fn eq(&self, other: &Self) -> bool {
        self.same_rings(other) && self.values == other.values
    }
}

/// The rings as they are drawn.
#[derive(Debug)]
struct Form {
    rings: Vec<Ring>,
    /// The side of a cell in mm, if the rings are in mm.
    pitch_mm: Option<f64>,
    drawn: Vec<DrawnRing>,
    /// Half of the sides of the bounding rectangle.
    half: Point<Double>,
    /// The number of rotations that map it onto itself: with any zooms, and with equal ones.
    rotations: [Option<u32>; 2],
    mirror: Option<u32>,
}

/// A ring about the centre of the bounding rectangle of all rings.
#[derive(Clone, Debug)]
enum DrawnRing {
    /// With the material on the right when going from point to point.
    Polygon(Vec<Point<Double>>),
    Ellipse(Ellipse<Double>, Side),
}

impl Outline {
    /// Creates an outline in its own place: the top left corner of its bounding rectangle at the origin, angle 0 and
    /// zoom 1. With a `pitch_mm`, the rings are given in mm, and a cell has that side; otherwise they are given in cells.
    ///
    /// # Errors
    /// Returns an error if there is no ring, more than [`MOST_POINTS`] points, a polygon with fewer than three points or
    /// without area, a radius that is not above 0, a number that is not finite or beyond ±1,000,000, or if
    /// rings cross or overlap.
    pub fn new(rings: Vec<Ring>, pitch_mm: Option<f64>) -> Result<Self, OutlineError> {
        let form = Form::new(rings, pitch_mm)?;
        Ok(Self {
            form: Arc::new(form),
            values: Values::upright(0.0, 0.0),
            name: None,
        })
    }

    /// Returns the same outline in its own place, as a new one is.
    #[must_use]
    pub fn at_home(mut self) -> Self {
        self.values = Values::upright(0.0, 0.0);
        self
    }

    /// Returns the same outline with the name under which it is stored.
    #[must_use]
    pub fn named(mut self, name: &str) -> Self {
        self.name = Some(name.into());
        self
    }

    /// Returns the same outline in the middle of the sensor, at whole cells.
    #[must_use]
    pub fn in_the_middle(mut self, sensor: &Sensor) -> Self {
        let [width, height] = self.size();
        let place = |side: u8, own: f64| ((f64::from(side) - own) / 2.0).floor();
        self.values
            .put(Parameter::X0, place(sensor.columns(), width));
        self.values.put(Parameter::Y0, place(sensor.rows(), height));
        self
    }

    /// Returns the rings, without placement, in mm if there is a [pitch](Self::pitch_mm), otherwise in cells.
    pub fn rings(&self) -> &[Ring] {
        &self.form.rings
    }

    /// Returns the sides of the bounding rectangle before zoom and rotation, in cells.
    pub fn size(&self) -> [f64; 2] {
        [self.form.half.x, self.form.half.y].map(|half| 2.0 * half.to_f64())
    }

    /// Returns true if both are of the same rings, wherever they are placed.
    pub fn same_rings(&self, other: &Self) -> bool {
        (&self.form.rings, self.form.pitch_mm) == (&other.form.rings, other.form.pitch_mm)
    }

    /// Returns the side of a cell in mm if the rings are given in mm; None if they are given in cells.
    pub fn pitch_mm(&self) -> Option<f64> {
        self.form.pitch_mm
    }

    /// Returns the same outline on a sensor of this pitch, if its rings are given in mm; otherwise as it is.
    ///
    /// # Errors
    /// Returns an error if it is then larger than 1,000,000 cells.
    pub fn at_pitch(self, pitch_mm: f64) -> Result<Self, OutlineError> {
        if self.form.pitch_mm.is_none_or(|own| own == pitch_mm) {
            return Ok(self);
        }
        let form = Form::new(self.form.rings.clone(), Some(pitch_mm))?;
        Ok(Self {
            form: Arc::new(form),
            ..self
        })
    }

    /// The number of rotations within a full turn that map the outline onto itself; None if all do.
    pub(crate) fn rotations(&self, equal_zooms: bool) -> Option<u32> {
        self.form.rotations[usize::from(equal_zooms)]
    }

    /// The sum in degrees of two angles at which the outline shows its mirror image, with right and left exchanged; None
    /// if none were found.
    pub(crate) fn mirror(&self) -> Option<u32> {
        self.form.mirror
    }

    /// The sides of the bounding rectangle before zoom and rotation; None if they are no decimals.
    pub(crate) fn box_sides(&self) -> Option<[f64; 2]> {
        let sides = [self.form.half.x, self.form.half.y].map(|half| half + half);
        let are_decimals = sides
            .iter()
            .all(|&side| is_zero(Double::decimal(side.to_f64()) - side));
        are_decimals.then(|| sides.map(Real::to_f64))
    }
}

impl Solid for Outline {
    fn draw<T: Real>(&self, pen: &mut impl Pen<T>) {
        let value = |parameter: Parameter| T::decimal(self.values.of(parameter));
        let [x0, y0, angle, zoom_x, zoom_y] = PICTURE_PARAMETERS.map(value);
        let turn = Turn::clockwise(-angle);
        let zoomed = |point: Point<Double>| {
            Point::new(
                T::from_double(point.x) * zoom_x,
                T::from_double(point.y) * zoom_y,
            )
        };
        let centre = Point::new(x0 * zoom_x, y0 * zoom_y).moved(zoomed(self.form.half));
        draw(
            &self.form.drawn,
            |point| centre.moved(turn.of(zoomed(point))),
            |vector| turn.of(zoomed(vector)),
            pen,
        );
    }
}

/// Draws rings, given where their points and their vectors go.
fn draw<T: Real>(
    rings: &[DrawnRing],
    place: impl Fn(Point<Double>) -> Point<T>,
    turned: impl Fn(Point<Double>) -> Point<T>,
    pen: &mut impl Pen<T>,
) {
    for ring in rings {
        match ring {
            DrawnRing::Polygon(points) => {
                let Some(mut from) = points.last().map(|&point| place(point)) else {
                    continue;
                };
                for to in points.iter().map(|&point| place(point)) {
                    pen.edge(from, to);
                    from = to;
                }
            }
            DrawnRing::Ellipse(own, material) => {
                let ellipse = Ellipse {
                    centre: place(own.centre),
                    across: turned(own.across),
                    along: turned(own.along),
                };
                pen.ellipse(&ellipse, *material);
            }
        }
    }
}

impl Form {
    fn new(rings: Vec<Ring>, pitch_mm: Option<f64>) -> Result<Self, OutlineError> {
        check(&rings)?;
        let pitch = Double::decimal(pitch_mm.unwrap_or(1.0));
        let decimal = |pair: [f64; 2]| {
            let [x, y] = pair.map(|length| Double::decimal(length) / pitch);
            Point::new(x, y)
        };
        let placed = rings.iter().map(|ring| match ring {
            Ring::Polygon(points) => {
                DrawnRing::Polygon(points.iter().map(|&point| decimal(point)).collect())
            }
            Ring::Ellipse(own) => {
                let turn = Turn::clockwise(Double::decimal(own.angle));
                let [across, along] = turn.of_axes(decimal(own.radii));
                let centre = decimal(own.centre);
                let ellipse = Ellipse {
                    centre,
                    across,
                    along,
                };
                DrawnRing::Ellipse(ellipse, Side::Inside)
            }
        });
        let mut drawn: Vec<DrawnRing> = placed.collect();
        let Some(extent) = Extent::<Double>::drawn(&Rings(&drawn)) else {
            return refused("no rings");
        };
        let middle = |low: Double, high: Double| (low + high) * Double::HALF;
        let (x, y) = (
            middle(extent.left, extent.right),
            middle(extent.top, extent.bottom),
        );
        let to_centre = Point::new(-x, -y);
        for ring in &mut drawn {
            match ring {
                DrawnRing::Polygon(points) => {
                    for point in points {
                        *point = point.moved(to_centre);
                    }
                }
                DrawnRing::Ellipse(own, _) => own.centre = own.centre.moved(to_centre),
            }
        }
        arrange(&mut drawn)?;
        let half = Point::new(extent.right - x, extent.bottom - y);
        let is_round = |ring: &DrawnRing| match ring {
            DrawnRing::Polygon(_) => false,
            DrawnRing::Ellipse(own, _) => {
                let [xx, xy, yy] = axes(own);
                is_zero(own.centre.x) && is_zero(own.centre.y) && is_zero(xy) && is_zero(xx - yy)
            }
        };
        let maps = |map: [[i32; 2]; 2]| {
            drawn
                .iter()
                .all(|ring| drawn.iter().any(|image| ring.is_mapped_to(image, map)))
        };
        let halved = if maps([[-1, 0], [0, -1]]) { 2 } else { 1 };
        let quartered = if maps([[0, -1], [1, 0]]) { 4 } else { halved };
        let whole = (!drawn.iter().all(is_round)).then_some(quartered);
        let mirror = if maps([[-1, 0], [0, 1]]) {
            Some(0)
        } else {
            maps([[1, 0], [0, -1]]).then_some(180)
        };
        Ok(Self {
            rotations: [Some(halved), whole],
            mirror,
            pitch_mm,
            rings,
            drawn,
            half,
        })
    }
}

fn refused<T>(message: impl Into<String>) -> Result<T, OutlineError> {
    Err(OutlineError(message.into()))
}

/// Checks the numbers of rings.
fn check(rings: &[Ring]) -> Result<(), OutlineError> {
    let mut points = 0;
    for (number, ring) in (1..).zip(rings) {
        let is_allowed = |pair: &[f64; 2]| pair.iter().all(|own| own.abs() <= LARGEST);
        let allowed = match ring {
            Ring::Polygon(own) => {
                points += own.len();
                if own.len() < 3 {
                    return refused(format!(
                        "ring {number}: {} points, expected at least 3",
                        own.len()
                    ));
                }
                own.iter().all(is_allowed)
            }
            Ring::Ellipse(own) => {
                if !own.radii.iter().all(|&radius| radius > 0.0) {
                    return refused(format!("ring {number}: a radius is not above 0"));
                }
                own.angle.is_finite() && is_allowed(&own.centre) && is_allowed(&own.radii)
            }
        };
        if !allowed {
            return refused(format!(
                "ring {number}: a number is not finite, or beyond ±1,000,000"
            ));
        }
    }
    if points > MOST_POINTS {
        return refused(format!("{points} points, expected at most {MOST_POINTS}"));
    }
    Ok(())
}

/// Rings that are drawn where they are.
struct Rings<'a>(&'a [DrawnRing]);

impl Solid for Rings<'_> {
    fn draw<T: Real>(&self, pen: &mut impl Pen<T>) {
        let point = |own: Point<Double>| Point::new(T::from_double(own.x), T::from_double(own.y));
        draw(self.0, point, point, pen);
    }
}

/// Returns true if two numbers of 32 digits are equal up to their rounding.
fn is_zero(difference: Double) -> bool {
    difference.abs() < Double::TIE
}

/// Returns the matrix xx, xy, yy of an ellipse's axes, which is the same for all axes of the same ellipse.
fn axes(own: &Ellipse<Double>) -> [Double; 3] {
    let (a, b) = (own.across, own.along);
    [
        a.x * a.x + b.x * b.x,
        a.x * a.y + b.x * b.y,
        a.y * a.y + b.y * b.y,
    ]
}

impl DrawnRing {
    /// Returns true if a turn by right angles, or a mirroring, about the centre maps this ring to another one.
    fn is_mapped_to(&self, image: &Self, map: [[i32; 2]; 2]) -> bool {
        let [[a, b], [c, d]] = map.map(|row| row.map(Double::whole));
        let mapped = |own: Point<Double>| Point::new(a * own.x + b * own.y, c * own.x + d * own.y);
        let same = |one: Point<Double>, other: Point<Double>| {
            is_zero(one.x - other.x) && is_zero(one.y - other.y)
        };
        match (self, image) {
            (Self::Polygon(own), Self::Polygon(image)) if own.len() == image.len() => {
                let first = mapped(own[0]);
                let Some(start) = image.iter().position(|&point| same(point, first)) else {
                    return false;
                };
                // A mirrored ring runs the other way.
                let count = own.len();
                let step = if map[0][0] * map[1][1] - map[0][1] * map[1][0] < 0 {
                    count - 1
                } else {
                    1
                };
                let others = (0..count).map(|index| image[(start + index * step) % count]);
                own.iter()
                    .zip(others)
                    .all(|(&point, other)| same(mapped(point), other))
            }
            (Self::Ellipse(own, side), Self::Ellipse(image, other)) => {
                let turned = Ellipse {
                    centre: mapped(own.centre),
                    across: mapped(own.across),
                    along: mapped(own.along),
                };
                let matrices = axes(&turned).into_iter().zip(axes(image));
                side == other
                    && same(turned.centre, image.centre)
                    && matrices
                        .into_iter()
                        .all(|(one, other)| is_zero(one - other))
            }
            _ => false,
        }
    }
}

/// The number of chords by which ellipses are checked for crossings.
const CHORDS: u32 = 256;

/// A piece of a ring: its number, its ends, and whether it is a piece of an ellipse.
struct Piece {
    ring: usize,
    from: [f64; 2],
    to: [f64; 2],
}

/// Turns each ring so that the material lies on its right, by the even–odd rule.
///
/// # Errors
/// Returns an error if rings cross or overlap: then the areas to the right of their pieces are not the material.
fn arrange(rings: &mut [DrawnRing]) -> Result<(), OutlineError> {
    let size = Extent::of(&Rings(rings))
        .map_or(1.0, |own| (own.right - own.left).max(own.bottom - own.top));
    let mut pieces = pieces(rings);
    let bins = Bins::new(&pieces);
    if let Some((one, other)) = bins.crossing(&pieces) {
        return crossing(one, other);
    }
    // Of each ring, the area decides which way it runs, and its depth on which side the material is.
    for (number, ring) in rings.iter_mut().enumerate() {
        let own = pieces.iter().filter(|piece| piece.ring == number);
        let area: f64 = own
            .map(|piece| piece.from[0] * piece.to[1] - piece.to[0] * piece.from[1])
            .sum();
        if area.abs() < 1e-12 * size * size {
            return refused(format!("ring {} encloses no area", number + 1));
        }
        let Some(first) = pieces.iter().find(|piece| piece.ring == number) else {
            continue;
        };
        let beside = first.beside(if area > 0.0 { size } else { -size });
        let is_hole = bins.count(&pieces, beside, Some(number)) % 2 == 1;
        // An ellipse runs clockwise.
        if (area > 0.0) == is_hole {
            match ring {
                DrawnRing::Polygon(points) => points.reverse(),
                DrawnRing::Ellipse(_, material) => *material = Side::Outside,
            }
            for piece in pieces.iter_mut().filter(|piece| piece.ring == number) {
                std::mem::swap(&mut piece.from, &mut piece.to);
            }
        }
    }
    for piece in &pieces {
        let beside = piece.beside(size);
        if bins.count(&pieces, beside, None).is_multiple_of(2) {
            return crossing(piece, piece);
        }
    }
    Ok(())
}

fn crossing(one: &Piece, other: &Piece) -> Result<(), OutlineError> {
    let (one, other) = (one.ring + 1, other.ring + 1);
    refused(if one == other {
        format!("ring {one} crosses or overlaps itself or another one")
    } else {
        format!("rings {one} and {other} cross")
    })
}

fn pieces(rings: &[DrawnRing]) -> Vec<Piece> {
    let mut pieces = Vec::new();
    for (ring, drawn) in rings.iter().enumerate() {
        let points: Vec<[f64; 2]> = match drawn {
            DrawnRing::Polygon(points) => points
                .iter()
                .map(|own| [own.x.to_f64(), own.y.to_f64()])
                .collect(),
            DrawnRing::Ellipse(own, _) => {
                let at = |chord| {
                    let part = f64::from(chord) / f64::from(CHORDS) * 360.0;
                    let (sin, cos) = part.sin_cos_degrees();
                    let on = |centre: Double, across: Double, along: Double| {
                        centre.to_f64() + across.to_f64() * cos + along.to_f64() * sin
                    };
                    [
                        on(own.centre.x, own.across.x, own.along.x),
                        on(own.centre.y, own.across.y, own.along.y),
                    ]
                };
                (0..CHORDS).map(at).collect()
            }
        };
        let next = points.iter().cycle().skip(1);
        let ends = points.iter().zip(next).filter(|(from, to)| from != to);
        pieces.extend(ends.map(|(&from, &to)| Piece { ring, from, to }));
    }
    pieces
}

impl Piece {
    /// Returns a point just to the right of the middle of the piece, by a small part of a size; on the left if it is
    /// negative.
    fn beside(&self, size: f64) -> [f64; 2] {
        let [dx, dy] = [0, 1].map(|axis| self.to[axis] - self.from[axis]);
        let way = 1e-13 * size / libm::hypot(dx, dy);
        let [x, y] = [0, 1].map(|axis| f64::midpoint(self.from[axis], self.to[axis]));
        [x - dy * way, y + dx * way]
    }

    /// Returns on which side of the line through this piece a point lies.
    fn side(&self, [x, y]: [f64; 2]) -> f64 {
        let [dx, dy] = [0, 1].map(|axis| self.to[axis] - self.from[axis]);
        dx * (y - self.from[1]) - dy * (x - self.from[0])
    }

    fn crosses(&self, other: &Self) -> bool {
        self.side(other.from) * self.side(other.to) < 0.0
            && other.side(self.from) * other.side(self.to) < 0.0
    }
}

/// The numbers of pieces by bands of y, so that few are looked at for a height.
struct Bins {
    top: f64,
    per_height: f64,
    lists: Vec<Vec<usize>>,
}

impl Bins {
    fn new(pieces: &[Piece]) -> Self {
        let heights = || pieces.iter().flat_map(|piece| [piece.from[1], piece.to[1]]);
        let (top, bottom) = (
            heights().fold(f64::MAX, f64::min),
            heights().fold(f64::MIN, f64::max),
        );
        let mut bins = Self {
            top,
            #[expect(clippy::cast_precision_loss, reason = "a number of pieces")]
            per_height: pieces.len() as f64 / (bottom - top).max(f64::MIN_POSITIVE),
            lists: vec![Vec::new(); pieces.len() + 1],
        };
        for (number, piece) in pieces.iter().enumerate() {
            let ends = [piece.from[1], piece.to[1]].map(|height| bins.bin(height));
            for bin in ends[0].min(ends[1])..=ends[0].max(ends[1]) {
                bins.lists[bin].push(number);
            }
        }
        bins
    }

    #[expect(
        clippy::cast_possible_truncation,
        clippy::cast_sign_loss,
        reason = "kept within the bins"
    )]
    fn bin(&self, height: f64) -> usize {
        let place = (height - self.top) * self.per_height;
        (place.max(0.0) as usize).min(self.lists.len() - 1)
    }

    /// Returns two pieces that cross.
    fn crossing<'a>(&self, pieces: &'a [Piece]) -> Option<(&'a Piece, &'a Piece)> {
        self.lists.iter().find_map(|bin| {
            let mut pairs = bin.iter().enumerate().flat_map(|(place, &one)| {
                bin[place + 1..]
                    .iter()
                    .map(move |&other| (&pieces[one], &pieces[other]))
            });
            pairs.find(|(one, other)| one.crosses(other))
        })
    }

    /// Returns how many pieces lie to the left of a point at its height: an odd number of a ring that encloses it.
    fn count(&self, pieces: &[Piece], [x, y]: [f64; 2], without: Option<usize>) -> usize {
        let own = self.lists[self.bin(y)]
            .iter()
            .map(|&number| &pieces[number]);
        let own = own.filter(|piece| Some(piece.ring) != without);
        let passed = own.filter(|piece| (piece.from[1] <= y) != (piece.to[1] <= y));
        passed
            .filter(|piece| {
                let part = (y - piece.from[1]) / (piece.to[1] - piece.from[1]);
                piece.from[0] + part * (piece.to[0] - piece.from[0]) < x
            })
            .count()
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::figure::Figure;
    use crate::parameter::ParameterError;
    use crate::source::Source;
    use crate::touch::Plane;

    fn ellipse(centre: [f64; 2], radii: [f64; 2], angle: f64) -> Ring {
        Ring::Ellipse(EllipseRing {
            centre,
            radii,
            angle,
        })
    }

    fn rectangle([left, top]: [f64; 2], [right, bottom]: [f64; 2]) -> Ring {
        Ring::Polygon(vec![
            [left, top],
            [right, top],
            [right, bottom],
            [left, bottom],
        ])
    }

    fn area(rings: Vec<Ring>) -> f64 {
        let mut plane = Plane::new(Sensor::default());
        plane.touch(&Outline::new(rings, None).expect("rings"));
        plane.coverages().values().iter().sum()
    }

    #[test]
    fn rings_in_rings_are_holes_and_pieces_in_either_sense() {
        let nested = |order: [usize; 3], turned: bool| {
            let mut rings = [
                rectangle([0.0, 0.0], [10.0, 8.0]),
                rectangle([1.0, 1.0], [9.0, 7.0]),
                ellipse([5.0, 4.0], [2.0, 1.0], 30.0),
            ];
            if turned && let Ring::Polygon(points) = &mut rings[1] {
                points.reverse();
            }
            order.map(|ring| rings[ring].clone()).to_vec()
        };
        let expected = 80.0 - 48.0 + 2.0 * std::f64::consts::PI;
        for order in [[0, 1, 2], [2, 1, 0], [1, 2, 0]] {
            for turned in [false, true] {
                assert!((area(nested(order, turned)) - expected).abs() < 1e-9);
            }
        }
        // Pieces side by side, also with a common side, and one in millimetres.
        let pair = vec![
            rectangle([0.0, 0.0], [2.0, 2.0]),
            rectangle([2.0, 0.0], [5.0, 2.0]),
            rectangle([7.0, 1.0], [8.0, 4.0]),
        ];
        assert!((area(pair.clone()) - 13.0).abs() < 1e-9);
        let mm = Outline::new(pair, Some(2.5)).expect("rings");
        assert_eq!((mm.size(), mm.pitch_mm()), ([3.2, 1.6], Some(2.5)));
        let wider = mm.at_pitch(5.0).expect("rings");
        assert_eq!(wider.size(), [1.6, 0.8]);
    }

    #[test]
    fn what_is_no_outline_is_refused_in_a_sentence() {
        let square = || rectangle([0.0, 0.0], [4.0, 4.0]);
        for (rings, expected) in [
            (vec![], "no rings"),
            (
                vec![Ring::Polygon(vec![[0.0, 0.0], [1.0, 1.0]])],
                "ring 1: 2 points, expected at least 3",
            ),
            (
                vec![Ring::Polygon(vec![[0.0, 0.0], [1.0, 1.0], [2.0, 2.0]])],
                "ring 1 encloses no area",
            ),
            (
                vec![square(), ellipse([1.0, 1.0], [1.0, 0.0], 0.0)],
                "ring 2: a radius is not above 0",
            ),
            (
                vec![square(), rectangle([2.0, 2.0], [6.0, 6.0])],
                "rings 1 and 2 cross",
            ),
            (
                vec![square(), ellipse([4.1, 2.0], [1.0, 1.0], 0.0)],
                "rings 1 and 2 cross",
            ),
            (
                vec![Ring::Polygon(vec![
                    [0.0, 0.0],
                    [2.0, 2.0],
                    [2.0, 0.0],
                    [0.0, 2.0],
                ])],
                "ring 1 crosses or overlaps itself or another one",
            ),
            (
                vec![square(), square()],
                "ring 1 crosses or overlaps itself or another one",
            ),
            (
                vec![rectangle([0.0, 0.0], [f64::NAN, 4.0])],
                "ring 1: a number is not finite, or beyond ±1,000,000",
            ),
            (
                vec![Ring::Polygon(vec![[0.0, 0.0]; MOST_POINTS + 1])],
                "20001 points, expected at most 20000",
            ),
        ] {
            let refused = Outline::new(rings, None).expect_err(expected);
            assert_eq!(refused.to_string(), expected);
        }
    }

    #[test]
    fn symmetries_are_found() {
        let symmetry = |rings: Vec<Ring>| {
            let outline = Outline::new(rings, None).expect("rings");
            let rotations = [false, true].map(|equal| outline.rotations(equal));
            (rotations, outline.mirror(), outline.box_sides())
        };
        let bar = || rectangle([0.1, 0.2], [6.3, 2.5]);
        assert_eq!(
            symmetry(vec![bar()]),
            ([Some(2), Some(2)], Some(0), Some([6.2, 2.3]))
        );
        let square = || rectangle([0.1, 0.2], [4.4, 4.5]);
        assert_eq!(symmetry(vec![square()]).0, [Some(2), Some(4)]);
        let off_centre = ellipse([1.0, 2.35], [0.5, 0.5], 0.0);
        assert_eq!(symmetry(vec![square(), off_centre]).1, Some(180));
        let drilled = ellipse([2.25, 2.35], [0.5, 0.5], 0.0);
        assert_eq!(
            symmetry(vec![square(), drilled.clone()]).0,
            [Some(2), Some(4)]
        );
        assert_eq!(symmetry(vec![drilled]).0, [Some(2), None]);
        let tilted = symmetry(vec![ellipse([0.0, 0.0], [3.0, 1.0], 30.0)]);
        assert_eq!(tilted, ([Some(2), Some(2)], None, None));
        let hook = Ring::Polygon(vec![[0.0, 0.0], [3.0, 0.0], [3.0, 1.0], [1.0, 2.0]]);
        assert_eq!(symmetry(vec![hook]).0, [Some(1), Some(1)]);
    }

    /// Also at half-cell positions and right angles, where many taxels are covered exactly by half.
    #[test]
    fn a_figure_as_an_outline_leaves_the_imprints_of_the_figure() -> Result<(), ParameterError> {
        use Parameter::{Angle, X0, Y0};
        let sensor = Sensor::default();
        let mut plane = Plane::new(sensor);
        let tube = vec![
            ellipse([4.0, 2.5], [4.0, 2.5], 0.0),
            ellipse([4.0, 2.5], [3.0, 1.5], 0.0),
        ];
        let frame = vec![
            rectangle([0.0, 0.0], [7.0, 3.5]),
            rectangle([1.0, 1.0], [6.0, 2.5]),
        ];
        for (figure, rings) in [
            (Figure::ellipse(4.0, 2.5).thickness(1.0), tube),
            (Figure::rectangle(7.0, 3.5).thickness(1.0), frame),
        ] {
            let outline = Outline::new(rings, None).expect("rings");
            for step in 0..400 {
                let (x0, y0) = (
                    f64::from(step % 20) * 0.25 + 1.0,
                    f64::from(step / 20) * 0.125 + 2.0,
                );
                let angle = f64::from(step * 15 % 360);
                let figure = figure.at(x0, y0).angle(angle).on(&sensor)?;
                let outline = Source::from(outline.clone())
                    .with(X0, x0, &sensor)?
                    .with(Y0, y0, &sensor)?;
                // Figures turn clockwise, outlines counter-clockwise.
                let outline = outline.with(Angle, (360.0 - angle) % 360.0, &sensor)?;
                assert_eq!(
                    plane.touch(&outline),
                    plane.touch(&figure),
                    "{x0} {y0} {angle}"
                );
            }
        }
        Ok(())
    }
}
