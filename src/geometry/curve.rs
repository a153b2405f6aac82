//! An ellipse prepared for being cut at the lines of a grid.
//!
//! With `a`, `b` the images of the disc's axes, the reach in y is `R = √(a.y² + b.y²)`, and the line `y = c.y + d`
//! meets the ellipse at `x = c.x + shear·d ± scale·√((R − d)(R + d))`, with `shear = (a·b products) / R²` and
//! `scale = |det| / R²`; likewise for vertical lines.

use super::outline::{Ellipse, Point};
use super::real::Real;

/// An ellipse: its extreme points, where it meets horizontal and vertical lines, and what its chords cut off.
#[derive(Clone, Debug)]
pub struct Curve<T> {
    centre: Point<T>,
    reach: Point<T>,
    shear: Point<T>,
    scale: Point<T>,
    /// The area of the image of the unit square, positive.
    area: T,
    /// Half of the map back to the unit disc.
    to_disc: [Point<T>; 2],
    /// The leftmost point.
    pub left: Point<T>,
    /// The topmost point.
    pub top: Point<T>,
    /// The rightmost point.
    pub right: Point<T>,
    /// The bottommost point.
    pub bottom: Point<T>,
}

impl<T: Real> Curve<T> {
    /// Prepares an ellipse.
    pub fn of(ellipse: &Ellipse<T>) -> Self {
        let Ellipse {
            centre,
            across: a,
            along: b,
        } = *ellipse;
        let reach = ellipse.reach();
        let determinant = a.x * b.y - a.y * b.x;
        let area = determinant.abs();
        let (x_inverse, y_inverse) = (T::ONE / (reach.x * reach.x), T::ONE / (reach.y * reach.y));
        let mixed = a.x * a.y + b.x * b.y;
        let shear = Point::new(mixed * y_inverse, mixed * x_inverse);
        let halved = T::HALF / determinant;
        let skew = Point::new(shear.x * reach.y, shear.y * reach.x);
        Self {
            centre,
            reach,
            shear,
            scale: Point::new(area * y_inverse, area * x_inverse),
            area,
            to_disc: [
                Point::new(b.y * halved, -(b.x * halved)),
                Point::new(-(a.y * halved), a.x * halved),
            ],
            left: Point::new(centre.x - reach.x, centre.y - skew.y),
            top: Point::new(centre.x - skew.x, centre.y - reach.y),
            right: Point::new(centre.x + reach.x, centre.y + skew.y),
            bottom: Point::new(centre.x + skew.x, centre.y + reach.y),
        }
    }

    /// Where the horizontal line at `y` meets it: left, right.
    pub fn xs_at(&self, y: T) -> [T; 2] {
        let d = y - self.centre.y;
        let middle = self.centre.x + self.shear.x * d;
        let root = self.scale.x * ((self.reach.y - d) * (self.reach.y + d)).sqrt();
        [middle - root, middle + root]
    }

    /// Where the vertical line at `x` meets it: above, below.
    pub fn ys_at(&self, x: T) -> [T; 2] {
        let d = x - self.centre.x;
        let middle = self.centre.y + self.shear.y * d;
        let root = self.scale.y * ((self.reach.x - d) * (self.reach.x + d)).sqrt();
        [middle - root, middle + root]
    }

    /// The square of half the chord between two points that lie so far apart, in the unit disc.
    pub fn squared_chord(&self, chord: Point<T>) -> T {
        let [first, second] = &self.to_disc;
        let (u, v) = (
            first.x * chord.x + first.y * chord.y,
            second.x * chord.x + second.y * chord.y,
        );
        u * u + v * v
    }

    /// The area between an arc and its chord, whose square as above is `squared`, at most 1/8; positive where the arc
    /// runs clockwise as seen.
    ///
    /// In the unit disc it is `(θ − sin θ) / 2`, and `sin θ` is the cross product of the arc's ends. Written as
    /// `sin θ · series(sin²(θ/2))` it takes no root; the second sine is half of the chord.
    pub fn short_segment(&self, from: Point<T>, to: Point<T>, squared: T) -> T {
        let (x, y) = (to.x - from.x, to.y - from.y);
        let cross = (from.x - self.centre.x) * y - (from.y - self.centre.y) * x;
        cross * T::segment_series(squared)
    }

    /// The same of an arc of any length up to half the ellipse; `clockwise` has to say how it runs.
    pub fn segment(&self, from: Point<T>, to: Point<T>, squared: T, clockwise: bool) -> T {
        if squared * T::whole(8) <= T::ONE {
            return self.short_segment(from, to, squared);
        }
        let area = self.area * long_segment(squared.min(T::ONE));
        if clockwise { area } else { -area }
    }
}

/// The area that a chord of length `2s` cuts off the unit disc, from `s²` in [1/8, 1].
///
/// Such chords are halved: it is twice what the chord of half the angle cuts off, plus the triangle
/// `s·(1 − √(1 − s²))` between the three chords.
fn long_segment<T: Real>(squared: T) -> T {
    let (sin, versine) = (squared.sqrt(), T::ONE - (T::ONE - squared).sqrt());
    let halved = versine * T::HALF;
    let half = if halved * T::whole(8) <= T::ONE {
        sin * T::segment_series(halved)
    } else {
        long_segment(halved)
    };
    T::whole(2) * half + sin * versine
}
