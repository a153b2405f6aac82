//! The positions at which a shape is swept if none are given, and the smallest sensor for them.
//!
//! They are a convention of this project. If x0 or y0 is not given, a sweep takes one cell of positions, in steps of a
//! hundredth of a cell unless another step is requested. For a shape that has a position ([`default_ranges`]), it is the
//! cell in which the shape lies (1.99 lies in `1:1.99:0.01`); for a figure that has none, as on the command line
//! ([`figure_ranges`]), it is the paper's cell. If the sensor cuts something off there, it takes the cell nearest to the
//! middle among those in which nothing is cut off, starting at a whole number if possible. If something is cut off in
//! every cell, it takes the middle of the sensor. All positions are multiples of the step, so that large and small
//! shapes are touched at the same positions within a cell.

use crate::geometry::Extent;
use crate::parameter::Parameter;
use crate::pose::axis::{Anchor, Axis, PerAxis, Ranges};
use crate::pose::grid::{GridError, PoseGrid, centre, union};
use crate::pose::range::DecimalRange;
use crate::sensor::{MAX_SIDE, Sensor};
use crate::source::Source;
use crate::touch::DOUBTFUL;

/// The ranges that the user gave. An axis without a range has its default: for x0 and y0 one cell that suits the shape
/// ([`default_ranges`]), for the others that of [`Ranges::default`].
pub type GivenRanges = PerAxis<Option<DecimalRange>>;

/// The side of a cell in hundredths. A step from one position to the next divides it.
const CELL: u32 = 100;

/// The step of a default range, in hundredths.
const FINE: u32 = 1;

/// Returns the ranges of a sweep of `source`, with defaults for those that are not given: for x0 and y0, the cell in
/// which the shape lies if no pose is cut off there, otherwise one around the middle.
///
/// The shape's own position matters. Its zoom is kept if that axis has no range; its angle matters only if it is in
/// the ranges. Given ranges stay as they are.
///
/// # Errors
/// Returns an error if a given range exceeds that of its parameter, or a figure has zooms other than 1.
pub fn default_ranges(
    source: &Source,
    sensor: &Sensor,
    anchor: Anchor,
    given: &GivenRanges,
) -> Result<Ranges, GridError> {
    check_given(given, sensor)?;
    let given = &GivenRanges::from_fn(|axis| given[axis].or_else(|| own_zoom(source, axis)));
    let reach = Reach::of(source, anchor, given)?;
    let (x, y) = own_position(source, anchor);
    let axes = [
        (Axis::X0, x, sensor.columns()),
        (Axis::Y0, y, sensor.rows()),
    ];
    let mut asked = axes.into_iter().filter(|(axis, ..)| given[*axis].is_none());
    let own = asked.all(|(axis, at, side)| {
        let free = reach.free(axis, side, FINE);
        let start = hundredths((at + DOUBTFUL).floor() * 100.0);
        free.contains(&start) && start >= -limit(sensor) && start + beyond(FINE) <= limit(sensor)
    });
    let mut ranges = filled(given);
    for (axis, at, side) in axes {
        if given[axis].is_none() {
            let start = if own {
                hundredths((at + DOUBTFUL).floor() * 100.0)
            } else {
                reach.middle(axis, side, FINE)
            };
            ranges[axis] = cell_from(start, sensor, FINE);
        }
    }
    Ok(ranges)
}

/// Returns the ranges in which a figure without a position is swept. If x0 or y0 is not given, it gets the paper's cell
/// ([`Ranges::default`]) if the sensor cuts nothing off there; otherwise the cell of [`common_ranges`].
///
/// # Errors
/// Returns an error if a given range exceeds that of its parameter, or zooms other than 1 are given.
pub fn figure_ranges(
    figure: &Source,
    sensor: &Sensor,
    anchor: Anchor,
    given: &GivenRanges,
) -> Result<Ranges, GridError> {
    let ranges = filled(given);
    match PoseGrid::new(figure.clone(), *sensor, anchor, ranges) {
        Ok(grid) if grid.poses_beyond_sensor() == 0 => Ok(ranges),
        _ => common_ranges([figure], sensor, anchor, given),
    }
}

/// Returns the ranges in which several shapes are swept on the same sensor. If x0 or y0 is not given, it gets the cell
/// around the middle in which none of the shapes is cut off at any requested angle.
///
/// If there is no such cell, the positions put the middle of the common reach in the middle of the sensor.
/// [`PoseGrid::poses_beyond_sensor`] then returns how many poses of a shape are cut off.
///
/// # Errors
/// Returns an error if a given range exceeds that of its parameter, or a figure has zooms other than 1.
pub fn common_ranges<'a>(
    sources: impl IntoIterator<Item = &'a Source>,
    sensor: &Sensor,
    anchor: Anchor,
    given: &GivenRanges,
) -> Result<Ranges, GridError> {
    check_given(given, sensor)?;
    Ok(Reach::of_all(sources, anchor, given)?.ranges(sensor, given, FINE))
}

/// Returns the smallest square sensor of at least `least` × `least` taxels (`least` is moved into 1 to 64) on which no
/// shape is cut off in any pose, and the ranges of these poses: if x0 or y0 is not given, one cell around the middle
/// that is the same for all shapes. The sensor has the default threshold and pitch. None if even 64 × 64 taxels are too
/// few.
///
/// Recognition sets `least` to 16, so that a set of small shapes is swept on the same sensor as other sets.
///
/// # Errors
/// Returns an error if a given range exceeds that of its parameter on the largest sensor, or a figure has zooms
/// other than 1.
pub fn smallest_sensor<'a>(
    sources: impl IntoIterator<Item = &'a Source>,
    anchor: Anchor,
    given: &GivenRanges,
    least: u8,
) -> Result<Option<(Sensor, Ranges)>, GridError> {
    let sources: Vec<&Source> = sources.into_iter().collect();
    let reach = Reach::of_all(sources.iter().copied(), anchor, given)?;
    let sides = SensorSides::at_least(least);
    Ok(reach.smallest_sensor(&sources, given, sides, FINE))
}

/// The sides of the sensors to choose from: the given sides, and the smallest length of the others. If no side is
/// given, the sensors are square.
#[derive(Clone, Copy, Debug)]
pub struct SensorSides {
    columns: Option<u8>,
    rows: Option<u8>,
    least: u8,
}

impl SensorSides {
    /// Creates sides of which none is given.
    pub fn at_least(least: u8) -> Self {
        Self {
            columns: None,
            rows: None,
            least: least.clamp(1, MAX_SIDE),
        }
    }

    /// Sets the sides along the given axes to those of `sensor`.
    #[must_use]
    pub fn with_sides_of(self, sensor: &Sensor, is_given: impl Fn(Axis) -> bool) -> Self {
        Self {
            columns: is_given(Axis::X0).then(|| sensor.columns()),
            rows: is_given(Axis::Y0).then(|| sensor.rows()),
            ..self
        }
    }

    /// Returns the largest sensor with these sides.
    pub fn largest(self) -> Sensor {
        self.sensors().last().unwrap_or(Sensor::LARGEST)
    }

    /// Iterates over the sensors with these sides, from the smallest to the largest.
    fn sensors(self) -> impl Iterator<Item = Sensor> {
        let sides = self.least..=MAX_SIDE;
        sides.filter_map(move |side| {
            Sensor::new(self.columns.unwrap_or(side), self.rows.unwrap_or(side)).ok()
        })
    }

    fn given(self, axis: Axis) -> Option<u8> {
        match axis {
            Axis::Y0 => self.rows,
            _ => self.columns,
        }
    }
}

/// Returns the axes of positions, and the sides of a sensor along them.
fn plane_axes(sensor: &Sensor) -> [(Axis, u8); 2] {
    [(Axis::X0, sensor.columns()), (Axis::Y0, sensor.rows())]
}

/// Returns true if a sensor allows the given positions and the sizes of the shapes; they may be too large for a small
/// one.
fn allows(sensor: &Sensor, given: &GivenRanges, sources: &[&Source]) -> bool {
    check_given(given, sensor).is_ok() && sources.iter().all(|source| is_allowed(source, sensor))
}

/// Returns true if the sizes of a shape are in range on a sensor. They may be too large even if the shape fits on it.
fn is_allowed(source: &Source, sensor: &Sensor) -> bool {
    let own = source.parameters();
    own.iter().all(|parameter| {
        let placed = Axis::ALL.iter().any(|axis| axis.parameter() == *parameter);
        let value = source.get(*parameter).filter(|_| !placed);
        value.is_none_or(|value| sensor.check(*parameter, value).is_ok())
    })
}

/// Checks the given ranges.
///
/// # Errors
/// Returns an error if one exceeds the range of its parameter.
pub fn check_given(given: &GivenRanges, sensor: &Sensor) -> Result<(), GridError> {
    for (axis, range) in given.iter() {
        if let Some(range) = range {
            sensor.check(axis.parameter(), range.value(0))?;
            sensor.check(axis.parameter(), range.last())?;
        }
    }
    Ok(())
}

/// The reach of shapes from their anchor, for each pair of zooms, since positions of a picture are zoomed with it.
///
/// In the methods, `step` is the distance from one position in a cell to the next, in hundredths; it divides 100.
#[derive(Clone, Debug, Default)]
pub struct Reach(Vec<(Extent, [f64; 2])>);

impl Reach {
    /// Computes the reach of a shape at the given angles and zooms.
    pub(crate) fn of(
        source: &Source,
        anchor: Anchor,
        given: &GivenRanges,
    ) -> Result<Self, GridError> {
        let mut ranges = filled(given);
        // The position does not matter, but a given one must be in range.
        for axis in [Axis::X0, Axis::Y0] {
            if given[axis].is_none() {
                ranges[axis] = DecimalRange::whole(0);
            }
        }
        let grid = PoseGrid::new(source.clone(), Sensor::LARGEST, anchor, ranges)?;
        let mut reaches: Vec<(Extent, [f64; 2])> = Vec::new();
        for (orientation, extent) in (0..).zip(grid.extents()) {
            let Some(extent) = extent else { continue };
            let pose = grid.first_pose(orientation);
            let zooms = match (anchor, source) {
                (Anchor::Corner, Source::Picture(_)) => [pose[Axis::ZoomX], pose[Axis::ZoomY]],
                _ => [1.0; 2],
            };
            match reaches.last_mut() {
                Some((known, same)) if *same == zooms => *known = union(*known, extent),
                _ => reaches.push((extent, zooms)),
            }
        }
        Ok(Self(reaches))
    }

    /// Computes the reach of several shapes together.
    ///
    /// # Errors
    /// Returns an error if a given range exceeds that of its parameter, or a figure has zooms other than 1.
    pub fn of_all<'a>(
        sources: impl IntoIterator<Item = &'a Source>,
        anchor: Anchor,
        given: &GivenRanges,
    ) -> Result<Self, GridError> {
        let mut all = Self::default();
        for source in sources {
            all.add(Self::of(source, anchor, given)?);
        }
        Ok(all)
    }

    pub(crate) fn add(&mut self, mut other: Self) {
        self.0.append(&mut other.0);
    }

    /// Returns the smallest sensor with these sides that cuts nothing off, and the ranges on it, like
    /// [`smallest_sensor`]; `sources` are the shapes. None if there is no such sensor.
    pub fn smallest_sensor(
        &self,
        sources: &[&Source],
        given: &GivenRanges,
        sides: SensorSides,
        step: u32,
    ) -> Option<(Sensor, Ranges)> {
        let best = self.best_sensor(sources, given, sides, step);
        let is_held = |(sensor, ranges): &(Sensor, Ranges)| {
            let mut axes = plane_axes(sensor).into_iter();
            let holds = axes.all(|(axis, side)| {
                self.clears_start(axis, ranges[axis]) && self.clears_end(axis, side, ranges[axis])
            });
            holds && allows(sensor, given, sources)
        };
        Some(best).filter(is_held)
    }

    /// Returns the smallest sensor with these sides that cuts off no more than any larger one would, and the ranges on
    /// it; the largest sensor if each larger one cuts off less. If nothing has to be cut off, nothing is.
    pub fn best_sensor(
        &self,
        sources: &[&Source],
        given: &GivenRanges,
        sides: SensorSides,
        step: u32,
    ) -> (Sensor, Ranges) {
        let at = |sensor: Sensor| (sensor, self.ranges(&sensor, given, step));
        let is_enough = |(sensor, ranges): &(Sensor, Ranges)| {
            let mut axes = plane_axes(sensor).into_iter();
            let gains_nothing = axes.all(|(axis, side)| {
                // Parts cut off at the left or the top are so on every sensor, unless the position is chosen together
                // with the sensor.
                sides.given(axis).is_some()
                    || self.clears_end(axis, side, ranges[axis])
                        && (given[axis].is_some() || self.clears_start(axis, ranges[axis]))
            });
            gains_nothing && allows(sensor, given, sources)
        };
        let mut enough = sides.sensors().map(at).filter(is_enough);
        enough.next().unwrap_or_else(|| at(sides.largest()))
    }

    /// Returns the given ranges, which the sensor must allow, with one cell around the middle for a position that is
    /// not given.
    pub(crate) fn ranges(&self, sensor: &Sensor, given: &GivenRanges, step: u32) -> Ranges {
        let mut ranges = filled(given);
        for (axis, side) in plane_axes(sensor) {
            if given[axis].is_none() {
                ranges[axis] = cell_from(self.middle(axis, side, step), sensor, step);
            }
        }
        ranges
    }

    /// Iterates over the reach along an axis: its start, its end, and the zoom of the position.
    fn along(&self, axis: Axis) -> impl Iterator<Item = (f64, f64, f64)> + '_ {
        self.0
            .iter()
            .map(move |(extent, [zoom_x, zoom_y])| match axis {
                Axis::Y0 => (extent.top, extent.bottom, *zoom_y),
                _ => (extent.left, extent.right, *zoom_x),
            })
    }

    /// Returns true if nothing is cut off at the left (or at the top) with the anchor at any of these positions.
    fn clears_start(&self, axis: Axis, positions: DecimalRange) -> bool {
        let mut all = self.along(axis);
        all.all(|(low, _, zoom)| low + zoom * positions.value(0) >= -DOUBTFUL)
    }

    /// Returns true if nothing is cut off at the right (or at the bottom) of a sensor with this side, with the anchor
    /// at any of these positions.
    fn clears_end(&self, axis: Axis, side: u8, positions: DecimalRange) -> bool {
        let end = f64::from(side) + DOUBTFUL;
        let mut all = self.along(axis);
        all.all(|(_, high, zoom)| high + zoom * positions.last() <= end)
    }

    /// Returns the first and the last position at which nothing is cut off. The last is below the first if something is
    /// cut off at every position. Without a shape, only the sensor limits the positions.
    fn limits(&self, axis: Axis, side: u8) -> (f64, f64) {
        let end = f64::from(side);
        let all = self.along(axis);
        let limits = all.map(|(low, high, zoom)| (-low / zoom, (end - high) / zoom));
        limits
            .reduce(|one, other| (one.0.max(other.0), one.1.min(other.1)))
            .unwrap_or((0.0, end))
    }

    /// Returns the positions, in hundredths, from which one cell of positions lies within the limits.
    fn free(&self, axis: Axis, side: u8, step: u32) -> std::ops::RangeInclusive<i64> {
        let (low, high) = self.limits(axis, side);
        // A limit that differs from a hundredth only by rounding counts as that hundredth.
        let from = (low * 100.0 - 1e-9) / f64::from(step);
        let to = (high * 100.0 + 1e-9) / f64::from(step);
        multiple(from.ceil(), step)..=multiple(to.floor(), step) - beyond(step)
    }

    /// Returns the position, in hundredths, at which the cell around the middle starts.
    fn middle(&self, axis: Axis, side: u8, step: u32) -> i64 {
        let (low, high) = self.limits(axis, side);
        let free = self.free(axis, side, step);
        // If two positions are equally near, the lower one is taken.
        let middle = ((low + high) * 50.0 - f64::from(CELL) / 2.0 - 1e-9) / f64::from(step);
        let middle = multiple(middle.ceil(), step);
        if free.is_empty() {
            return middle;
        }
        let near = middle.clamp(*free.start(), *free.end());
        let down = near.div_euclid(100) * 100;
        let whole = [down, down + 100]
            .into_iter()
            .filter(|start| free.contains(start));
        whole
            .min_by_key(|start| (start - middle).abs())
            .unwrap_or(near)
    }
}

/// Returns the position of the anchor of a shape in its own pose.
fn own_position(source: &Source, anchor: Anchor) -> (f64, f64) {
    match anchor {
        Anchor::Corner => {
            let own = |parameter| source.get(parameter).unwrap_or(0.0);
            (own(Parameter::X0), own(Parameter::Y0))
        }
        Anchor::Centre => {
            let upright = source.clone().with(Parameter::Angle, 0.0, &Sensor::LARGEST);
            let centre = centre::<f64>(upright.as_ref().unwrap_or(source));
            (centre.x, centre.y)
        }
    }
}

/// Returns the zoom of a shape along the axis of that zoom, as a range; None for other axes and other shapes.
fn own_zoom(source: &Source, axis: Axis) -> Option<DecimalRange> {
    let zoom = match axis {
        Axis::ZoomX | Axis::ZoomY => source.get(axis.parameter()),
        Axis::X0 | Axis::Y0 | Axis::Angle => None,
    };
    DecimalRange::rounded(zoom?, 12)
}

fn filled(given: &GivenRanges) -> Ranges {
    let default = Ranges::default();
    Ranges::from_fn(|axis| given[axis].unwrap_or(default[axis]))
}

fn multiple(count: f64, step: u32) -> i64 {
    hundredths(count).saturating_mul(step.into())
}

/// Returns how far the last position of a cell lies beyond its first one, in hundredths.
fn beyond(step: u32) -> i64 {
    i64::from(CELL - step)
}

/// Returns one cell of positions from `start` on, in hundredths, moved so that the sensor allows all of them.
fn cell_from(start: i64, sensor: &Sensor, step: u32) -> DecimalRange {
    let limit = limit(sensor);
    let start = start.clamp(-limit, limit - beyond(step));
    DecimalRange::from_units(start, step.into(), 2, u64::from(CELL / step))
}

/// Returns the largest position that a sensor allows, in hundredths of a cell.
fn limit(sensor: &Sensor) -> i64 {
    i64::from(sensor.side()) * 100
}

#[expect(
    clippy::cast_possible_truncation,
    reason = "saturates: positions are at most a few thousand hundredths"
)]
fn hundredths(value: f64) -> i64 {
    value as i64
}

#[cfg(test)]
mod tests {
    #[test]
    fn examples_of_default_ranges() -> Result<(), Box<dyn std::error::Error>> {
        use crate::pose::{GivenRanges, default_ranges, figure_ranges, smallest_sensor};
        use crate::prelude::*;
        let sensor = Sensor::default();
        let given = GivenRanges::default();
        let washer = Figure::ellipse(4.0, 4.0).at(1.99, 1.47).on(&sensor)?;
        let ranges = default_ranges(&washer.into(), &sensor, Anchor::Corner, &given)?;
        assert_eq!(ranges[Axis::X0].to_string(), "1:1.99:0.01");
        // A picture keeps its zooms.
        let bar = Picture::of("###".parse().expect("a row"))
            .zoom(0.5, 2.0)
            .on(&sensor)?;
        let ranges = default_ranges(&bar.into(), &sensor, Anchor::Centre, &given)?;
        assert_eq!(
            (
                ranges[Axis::ZoomX].to_string(),
                ranges[Axis::ZoomY].to_string()
            ),
            ("0.5".into(), "2".into())
        );
        // A square of 10 that lies there is cut off when it turns.
        let square = Figure::rectangle(10.0, 10.0).at(1.99, 1.47).on(&sensor)?;
        let ranges = default_ranges(&square.into(), &sensor, Anchor::Corner, &given)?;
        assert_eq!(ranges[Axis::X0].to_string(), "2.5:3.49:0.01");
        let given = GivenRanges::default();
        let bar = Figure::rectangle(6.0, 3.0).on(&Sensor::default())?;
        let ranges = figure_ranges(&bar.into(), &Sensor::default(), Anchor::Corner, &given)?;
        assert_eq!(ranges[Axis::X0].to_string(), "5:5.99:0.01");
        // A smaller sensor would cut it off there.
        let sensor = Sensor::new(10, 10)?;
        let bar = Figure::rectangle(6.0, 3.0).on(&sensor)?;
        let ranges = figure_ranges(&bar.into(), &sensor, Anchor::Corner, &given)?;
        assert_eq!(ranges[Axis::X0].to_string(), "1:1.99:0.01");
        let triangle = Source::from(Figure::triangle(11.77).on(&Sensor::default())?);
        let disc = Source::from(Figure::ellipse(3.09, 3.09).on(&Sensor::default())?);
        let all_angles = GivenRanges::default();
        let fit = smallest_sensor([&triangle, &disc], Anchor::Centre, &all_angles, 16)?;
        let (sensor, ranges) = fit.expect("it fits on 64 × 64");
        // Its corners move on a circle of radius 6.8, and its centre moves within one cell.
        assert_eq!((sensor.columns(), sensor.rows()), (16, 16));
        assert_eq!(ranges[Axis::X0].to_string(), "7:7.99:0.01");
        let grid = PoseGrid::new(triangle, sensor, Anchor::Centre, ranges)?;
        assert_eq!(grid.poses_beyond_sensor(), 0);
        Ok(())
    }
}
