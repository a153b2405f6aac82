//! Poses that follow from others by a half turn of the plane.
//!
//! A half turn about a point whose coordinates are whole or half cells maps taxels onto taxels. It maps a shape with
//! point symmetry onto the same shape elsewhere: its centre goes from `c` to `m − c`, with `m` a whole number. If the
//! ranges of x0 and y0 cover whole cells, and contain with every centre its image up to whole cells, then each row of
//! an orientation is the image of another one, and only half of the rows need to be swept.
//!
//! **Exactly.** Positions are compared as decimals, so what is mapped is equal in real arithmetic, ties included. For
//! that, twice the distance from anchor to centre must be a decimal. It is 0 with the anchor at the centre. Otherwise
//! it is the sides of the bounding rectangle, which are decimals for ellipses, rectangles and pictures that are not
//! zoomed, but not for regular polygons. What the sensor cuts off has no image, so the shape must lie inside the
//! sensor in all poses of the orientation.

use crate::figure::FigureKind;
use crate::pose::{Anchor, Axis, DecimalRange, PoseGrid, period};
use crate::source::Source;

/// A half turn that maps the poses of an orientation onto each other.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(crate) struct PointSymmetry {
    pub(crate) x: IndexReflection,
    pub(crate) y: IndexReflection,
}

impl PointSymmetry {
    /// Returns the symmetry of a grid; None if the shape or the ranges are not mapped onto themselves. The caller
    /// must check that the shape lies inside the sensor in every pose.
    pub(crate) fn of(grid: &PoseGrid) -> Option<Self> {
        if period(grid.source()).is_some_and(|period| 180 % period != 0) {
            return None;
        }
        let [width, height] = twice_to_centre(grid)?;
        Some(Self {
            x: IndexReflection::of(&grid.ranges()[Axis::X0], width)?,
            y: IndexReflection::of(&grid.ranges()[Axis::Y0], height)?,
        })
    }
}

/// Returns twice the distance from the anchor to the centre along x and along y, in cells; None if it is not a
/// decimal.
fn twice_to_centre(grid: &PoseGrid) -> Option<[f64; 2]> {
    if grid.anchor() == Anchor::Centre {
        return Some([0.0; 2]);
    }
    match grid.source() {
        Source::Figure(figure) => {
            let sizes = figure.kind().sizes();
            let size = |index: usize| figure.get(*sizes.get(index)?);
            match figure.kind() {
                FigureKind::Ellipse => Some([2.0 * size(0)?, 2.0 * size(1)?]),
                FigureKind::Rectangle => Some([size(0)?, size(1)?]),
                _ => None,
            }
        }
        Source::Picture(picture) => {
            let ranges = grid.ranges();
            if [Axis::ZoomX, Axis::ZoomY]
                .iter()
                .any(|&axis| ranges[axis] != DecimalRange::whole(1))
            {
                return None;
            }
            let bounds = picture.imprint().bounds()?;
            let side = |from: u8, to: u8| f64::from(to - from);
            Some([
                side(bounds.left, bounds.right),
                side(bounds.top, bounds.bottom),
            ])
        }
    }
}

/// A mapping of the values of a range onto each other: value `i` to value `last − i`, or to `last − i + count` if
/// that would be negative, so that it wraps around.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(crate) struct IndexReflection {
    pub(crate) count: u64,
    pub(crate) last: u64,
    /// The sum of the coordinates of a centre and its image, in cells, for values up to `last`, and for those after it.
    cells: [i32; 2],
}

impl IndexReflection {
    /// Returns the reflection of a range whose values lie `extent / 2` before the centre; None if the values are not
    /// mapped onto each other.
    fn of(range: &DecimalRange, extent: f64) -> Option<Self> {
        // The shortest decimal that reads back as the number is the one that was given.
        let extent: DecimalRange = extent.to_string().parse().ok()?;
        let (mut numbers, mut one) = (range.units(), range.one());
        let (mut extent, extent_one) = (extent.units()[0], extent.one());
        // Both are powers of ten.
        let all = one.max(extent_one);
        numbers = numbers.map(|number| number * (all / one));
        extent *= all / extent_one;
        one = all;
        let [start, step] = numbers;
        let whole = i128::from(range.count()) * step;
        // Two centres that are images of each other sum up to a whole number of cells.
        let way = (-2 * start - extent).rem_euclid(whole);
        if whole % one != 0 || way % step != 0 {
            return None;
        }
        let cells = (2 * start + extent + way) / one;
        Some(Self {
            count: range.count(),
            last: u64::try_from(way / step).ok()?,
            cells: [
                i32::try_from(cells).ok()?,
                i32::try_from(cells + whole / one).ok()?,
            ],
        })
    }

    /// Returns the value whose image this one is, and whether this one comes after `last`.
    pub(crate) fn image(&self, index: u64) -> (u64, bool) {
        if index <= self.last {
            (self.last - index, false)
        } else {
            (self.last + self.count - index, true)
        }
    }

    /// Returns the sum of the coordinates of a centre and its image, in cells, for values up to `last` or after it.
    pub(crate) fn cells(&self, after: bool) -> i32 {
        self.cells[usize::from(after)]
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::figure::Figure;
    use crate::picture::Picture;
    use crate::pose::Ranges;
    use crate::sensor::Sensor;

    fn has_images(source: Source, anchor: Anchor, zoom: &str) -> bool {
        let ranges = Ranges::default().with(Axis::ZoomX, zoom.parse().expect("a range"));
        let grid = PoseGrid::new(source, Sensor::default(), anchor, ranges).expect("a grid");
        PointSymmetry::of(&grid).is_some()
    }

    fn fold(range: &str, extent: f64) -> Option<IndexReflection> {
        IndexReflection::of(&range.parse().expect("a range"), extent)
    }

    #[test]
    fn a_centre_and_its_image_sum_up_to_whole_cells() {
        for (range, extent) in [
            ("5:5.99:0.01", 6.0),
            ("5:5.99:0.01", 0.7),
            ("-0.5:1.4:0.1", 3.1),
            ("2.125:3.1:0.025", 2.4),
            ("7", 3.0),
            ("7.5", 0.0),
            ("0:2.97:0.03", 0.0),
        ] {
            let fold = fold(range, extent).expect("a fold");
            let range: DecimalRange = range.parse().expect("a range");
            for index in 0..range.count() {
                let (image, after) = fold.image(index);
                assert_eq!(fold.image(image), (index, after));
                let sum = range.value(index) + range.value(image) + extent;
                let cells = f64::from(fold.cells(after));
                assert!(
                    (sum - cells).abs() < 1e-9,
                    "{range} {extent}: {sum}, {cells}"
                );
            }
        }
    }

    #[test]
    fn only_shapes_that_a_half_turn_maps_onto_themselves_have_images() {
        let halved = |kind: FigureKind, anchor| {
            has_images(
                Source::Figure(Figure::default_of(kind, &Sensor::default())),
                anchor,
                "1",
            )
        };
        let (corner, centre) = (Anchor::Corner, Anchor::Centre);
        assert!(halved(FigureKind::Rectangle, corner) && halved(FigureKind::Ellipse, corner));
        assert!(halved(FigureKind::Hexagon, centre) && halved(FigureKind::Octagon, centre));
        assert!(!halved(FigureKind::Hexagon, corner) && !halved(FigureKind::Octagon, corner));
        assert!(!halved(FigureKind::Triangle, centre) && !halved(FigureKind::Heptagon, centre));
        let picture = |rows: &str, anchor, zoom: &str| {
            let rows = rows.parse().expect("rows");
            has_images(Source::Picture(Picture::at_home(rows)), anchor, zoom)
        };
        assert!(picture("##.\n.##", corner, "1") && !picture("###\n.##", corner, "1"));
        assert!(!picture("##.\n.##", corner, "0.5") && picture("##.\n.##", centre, "0.5"));
    }

    #[test]
    fn other_ranges_have_no_image() {
        // A step more or less than whole cells; a width between the steps; a position off the half cells; not a
        // decimal.
        for (range, extent) in [
            ("5:6:0.01", 6.0),
            ("5:5.98:0.01", 6.0),
            ("5:5.99:0.01", 6.005),
            ("5.3", 6.0),
            ("5:5.99:0.01", 3.0 * 3_f64.sqrt()),
        ] {
            assert_eq!(fold(range, extent), None, "{range} {extent}");
        }
    }
}
