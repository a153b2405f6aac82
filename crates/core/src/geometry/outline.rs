//! The boundary of a shape: straight edges and ellipses, drawn with a [`Pen`].
//!
//! A shape is *drawn* rather than returned: it calls the pen for each edge and each ellipse of its boundary. So a shape
//! needs only one definition, which serves every purpose (areas, extents, pictures) and every type of number
//! ([`Real`]), and allocates nothing with `f64`.
//!
//! **Orientation.** Edges run clockwise as seen (x right, y down) around the material, with the material on their
//! right; around a hole they run the other way. Only closed sets of edges bound an area; the order of the edges does
//! not matter.
//!
//! **Size.** Coordinates must be finite, and those of ellipses below 1e70; a shape with other coordinates leaves an
//! empty imprint. Coordinates may lie far beyond the sensor, but rounding errors grow with them: of the 32 digits that
//! decide a tie, as many are lost as a coordinate has before the decimal point, and twice as many for an ellipse.

use std::sync::LazyLock;

use crate::geometry::real::{Double, Real};

/// A point of the plane, or a vector in it; in cell sides.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Point<T> {
    /// The coordinate to the right.
    pub x: T,
    /// The coordinate downwards.
    pub y: T,
}

impl<T: Real> Point<T> {
    /// Creates the point at (`x`, `y`).
    pub const fn new(x: T, y: T) -> Self {
        Self { x, y }
    }

    /// Returns the point moved by a vector.
    #[must_use]
    pub fn moved(self, by: Self) -> Self {
        Self::new(self.x + by.x, self.y + by.y)
    }
}

/// A rotation about the origin.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Turn<T> {
    sin: T,
    cos: T,
}

impl<T: Real> Turn<T> {
    /// Creates a clockwise rotation as seen (y runs down), by an angle in degrees.
    pub fn clockwise(degrees: T) -> Self {
        let (sin, cos) = degrees.sin_cos_degrees();
        Self { sin, cos }
    }

    /// Returns the rotated vector.
    pub fn of(&self, vector: Point<T>) -> Point<T> {
        Point::new(
            vector.x * self.cos - vector.y * self.sin,
            vector.x * self.sin + vector.y * self.cos,
        )
    }

    pub(crate) fn of_axes(&self, Point { x, y }: Point<T>) -> [Point<T>; 2] {
        [
            Point::new(x * self.cos, x * self.sin),
            Point::new(-(y * self.sin), y * self.cos),
        ]
    }
}

/// An ellipse as the affine image of the unit disc: `centre + across·u + along·v` for `u² + v² ≤ 1`.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Ellipse<T> {
    /// The centre.
    pub centre: Point<T>,
    /// The image of the disc's first axis.
    pub across: Point<T>,
    /// The image of the disc's second axis; not parallel to the first.
    pub along: Point<T>,
}

impl<T: Real> Ellipse<T> {
    /// Returns half of the ellipse's width and half of its height.
    pub fn reach(&self) -> Point<T> {
        let length = |a: T, b: T| (a * a + b * b).sqrt();
        Point::new(
            length(self.across.x, self.along.x),
            length(self.across.y, self.along.y),
        )
    }

    /// Returns the area of the parallelogram that the two axes span: the area of the ellipse divided by π.
    pub(crate) fn span(&self) -> T {
        (self.across.x * self.along.y - self.across.y * self.along.x).abs()
    }

    /// Returns how far an extreme point lies to the side of the centre, times the reach in the direction of that point;
    /// 0 for a circle or an upright ellipse.
    pub(crate) fn skew(&self) -> T {
        self.across.x * self.across.y + self.along.x * self.along.y
    }
}

/// The side of a boundary on which the material lies.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash)]
pub enum Side {
    /// The boundary encloses material.
    Inside,
    /// The boundary encloses a hole.
    Outside,
}

/// The pen with which a shape draws its boundary. All coordinates are finite.
pub trait Pen<T: Real> {
    /// Draws a straight piece of boundary, with the material on the right when going from `from` to `to`.
    fn edge(&mut self, from: Point<T>, to: Point<T>);
    /// Draws a whole ellipse.
    fn ellipse(&mut self, ellipse: &Ellipse<T>, material: Side);

    /// Draws the closed ring through the points, which are given clockwise as seen.
    fn ring(&mut self, points: &[Point<T>], material: Side) {
        let Some(&last) = points.last() else { return };
        let mut from = last;
        for &to in points {
            match material {
                Side::Inside => self.edge(from, to),
                Side::Outside => self.edge(to, from),
            }
            from = to;
        }
    }
}

/// A pen that passes everything on to another pen, shifted.
pub(crate) struct Moving<'a, T, P> {
    pub(crate) by: Point<T>,
    pub(crate) pen: &'a mut P,
}

impl<T: Real, P: Pen<T>> Pen<T> for Moving<'_, T, P> {
    fn edge(&mut self, from: Point<T>, to: Point<T>) {
        self.pen.edge(from.moved(self.by), to.moved(self.by));
    }
    fn ellipse(&mut self, ellipse: &Ellipse<T>, material: Side) {
        let centre = ellipse.centre.moved(self.by);
        self.pen.ellipse(&Ellipse { centre, ..*ellipse }, material);
    }
}

/// A shape with a boundary: a figure, a picture, or an outline of your own.
///
/// A type of your own defines once, for every type of number, how it is drawn:
///
/// ```
/// use taxel_core::prelude::*;
/// use taxel_core::geometry::{Ellipse, Pen, Point, Real, Side};
///
/// /// A square plate with a round hole in its middle.
/// struct Flange { left: f64, top: f64, side: f64, bore: f64 }
///
/// impl Solid for Flange {
///     fn draw<T: Real>(&self, pen: &mut impl Pen<T>) {
///         let [left, top, side, bore] = [self.left, self.top, self.side, self.bore].map(T::decimal);
///         let corner = |x: T, y: T| Point::new(left + x, top + y);
///         let (none, half) = (T::ZERO, side * T::HALF);
///         // Clockwise as seen.
///         let plate = [corner(none, none), corner(side, none), corner(side, side), corner(none, side)];
///         pen.ring(&plate, Side::Inside);
///         let (across, along) = (Point::new(bore, none), Point::new(none, bore));
///         pen.ellipse(&Ellipse { centre: corner(half, half), across, along }, Side::Outside);
///     }
/// }
///
/// let mut plane = Plane::new(Sensor::default());
/// let imprint = plane.touch(&Flange { left: 2.0, top: 2.0, side: 6.0, bore: 1.5 });
/// assert_eq!(imprint.count(), 6 * 6 - 4);
/// let covered: f64 = plane.coverages().values().iter().sum();
/// assert!((covered - (36.0 - std::f64::consts::PI * 1.5 * 1.5)).abs() < 1e-9);
/// ```
///
/// For rings of polygons and ellipses, use [`Outline`](crate::outline::Outline).
pub trait Solid {
    /// Draws the whole boundary. Implementations convert the numbers of the shape with [`Real::decimal`].
    fn draw<T: Real>(&self, pen: &mut impl Pen<T>);
}

/// The smallest upright rectangle around a shape; in cell sides, in the frame of the plane.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Extent<T = f64> {
    /// The smallest x.
    pub left: T,
    /// The smallest y.
    pub top: T,
    /// The largest x.
    pub right: T,
    /// The largest y.
    pub bottom: T,
}

impl Extent {
    /// Returns the extent of a shape; None if the shape has no boundary.
    pub fn of(solid: &impl Solid) -> Option<Self> {
        Self::drawn(solid)
    }
}

impl<T: Real> Extent<T> {
    /// Returns the extent of a shape in numbers of any precision.
    pub(crate) fn drawn(solid: &impl Solid) -> Option<Self> {
        let mut pen = ExtentPen(None);
        solid.draw(&mut pen);
        pen.0
    }

    /// Returns the smallest extent that contains both.
    pub(crate) fn union(self, other: Self) -> Self {
        Self {
            left: self.left.min(other.left),
            top: self.top.min(other.top),
            right: self.right.max(other.right),
            bottom: self.bottom.max(other.bottom),
        }
    }
}

/// A pen that draws nothing, but notes how far the boundary reaches.
struct ExtentPen<T>(Option<Extent<T>>);

impl<T: Real> ExtentPen<T> {
    fn cover(&mut self, low: Point<T>, high: Point<T>) {
        let own = Extent {
            left: low.x,
            top: low.y,
            right: high.x,
            bottom: high.y,
        };
        self.0 = Some(self.0.map_or(own, |old| old.union(own)));
    }
}

impl<T: Real> Pen<T> for ExtentPen<T> {
    fn edge(&mut self, from: Point<T>, to: Point<T>) {
        self.cover(from, from);
        self.cover(to, to);
    }
    fn ellipse(&mut self, ellipse: &Ellipse<T>, _material: Side) {
        let (centre, reach) = (ellipse.centre, ellipse.reach());
        let opposite = Point::new(-reach.x, -reach.y);
        self.cover(centre.moved(opposite), centre.moved(reach));
    }
}

pub(crate) const MOST_CORNERS: usize = 8;

/// A regular polygon of side 2 about its centre, standing on a side. Its numbers have 32 digits.
pub(crate) struct RegularPolygon {
    /// The corners, clockwise from the left end of the bottom side. A polygon with fewer repeats its first ones.
    pub(crate) corners: [Point<Double>; MOST_CORNERS],
    pub(crate) top_left: Point<Double>,
    /// The distance from the centre to each side.
    pub(crate) inradius: Double,
}

impl RegularPolygon {
    /// Returns the polygon with a number of corners, from 3 to [`MOST_CORNERS`].
    pub(crate) fn with_corners(corners: u8) -> &'static Self {
        static POLYGONS: LazyLock<[RegularPolygon; MOST_CORNERS - 2]> =
            LazyLock::new(|| [3, 4, 5, 6, 7, 8].map(RegularPolygon::new));
        &POLYGONS[usize::from(corners) - 3]
    }

    fn new(corners: u8) -> Self {
        let (sin, cos) = (Double::whole(180) / Double::whole(corners.into())).sin_cos_degrees();
        let inradius = cos / sin;
        let step = Turn {
            sin: Double::whole(2) * sin * cos,
            cos: Double::ONE - Double::whole(2) * sin * sin,
        };
        let mut next = Point::new(-Double::ONE, inradius);
        let corners = std::array::from_fn(|_| {
            let corner = next;
            next = step.of(corner);
            corner
        });
        let least = |least: Point<Double>, corner: &Point<Double>| {
            Point::new(least.x.min(corner.x), least.y.min(corner.y))
        };
        Self {
            top_left: corners.iter().fold(next, least),
            corners,
            inradius,
        }
    }
}
