use std::fmt;

use rayon::prelude::*;

use crate::atlas::{ImprintKey, KeyTable};
use crate::figure::{Figure, FigureBuilder, FigureKind};
use crate::parameter::number::grouped;
use crate::pose::{
    Anchor, Axis, DecimalRange, GivenRanges, GridError, PoseGrid, Ranges, Reach, SensorSides,
};
use crate::progress::{Progress, ToTheEnd};
use crate::recognition::model::{
    Gathered, Model, ModelError, ModelHead, NamedShape, ShapeCount, check_shapes,
};
use crate::sensor::Sensor;
use crate::source::Source;
use crate::sweep::{CountedImprints, Shard, Sweep};

/// The smallest side of a sensor that a training chooses by itself: the side of the paper's sensor.
pub const LEAST_SIDE: u8 = 16;

/// A training to run: shapes, a sensor and the poses in which each shape touches it.
///
/// It uses rayon's current thread pool; the model is the same for any number of threads.
///
/// ```
/// use taxel_core::prelude::*;
/// use taxel_core::recognition::{NamedShape, Training};
///
/// let sensor = Sensor::default();
/// let shapes = [
///     NamedShape::new("square", Figure::rectangle(4.0, 4.0).on(&sensor)?),
///     NamedShape::new("bar", Figure::rectangle(8.0, 2.0).on(&sensor)?),
/// ];
/// let ranges = Ranges::default().with(Axis::Angle, "0:345:15".parse()?);
/// let model = Training::new(shapes, sensor, Anchor::Centre, ranges)?.run()?;
/// assert_eq!(model.poses(), 24 * 100 * 100);
///
/// let touch: Imprint = "####\n####\n####\n####".parse()?;
/// assert_eq!(model.counts_of(&touch)[0].shape, 0);
/// # Ok::<(), Box<dyn std::error::Error>>(())
/// ```
#[derive(Clone)]
#[must_use = "nothing is trained before `run`"]
pub struct Training<'a> {
    /// The grid of poses of each shape, in the order of the set.
    pub grids: Vec<PoseGrid>,
    /// The shapes of the set, in order.
    pub shapes: Vec<NamedShape>,
    allow_cut: bool,
    shard: Shard,
    progress: &'a dyn Progress,
}

impl fmt::Debug for Training<'_> {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.debug_struct("Training")
            .field("shapes", &self.shapes)
            .field("allow_cut", &self.allow_cut)
            .field("shard", &self.shard)
            .finish_non_exhaustive()
    }
}

/// The error of a training.
#[derive(Clone, Debug, PartialEq, thiserror::Error)]
pub enum TrainingError {
    /// An invalid set: it has no shape or more than 32,768; a name is missing, given twice, longer than 64 characters
    /// or has a control character; or a weight is 0.
    #[error(transparent)]
    Set(#[from] ModelError),
    /// A shape that cannot be touched in these poses.
    #[error("{name}: {error}")]
    Grid {
        /// The name of the shape.
        name: String,
        /// The problem with its poses.
        error: GridError,
    },
    /// Poses that the sensor cuts off, so that imprints depend on its rim. [`Training::fitting`] finds a sensor that
    /// cuts nothing off, and [`Training::allow_cut`] accepts such poses.
    #[error(
        "{name}: the {columns} × {rows} sensor cuts off {} of {} poses",
        grouped(*cut), grouped(*poses)
    )]
    Cut {
        /// The name of the first shape with such poses.
        name: String,
        /// Columns of the sensor.
        columns: u8,
        /// Rows of the sensor.
        rows: u8,
        /// The number of poses that are cut off.
        cut: u64,
        /// The number of poses of the shape.
        poses: u64,
    },
    /// Shapes that no sensor holds in every angle.
    #[error("the shapes do not fit on 64 × 64 taxels in every angle")]
    Large,
    /// The training was stopped.
    #[error("stopped before the end")]
    Stopped,
}

impl TrainingError {
    pub(super) fn grid(name: &str, error: impl Into<GridError>) -> Self {
        Self::Grid {
            name: name.to_owned(),
            error: error.into(),
        }
    }
}

impl<'a> Training<'a> {
    /// Creates a training over a whole grid of poses, the same for each shape.
    ///
    /// # Errors
    /// Returns [`TrainingError::Set`] for an invalid set, or [`TrainingError::Grid`] if a pose is out of range for a
    /// shape.
    pub fn new(
        shapes: impl IntoIterator<Item = NamedShape>,
        sensor: Sensor,
        anchor: Anchor,
        ranges: Ranges,
    ) -> Result<Self, TrainingError> {
        let shapes: Vec<NamedShape> = shapes.into_iter().collect();
        check_shapes(&shapes)?;
        let grids = grids(&shapes, sensor, anchor, ranges)?;
        Ok(Self::of_grids(shapes, grids))
    }

    /// Creates a training in which each shape has its own grid, all with the same number of poses. Its model has the
    /// sensor and the poses of the first grid.
    pub(super) fn of_grids(shapes: Vec<NamedShape>, grids: Vec<PoseGrid>) -> Self {
        Self {
            grids,
            shapes,
            allow_cut: false,
            shard: Shard::WHOLE,
            progress: &ToTheEnd,
        }
    }

    /// Also takes poses that the sensor cuts off. Their imprints depend on the sensor's rim, not on the shape alone.
    pub fn allow_cut(mut self, allow: bool) -> Self {
        self.allow_cut = allow;
        self
    }

    /// Takes only one part of the poses; [`ModelMerge`](crate::recognition::ModelMerge) merges all parts.
    pub fn with_shard(mut self, shard: Shard) -> Self {
        self.shard = shard;
        self
    }

    /// Reports to `progress` from time to time, from any thread, the number of poses done since the last report, which
    /// is 0 within a long row. The training stops when it returns `Break`.
    pub fn with_progress(mut self, progress: &'a dyn Progress) -> Self {
        self.progress = progress;
        self
    }

    /// Returns the number of poses of all shapes together in this shard.
    pub fn poses(&self) -> u64 {
        self.grids.iter().map(|grid| self.shard.poses(grid)).sum()
    }

    /// Returns the head of the model, as if the sensor cut nothing off.
    pub fn head(&self) -> ModelHead {
        let grid = &self.grids[0];
        let (shapes, poses) = (self.shapes.clone(), self.shard.poses(grid));
        let (sensor, ranges) = (*grid.sensor(), *grid.ranges());
        let mut head = ModelHead::new(shapes, sensor, grid.anchor(), ranges, poses);
        head.shard = self.shard;
        head
    }

    /// Runs the training.
    ///
    /// # Errors
    /// Returns [`TrainingError::Cut`] if the sensor cuts off a pose and that is not allowed, or
    /// [`TrainingError::Stopped`].
    pub fn run(self) -> Result<Model, TrainingError> {
        let mut gathered = Gathered::default();
        let mut head = self.head();
        head.cut.clear();
        for (shape, grid) in (0..).zip(&self.grids) {
            let sweep = Sweep::new(grid)
                .with_shard(self.shard)
                .with_progress(self.progress);
            let counted = sweep.count().ok_or(TrainingError::Stopped)?;
            if counted.partly_off > 0 && !self.allow_cut {
                return Err(TrainingError::Cut {
                    name: self.shapes[usize::from(shape)].name.clone(),
                    columns: grid.sensor().columns(),
                    rows: grid.sensor().rows(),
                    cut: counted.partly_off,
                    poses: counted.poses,
                });
            }
            let (keys, counts) = keys_of(&counted);
            for (index, poses) in counts.into_iter().enumerate() {
                gathered.add(keys.get(index), ShapeCount::new(shape, poses));
            }
            head.cut.push(counted.partly_off);
        }
        Ok(gathered.finish(head)?)
    }
}

/// Returns the same grid for each shape.
pub(super) fn grids(
    shapes: &[NamedShape],
    sensor: Sensor,
    anchor: Anchor,
    ranges: Ranges,
) -> Result<Vec<PoseGrid>, TrainingError> {
    let grid = |shape: &NamedShape| {
        let grid = PoseGrid::new(shape.source.clone(), sensor, anchor, ranges);
        grid.map_err(|error| TrainingError::grid(&shape.name, error))
    };
    shapes.iter().map(grid).collect()
}

fn keys_of(counted: &CountedImprints) -> (KeyTable, Vec<u64>) {
    let key = |index| {
        let (imprint, count) = counted.get(index);
        (ImprintKey::of(&imprint), count)
    };
    let imprints = (0..counted.len()).into_par_iter().with_min_len(4096);
    let (mut keys, mut counts) = (KeyTable::default(), Vec::new());
    for (key, count) in imprints.map(key).collect::<Vec<_>>() {
        let slot = keys.intern(key.borrowed());
        if slot == counts.len() {
            counts.push(0);
        }
        counts[slot] += count;
    }
    (keys, counts)
}

/// Returns the seven figures at the default sizes of forms. They cover 7 to 77 cells, so their size alone already tells
/// them apart.
pub fn default_figures() -> Vec<NamedShape> {
    let sensor = Sensor::default();
    let figure =
        |&kind: &FigureKind| NamedShape::new(kind.name(), Figure::default_of(kind, &sensor));
    FigureKind::ALL.iter().map(figure).collect()
}

/// Returns the seven figures, each of about 30 cells: only their form tells them apart.
#[expect(
    clippy::missing_panics_doc,
    reason = "the sizes are constants, and a test reads them all"
)]
pub fn equal_figures() -> Vec<NamedShape> {
    let figures = [
        Figure::ellipse(3.09, 3.09),
        Figure::rectangle(6.0, 5.0),
        Figure::triangle(8.32),
        Figure::pentagon(4.18),
        Figure::hexagon(3.4),
        Figure::heptagon(2.87),
        Figure::octagon(2.49),
    ];
    let shape = |figure: FigureBuilder| {
        let figure = figure.at(4.0, 4.0).on(&Sensor::default());
        let figure = figure.expect("the sizes are in range");
        NamedShape::new(figure.kind().name(), figure)
    };
    figures.map(shape).to_vec()
}

/// The number of positions within a cell in each direction: a divisor of 100, so that steps are whole hundredths.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash)]
pub struct CellPositions(u8);

impl CellPositions {
    /// Hundredths of a cell, as in a sweep.
    pub const FINE: Self = Self(100);

    /// Creates a number of positions; None if it is not a divisor of 100.
    pub fn new(count: u8) -> Option<Self> {
        (count > 0 && 100_u8.is_multiple_of(count)).then_some(Self(count))
    }

    /// Returns the number of positions of ranges that are one cell, with as many in each direction; None for others.
    pub fn of(ranges: &Ranges) -> Option<Self> {
        let of = |axis: Axis| {
            let count = u8::try_from(ranges[axis].count()).ok()?;
            let is_cell = (ranges[axis].step() * f64::from(count) - 1.0).abs() < 1e-9;
            Self::new(count).filter(|_| is_cell)
        };
        let (x, y) = (of(Axis::X0)?, of(Axis::Y0)?);
        (x == y).then_some(x)
    }

    /// Returns the number of positions.
    pub fn get(self) -> u8 {
        self.0
    }

    /// Returns the distance between two positions, in hundredths of a cell.
    pub fn step(self) -> u32 {
        100 / u32::from(self.0)
    }
}

/// The steps of a grid of poses: one cell of positions, and the angles.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct GridSteps {
    /// The number of positions of a cell in each direction.
    pub positions: CellPositions,
    /// The angles in degrees.
    pub angles: DecimalRange,
}

impl GridSteps {
    /// Hundredths of a cell and whole degrees, as in a sweep.
    pub const FINE: Self = Self {
        positions: CellPositions::FINE,
        angles: DecimalRange::from_units(0, 1, 0, 360),
    };

    /// Fifths of a cell and every third degree: one in 1,200 poses of [`Self::FINE`]. Touches between them are fitted.
    pub const COARSE: Self = Self {
        positions: CellPositions(5),
        angles: DecimalRange::from_units(0, 3, 0, 120),
    };

    #[cfg(test)]
    pub(super) fn of(positions: u8, angles: &str) -> Self {
        let positions = CellPositions::new(positions).expect("a divisor of 100");
        let angles = angles.parse().expect("a range");
        Self { positions, angles }
    }
}

impl Training<'_> {
    /// Creates a training on the smallest square sensor, at least 16 × 16, that cuts off none of the shapes in any of
    /// the poses: one cell of positions around its middle, the given angles.
    ///
    /// # Errors
    /// Returns [`TrainingError::Large`] if no sensor is large enough, or the errors of [`Training::new`].
    pub fn fitting(
        shapes: impl IntoIterator<Item = NamedShape>,
        steps: GridSteps,
    ) -> Result<Self, TrainingError> {
        Self::on_a_sensor_like(&Sensor::default(), shapes.into_iter().collect(), steps)
    }

    /// Creates the same training on a sensor that is at least as large as another one and has its threshold.
    pub(super) fn on_a_sensor_like(
        like: &Sensor,
        shapes: Vec<NamedShape>,
        steps: GridSteps,
    ) -> Result<Self, TrainingError> {
        let of_set = |error| TrainingError::grid("the set", error);
        let sources: Vec<&Source> = shapes.iter().map(|shape| &shape.source).collect();
        let given = angles_only(steps.angles);
        let reach = Reach::of_all(sources.iter().copied(), Anchor::Centre, &given);
        let (sensor, ranges) = fit(&reach.map_err(of_set)?, &sources, steps, like.side())?;
        let sensor = sensor.with_threshold(like.threshold());
        let sensor = sensor.map_err(|error| of_set(error.into()))?;
        Self::new(shapes, sensor, Anchor::Centre, ranges)
    }
}

pub(super) fn angles_only(angles: DecimalRange) -> GivenRanges {
    let mut given = GivenRanges::default();
    given[Axis::Angle] = Some(angles);
    given
}

/// Returns the smallest square sensor, of at least `least` columns, that cuts nothing off, and one cell of positions
/// around its middle.
pub(super) fn fit(
    reach: &Reach,
    sources: &[&Source],
    steps: GridSteps,
    least: u8,
) -> Result<(Sensor, Ranges), TrainingError> {
    let sides = SensorSides::at_least(least);
    let angles = angles_only(steps.angles);
    let found = reach.smallest_sensor(sources, &angles, sides, steps.positions.step());
    found.ok_or(TrainingError::Large)
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::recognition::Evaluation;

    #[test]
    fn equal_figures_cover_thirty_cells_and_are_hard_to_tell_apart() {
        let steps = GridSteps::of(10, "0:355:5");
        let training = Training::fitting(equal_figures(), steps).expect("they fit");
        let grid = &training.grids[0];
        assert_eq!(grid.sensor().columns(), 16);
        assert_eq!(grid.ranges()[Axis::X0].to_string(), "7:7.9:0.1");
        assert_eq!(grid.ranges()[Axis::Angle].to_string(), "0:355:5");
        let model = training.run().expect("not stopped");
        assert_eq!((model.poses(), model.cut()), (7200, &[0; 7][..]));
        let error = Evaluation::of(&model).error();
        assert!((0.3..0.35).contains(&error), "{error}");
        for shape in model.shapes() {
            let grid = Training::fitting(vec![shape.clone()], steps).expect("it fits");
            let grid = &grid.grids[0];
            let mut plane = crate::touch::Plane::new(*grid.sensor());
            plane.touch(&grid.placed(0));
            let area: f64 = plane.coverages().values().iter().sum();
            assert!((area - 30.0).abs() < 0.2, "{}: {area}", shape.name);
        }
    }

    #[test]
    fn positions_that_are_not_divisors_are_refused() {
        for positions in [0, 7, 101] {
            assert_eq!(CellPositions::new(positions), None);
        }
    }

    /// On 16 × 16, the centre of a disc can move by a whole cell if its radius is 7.5, by 0.6 cells if it is 7.7, and
    /// not at all if it is 8.
    #[test]
    fn the_sensor_is_just_large_enough_for_the_positions() {
        let fit = |radius: f64, positions| {
            let disc = Figure::ellipse(radius, radius).on(&Sensor::LARGEST);
            let shapes = vec![NamedShape::new("disc", disc.expect("in range"))];
            let steps = GridSteps::of(positions, "0");
            let training = Training::fitting(shapes, steps).expect("it fits");
            let grid = &training.grids[0];
            let range = grid.ranges()[Axis::X0].to_string();
            (grid.sensor().side(), range)
        };
        let found = |side, range: &str| (side, range.to_owned());
        assert_eq!(fit(7.7, 100), found(17, "8:8.99:0.01"));
        assert_eq!(fit(7.5, 5), found(16, "7.6:8.4:0.2"));
        assert_eq!(fit(7.5, 2), found(16, "8:8.5:0.5"));
        assert_eq!(fit(7.7, 2), found(17, "8:8.5:0.5"));
        assert_eq!(fit(8.0, 2), found(17, "8:8.5:0.5"));
        assert_eq!(fit(8.0, 1), found(16, "8"));
        assert_eq!(fit(7.0, 1), found(16, "8"));
    }

    #[test]
    fn figures_of_default_sizes_are_told_apart_by_any_touch() {
        let steps = GridSteps::of(20, "0:357:3");
        let training = Training::fitting(default_figures(), steps).expect("they fit");
        let model = training.run().expect("not stopped");
        assert_eq!(Evaluation::of(&model).error(), 0.0);
    }
}
