//! Regular polygons, computed once with 32 digits and then only scaled.

use std::sync::LazyLock;

use crate::geometry::outline::Point;
use crate::geometry::real::{Double, Real};

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
        let (step_sin, step_cos) = (
            Double::whole(2) * sin * cos,
            Double::ONE - Double::whole(2) * sin * sin,
        );
        let mut next = Point::new(-Double::ONE, inradius);
        let corners = std::array::from_fn(|_| {
            let corner = next;
            next = Point::new(
                corner.x * step_cos - corner.y * step_sin,
                corner.x * step_sin + corner.y * step_cos,
            );
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
