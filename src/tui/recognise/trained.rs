//! A trained model, with what the screen shows about it as a whole, and a random touch of its shapes.

use std::sync::Arc;
use std::time::SystemTime;

use rand_pcg::Pcg64;
use taxel_core::imprint::Imprint;
use taxel_core::pose::PoseGrid;
use taxel_core::recognition::{Evaluation, Model, below, random_touch};
use taxel_core::sensor::Sensor;
use taxel_files::storage::{FoundModel, ModelChoice, Models};

use crate::tui::jobs::JobProgress;

#[derive(Debug)]
pub(crate) struct TrainedModel {
    pub(crate) choice: ModelChoice,
    pub(crate) model: Model,
    /// Length and time of the file that it was read from.
    version: Option<(u64, SystemTime)>,
    pub(super) evaluation: Evaluation,
}

impl TrainedModel {
    /// Reads a model, or trains it. `known` is the one of the set so far, which stays if neither its file was written
    /// since nor the shapes of its set are others.
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
        let known = known.filter(|known| known.choice == choice);
        let is_unchanged = |known: &&Arc<Self>| version.is_some() && known.version == version;
        if let Some(known) = known.as_ref().filter(is_unchanged) {
            return Ok(Arc::clone(known));
        }
        let found = models
            .find(choice.clone())
            .map_err(|error| error.to_string())?;
        if let FoundModel::BuiltIn { set, .. } = &found {
            let is_same = |known: &Arc<Self>| known.model.shapes() == set.shapes;
            if let Some(known) = known.filter(is_same) {
                return Ok(known);
            }
        }
        let model = found.ready(progress)?;
        Ok(Arc::new(Self {
            evaluation: Evaluation::of(&model),
            choice,
            model,
            version,
        }))
    }

    pub(super) fn name(&self, shape: usize) -> &str {
        &self.model.shapes()[shape].name
    }

    /// Touches with a random shape, with a probability in proportion to its weight, in a random pose, which may lie
    /// between those of the grid. Returns the index of the shape, the sensor and the imprint as [`onto`] does.
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
        let (own, ranges) = (*self.model.sensor(), *self.model.ranges());
        let source = shapes.get(shape)?.source.clone();
        let grid = PoseGrid::new(source, own, self.model.anchor(), ranges).ok()?;
        let imprint = random_touch(&grid, random);
        let (sensor, imprint) = onto(&imprint, sensor, own);
        Some((shape, sensor, imprint))
    }
}

/// Returns an imprint on the user's sensor if it fits there, otherwise on the model's sensor; and that sensor.
fn onto(imprint: &Imprint, sensor: Sensor, own: Sensor) -> (Sensor, Imprint) {
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

#[cfg(test)]
mod tests {
    use super::*;

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
