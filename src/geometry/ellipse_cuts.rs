//! An ellipse prepared for being cut at the lines of a grid.
//!
//! With `a`, `b` the images of the disc's axes, the reach in y is `R = √(a.y² + b.y²)`. The line `y = c.y + R·sin η`
//! meets the ellipse at `x = c.x + shear·R·sin η ± extent·cos η`, with `shear = (a.x·a.y + b.x·b.y) / R²` and
//! `extent = |det| / R`; likewise for vertical lines.
//!
//! **Moments.** Along an arc whose angle in the disc is `φ`, Green's theorem gives `∫ X dY = (X·Y + det·φ) / 2` about
//! the centre. A horizontal line needs only one angle `η` for the two points at which it meets the ellipse, since they
//! are equally far from the topmost point; so does a vertical line.

use crate::geometry::outline::{Ellipse, Point};
use crate::geometry::real::Real;

/// An ellipse: its extreme points, and where it meets horizontal and vertical lines.
#[derive(Clone, Copy, Debug)]
pub(crate) struct EllipseCuts<T> {
    centre: Point<T>,
    reach: Point<T>,
    inverse: Point<T>,
    shear: Point<T>,
    extent: Point<T>,
    /// Half the area of the image of the unit square, positive.
    half_area: T,
    /// The angle by which the rightmost point lies below the middle between the topmost and the bottommost one.
    tilt: T,
    /// The leftmost point.
    pub(crate) left: Point<T>,
    /// The topmost point.
    pub(crate) top: Point<T>,
    /// The rightmost point.
    pub(crate) right: Point<T>,
    /// The bottommost point.
    pub(crate) bottom: Point<T>,
}

/// The running sums of a descent along a half of an ellipse, at one of its points.
///
/// The contribution between two points is their difference.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Sums<T> {
    /// `∫ dy`: the height below the centre.
    pub height: T,
    /// `∫ x dy`, from the leftmost or rightmost point on.
    pub moment: T,
}

/// Where a line meets an ellipse: the x, and the sums of the descent along the left or the right half up to there.
pub(crate) type Crossing<T> = (T, Sums<T>);

impl<T: Real> EllipseCuts<T> {
    /// Prepares an ellipse; None if it is thinner than any tie.
    pub(crate) fn of(ellipse: &Ellipse<T>) -> Option<Self> {
        let (centre, reach, area) = (ellipse.centre, ellipse.reach(), ellipse.span());
        if area <= T::TIE * T::TIE {
            return None;
        }
        let inverse = Point::new(T::ONE / reach.x, T::ONE / reach.y);
        let extent = Point::new(area * inverse.y, area * inverse.x);
        // How far the extreme points lie to the side of the centre.
        let mixed = ellipse.skew();
        let skew = Point::new(mixed * inverse.y, mixed * inverse.x);
        Some(Self {
            centre,
            reach,
            inverse,
            shear: Point::new(skew.x * inverse.y, skew.y * inverse.x),
            extent,
            half_area: area * T::HALF,
            // Circles and upright ellipses are not tilted.
            tilt: if mixed == T::ZERO {
                T::ZERO
            } else {
                T::angle(skew.y * inverse.y, extent.y * inverse.y)
            },
            left: Point::new(centre.x - reach.x, centre.y - skew.y),
            top: Point::new(centre.x - skew.x, centre.y - reach.y),
            right: Point::new(centre.x + reach.x, centre.y + skew.y),
            bottom: Point::new(centre.x + skew.x, centre.y + reach.y),
        })
    }

    /// Where the horizontal line at `y` meets it: left, right. If it passes by, the nearest extreme point, twice.
    pub(crate) fn across(&self, y: T) -> [Crossing<T>; 2] {
        let height = y - self.centre.y;
        let (angle, half) = if height.abs() < self.reach.y {
            let sin = height * self.inverse.y;
            let cos = ((T::ONE - sin) * (T::ONE + sin)).sqrt();
            (T::angle(sin, cos), self.extent.x * cos)
        } else if height < T::ZERO {
            (-T::QUARTER_TURN, T::ZERO)
        } else {
            (T::QUARTER_TURN, T::ZERO)
        };
        let middle = self.centre.x + self.shear.x * height;
        let at = |x: T, angle: T| {
            let moment = height * T::HALF * (x + self.centre.x) + self.half_area * angle;
            (x, Sums { height, moment })
        };
        [
            at(middle - half, -(angle + self.tilt)),
            at(middle + half, angle - self.tilt),
        ]
    }

    /// Where the vertical line at `x` meets it, which it must: above, below. The moments are a quarter turn off, see
    /// [`Self::quarter`].
    pub(crate) fn along(&self, x: T) -> [Sums<T>; 2] {
        let aside = x - self.centre.x;
        let sin = aside * self.inverse.x;
        let cos = ((T::ONE - sin) * (T::ONE + sin)).sqrt();
        let sector = self.half_area * T::angle(sin, cos);
        let middle = self.shear.y * aside;
        let half = self.extent.y * cos;
        let mean = (x + self.centre.x) * T::HALF;
        let at = |height: T, sector: T| Sums {
            height,
            moment: height * mean + sector,
        };
        [at(middle - half, sector), at(middle + half, -sector)]
    }

    /// Where the horizontal line at `y` meets it: the x on the left and on the right. If it passes by, the middle,
    /// twice.
    pub(crate) fn chord(&self, y: T) -> [T; 2] {
        self.chords(y, T::ONE)[0]
    }

    /// The same, and where the line meets the ellipse scaled about its centre by the root of `size`.
    pub(crate) fn chords(&self, y: T, size: T) -> [[T; 2]; 2] {
        let height = y - self.centre.y;
        let sin = height * self.inverse.y;
        let middle = self.centre.x + self.shear.x * height;
        [T::ONE, size].map(|size| {
            let half = self.extent.x * (size - sin * sin).sqrt();
            [middle - half, middle + half]
        })
    }

    /// The area of the parallelogram that its axes span.
    pub(crate) fn span(&self) -> T {
        self.half_area / T::HALF
    }

    /// The square of the smaller radius.
    pub(crate) fn smaller_radius_squared(&self) -> T {
        // The sum and the product of the squared radii are known.
        let span = self.span();
        let sum = self.reach.x * self.reach.x + self.reach.y * self.reach.y;
        let larger = (sum + (sum * sum - T::whole(4) * span * span).sqrt()) * T::HALF;
        span * span / larger
    }

    /// The same ellipse elsewhere.
    pub(crate) fn moved(&self, by: Point<T>) -> Self {
        Self {
            centre: self.centre.moved(by),
            left: self.left.moved(by),
            top: self.top.moved(by),
            right: self.right.moved(by),
            bottom: self.bottom.moved(by),
            ..*self
        }
    }

    /// A quarter turn's share of a moment. Subtract it from the result of [`Self::along`] on a descent to the right,
    /// and add it on a descent to the left.
    pub(crate) fn quarter(&self) -> T {
        self.half_area * T::QUARTER_TURN
    }
}
