//! A model that is ready, with what the screen shows of it as a whole.

use rand_core::SeedableRng;
use rand_pcg::Pcg64;

use crate::pose::{Axis, DecimalRange, PoseGrid, Ranges};
use crate::recognition::{Evaluation, Model, below};
use crate::storage::ModelChoice;
use crate::touch::Plane;
use crate::tui::recognise::confused::Examples;

/// A model with what is known of it as a whole.
#[derive(Debug)]
pub struct TrainedModel {
    /// The set.
    pub choice: ModelChoice,
    /// Its model.
    pub model: Model,
    /// How well it tells its shapes apart.
    pub evaluation: Evaluation,
    /// An imprint of each cell of its confusion matrix.
    pub examples: Examples,
    /// Where its grid is coarser than hundredths and whole degrees: the share of poses in these steps that leave an
    /// imprint which the model does not know.
    pub unknown_between: Option<f64>,
}

impl PartialEq for TrainedModel {
    /// Whether they are one: they are never changed.
    fn eq(&self, other: &Self) -> bool {
        std::ptr::eq(self, other)
    }
}

impl TrainedModel {
    /// Evaluates a model.
    pub fn new(choice: ModelChoice, model: Model) -> Self {
        Self {
            evaluation: Evaluation::of(&model),
            examples: Examples::of(&model),
            unknown_between: unknown_between(&model),
            choice,
            model,
        }
    }

    /// The name of a shape, counted from 0; empty if there are not that many.
    pub fn name(&self, shape: usize) -> &str {
        let shape = self.model.shapes().get(shape);
        shape.map_or("", |shape| &shape.name)
    }

    /// The grid of poses of a shape; None if there are not that many shapes.
    pub fn grid(&self, shape: usize) -> Option<PoseGrid> {
        grid_of(&self.model, shape, *self.model.ranges())
    }
}

#[cfg(test)]
impl TrainedModel {
    /// A small model under the name of a set: a bar of 6 × 2 at every tenth of a cell and ten degrees.
    pub(in crate::tui) fn of_a_bar(choice: ModelChoice) -> Self {
        use crate::figure::Figure;
        use crate::pose::Anchor;
        use crate::recognition::{NamedShape, Training};
        use crate::sensor::Sensor;

        let sensor = Sensor::default();
        let bar = Figure::rectangle(6.0, 2.0).on(&sensor).expect("in range");
        let cell = |text: &str| text.parse().expect("a range");
        let ranges = Ranges::default()
            .with(Axis::X0, cell("5:5.9:0.1"))
            .with(Axis::Y0, cell("5:5.9:0.1"))
            .with(Axis::Angle, cell("0:170:10"));
        let training = Training::new(
            [NamedShape::new("bar", bar)],
            sensor,
            Anchor::Centre,
            ranges,
        );
        let model = training.expect("a set").run().expect("not stopped");
        Self::new(choice, model)
    }
}

/// The poses of a shape on the sensor of its model, in these ranges: those of the model, or finer ones to try poses
/// between.
fn grid_of(model: &Model, shape: usize, ranges: Ranges) -> Option<PoseGrid> {
    let source = model.shapes().get(shape)?.source.clone();
    PoseGrid::new(source, *model.sensor(), model.anchor(), ranges).ok()
}

/// Poses per shape that are tried.
const TRIED: u32 = 100;

/// The share of random poses in hundredths and whole degrees whose imprint a model does not know. None if its own steps
/// are as fine.
fn unknown_between(model: &Model) -> Option<f64> {
    let ranges = model.ranges();
    let axes = [(Axis::X0, 0.01), (Axis::Y0, 0.01), (Axis::Angle, 1.0)];
    let mut fine = *ranges;
    for (axis, step) in axes {
        fine[axis] = finer(&ranges[axis], step).unwrap_or(ranges[axis]);
    }
    if fine == *ranges {
        return None;
    }
    let mut random = Pcg64::seed_from_u64(0);
    let (mut tried, mut unknown) = (0_u32, 0_u32);
    let mut plane = Plane::new(*model.sensor());
    for shape in 0..model.shapes().len() {
        let Some(grid) = grid_of(model, shape, fine) else {
            continue;
        };
        for _ in 0..TRIED {
            let pose = grid.pose(below(&mut random, grid.poses()));
            let imprint = plane.touch(&grid.placed(pose));
            tried += 1;
            unknown += u32::from(model.counts_of(&imprint).is_empty());
        }
    }
    (tried > 0).then(|| f64::from(unknown) / f64::from(tried))
}

/// The same range in smaller steps, up to before the value that would come next. None if its steps are as small.
fn finer(range: &DecimalRange, step: f64) -> Option<DecimalRange> {
    if range.count() < 2 || range.step() < 1.5 * step {
        return None;
    }
    let last = range.last() + range.step() - step;
    format!("{:.2}:{last:.2}:{step}", range.value(0))
        .parse()
        .ok()
}
