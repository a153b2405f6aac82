use std::ops::Range;

use crate::geometry::{Ellipse, Extent, Moving, Pen, Point, Real, Side, Solid};
use crate::parameter::number::{grouped, to_decimals};
use crate::parameter::{Parameter, ParameterError};
use crate::pose::axis::{Anchor, Axis, Pose, PoseIndex, Ranges};
use crate::pose::range::DecimalRange;
use crate::sensor::Sensor;
use crate::source::Source;
use crate::touch::DOUBTFUL;

/// The largest number of decimals of an angle in a range.
const ANGLE_DECIMALS: i32 = 12;

/// The largest number of poses of a grid.
pub const MAX_POSES: u64 = 1_000_000_000_000;

/// A shape, a sensor and the poses to sweep, all of them in range. Units are cells and degrees.
///
/// **Order of poses.** x0 runs fastest, then y0, the angle, zoom x and zoom y (only pictures have zooms). A *row*
/// consists of all x0 at one y0; an *orientation* consists of all rows at one angle and one pair of zooms. Poses, rows
/// and orientations are numbered from 0 in this order.
///
/// **Anchor.** The ranges of x0 and y0 locate either the corner of the shape, as everywhere in the program, or its
/// centre. The centre of a figure is its centre of rotation. That of a picture is the centre of its scaled bounding
/// rectangle, which then lies *at* the given point under every zoom. The anchor is a convention of this project.
///
/// ```
/// use taxel_core::prelude::*;
/// let rectangle = Source::Figure(Figure::default_of(FigureKind::Rectangle, &Sensor::default()));
/// let grid = PoseGrid::new(rectangle, Sensor::default(), Anchor::Corner, Ranges::default())?;
/// assert_eq!(grid.poses(), 3_600_000);
/// let pose = grid.pose(10_203);
/// assert_eq!((pose[Axis::X0], pose[Axis::Y0], pose[Axis::Angle]), (5.03, 5.02, 1.0));
/// # Ok::<(), taxel_core::pose::GridError>(())
/// ```
#[derive(Clone, Debug, PartialEq)]
pub struct PoseGrid {
    source: Source,
    sensor: Sensor,
    anchor: Anchor,
    ranges: Ranges,
}

impl PoseGrid {
    /// Creates a grid of poses of `source`, whose own position, angle and zooms do not matter.
    ///
    /// # Errors
    /// Returns an error if a range exceeds that of its parameter, if a figure has zooms other than 1, or if there are
    /// more than [`MAX_POSES`] poses.
    pub fn new(
        source: Source,
        sensor: Sensor,
        anchor: Anchor,
        ranges: Ranges,
    ) -> Result<Self, GridError> {
        let (mut source, mut poses) = (source, 1_u128);
        for (axis, &range) in ranges.iter() {
            let parameter = axis.parameter();
            if !source.parameters().contains(&parameter) {
                if range != DecimalRange::whole(1) {
                    return Err(GridError::Zoom(source.noun()));
                }
                continue;
            }
            sensor.check(parameter, range.last())?;
            source = source.with(parameter, range.value(0), &sensor)?;
            poses *= u128::from(range.count());
        }
        if poses > u128::from(MAX_POSES) {
            return Err(GridError::Poses(poses));
        }
        Ok(Self {
            source,
            sensor,
            anchor,
            ranges,
        })
    }

    /// Returns the shape, in the first pose.
    pub fn source(&self) -> &Source {
        &self.source
    }

    /// Returns the sensor.
    pub fn sensor(&self) -> &Sensor {
        &self.sensor
    }

    /// Returns the point of the shape that x0 and y0 locate.
    pub fn anchor(&self) -> Anchor {
        self.anchor
    }

    /// Returns the range of each axis.
    pub fn ranges(&self) -> &Ranges {
        &self.ranges
    }

    /// Iterates over the axes that the shape has: all of them for a picture, all except the zooms for a figure.
    pub fn axes(&self) -> impl Iterator<Item = Axis> + use<> {
        Axis::of(&self.source)
    }

    /// Returns the number of poses.
    pub fn poses(&self) -> u64 {
        self.rows() * self.row_length()
    }

    /// Returns the number of poses in a row.
    pub fn row_length(&self) -> u64 {
        self.ranges[Axis::X0].count()
    }

    /// Returns the number of rows in all orientations together.
    pub fn rows(&self) -> u64 {
        self.orientations() * self.rows_per_orientation()
    }

    /// Returns the number of rows in an orientation.
    pub fn rows_per_orientation(&self) -> u64 {
        self.ranges[Axis::Y0].count()
    }

    pub(super) fn orientations(&self) -> u64 {
        let [_, _, angles, zooms_x, zooms_y] = self.counts().into_array();
        angles * zooms_x * zooms_y
    }

    /// Returns the number of values of each axis.
    pub fn counts(&self) -> PoseIndex {
        PoseIndex::from_fn(|axis| self.ranges[axis].count())
    }

    /// Returns the index of pose `number` on each axis. Numbers beyond the last pose start again at the first.
    pub fn index(&self, number: u64) -> PoseIndex {
        let mut rest = number;
        PoseIndex::from_fn(|axis| {
            let count = self.ranges[axis].count();
            let index = rest % count;
            rest /= count;
            index
        })
    }

    /// Returns the number of the pose at an index. An index beyond the grid is moved to its edge.
    pub fn number(&self, index: PoseIndex) -> u64 {
        index.iter().rev().fold(0, |number, (axis, &index)| {
            let count = self.ranges[axis].count();
            number * count + index.min(count - 1)
        })
    }

    /// Returns pose `number`. Numbers beyond the last pose start again at the first.
    pub fn pose(&self, number: u64) -> Pose {
        let index = self.index(number);
        Pose::from_fn(|axis| self.ranges[axis].value(index[axis]))
    }

    /// Returns the part of the grid that has, on each axis, the `counts` values from `from` on. None if it is empty or
    /// leaves this grid.
    pub fn part(&self, from: PoseIndex, counts: PoseIndex) -> Option<Self> {
        let mut ranges = self.ranges;
        for axis in Axis::ALL {
            let end = from[axis].checked_add(counts[axis])?;
            ranges[axis] = ranges[axis].part(from[axis]..end)?;
        }
        Self::new(self.source.clone(), self.sensor, self.anchor, ranges).ok()
    }

    /// Returns the shape in pose `number`. Numbers beyond the last pose start again at the first. For a pose between
    /// those of the grid, see [`Self::source_at`].
    pub fn placed(&self, number: u64) -> Placed {
        self.placed_in(self.pose(number))
    }

    /// Returns the shape in a pose, which may lie between those of the grid. A centre may lie anywhere, and an angle may be
    /// of any size; any other value beyond the range of its parameter is ignored.
    pub fn placed_in(&self, pose: Pose) -> Placed {
        let is_centred = self.anchor == Anchor::Centre;
        let mut corner = if is_centred { at_origin(pose) } else { pose };
        corner[Axis::Angle] = within_a_turn(pose[Axis::Angle]);
        let mut source = self.source.clone();
        for axis in self.axes() {
            if let Ok(value) = self.sensor.check(axis.parameter(), corner[axis]) {
                source.put(axis.parameter(), value);
            }
        }
        let centre = is_centred.then(|| [pose[Axis::X0], pose[Axis::Y0]]);
        Placed { source, centre }
    }

    /// Returns the point about which the shape turns, in pose `number` and for any anchor: x and y in cells. Numbers
    /// beyond the last pose start again at the first.
    pub fn centre(&self, number: u64) -> [f64; 2] {
        self.placed(number).centre()
    }

    /// Returns the shape in a pose, placed by its corner as in forms and files. The pose may lie between those of the
    /// grid.
    ///
    /// If the grid's anchor is the centre, the corner is rounded to nine decimals. So a taxel that is covered just at
    /// the threshold may differ.
    ///
    /// # Errors
    /// Returns an error if the corner lies outside of the range of x0 or y0, or a value of the pose is out of range.
    pub fn source_at(&self, pose: Pose) -> Result<Source, ParameterError> {
        let mut corner = pose;
        if self.anchor == Anchor::Centre {
            let at_origin = self.placed_in(pose).source;
            let centre = centre::<f64>(&at_origin);
            for (axis, zoom, from) in [
                (Axis::X0, Parameter::ZoomX, centre.x),
                (Axis::Y0, Parameter::ZoomY, centre.y),
            ] {
                // Figures have no zoom.
                let zoom = at_origin.get(zoom).unwrap_or(1.0);
                corner[axis] = to_decimals((pose[axis] - from) / zoom, 9);
            }
        }
        self.axes().try_fold(self.source.clone(), |source, axis| {
            source.with(axis.parameter(), corner[axis], &self.sensor)
        })
    }

    /// Returns true if this grid is one of the same shape, in any pose, on the same sensor. The pitch does not matter.
    pub fn is_of(&self, source: &Source, sensor: &Sensor) -> bool {
        let own = &self.sensor;
        // In the same pose, only the shapes can differ.
        let mut posed = source.clone();
        for axis in self.axes() {
            posed.put(axis.parameter(), self.ranges[axis].value(0));
        }
        (own.size(), own.threshold()) == (sensor.size(), sensor.threshold()) && posed == self.source
    }

    fn first_pose(&self, orientation: u64) -> Pose {
        self.pose(orientation * self.rows_per_orientation() * self.row_length())
    }

    /// Returns the shape in an orientation, with its anchor at the origin.
    pub(crate) fn at_origin(&self, orientation: u64) -> Placed {
        self.placed_in(at_origin(self.first_pose(orientation)))
    }

    /// Returns the factors by which the position of the anchor is multiplied: the corner of a picture is zoomed with it.
    pub(super) fn zooms_of_anchor(&self, orientation: u64) -> [f64; 2] {
        match self.anchor {
            Anchor::Centre => [1.0; 2],
            Anchor::Corner => {
                let pose = self.first_pose(orientation);
                [pose[Axis::ZoomX], pose[Axis::ZoomY]]
            }
        }
    }

    /// Returns the position of the anchor in the plane, for the values of x0 and y0 with indices `x` and `y`.
    pub(crate) fn offset<T: Real>(&self, orientation: u64, x: u64, y: u64) -> Point<T> {
        let at = |axis, index| T::decimal(self.ranges[axis].value(index));
        let (x, y) = (at(Axis::X0, x), at(Axis::Y0, y));
        match self.zooms_of_anchor(orientation) {
            [1.0, 1.0] => Point::new(x, y),
            [zoom_x, zoom_y] => Point::new(x * T::decimal(zoom_x), y * T::decimal(zoom_y)),
        }
    }
}

fn at_origin(pose: Pose) -> Pose {
    pose.with(Axis::X0, 0.0).with(Axis::Y0, 0.0)
}

/// Returns the same angle, from 0° to below 360°. The difference is rounded, since that of two numbers that are nearest to
/// decimals is not always nearest to a decimal.
fn within_a_turn(angle: f64) -> f64 {
    if (0.0..360.0).contains(&angle) {
        return angle;
    }
    to_decimals(angle.rem_euclid(360.0), ANGLE_DECIMALS)
}

/// The error for a grid that cannot be created.
#[derive(Clone, Debug, PartialEq, thiserror::Error)]
pub enum GridError {
    /// A range exceeds that of its parameter.
    #[error(transparent)]
    Parameter(#[from] ParameterError),
    /// A number has more digits than a range can have.
    #[error("{0} has too many digits for a range")]
    Digits(f64),
    /// A shape that has no zoom, such as a "figure", has zooms other than 1.
    #[error("a {0} has no zoom, only a picture has one")]
    Zoom(&'static str),
    /// There are too many poses.
    #[error("{} poses, expected at most {}", grouped(*.0), grouped(MAX_POSES))]
    Poses(u128),
}

/// A shape in a pose of a grid, ready for a touch ([`Plane::touch`](crate::touch::Plane::touch)).
#[derive(Clone, Debug)]
pub struct Placed {
    source: Source,
    /// The position of its centre, if the anchor is the centre. The shape then has its corner at the origin.
    centre: Option<[f64; 2]>,
}

impl Placed {
    /// Returns the point about which the shape turns.
    pub(crate) fn centre(&self) -> [f64; 2] {
        self.centre.unwrap_or_else(|| {
            let centre = centre::<f64>(&self.source);
            [centre.x, centre.y]
        })
    }
}

impl Solid for Placed {
    fn draw<T: Real>(&self, pen: &mut impl Pen<T>) {
        let Some([x, y]) = self.centre else {
            return self.source.draw(pen);
        };
        let centre = centre::<T>(&self.source);
        let by = Point::new(T::decimal(x) - centre.x, T::decimal(y) - centre.y);
        self.source.draw(&mut Moving { by, pen });
    }
}

/// Returns the centre of rotation of a shape, in cells: the middle of a figure, or that of the bounding rectangle of
/// another shape.
pub(super) fn centre<T: Real>(source: &Source) -> Point<T> {
    let mut upright = source.clone();
    upright.put(Parameter::Angle, 0.0);
    let zero = Point::new(T::ZERO, T::ZERO);
    if source.kind().is_none() {
        return Extent::drawn(&upright).map_or(zero, |extent: Extent<T>| {
            let (x, y) = (extent.left + extent.right, extent.top + extent.bottom);
            Point::new(x * T::HALF, y * T::HALF)
        });
    }
    let Boundary { edges, ellipses } = Boundary::of(&upright);
    if let Some((ellipse, _)) = ellipses.first() {
        return ellipse.centre;
    }
    // The mean of the corners. A concentric hole does not change it.
    let sum = edges.iter().fold(zero, |sum, &(from, _)| sum.moved(from));
    let count = T::whole(i32::try_from(edges.len()).unwrap_or(i32::MAX));
    Point::new(sum.x / count, sum.y / count)
}

// The stored boundary of a shape: drawn once, and used for all positions that differ by a shift.
//
// Sweeps cut bands from it in `f64`; for cases that `f64` cannot decide, it is drawn as `Double`. The frame and the
// units are those of the plane; the anchor of the shape is at the origin.

/// The boundary of a shape: straight edges with the material on their right, and ellipses.
#[derive(Clone, Debug)]
pub(crate) struct Boundary<T> {
    pub(crate) edges: Vec<(Point<T>, Point<T>)>,
    pub(crate) ellipses: Vec<(Ellipse<T>, Side)>,
}

impl<T: Real> Boundary<T> {
    pub(crate) fn of(solid: &impl Solid) -> Self {
        let mut boundary = Self {
            edges: Vec::new(),
            ellipses: Vec::new(),
        };
        solid.draw(&mut boundary);
        boundary
    }

    /// Draws the stored boundary, shifted.
    pub(crate) fn draw(&self, by: Point<T>, pen: &mut impl Pen<T>) {
        let mut pen = Moving { by, pen };
        for &(from, to) in &self.edges {
            pen.edge(from, to);
        }
        for (ellipse, material) in &self.ellipses {
            pen.ellipse(ellipse, *material);
        }
    }
}

impl<T: Real> Pen<T> for Boundary<T> {
    fn edge(&mut self, from: Point<T>, to: Point<T>) {
        self.edges.push((from, to));
    }
    fn ellipse(&mut self, ellipse: &Ellipse<T>, material: Side) {
        self.ellipses.push((*ellipse, material));
    }
}

// The reach of a shape over all orientations of a grid. It tells which poses the sensor cuts off.
//
// The *reach* is the smallest upright rectangle around the shape in every orientation, relative to its anchor. A pose
// is cut off if the shape then reaches beyond the sensor, by the rule of [`crate::touch::reaches_beyond`]. Units are
// cell sides, and the frame is that of the plane.

impl PoseGrid {
    /// Returns the smallest upright rectangle around the shape in every orientation of the grid, with its anchor at the
    /// origin; in cell sides. None if the shape has no boundary, like a picture of an empty imprint.
    ///
    /// The position of a picture that is placed by its corner is zoomed too. In such a pose, the rectangle has to be
    /// moved by `zoom_x · x0`, `zoom_y · y0`.
    ///
    /// Takes time in proportion to the number of orientations.
    pub fn reach(&self) -> Option<Extent> {
        let extents = (0..self.orientations()).filter_map(|own| Extent::of(&self.at_origin(own)));
        extents.reduce(Extent::union)
    }

    /// Returns the number of poses in which the shape reaches beyond the sensor and is cut off. A sweep of the grid
    /// reports the same number.
    ///
    /// Takes time in proportion to the number of orientations.
    pub fn poses_beyond_sensor(&self) -> u64 {
        let inside = (0..self.orientations()).map(|orientation| {
            let [columns, rows] = self.positions_inside(orientation, DOUBTFUL);
            (columns.end - columns.start) * (rows.end - rows.start)
        });
        self.poses() - inside.sum::<u64>()
    }

    /// Returns the indices of x0 at which the shape keeps within the left and the right side of the sensor, and those of
    /// y0 at which it keeps within the upper and the lower one, or reaches beyond by no more than `margin`.
    pub(crate) fn positions_inside(&self, orientation: u64, margin: f64) -> [Range<u64>; 2] {
        let counts = [self.row_length(), self.rows_per_orientation()];
        let Some(extent) = Extent::of(&self.at_origin(orientation)) else {
            return counts.map(|count| 0..count);
        };
        // Positions grow with their index.
        let inside = |count: u64, low: f64, high: f64, side: u8, at: &dyn Fn(u64) -> f64| {
            let from = first(0..count, |index| low + at(index) >= -margin);
            let end = f64::from(side) + margin;
            from..first(from..count, |index| high + at(index) > end)
        };
        let x = |index| self.offset::<f64>(orientation, index, 0).x;
        let y = |index| self.offset::<f64>(orientation, 0, index).y;
        let (columns, rows) = (self.sensor.columns(), self.sensor.rows());
        [
            inside(counts[0], extent.left, extent.right, columns, &x),
            inside(counts[1], extent.top, extent.bottom, rows, &y),
        ]
    }
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

#[cfg(test)]
mod tests {
    use super::*;
    use crate::figure::{Figure, FigureKind};
    use crate::imprint::Imprint;
    use crate::picture::Picture;
    use crate::touch::Plane;

    fn grid(source: Source, anchor: Anchor) -> PoseGrid {
        let range = |text: &str| text.parse().expect("a range");
        let zoomed = source.kind().is_none();
        let zoom = if zoomed { "0.5:1.5:0.25" } else { "1" };
        let ranges = Ranges::new([
            // At none of these positions is a cell covered exactly by half.
            range("5.013:5.913:0.3"),
            range("6.007:6.507:0.1"),
            range("0:350:50"),
            range(zoom),
            range(zoom),
        ]);
        PoseGrid::new(source, Sensor::default(), anchor, ranges).expect("in range")
    }

    fn picture() -> Source {
        let imprint = Imprint::from_rows([".##.", ".#..", "####"]).expect("rows");
        Source::Picture(Picture::at_home(imprint))
    }

    #[test]
    fn numbers_and_indices_name_the_same_poses() {
        let grid = grid(picture(), Anchor::Corner);
        assert_eq!(grid.counts().into_array(), [4, 6, 8, 5, 5]);
        for number in [0, 1, 4, 23, 24, 191, 192, 4000, grid.poses() - 1] {
            let index = grid.index(number);
            assert_eq!(grid.number(index), number);
            let pose = grid.pose(number);
            for axis in [Axis::X0, Axis::Angle] {
                assert_eq!(pose[axis], grid.ranges()[axis].value(index[axis]));
            }
        }
        let beyond = PoseIndex::new([u64::MAX; 5]);
        assert_eq!(grid.number(beyond), grid.poses() - 1);
    }

    #[test]
    fn a_part_has_the_poses_of_the_whole() {
        let whole = grid(picture(), Anchor::Corner);
        let cut = |from, counts| whole.part(PoseIndex::new(from), PoseIndex::new(counts));
        let from = PoseIndex::new([1, 2, 3, 4, 0]);
        let part = cut(from.into_array(), [2, 3, 1, 1, 2]).expect("it lies inside");
        assert_eq!(part.poses(), 12);
        for number in 0..part.poses() {
            let index = part.index(number);
            let inside = PoseIndex::from_fn(|axis| from[axis] + index[axis]);
            assert_eq!(part.pose(number), whole.pose(whole.number(inside)));
        }
        assert_eq!(cut([3, 0, 0, 0, 0], [2, 1, 1, 1, 1]), None);
        assert_eq!(cut([0; 5], [0, 1, 1, 1, 1]), None);
        assert_eq!(cut([u64::MAX; 5], [1; 5]), None);
    }

    #[test]
    fn a_pose_can_be_touched_by_itself() {
        let triangle = Source::Figure(Figure::default_of(FigureKind::Triangle, &Sensor::default()));
        for (source, anchor) in [
            (triangle.clone(), Anchor::Corner),
            (triangle, Anchor::Centre),
            (picture(), Anchor::Corner),
            (picture(), Anchor::Centre),
        ] {
            let grid = grid(source, anchor);
            let mut plane = Plane::new(*grid.sensor());
            for number in (0..grid.poses()).step_by(7) {
                let pose = grid.pose(number);
                let source = grid.source_at(pose).expect("inside of the sensor");
                let expected = plane.touch(&grid.placed(number));
                assert_eq!(plane.touch(&source), expected, "{anchor:?} {pose:?}");
                assert!(grid.is_of(&source, grid.sensor()));
            }
        }
    }

    #[test]
    fn a_grid_is_not_one_of_another_shape_or_sensor() {
        let sensor = Sensor::default();
        let hexagon = Figure::default_of(FigureKind::Hexagon, &Sensor::default());
        let grid = grid(Source::Figure(hexagon), Anchor::Corner);
        let with = |parameter, value| {
            Source::Figure(hexagon.with(parameter, value, &sensor).expect("in range"))
        };
        assert!(grid.is_of(&with(Parameter::X0, 1.5), &sensor));
        assert!(grid.is_of(&with(Parameter::Angle, 77.0), &sensor));
        assert!(!grid.is_of(&with(Parameter::Side, 1.5), &sensor));
        assert!(!grid.is_of(&with(Parameter::Thickness, 1.0), &sensor));
        assert!(!grid.is_of(&picture(), &sensor));
        let octagon = Source::Figure(Figure::default_of(FigureKind::Octagon, &Sensor::default()));
        assert!(!grid.is_of(&octagon, &sensor));
        let coarse = sensor.with(Parameter::Threshold, 0.7).expect("in range");
        assert!(!grid.is_of(grid.source(), &coarse));
        let pitch = sensor.with(Parameter::Pitch, 2.5).expect("in range");
        assert!(
            grid.is_of(grid.source(), &pitch),
            "the imprints are the same"
        );
    }

    #[test]
    fn a_shape_is_placed_by_its_corner_or_its_centre() {
        // 6 × 3, with its corner at 5, 5 before it is turned, then with its centre there.
        let [corner, centre] = [Anchor::Corner, Anchor::Centre].map(|anchor| {
            let sensor = Sensor::default();
            let rectangle = Figure::default_of(FigureKind::Rectangle, &sensor).into();
            PoseGrid::new(rectangle, sensor, anchor, Ranges::default()).expect("in range")
        });
        assert_eq!(corner.centre(0), [8.0, 6.5]);
        let first = centre.source_at(centre.pose(0)).expect("in range");
        let place = [Parameter::X0, Parameter::Y0].map(|own| first.get(own));
        assert_eq!(place, [Some(2.0), Some(3.5)]);
    }
}
