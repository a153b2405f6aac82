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
use crate::pose::grid::{GridError, PoseGrid, centre};
use crate::pose::range::DecimalRange;
use crate::sensor::{MAX_SIDE, Sensor};
use crate::source::Source;
use crate::touch::DOUBTFUL;

/// The ranges that the user gave. An axis without a range has its default: for x0 and y0 one cell that suits the shape
/// ([`default_ranges`]), for the others that of [`Ranges::default`].
pub type GivenRanges = PerAxis<Option<DecimalRange>>;

/// The step of a default range, in hundredths of a cell.
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
    let own_zoom = |axis: Axis| {
        let zoom = source.get(axis.parameter()).filter(|_| axis.is_zoom());
        DecimalRange::rounded(zoom?, 12)
    };
    let given = &GivenRanges::from_fn(|axis| given[axis].or_else(|| own_zoom(axis)));
    let reach = Reach::of(source, anchor, given)?;
    let own = match anchor {
        Anchor::Corner => [Parameter::X0, Parameter::Y0].map(|own| source.get(own).unwrap_or(0.0)),
        Anchor::Centre => {
            let centre = centre::<f64>(source);
            [centre.x, centre.y]
        }
    };
    let cell = own.map(|at| hundredths((at + DOUBTFUL).floor() * 100.0));
    Ok(reach.ranges(sensor, given, FINE, Some(cell)))
}

/// Returns the ranges in which a figure without a position is swept. If x0 or y0 is not given, it gets the paper's cell
/// ([`Ranges::default`]) if the sensor cuts nothing off there; otherwise the cell around the middle in
/// which it is not cut off at any given angle.
///
/// # Errors
/// Returns an error if a given range exceeds that of its parameter, or zooms other than 1 are given.
pub fn figure_ranges(
    figure: &Source,
    sensor: &Sensor,
    anchor: Anchor,
    given: &GivenRanges,
) -> Result<Ranges, GridError> {
    check_given(given, sensor)?;
    let reach = Reach::of(figure, anchor, given)?;
    let is_clear = |axis: Axis, side| {
        let cut = given[axis].map(|positions| reach.cut(axis, side, positions));
        cut.is_none_or(|cut| cut == [false; 2])
    };
    let is_clear = sides_of(sensor)
        .iter()
        .all(|&(axis, side)| is_clear(axis, side));
    Ok(reach.ranges(sensor, given, FINE, is_clear.then_some([500; 2])))
}

/// The sides of the sensors to choose from. If no side is given, the sensors are square.
#[derive(Clone, Copy, Debug)]
pub struct SensorSides {
    /// The number of columns, if it is given.
    pub columns: Option<u8>,
    /// The number of rows, if it is given.
    pub rows: Option<u8>,
    /// The smallest length of a side that is not given.
    pub least: u8,
}

impl SensorSides {
    /// Creates sides of which none is given.
    pub fn at_least(least: u8) -> Self {
        Self {
            columns: None,
            rows: None,
            least,
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
}

/// Returns the axes of positions, and the sides of a sensor along them.
fn sides_of(sensor: &Sensor) -> [(Axis, u8); 2] {
    [(Axis::X0, sensor.columns()), (Axis::Y0, sensor.rows())]
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

/// Returns true if a sensor allows the given positions and the sizes of the shapes; they may be too large for a small
/// one even if the shapes fit on it.
fn allows(sensor: &Sensor, given: &GivenRanges, sources: &[&Source]) -> bool {
    let is_allowed = |source: &Source| {
        let own = source.parameters().iter();
        let mut sizes = own.filter(|own| Axis::ALL.iter().all(|axis| axis.parameter() != **own));
        sizes.all(|&size| {
            let value = source.get(size);
            value.is_none_or(|value| sensor.check(size, value).is_ok())
        })
    };
    check_given(given, sensor).is_ok() && sources.iter().all(|source| is_allowed(source))
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
        let ranges = Ranges::from_fn(|axis| match axis {
            // The position does not matter, but a given one must be in range.
            Axis::X0 | Axis::Y0 => given[axis].unwrap_or(DecimalRange::whole(0)),
            _ => filled(given)[axis],
        });
        let grid = PoseGrid::new(source.clone(), Sensor::LARGEST, anchor, ranges)?;
        let mut reaches: Vec<(Extent, [f64; 2])> = Vec::new();
        for orientation in 0..grid.orientations() {
            let Some(extent) = Extent::of(&grid.at_origin(orientation)) else {
                continue;
            };
            let zooms = grid.zooms_of_anchor(orientation);
            match reaches.last_mut() {
                Some((known, same)) if *same == zooms => *known = known.union(extent),
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

    /// Returns the smallest sensor with these sides on which no shape is cut off in any pose, and the ranges of these
    /// poses: if x0 or y0 is not given, one cell around the middle that is the same for all shapes, in steps of
    /// `step` hundredths. `sources` are the shapes. The sensor has the default threshold and pitch. None if there is no
    /// such sensor.
    pub fn smallest_sensor(
        &self,
        sources: &[&Source],
        given: &GivenRanges,
        sides: SensorSides,
        step: u32,
    ) -> Option<(Sensor, Ranges)> {
        let (sensor, ranges) = self.best_sensor(sources, given, sides, step);
        let is_cut = |&(axis, side): &(Axis, u8)| self.cut(axis, side, ranges[axis]) != [false; 2];
        let is_held = !sides_of(&sensor).iter().any(is_cut) && allows(&sensor, given, sources);
        is_held.then_some((sensor, ranges))
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
        let at = |sensor: Sensor| (sensor, self.ranges(&sensor, given, step, None));
        let is_enough = |(sensor, ranges): &(Sensor, Ranges)| {
            let gains = |(axis, side)| {
                // Parts cut off at the left or the top are so on every sensor, unless the position is chosen together
                // with the sensor.
                let [start, end] = self.cut(axis, side, ranges[axis]);
                end || start && given[axis].is_none()
            };
            let [along_x, along_y] = sides_of(sensor);
            let gains_columns = sides.columns.is_none() && gains(along_x);
            let gains_rows = sides.rows.is_none() && gains(along_y);
            !gains_columns && !gains_rows && allows(sensor, given, sources)
        };
        let mut enough = sides.sensors().map(at).filter(is_enough);
        enough.next().unwrap_or_else(|| at(sides.largest()))
    }

    /// Returns the given ranges, which the sensor must allow, with one cell for a position that is not given: the one
    /// that starts at `own`, in hundredths, if there is one and nothing is cut off in it; otherwise the one around the
    /// middle.
    fn ranges(
        &self,
        sensor: &Sensor,
        given: &GivenRanges,
        step: u32,
        own: Option<[i64; 2]>,
    ) -> Ranges {
        let sides = sides_of(sensor).into_iter().zip([0, 1]);
        let asked: Vec<_> = sides
            .filter(|((axis, _), _)| given[*axis].is_none())
            .collect();
        // The first and the last start of a cell that the sensor allows, in hundredths.
        let end = i64::from(sensor.side()) * 100;
        let (low, high) = (-end, end - i64::from(100 - step));
        let is_free = |own: &[i64; 2]| {
            asked.iter().all(|&((axis, side), index)| {
                let free = self.free(axis, side, step);
                free.contains(&own[index]) && (low..=high).contains(&own[index])
            })
        };
        let own = own.filter(is_free);
        let mut ranges = filled(given);
        for &((axis, side), index) in &asked {
            let start = own.map_or_else(|| self.middle(axis, side, step), |own| own[index]);
            let start = start.clamp(low, high);
            ranges[axis] = DecimalRange::from_units(start, step.into(), 2, (100 / step).into());
        }
        ranges
    }

    /// Returns the first and the last position at which nothing is cut off. The last is below the first if something is
    /// cut off at every position. Without a shape, only the sensor limits the positions.
    fn limits(&self, axis: Axis, side: u8) -> (f64, f64) {
        let end = f64::from(side);
        let limits = self.0.iter().map(|(extent, [zoom_x, zoom_y])| match axis {
            Axis::Y0 => (-extent.top / zoom_y, (end - extent.bottom) / zoom_y),
            _ => (-extent.left / zoom_x, (end - extent.right) / zoom_x),
        });
        limits
            .reduce(|one, other| (one.0.max(other.0), one.1.min(other.1)))
            .unwrap_or((0.0, end))
    }

    /// Returns whether something is cut off at the left (or at the top), and at the right (or at the bottom), with the
    /// anchor at some of these positions.
    fn cut(&self, axis: Axis, side: u8, positions: DecimalRange) -> [bool; 2] {
        let (low, high) = self.limits(axis, side);
        [
            positions.value(0) < low - DOUBTFUL,
            positions.last() > high + DOUBTFUL,
        ]
    }

    /// Returns the positions, in hundredths, from which one cell of positions lies within the limits.
    fn free(&self, axis: Axis, side: u8, step: u32) -> std::ops::RangeInclusive<i64> {
        let (low, high) = self.limits(axis, side);
        // A limit that differs from a hundredth only by rounding counts as that hundredth.
        let from = (low * 100.0 - 1e-9) / f64::from(step);
        let to = (high * 100.0 + 1e-9) / f64::from(step);
        multiple(from.ceil(), step)..=multiple(to.floor(), step) - i64::from(100 - step)
    }

    /// Returns the position, in hundredths, at which the cell around the middle starts.
    fn middle(&self, axis: Axis, side: u8, step: u32) -> i64 {
        let (low, high) = self.limits(axis, side);
        let free = self.free(axis, side, step);
        // If two positions are equally near, the lower one is taken.
        let middle = ((low + high) * 50.0 - 50.0 - 1e-9) / f64::from(step);
        let middle = multiple(middle.ceil(), step);
        if free.is_empty() {
            return middle;
        }
        let near = middle.clamp(*free.start(), *free.end());
        let down = near.div_euclid(100) * 100;
        let whole = [down, down + 100]
            .into_iter()
            .filter(|start| free.contains(start));
        let nearest = whole.min_by_key(|start| (start - middle).abs());
        nearest.unwrap_or(near)
    }
}

fn filled(given: &GivenRanges) -> Ranges {
    let default = Ranges::default();
    Ranges::from_fn(|axis| given[axis].unwrap_or(default[axis]))
}

fn multiple(count: f64, step: u32) -> i64 {
    hundredths(count).saturating_mul(step.into())
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
    fn a_shape_stays_in_its_cell_unless_it_is_cut_off_there()
    -> Result<(), Box<dyn std::error::Error>> {
        use crate::pose::{GivenRanges, Reach, SensorSides, default_ranges, figure_ranges};
        use crate::prelude::*;
        let sensor = Sensor::default();
        let given = GivenRanges::default();
        let washer = Figure::ellipse(4.0, 4.0).at(1.99, 1.47).on(&sensor)?;
        let ranges = default_ranges(&washer.into(), &sensor, Anchor::Corner, &given)?;
        assert_eq!(ranges[Axis::X0].to_string(), "1:1.99:0.01");
        // A picture keeps its zooms.
        let bar = Source::from(Picture::at_home("###".parse().expect("a row")))
            .with(Parameter::ZoomX, 0.5, &sensor)?
            .with(Parameter::ZoomY, 2.0, &sensor)?;
        let ranges = default_ranges(&bar, &sensor, Anchor::Centre, &given)?;
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
        let set = [&triangle, &disc];
        let reach = Reach::of_all(set, Anchor::Centre, &all_angles)?;
        let fit = reach.smallest_sensor(&set, &all_angles, SensorSides::at_least(16), 1);
        let (sensor, ranges) = fit.expect("it fits on 64 × 64");
        // Its corners move on a circle of radius 6.8, and its centre moves within one cell.
        assert_eq!((sensor.columns(), sensor.rows()), (16, 16));
        assert_eq!(ranges[Axis::X0].to_string(), "7:7.99:0.01");
        let grid = PoseGrid::new(triangle, sensor, Anchor::Centre, ranges)?;
        assert_eq!(grid.poses_beyond_sensor(), 0);
        Ok(())
    }
}
