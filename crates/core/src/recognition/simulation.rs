//! Simulates touches to estimate what cannot be counted: how often noisy touches are named right.
//!
//! Random touches are the same for the same seed on every machine and for any number of threads. Every mean has its
//! standard error.

use std::collections::BTreeMap;
use std::sync::atomic::{AtomicBool, Ordering};

use rand_core::{Rng, SeedableRng};
use rand_pcg::Pcg64;
use rayon::prelude::*;

use crate::atlas::ImprintKey;
use crate::imprint::Imprint;
use crate::index::{index, lower_word};
use crate::parameter::number::share;
use crate::progress::Progress;
use crate::recognition::likelihood::Noise;
use crate::recognition::model::{Model, add_log_counts, first_of_most, float};
use crate::recognition::scan::shift_count;
use crate::sensor::MatrixSize;

/// The rate at which noisy touches are named right. The same number of touches is drawn for each shape; in shares and
/// means, each touch counts with the weight of its shape.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct RecognitionRate {
    /// Touches that were drawn.
    pub touches: u64,
    /// The number of touches, each counted with the weight of its shape.
    pub weighted_touches: u128,
    /// The number of touches that were named right, each counted with the weight of its shape.
    pub weighted_right: u128,
    /// The share of touches that were named right.
    pub accuracy: f64,
    /// The standard error of [`Self::accuracy`]. The number of touches of each shape is fixed, so only the
    /// variation among the touches of one shape counts, not the differences between shapes.
    pub standard_error: f64,
    /// The mean probability of the answers. It estimates the accuracy if the assumed noise is the real one.
    pub mean_confidence: f64,
    /// The share of touches whose imprint the model holds.
    pub held_share: f64,
}

impl RecognitionRate {
    fn of(shapes: &[(u32, ShapeRate)]) -> Self {
        let mut rate = Self::default();
        let (mut held, mut variance, mut confidence) = (0, 0.0, 0.0);
        for (weight, own) in shapes {
            let weighted = |count: u64| u128::from(*weight) * u128::from(count);
            rate.touches += own.touches;
            rate.weighted_touches += weighted(own.touches);
            rate.weighted_right += weighted(own.right);
            held += weighted(own.held);
            variance += f64::from(*weight) * f64::from(*weight) * own.variance();
            confidence += f64::from(*weight) * own.confidence;
        }
        let all = rate.weighted_touches;
        Self {
            accuracy: share(rate.weighted_right, all),
            standard_error: variance.sqrt() * share(1, all),
            mean_confidence: confidence * share(1, all),
            held_share: share(held, all),
            ..rate
        }
    }
}

#[derive(Clone, Copy, Default)]
struct ShapeRate {
    touches: u64,
    right: u64,
    held: u64,
    /// The sum of the probabilities of the names that were given.
    confidence: f64,
}

impl ShapeRate {
    fn add(&mut self, more: Self) {
        self.touches += more.touches;
        self.right += more.right;
        self.held += more.held;
        self.confidence += more.confidence;
    }

    /// Returns the variance of the number of touches that are named right, which is binomial.
    fn variance(&self) -> f64 {
        let wrong = self.touches - self.right;
        float(self.right) * float(wrong) / float(self.touches.max(1))
    }
}

#[derive(Clone, Default)]
pub(super) struct Draw {
    /// For each key: the number of touches up to and including this key, and the number of the key.
    sums: Vec<(u64, usize)>,
}

impl Draw {
    /// Creates the distribution of each shape of a model; a pose with a key counts as `times` touches.
    pub(super) fn all(model: &Model, times: impl Fn(usize) -> u64) -> Vec<Self> {
        let mut draws = vec![Self::default(); model.shapes().len()];
        for key in 0..model.keys().len() {
            for count in model.counts(key) {
                let sums = &mut draws[usize::from(count.shape)].sums;
                let before = sums.last().map_or(0, |&(sum, _)| sum);
                sums.push((before + count.poses * times(key), key));
            }
        }
        draws
    }

    pub(super) fn key(&self, random: &mut Pcg64) -> Option<usize> {
        let &(end, _) = self.sums.last().filter(|(sum, _)| *sum > 0)?;
        let touch = below(random, end);
        let index = self.sums.partition_point(|&(sum, _)| sum <= touch);
        self.sums.get(index).map(|&(_, key)| key)
    }
}

impl Model {
    /// Draws `per_shape` touches of each shape, whose taxels flip as the noise says, names the shape of each under that
    /// noise, and counts.
    ///
    /// Each imprint is put in a random place on a matrix of this size where all of it fits. Imprints that fit nowhere
    /// are not drawn: the rate is that of the others. A shape none of whose imprints fits has no touches.
    ///
    /// `progress` is called with 1 after each touch, and stops the simulation by returning `Break`. Returns None if it
    /// was stopped, or if there is no touch.
    pub fn recognition_rate(
        &self,
        size: MatrixSize,
        noise: &Noise,
        per_shape: u64,
        seed: u64,
        progress: &dyn Progress,
    ) -> Option<RecognitionRate> {
        const CHUNK: u64 = 50;
        /// Chunks whose counts are held at a time: a billion touches would take gigabytes.
        const HELD: usize = 4096;
        let shifts = |key: usize| {
            let key = self.keys().get(key);
            shift_count((key.width, key.height), size)
        };
        let draws = Draw::all(self, shifts);
        let shapes = draws.len() as u64;
        let tasks = per_shape.div_ceil(CHUNK).saturating_mul(shapes);
        let stopped = AtomicBool::new(false);
        let rate = |number: u64| {
            let (chunk, shape) = (number / shapes, index(number % shapes));
            let mut random = generator(seed, number);
            let mut rate = ShapeRate::default();
            for _ in 0..CHUNK.min(per_shape - chunk * CHUNK) {
                if stopped.load(Ordering::Relaxed) {
                    break;
                }
                let Some(key) = draws[shape].key(&mut random) else {
                    break;
                };
                let touch = self.touch_of(key, size, noise, &mut random);
                let posterior = self.posterior_under(&touch, noise);
                let named = posterior.and_then(|own| first_of_most(own.into_iter().enumerate()));
                rate.touches += 1;
                rate.right += u64::from(named.is_some_and(|(named, _)| named == shape));
                rate.held += u64::from(self.keys().find(&ImprintKey::of(&touch)).is_some());
                rate.confidence += named.map_or(0.0, |(_, probability)| probability);
                if progress.add(1).is_break() {
                    stopped.store(true, Ordering::Relaxed);
                }
            }
            rate
        };
        let mut rates = vec![ShapeRate::default(); draws.len()];
        for start in (0..tasks).step_by(HELD) {
            let held = start..tasks.min(start.saturating_add(HELD as u64));
            let counted: Vec<ShapeRate> = held.into_par_iter().map(rate).collect();
            // In order, so that the sums have the same digits for any number of threads.
            for (number, counted) in (start..).zip(counted) {
                rates[index(number % shapes)].add(counted);
            }
            if stopped.load(Ordering::Relaxed) {
                return None;
            }
        }
        let weights = self.shapes().iter().map(|shape| shape.weight);
        let rates: Vec<(u32, ShapeRate)> = weights.zip(rates).collect();
        let rate = RecognitionRate::of(&rates);
        (rate.touches > 0).then_some(rate)
    }

    fn touch_of(&self, key: usize, size: MatrixSize, noise: &Noise, random: &mut Pcg64) -> Imprint {
        let (columns, rows) = (size.columns(), size.rows());
        let key = self.keys().get(key);
        let mut touch = Imprint::empty(size);
        let column = below(random, u64::from(columns - key.width) + 1);
        let row = index(below(random, u64::from(rows - key.height) + 1));
        for (index, word) in key.rows().enumerate() {
            touch.set_word(row + index, word << column);
        }
        if noise.flip() > 0.0 {
            for row in 0..rows {
                for column in 0..columns {
                    if unit(random) < noise.flip() {
                        touch.toggle(column, row);
                    }
                }
            }
        }
        noise.dead().map_or(touch, |dead| touch.without(dead))
    }
}

/// Creates a random generator for one of many tasks, so that no task waits for another.
pub(super) fn generator(seed: u64, task: u64) -> Pcg64 {
    Pcg64::seed_from_u64(seed ^ task.wrapping_mul(0x9e37_79b9_7f4a_7c15))
}

/// Draws a number from 0 to below `end`, each as likely as any other to within 2⁻⁶⁴.
pub fn below(random: &mut Pcg64, end: u64) -> u64 {
    let product = u128::from(random.next_u64()) * u128::from(end);
    lower_word(product >> 64)
}

pub(super) fn unit(random: &mut Pcg64) -> f64 {
    float(random.next_u64() >> 11) / float(1 << 53)
}

/// The number of touches of a shape until some shape, right or wrong, is as probable as wanted.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct TouchesUntil {
    /// The mean; None if a run did not reach the probability, since it is unknown how many touches that run would
    /// take.
    pub mean: Option<f64>,
    /// The standard error of the mean; also None for fewer than two runs.
    pub standard_error: Option<f64>,
    /// Runs that reached the probability within [`MOST_TOUCHES`].
    pub reached: u64,
    /// Runs in all.
    pub runs: u64,
    /// Runs that ended with the right shape.
    pub right: u64,
}

/// The largest number of touches of a run. Longer runs are abandoned: shapes that leave the same imprints can never
/// be told apart.
pub const MOST_TOUCHES: u32 = 10_000;

impl Model {
    /// Draws touches of each shape until some shape is as probable as `until` (0 to 1), `runs` times, and returns the
    /// number of touches for each shape, in the order of the set. If `until` is above 1 or NaN, no run reaches it; if
    /// it is 0 or less, every run reaches it with its first touch.
    ///
    /// `progress` is called with 1 after each run, from any thread, and stops the simulation by returning `Break`.
    /// Returns None if it was stopped.
    pub fn touches_until(
        &self,
        until: f64,
        runs: u64,
        seed: u64,
        progress: &dyn Progress,
    ) -> Option<Vec<TouchesUntil>> {
        let draws = Draw::all(self, |_| 1);
        let shapes = self.shapes().len() as u64;
        let of_shape = |(shape, draw): (usize, &Draw)| {
            let run = |run: u64| {
                let task = run.wrapping_mul(shapes).wrapping_add(shape as u64);
                let run = self.run_until(until, draw, shape, &mut generator(seed, task));
                progress.add(1).is_continue().then_some(run)
            };
            let runs = (0..runs).into_par_iter().map(run);
            Some(TouchesUntil::of(&runs.collect::<Option<Vec<_>>>()?))
        };
        draws.iter().enumerate().map(of_shape).collect()
    }

    /// Returns the number of touches of one run, and whether it ended with the right shape. None if the run was
    /// abandoned.
    fn run_until(
        &self,
        until: f64,
        draw: &Draw,
        shape: usize,
        random: &mut Pcg64,
    ) -> Option<(u32, bool)> {
        // ln(w Π n); −∞ for shapes that do not leave all of the keys.
        let mut logarithms = self.log_weights();
        for touches in 1..=MOST_TOUCHES {
            add_log_counts(&mut logarithms, self.counts(draw.key(random)?));
            let (best, most) = first_of_most(logarithms.iter().copied().enumerate())?;
            let sum: f64 = logarithms.iter().map(|own| libm::exp(own - most)).sum();
            if 1.0 / sum >= until {
                return Some((touches, best == shape));
            }
        }
        None
    }
}

impl TouchesUntil {
    /// Sums up some runs: the number of touches of each, and whether it ended with the right shape; None for one that
    /// was abandoned.
    fn of(runs: &[Option<(u32, bool)>]) -> Self {
        let ended = || runs.iter().flatten();
        let mut counts: BTreeMap<u32, u64> = BTreeMap::new();
        for (length, _) in ended() {
            *counts.entry(*length).or_default() += 1;
        }
        let sum_of = |value: &dyn Fn(f64) -> f64| -> f64 {
            let values = counts.iter();
            let values = values.map(|(&length, &runs)| value(length.into()) * float(runs));
            values.sum()
        };
        let (all, reached) = (runs.len() as u64, ended().count() as u64);
        let mean = (reached == all && all > 0).then(|| sum_of(&|length| length) / float(all));
        let standard_error = mean.filter(|_| all > 1).map(|mean| {
            let squares = sum_of(&|length| (length - mean) * (length - mean));
            (squares / float(all - 1) / float(all)).sqrt()
        });
        Self {
            mean,
            standard_error,
            reached,
            runs: all,
            right: ended().filter(|(_, right)| *right).count() as u64,
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::figure::Figure;
    use crate::pose::{Anchor, Ranges};
    use crate::progress::{ToTheEnd, stop_if};
    use crate::recognition::{NamedShape, Noise, Training};
    use crate::sensor::Sensor;

    #[test]
    fn a_touch_counts_with_the_weight_of_its_shape() {
        let sensor = Sensor::default();
        let bar = |length| {
            Figure::rectangle(length, 2.0)
                .on(&sensor)
                .expect("in range")
        };
        let shapes = [("long", 4.4, 9), ("short", 4.0, 1)];
        let shapes = shapes
            .map(|(name, length, weight)| NamedShape::new(name, bar(length)).weighted(weight));
        let range = |text: &str| text.parse().expect("a range");
        let ranges = Ranges::new(["8:8.9:0.1", "8", "0", "1", "1"].map(range));
        let training = Training::new(shapes, sensor, Anchor::Centre, ranges);
        let model = training.expect("a set").run().expect("not stopped");
        let noise = Noise::new(0.0).expect("in range");
        let rate = model.recognition_rate(sensor.size(), &noise, 2000, 0, &ToTheEnd);
        let rate = rate.expect("not stopped");
        // The long one is always named, so only the confidence is left to chance.
        assert_eq!(rate.touches, 4000);
        let weighted = (rate.weighted_touches, rate.weighted_right);
        assert_eq!(weighted, (20_000, 18_000));
        assert_eq!((rate.accuracy, rate.standard_error), (0.9, 0.0));
        assert!((rate.mean_confidence - 0.9).abs() < 0.002, "{rate:?}");
    }

    /// The imprint of the bar is 5 taxels long, or 6 if the bar lies between taxels.
    #[test]
    fn touches_that_fit_nowhere_are_left_out() {
        let sensor = Sensor::default();
        let bar = Figure::rectangle(5.2, 1.0).on(&sensor).expect("in range");
        let shapes = [NamedShape::new("bar", bar)];
        let range = |text: &str| text.parse().expect("a range");
        let ranges = Ranges::new(["5:5.9:0.1", "5", "0", "1", "1"].map(range));
        let training = Training::new(shapes, sensor, Anchor::Corner, ranges);
        let model = training.expect("a set").run().expect("not stopped");
        let noise = Noise::new(0.0).expect("in range");
        let rate = |columns| {
            let size = MatrixSize::of(columns, 1);
            let rate = model.recognition_rate(size, &noise, 10, 0, &ToTheEnd);
            rate.map(|rate| rate.touches)
        };
        assert_eq!((rate(5), rate(4), rate(1)), (Some(10), None, None));
    }

    #[test]
    fn the_standard_error_of_a_heavy_shape_counts_with_its_weight() {
        let rate = |right| ShapeRate {
            touches: 100,
            right,
            ..ShapeRate::default()
        };
        let found = RecognitionRate::of(&[(3, rate(50)), (1, rate(80))]);
        assert_eq!(found.accuracy, 230.0 / 400.0);
        // The variances are 25 and 16.
        let error = (9.0 * 25.0 + 16.0_f64).sqrt() / 400.0;
        assert!((found.standard_error - error).abs() < 1e-15, "{found:?}");
    }

    #[test]
    fn any_number_of_runs_can_be_stopped() {
        let sensor = Sensor::default();
        let bar = Figure::rectangle(4.0, 2.0).on(&sensor).expect("in range");
        let shapes = [NamedShape::new("bar", bar)];
        let training = Training::new(shapes, sensor, Anchor::Centre, Ranges::default());
        let model = training.expect("a set").run().expect("not stopped");
        for runs in [1_000_000_000, u64::MAX] {
            assert_eq!(model.touches_until(0.9, runs, 0, &|_| stop_if(true)), None);
        }
    }

    #[test]
    fn an_abandoned_run_leaves_no_mean() {
        let known = TouchesUntil::of(&[Some((2, true)), Some((4, true))]);
        assert_eq!((known.mean, known.standard_error), (Some(3.0), Some(1.0)));
        let unknown = TouchesUntil::of(&[Some((2, true)), None, Some((4, true))]);
        assert_eq!((unknown.mean, unknown.standard_error), (None, None));
        assert_eq!((unknown.reached, unknown.runs), (2, 3));
    }

    /// Two names of one shape are equally probable after every touch.
    #[test]
    fn the_first_of_equals_is_named_after_several_touches_too() {
        let sensor = Sensor::default();
        let bar = Figure::rectangle(4.0, 2.0).on(&sensor).expect("in range");
        let shapes = ["one", "other"].map(|name| NamedShape::new(name, bar));
        let training = Training::new(shapes, sensor, Anchor::Centre, Ranges::default());
        let model = training.expect("a set").run().expect("not stopped");
        let touches = model.touches_until(0.4, 10, 0, &ToTheEnd);
        let right = touches.map(|own| own.iter().map(|own| own.right).collect());
        assert_eq!(right, Some(vec![10, 0]));
        // Each has exactly this probability.
        let half = model.touches_until(0.5, 2, 0, &ToTheEnd);
        let means = half.map(|own| own.iter().map(|own| own.mean).collect());
        assert_eq!(means, Some(vec![Some(1.0), Some(1.0)]));
        // They are never told apart, so there is no mean.
        let never = model.touches_until(0.9, 2, 0, &ToTheEnd);
        let means = never.map(|own| {
            own.iter()
                .map(|own| (own.mean, own.standard_error))
                .collect()
        });
        assert_eq!(means, Some(vec![(None, None), (None, None)]));
        let noise = Noise::new(0.0).expect("in range");
        let rate = model.recognition_rate(sensor.size(), &noise, 10, 0, &ToTheEnd);
        assert_eq!(rate.map(|rate| rate.touches), Some(20));
        // One is always named right, the other never: the accuracy is ½ for every seed.
        let error = rate.map(|rate| (rate.accuracy, rate.standard_error));
        assert_eq!(error, Some((0.5, 0.0)));
    }

    #[test]
    fn a_single_run_has_a_mean_but_no_error() {
        let found = TouchesUntil::of(&[Some((3, true))]);
        assert_eq!((found.mean, found.standard_error), (Some(3.0), None));
        let found = TouchesUntil::of(&[Some((3, true)), Some((5, false))]);
        assert_eq!((found.mean, found.standard_error), (Some(4.0), Some(1.0)));
        assert_eq!((found.reached, found.right), (2, 1));
    }
}
