use std::fmt;

use rayon::prelude::*;

use crate::parameter::number::grouped;
use crate::pose::{Anchor, GridError, PoseGrid, Ranges};
use crate::progress::{Progress, ToTheEnd};
use crate::recognition::key::{ImprintKey, KeyTable};
use crate::recognition::model::{
    Gathered, Model, ModelError, ModelHead, NamedShape, ShapeCount, check_shapes,
};
use crate::sensor::Sensor;
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
/// assert_eq!(model.posterior(&touch), Some(vec![1.0, 0.0]));
/// # Ok::<(), Box<dyn std::error::Error>>(())
/// ```
#[derive(Clone)]
#[must_use = "nothing is trained before `run`"]
pub struct Training<'a> {
    grids: Vec<PoseGrid>,
    shapes: Vec<NamedShape>,
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
        let grid = |shape: &NamedShape| {
            let grid = PoseGrid::new(shape.source.clone(), sensor, anchor, ranges);
            grid.map_err(|error| TrainingError::Grid {
                name: shape.name.clone(),
                error,
            })
        };
        let grids = shapes.iter().map(grid).collect::<Result<_, _>>()?;
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

    /// Returns the shapes of the set, in order.
    pub fn shapes(&self) -> &[NamedShape] {
        &self.shapes
    }

    /// Returns the grid of poses of each shape, in the order of the set.
    pub fn grids(&self) -> &[PoseGrid] {
        &self.grids
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

    /// Returns true if a model has the head that the model of this training will have. It tells nothing about the keys
    /// and how they were counted.
    pub fn would_make(&self, model: &Model) -> bool {
        let (mut head, cut) = (self.head(), model.cut());
        let is_allowed = self.allow_cut || cut.iter().all(|&cut| cut == 0);
        head.cut = cut.to_vec();
        is_allowed && head == *model.head()
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
                let slot = gathered.slot(&keys, index);
                gathered.counts[slot].push(ShapeCount::new(shape, poses));
            }
            head.cut.push(counted.partly_off);
        }
        let counts = |index: usize| gathered.counts[index].iter().copied();
        Ok(Model::of_table(head, &gathered.keys, counts)?)
    }
}

fn keys_of(counted: &CountedImprints) -> (KeyTable, Vec<u64>) {
    const CHUNK: usize = 4096;
    let chunks: Vec<Vec<(ImprintKey, u64)>> = (0..counted.len().div_ceil(CHUNK))
        .into_par_iter()
        .map(|chunk| {
            let indices = chunk * CHUNK..counted.len().min((chunk + 1) * CHUNK);
            let key = |index| {
                let (imprint, count) = counted.get(index);
                (ImprintKey::of(&imprint), count)
            };
            indices.map(key).collect()
        })
        .collect();
    let (mut keys, mut counts) = (KeyTable::default(), Vec::new());
    for (key, count) in chunks.into_iter().flatten() {
        let slot = keys.intern(key.borrowed());
        if slot == counts.len() {
            counts.push(0);
        }
        counts[slot] += count;
    }
    (keys, counts)
}
