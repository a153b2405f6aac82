//! Touches between the poses that a model was trained on: how much a grid leaves out.

use std::collections::HashMap;

use rayon::prelude::*;

use crate::imprint::Imprint;
use crate::parameter::number::share;
use crate::pose::{Axis, PoseGrid};
use crate::progress::Progress;
use crate::recognition::model::{Model, ShapeCount};
use crate::recognition::training::{Training, TrainingError};
use crate::sensor::MatrixSize;

/// The result of touches half a step off the grid, in x0, y0 and angle.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct HalfStep {
    /// The number of touches.
    pub touches: u128,
    /// Touches whose imprint the model holds.
    pub held: u128,
    /// Touches that are named right, where those that the model does not hold count as wrong.
    pub right: u128,
    /// Touches that are named right, where an imprint that the model does not hold gets the name of the nearest one.
    pub right_with_nearest: u128,
}

/// A part of the work of [`Model::half_step`].
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash)]
pub enum HalfStepWork {
    /// This number of further poses was touched.
    Poses(u64),
    /// After all poses: the nearest imprint was sought for one more imprint that the model does not hold.
    Search {
        /// The number of all imprints that the model does not hold.
        of: u64,
    },
}

impl HalfStep {
    /// Returns the share of touches whose imprint the model does not hold.
    pub fn missing(&self) -> f64 {
        share(self.touches - self.held, self.touches)
    }

    /// Returns the error where touches that the model does not hold count as wrong.
    pub fn error(&self) -> f64 {
        share(self.touches - self.right, self.touches)
    }

    /// Returns the error where an imprint that the model does not hold gets the name of the nearest one.
    pub fn error_with_nearest(&self) -> f64 {
        share(self.touches - self.right_with_nearest, self.touches)
    }
}

impl Model {
    /// Touches every shape half a step beyond each pose of the model, and names the imprints. Of a shard, only its own
    /// poses count.
    ///
    /// Angles are directions, so 375° is 15°. Half a step beyond the largest x0 and y0 may exceed their range, which
    /// only forms and files have; what the sensor cuts off there leaves an imprint of its own, or an empty one.
    ///
    /// It takes about as long as the training, and more where many imprints are new. `progress` is called from time to
    /// time, from any thread, with the work that is done; it stops the test by returning `Break`.
    ///
    /// # Errors
    /// Returns [`TrainingError::Steps`] if half a step has too many decimals, or [`TrainingError::Stopped`].
    pub fn half_step(
        &self,
        progress: &dyn Progress<HalfStepWork>,
    ) -> Result<HalfStep, TrainingError> {
        let touched = |poses| progress.add(HalfStepWork::Poses(poses));
        let between = self.shifted_by_half_a_step(&touched)?;
        let keys = between.keys();
        let known: Vec<Option<usize>> = (0..keys.len())
            .map(|key| self.keys().find_ref(keys.get(key)))
            .collect();
        let missing: Vec<usize> = (0..keys.len())
            .filter(|&key| known[key].is_none())
            .collect();
        let search = HalfStepWork::Search {
            of: missing.len() as u64,
        };
        let nearest = missing.par_iter().map(|&key| {
            if progress.add(search).is_break() {
                return Err(TrainingError::Stopped);
            }
            let nearest = self.nearest(&with_margin(keys.imprint(key).as_ref()));
            Ok(nearest.map(|nearest| (key, nearest.shape)))
        });
        let nearest: Vec<Option<(usize, usize)>> = nearest.collect::<Result<_, _>>()?;
        let nearest: HashMap<usize, usize> = nearest.into_iter().flatten().collect();
        let mut result = HalfStep {
            touches: u128::from(between.poses()) * between.weights(),
            held: 0,
            right: 0,
            right_with_nearest: 0,
        };
        for (key, known) in known.into_iter().enumerate() {
            let counts = between.counts(key);
            let own = |named: usize| -> u128 {
                let right = |count: &&ShapeCount| usize::from(count.shape) == named;
                let right = counts.iter().filter(right);
                right.map(|&count| between.weighted(count)).sum()
            };
            let all: u128 = counts.iter().map(|&count| between.weighted(count)).sum();
            match known {
                Some(known) => {
                    let right = own(self.most_frequent(known).0);
                    result.held += all;
                    result.right += right;
                    result.right_with_nearest += right;
                }
                None => {
                    result.right_with_nearest += nearest.get(&key).map_or(0, |&named| own(named));
                }
            }
        }
        Ok(result)
    }

    /// Trains the same shapes half a step beyond each pose of the model.
    fn shifted_by_half_a_step(&self, progress: &dyn Progress) -> Result<Self, TrainingError> {
        let mut ranges = *self.ranges();
        for axis in [Axis::X0, Axis::Y0, Axis::Angle] {
            let shifted = ranges[axis].shifted_by_half_a_step();
            ranges[axis] = shifted.ok_or(TrainingError::Steps)?;
        }
        let shapes = self.shapes().to_vec();
        let training = Training::of_poses(shapes, |source| {
            PoseGrid::going_beyond(source, *self.sensor(), self.anchor(), ranges)
        })?;
        let training = training.with_shard(self.shard()).allow_cut(true);
        training.with_progress(progress).run()
    }
}

/// Returns an imprint with a margin of up to two taxels, in which the nearest imprint may lie.
fn with_margin(imprint: Option<&Imprint>) -> Imprint {
    const MARGIN: u8 = 2;
    let Some(imprint) = imprint else {
        return Imprint::empty(MatrixSize::SMALLEST.enlarged(MARGIN - 1));
    };
    let size = imprint.size().enlarged(2 * MARGIN);
    let mut wider = Imprint::empty(size);
    let (left, top) = (
        (size.columns() - imprint.columns()) / 2,
        usize::from((size.rows() - imprint.rows()) / 2),
    );
    for (row, &word) in imprint.words().iter().enumerate() {
        wider.set_word(row + top, word << left);
    }
    wider
}

#[cfg(test)]
mod tests {
    use std::sync::atomic::{AtomicU64, AtomicUsize, Ordering};

    use super::*;
    use crate::pose::{Anchor, Ranges};
    use crate::progress::{ToTheEnd, stop_if};
    use crate::recognition::sets::{GridSteps, equal_figures};
    use crate::sensor::Sensor;
    use crate::sweep::Shard;

    #[test]
    fn it_can_be_stopped_while_nearest_imprints_are_searched() {
        let steps = GridSteps::new(4, 30).expect("divisors");
        let training = Training::fitting(equal_figures(), steps).expect("they fit");
        let model = training.run().expect("not stopped");
        let calls = AtomicUsize::new(0);
        let stop_after = |most: usize| {
            calls.store(0, Ordering::Relaxed);
            model.half_step(&|_| stop_if(calls.fetch_add(1, Ordering::Relaxed) >= most))
        };
        let result = stop_after(usize::MAX).expect("not stopped");
        assert!(result.missing() > 0.0);
        let [poses, searches, all] = [0, 0, 0].map(AtomicU64::new);
        let reported = model.half_step(&|work| {
            match work {
                HalfStepWork::Poses(more) => poses.fetch_add(more, Ordering::Relaxed),
                HalfStepWork::Search { of } => {
                    searches.fetch_add(1, Ordering::Relaxed);
                    all.swap(of, Ordering::Relaxed)
                }
            };
            stop_if(false)
        });
        assert_eq!(reported, Ok(result));
        let expected = model.poses() * model.shapes().len() as u64;
        assert_eq!(poses.into_inner(), expected);
        let searches = searches.into_inner();
        assert!(searches > 0 && searches == all.into_inner());
        // The last call is made for the last imprint that the model does not hold.
        let all = calls.load(Ordering::Relaxed);
        assert_eq!(stop_after(all - 1), Err(TrainingError::Stopped));
        assert_eq!(stop_after(all), Ok(result));
    }

    #[test]
    fn a_shard_touches_beyond_its_own_poses_only() {
        let steps = GridSteps::new(4, 30).expect("divisors");
        let training = Training::fitting(equal_figures(), steps).expect("they fit");
        let touches = |training: Training| {
            let model = training.run().expect("not stopped");
            let result = model.half_step(&ToTheEnd).expect("few decimals");
            assert_eq!(result.touches, u128::from(model.poses()) * model.weights());
            result.touches
        };
        let shards = [1, 2].map(|number| {
            let shard = Shard::new(number, 2).expect("one of two");
            touches(training.clone().with_shard(shard))
        });
        assert_eq!(shards.iter().sum::<u128>(), touches(training));
    }

    /// Trains the equal figures on a sensor of 16 × 16, at an angle of 0 unless `axis` is the angle.
    fn trained(axis: Axis, range: &str) -> Model {
        let ranges = [
            (Axis::X0, "5"),
            (Axis::Y0, "5"),
            (Axis::Angle, "0"),
            (axis, range),
        ];
        let ranges = ranges
            .into_iter()
            .fold(Ranges::default(), |ranges, (axis, range)| {
                ranges.with(axis, range.parse().expect("a range"))
            });
        let training = Training::new(equal_figures(), Sensor::default(), Anchor::Corner, ranges);
        let training = training.expect("in range").allow_cut(true);
        training.run().expect("not stopped")
    }

    #[test]
    fn half_a_step_beyond_the_last_pose_may_leave_a_range() {
        for (axis, range, parts) in [
            // 375° is 15°.
            (Axis::Angle, "0:350:50", ["25:325:50", "15"]),
            (Axis::Angle, "0.6:352:50.2", ["25.7:326.9:50.2", "17.1"]),
            // At 16, as at 16.5, a figure has just left the sensor.
            (Axis::X0, "13:16:1", ["13.5:15.5:1", "16"]),
            (Axis::Y0, "13:16:1", ["13.5:15.5:1", "16"]),
        ] {
            let model = trained(axis, range);
            let (mut touches, mut held, mut right) = (0, 0, 0);
            for part in parts {
                let between = trained(axis, part);
                for key in 0..between.keys().len() {
                    let known = model.keys().find_ref(between.keys().get(key));
                    for &count in between.counts(key) {
                        let own = between.weighted(count);
                        touches += own;
                        held += if known.is_some() { own } else { 0 };
                        let named = known.map(|known| model.most_frequent(known).0);
                        right += if named == Some(count.shape.into()) {
                            own
                        } else {
                            0
                        };
                    }
                }
            }
            let result = model.half_step(&ToTheEnd).expect("not stopped");
            let found = (result.touches, result.held, result.right);
            assert_eq!(found, (touches, held, right), "{axis:?} {range}");
        }
    }

    #[test]
    fn touches_count_with_weights_and_missing_imprints_get_the_nearest_name() {
        let steps = GridSteps::new(4, 30).expect("divisors");
        let mut shapes = equal_figures();
        shapes[0].weight = 3;
        let training = Training::fitting(shapes.clone(), steps).expect("they fit");
        let model = training.run().expect("not stopped");
        let mut ranges = *model.ranges();
        for axis in [Axis::X0, Axis::Y0, Axis::Angle] {
            ranges[axis] = ranges[axis].shifted_by_half_a_step().expect("few decimals");
        }
        let between = Training::new(shapes, *model.sensor(), model.anchor(), ranges);
        let between = between.expect("in range").allow_cut(true).run();
        let between = between.expect("not stopped");
        let mut expected = HalfStep {
            touches: 0,
            held: 0,
            right: 0,
            right_with_nearest: 0,
        };
        for key in 0..between.keys().len() {
            let touch = between.keys().imprint(key).expect("none is empty");
            // Two taxels more on each side.
            let mut wider = Imprint::empty(touch.size().enlarged(4));
            for (column, row) in touch.active() {
                wider.set(column + 2, row + 2, true);
            }
            let nearest = model.nearest(&wider).expect("it has keys");
            for &count in between.counts(key) {
                let touches = between.weighted(count);
                expected.touches += touches;
                let right = u128::from(nearest.shape == usize::from(count.shape)) * touches;
                expected.right_with_nearest += right;
                if nearest.distance == 0 {
                    expected.held += touches;
                    expected.right += right;
                }
            }
        }
        assert!(expected.right_with_nearest > expected.right);
        assert_eq!(model.half_step(&ToTheEnd), Ok(expected));
    }
}
