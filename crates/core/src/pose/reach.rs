//! The reach of a shape over all orientations of a grid. It tells which poses the sensor cuts off.
//!
//! The *reach* is the smallest upright rectangle around the shape in every orientation, relative to its anchor. A pose
//! is cut off if the shape then reaches beyond the sensor, by the rule of [`crate::touch::reaches_beyond`]. Units are
//! cell sides, and the frame is that of the plane.

use std::ops::Range;

use crate::geometry::Extent;
use crate::pose::grid::PoseGrid;
use crate::touch::DOUBTFUL;

impl PoseGrid {
    /// Returns the smallest upright rectangle around the shape in every orientation of the grid, with its anchor at the
    /// origin; in cell sides. None if the shape has no boundary, like a picture of an empty imprint.
    ///
    /// The position of a picture that is placed by its corner is zoomed too. In such a pose, the rectangle has to be
    /// moved by `zoom_x · x0`, `zoom_y · y0`.
    ///
    /// Takes time in proportion to the number of orientations.
    pub fn reach(&self) -> Option<Extent> {
        self.extents().flatten().reduce(union)
    }

    /// Returns the number of poses in which the shape reaches beyond the sensor and is cut off. A sweep of the grid
    /// reports the same number.
    ///
    /// Takes time in proportion to the number of orientations.
    pub fn poses_beyond_sensor(&self) -> u64 {
        let extents = (0..).zip(self.extents());
        let inside = extents.map(|(orientation, extent)| match extent {
            Some(extent) => {
                let columns = self.columns_inside(orientation, &extent);
                let rows = self.rows_inside(orientation, &extent);
                (columns.end - columns.start) * (rows.end - rows.start)
            }
            None => self.row_length() * self.rows_per_orientation(),
        });
        self.poses() - inside.sum::<u64>()
    }

    pub(super) fn extents(&self) -> impl Iterator<Item = Option<Extent>> + '_ {
        (0..self.orientations()).map(|orientation| self.boundary::<f64>(orientation).extent())
    }

    /// Returns the indices of x0 at which the shape reaches beyond neither the left nor the right side of the sensor.
    pub(crate) fn columns_inside(&self, orientation: u64, extent: &Extent) -> Range<u64> {
        let at = |index| self.offset::<f64>(orientation, index, 0).x;
        inside(
            self.row_length(),
            at,
            (extent.left, extent.right),
            self.sensor().columns(),
        )
    }

    /// The same for y0, the upper and the lower side.
    pub(crate) fn rows_inside(&self, orientation: u64, extent: &Extent) -> Range<u64> {
        let at = |index| self.offset::<f64>(orientation, 0, index).y;
        inside(
            self.rows_per_orientation(),
            at,
            (extent.top, extent.bottom),
            self.sensor().rows(),
        )
    }
}

/// Returns the indices of the positions at which the interval from `low` to `high` lies within `side`. Positions grow
/// with their index.
fn inside(count: u64, at: impl Fn(u64) -> f64, (low, high): (f64, f64), side: u8) -> Range<u64> {
    let from = first(0..count, |index| low + at(index) >= -DOUBTFUL);
    let to = first(from..count, |index| {
        high + at(index) > f64::from(side) + DOUBTFUL
    });
    from..to
}

/// Returns the first number of a range for which a condition is true; it stays true from then on. The end of the range
/// if it is never true.
fn first(range: Range<u64>, is_true: impl Fn(u64) -> bool) -> u64 {
    let Range { mut start, mut end } = range;
    while start < end {
        let middle = start + (end - start) / 2;
        if is_true(middle) {
            end = middle;
        } else {
            start = middle + 1;
        }
    }
    start
}

pub(super) fn union(one: Extent, other: Extent) -> Extent {
    Extent {
        left: one.left.min(other.left),
        top: one.top.min(other.top),
        right: one.right.max(other.right),
        bottom: one.bottom.max(other.bottom),
    }
}

#[cfg(test)]
mod tests {
    #[test]
    fn examples() -> Result<(), Box<dyn std::error::Error>> {
        use crate::prelude::*;
        let sensor = Sensor::default();
        let bar = Figure::rectangle(6.0, 2.0).on(&sensor)?;
        let ranges = Ranges::default().with(Axis::Angle, "0:90:90".parse()?);
        let grid = PoseGrid::new(bar.into(), sensor, Anchor::Corner, ranges)?;
        let reach = grid.reach().expect("it has a boundary");
        // Upright it reaches from (0, 0) to (6, 2); turned about (3, 1), from (2, −2) to (4, 4).
        assert_eq!(
            (reach.left, reach.top, reach.right, reach.bottom),
            (0.0, -2.0, 6.0, 4.0)
        );
        let sensor = Sensor::new(8, 8)?;
        let square = Figure::rectangle(6.0, 6.0).on(&sensor)?;
        let ranges = Ranges::default()
            .with(Axis::X0, "0:3:0.5".parse()?)
            .with(Axis::Y0, "1:2:1".parse()?)
            .with(Axis::Angle, "0".parse()?);
        let grid = PoseGrid::new(square.into(), sensor, Anchor::Corner, ranges)?;
        // x0 of 2.5 and 3, at both values of y0.
        assert_eq!(grid.poses_beyond_sensor(), 4);
        Ok(())
    }
}
