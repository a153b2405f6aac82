//! An ellipse prepared for being cut at the lines of a grid.
//!
//! Let `a`, `b` be the images of the disc's axes and `c` the centre. The reach in y is `R = √(a.y² + b.y²)`. The line
//! `y = c.y + R·sin η` meets the ellipse at `x = c.x + shear·R·sin η ± extent·cos η`, with
//! `shear = (a.x·a.y + b.x·b.y) / R²` and `extent = |det| / R`; likewise for vertical lines.
//!
//! **Moments.** Along an arc whose angle in the disc is `φ`, Green's theorem gives `∫ X dY = (X·Y + det·φ) / 2` about
//! the centre. A horizontal line needs only one angle `η` for the two points at which it meets the ellipse, since both
//! are equally far from the topmost point; so does a vertical line.

use crate::geometry::outline::{Ellipse, Point};
use crate::geometry::real::Real;

#[derive(Clone, Copy, Debug)]
pub(crate) struct EllipseCuts<T> {
    centre: Point<T>,
    reach: Point<T>,
    inverse: Point<T>,
    shear: Point<T>,
    extent: Point<T>,
    /// Half of the area of the parallelogram that the axes span; positive.
    half_area: T,
    /// The angle by which the rightmost point lies below the middle between the topmost and the bottommost one.
    tilt: T,
    pub(crate) left: Point<T>,
    pub(crate) top: Point<T>,
    pub(crate) right: Point<T>,
    pub(crate) bottom: Point<T>,
}

/// The running sums of a descent along a half of an ellipse, at one of its points. A piece between two points
/// contributes the difference of their sums.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Sums<T> {
    /// `∫ dy`: the height below the centre.
    pub height: T,
    /// `∫ x dy`, starting at the leftmost or rightmost point.
    pub moment: T,
}

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
        // The distances by which the extreme points lie to the side of the centre.
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

    /// Returns where the horizontal line at `y` meets the ellipse: left, right. If it passes by, returns the nearest
    /// extreme point twice.
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

    /// Returns where the vertical line at `x`, which must meet the ellipse, does so: above, below. The moments are off
    /// by a quarter turn, see [`Self::quarter`].
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

    /// Returns a quarter turn's share of a moment. It is subtracted from the result of [`Self::along`] on a descent to
    /// the right, and added on a descent to the left.
    pub(crate) fn quarter(&self) -> T {
        self.half_area * T::QUARTER_TURN
    }
}
