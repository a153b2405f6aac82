//! A trained model, with what the screen shows about it as a whole, and its search for the poses of a touch.

use std::sync::Arc;
use std::time::SystemTime;

use rand_core::SeedableRng;
use rand_pcg::Pcg64;
use taxel_core::imprint::Imprint;
use taxel_core::pose::{Axis, DecimalRange, PoseGrid, Ranges};
use taxel_core::recognition::{Evaluation, Model, Nearest, PlacedSource, PoseEstimate, below};
use taxel_core::sensor::Sensor;
use taxel_core::touch::Plane;
use taxel_files::memory::MemoryGuard;
use taxel_files::storage::{ModelChoice, Models};

use crate::tui::jobs::JobProgress;
use crate::tui::models;
use crate::tui::recognise::confusion::{Examples, examples};

#[derive(Debug)]
pub(crate) struct TrainedModel {
    pub(crate) choice: ModelChoice,
    pub(crate) model: Model,
    /// Length and time of the file that it was read from.
    version: Option<(u64, SystemTime)>,
    pub(super) evaluation: Evaluation,
    pub(super) examples: Examples,
    /// Of random poses in hundredths of a cell and whole degrees: those whose imprint the model does not know, and all
    /// that were tried, each counted with the weight of its shape. None if its grid is as fine.
    pub(super) unknown_between: Option<(u64, u64)>,
}

impl TrainedModel {
    /// Reads a model, or trains it. `known` is the one of the set so far, which stays if its file was not written since.
    pub(super) fn prepare(
        models: &Models,
        choice: ModelChoice,
        known: Option<Arc<Self>>,
        progress: &JobProgress,
    ) -> Result<Arc<Self>, String> {
        let choice = models.locate(choice).map_err(|error| error.to_string())?;
        // Before it is read: if it is written meanwhile, it is read again the next time.
        let file = models.file(&choice).and_then(|path| path.metadata().ok());
        let version = file.and_then(|file| Some((file.len(), file.modified().ok()?)));
        let is_same = |known: &Arc<Self>| known.version == version && known.choice == choice;
        if let Some(known) = known.filter(|known| version.is_some() && is_same(known)) {
            return Ok(known);
        }
        let begins = |poses| {
            progress.post(move |app| {
                let preparing = app.recognition.preparing.as_mut();
                preparing.map(|preparing| preparing.poses.insert(poses));
            });
        };
        let model = models::ready(models, choice.clone(), begins, progress)?;
        Ok(Arc::new(Self {
            evaluation: Evaluation::of(&model),
            examples: examples(&model),
            unknown_between: unknown_between(&model),
            choice,
            model,
            version,
        }))
    }

    pub(super) fn name(&self, shape: usize) -> &str {
        &self.model.shapes()[shape].name
    }

    /// Touches with a random shape, with a probability in proportion to its weight, in a random pose of the grid.
    /// Returns the index of the shape, the sensor and the imprint as [`onto`] does.
    pub(super) fn random_touch(
        &self,
        sensor: Sensor,
        random: &mut Pcg64,
    ) -> Option<(usize, Sensor, Imprint)> {
        let shapes = self.model.shapes();
        let weights = shapes.iter().map(|shape| u64::from(shape.weight));
        let mut rest = below(random, weights.clone().sum());
        let before = weights.take_while(|&weight| {
            let later = rest >= weight;
            rest = rest.saturating_sub(weight);
            later
        });
        let shape = before.count();
        let grid = grid_of(&self.model, shape, *self.model.ranges())?;
        let pose = below(random, grid.poses());
        let own = *grid.sensor();
        let imprint = Plane::new(own).touch(&grid.placed(pose));
        let (sensor, imprint) = onto(&imprint, sensor, own);
        Some((shape, sensor, imprint))
    }
}

/// Returns an imprint on the user's sensor if it fits there, otherwise on the model's sensor; and that sensor.
pub(super) fn onto(imprint: &Imprint, sensor: Sensor, own: Sensor) -> (Sensor, Imprint) {
    let moved = |sensor: Sensor| Some((sensor, moved_onto(imprint, &sensor)?));
    let moved = moved(sensor).or_else(|| moved(own));
    moved.unwrap_or((sensor, Imprint::empty(sensor.size())))
}

/// Moves an imprint onto a sensor: as near to its own place as possible, off the rim if there is room. None if it
/// does not fit.
fn moved_onto(imprint: &Imprint, sensor: &Sensor) -> Option<Imprint> {
    let mut moved = Imprint::empty(sensor.size());
    let Some(bounds) = imprint.bounds() else {
        return Some(moved);
    };
    let place = |start: u8, end: u8, side: u8| {
        let room = side.checked_sub(end - start)?;
        let margin = u8::from(room >= 2);
        Some(start.clamp(margin, room - margin))
    };
    let left = place(bounds.left, bounds.right, sensor.columns())?;
    let top = place(bounds.top, bounds.bottom, sensor.rows())?;
    for (column, row) in imprint.active() {
        moved.set(column - bounds.left + left, row - bounds.top + top, true);
    }
    Some(moved)
}

/// Returns the poses of a shape in the given ranges: those of the model, or finer ones to try poses in between.
fn grid_of(model: &Model, shape: usize, ranges: Ranges) -> Option<PoseGrid> {
    let source = model.shapes().get(shape)?.source.clone();
    PoseGrid::new(source, *model.sensor(), model.anchor(), ranges).ok()
}

/// The largest number of poses whose outlines are drawn; more cannot be told apart over a matrix.
const POSES: usize = 13;

#[derive(Clone)]
pub(super) struct PoseSearch {
    pub(super) trained: Arc<TrainedModel>,
    pub(super) imprint: Imprint,
    /// The shape that the answer names.
    pub(super) named: Option<usize>,
}

impl PartialEq for PoseSearch {
    fn eq(&self, other: &Self) -> bool {
        let same_model = Arc::ptr_eq(&self.trained, &other.trained);
        same_model && (self.imprint, self.named) == (other.imprint, other.named)
    }
}

pub(super) struct Found {
    pub(super) nearest: Option<Nearest>,
    /// The named shape, or that of the nearest imprint if none is named, and the poses in which it leaves the nearest
    /// imprint.
    pub(super) pose: Option<(usize, PoseEstimate)>,
    pub(super) poses: Vec<PlacedSource>,
    pub(super) refused: Option<String>,
}

impl PoseSearch {
    pub(super) fn run(&self, progress: &JobProgress) -> Found {
        let model = &self.trained.model;
        let nearest = model.nearest(&self.imprint);
        let memory = MemoryGuard::new(None, "train the model in coarser steps to see poses");
        let found = memory.limit(progress, |progress| {
            let nearest = nearest.as_ref()?;
            let shape = self.named.unwrap_or(nearest.shape);
            let (pose, poses) = model.poses_of(shape, &nearest.imprint, POSES, progress)?;
            Some(((shape, pose), poses))
        });
        let refused = found.as_ref().err().cloned();
        let (pose, poses) = found.ok().flatten().unzip();
        Found {
            nearest,
            pose,
            poses: poses.unwrap_or_default(),
            refused,
        }
    }
}

fn unknown_between(model: &Model) -> Option<(u64, u64)> {
    let ranges = model.ranges();
    let mut fine = *ranges;
    for (axis, step) in [(Axis::X0, 0.01), (Axis::Y0, 0.01), (Axis::Angle, 1.0)] {
        fine[axis] = finer(&ranges[axis], step).unwrap_or(ranges[axis]);
    }
    if fine == *ranges {
        return None;
    }
    let mut random = Pcg64::seed_from_u64(0);
    let (mut tried, mut unknown) = (0, 0);
    let mut plane = Plane::new(*model.sensor());
    for (shape, named) in model.shapes().iter().enumerate() {
        let grid = grid_of(model, shape, fine)?;
        for _ in 0..100 {
            let pose = below(&mut random, grid.poses());
            let counts = model.counts_of(&plane.touch(&grid.placed(pose)));
            tried += u64::from(named.weight);
            if counts.is_empty() {
                unknown += u64::from(named.weight);
            }
        }
    }
    Some((unknown, tried))
}

/// Returns a range in smaller steps, which ends just before the value after the range's last one; None if its steps
/// are about as small already.
fn finer(range: &DecimalRange, step: f64) -> Option<DecimalRange> {
    if range.count() < 2 || range.step() < 1.5 * step {
        return None;
    }
    let last = range.last() + range.step() - step;
    let text = format!("{:.2}:{last:.2}:{step}", range.value(0));
    text.parse().ok()
}

#[cfg(test)]
mod tests {
    use taxel_core::figure::Figure;
    use taxel_core::pose::Anchor;
    use taxel_core::recognition::{NamedShape, Training};

    use super::*;

    fn between(weights: [u32; 2]) -> (u64, u64) {
        let sensor = Sensor::default();
        let [bar, disc] = [Figure::rectangle(6.0, 2.0), Figure::ellipse(0.6, 0.6)];
        let shapes = [("bar", bar), ("disc", disc)].into_iter().zip(weights);
        let shapes = shapes.map(|((name, figure), weight)| {
            NamedShape::new(name, figure.on(&sensor).expect("in range")).weighted(weight)
        });
        let range = |text: &str| text.parse().expect("a range");
        let ranges = Ranges::default()
            .with(Axis::X0, range("5:5.75:0.25"))
            .with(Axis::Y0, range("5:5.75:0.25"))
            .with(Axis::Angle, range("0:150:30"));
        let training = Training::new(shapes, sensor, Anchor::Centre, ranges);
        let model = training.expect("a set").run().expect("not stopped");
        unknown_between(&model).expect("a coarse grid")
    }

    #[test]
    fn poses_between_count_with_the_weight_of_their_shape() {
        let (bar, both) = (between([2, 1]), between([1, 1]));
        let of_bar = bar.0 - both.0;
        let of_disc = both.0 - of_bar;
        assert!(of_bar > of_disc, "{of_bar} {of_disc}");
        assert_eq!((both.1, bar.1), (200, 300));
        assert_eq!(between([100, 1]), (100 * of_bar + of_disc, 10_100));
    }

    #[test]
    fn a_touch_is_moved_onto_the_sensor_if_it_fits() {
        let read = |text: &str| text.parse::<Imprint>().expect("an imprint");
        let own = read("......\n......\n......\n....##\n....#.\n......");
        let sensor = |columns, rows| Sensor::new(columns, rows).expect("a sensor");
        let onto = |columns, rows| moved_onto(&own, &sensor(columns, rows));
        assert_eq!(onto(4, 4), Some(read("....\n.##.\n.#..\n....")));
        assert_eq!(onto(3, 2), Some(read(".##\n.#.")));
        assert_eq!(onto(1, 9), None);
        assert_eq!(onto(8, 8).and_then(|moved| moved.bounds()), own.bounds());
    }
}
