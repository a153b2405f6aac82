//! Simulates touches to estimate what cannot be counted: how often noisy touches are named right.
//!
//! Random touches are the same for the same seed on every machine and for any number of threads. Every mean has its
//! standard error.

use std::sync::atomic::{AtomicBool, Ordering};

use rand_pcg::Pcg64;
use rayon::prelude::*;

use crate::imprint::Imprint;
use crate::index::index;
use crate::parameter::number::share;
use crate::progress::Progress;
use crate::recognition::key::ImprintKey;
use crate::recognition::model::{Model, first_of_most, float};
use crate::recognition::noise::Noise;
use crate::recognition::random::{below, generator, random_taxels, unit};
use crate::recognition::scan::shift_count;
use crate::sensor::MatrixSize;

/// The rate at which noisy touches are named right. The same number of touches is drawn for each shape; in shares and
/// means, each touch counts with the weight of its shape.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct RecognitionRate {
    /// Touches that were drawn.
    pub touches: u64,
    /// Touches that were named right.
    pub right: u64,
    /// Touches whose imprint some shape also leaves without noise.
    pub held: u64,
    weighted_touches: u128,
    weighted_right: u128,
    accuracy: f64,
    standard_error: f64,
    mean_confidence: f64,
    held_share: f64,
}

impl RecognitionRate {
    /// Returns the number of touches, each counted with the weight of its shape.
    pub fn weighted_touches(&self) -> u128 {
        self.weighted_touches
    }

    /// Returns the number of touches that were named right, each counted with the weight of its shape.
    pub fn weighted_right(&self) -> u128 {
        self.weighted_right
    }

    /// Returns the share of touches that were named right.
    pub fn accuracy(&self) -> f64 {
        self.accuracy
    }

    /// Returns the standard error of [`Self::accuracy`]. The number of touches of each shape is fixed, so only the
    /// variation among the touches of one shape counts, not the differences between shapes.
    pub fn standard_error(&self) -> f64 {
        self.standard_error
    }

    /// Returns the mean probability of the answers. It estimates the accuracy if the assumed noise is the real one.
    pub fn mean_confidence(&self) -> f64 {
        self.mean_confidence
    }

    /// Returns the share of touches whose imprint the model holds.
    pub fn held_share(&self) -> f64 {
        self.held_share
    }

    fn of(shapes: &[(u32, ShapeRate)]) -> Self {
        let sum = |of: fn(&ShapeRate) -> u64| shapes.iter().map(|(_, own)| of(own)).sum();
        let weighted = |of: fn(&ShapeRate) -> u64| -> u128 {
            let products = shapes
                .iter()
                .map(|(weight, own)| u128::from(*weight) * u128::from(of(own)));
            products.sum()
        };
        let (all, right) = (weighted(|own| own.touches), weighted(|own| own.right));
        let squared = |weight: u32| f64::from(weight) * f64::from(weight);
        let variances = (shapes.iter()).map(|(weight, own)| squared(*weight) * own.variance());
        let confidences = shapes
            .iter()
            .map(|(weight, own)| f64::from(*weight) * own.confidence);
        let part = share(1, all);
        Self {
            touches: sum(|own| own.touches),
            right: sum(|own| own.right),
            held: sum(|own| own.held),
            weighted_touches: all,
            weighted_right: right,
            accuracy: share(right, all),
            standard_error: variances.sum::<f64>().sqrt() * part,
            mean_confidence: confidences.sum::<f64>() * part,
            held_share: share(weighted(|own| own.held), all),
        }
    }
}

/// The result of a touch: whether the model holds its imprint, and the name that it got (the shape and its
/// probability), if any.
pub(super) struct Judgement {
    pub(super) is_held: bool,
    pub(super) named: Option<(usize, f64)>,
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
    fn count(&mut self, shape: usize, judged: &Judgement) {
        let is_right = judged.named.is_some_and(|(named, _)| named == shape);
        self.touches += 1;
        self.right += u64::from(is_right);
        self.held += u64::from(judged.is_held);
        self.confidence += judged.named.map_or(0.0, |(_, probability)| probability);
    }

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

/// Touches to simulate: the same number of each shape, each in a random place, with taxels that flip or are dead.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct NoisyTouches {
    size: MatrixSize,
    noise: Noise,
    random_dead: u32,
    per_shape: u64,
    seed: u64,
}

impl NoisyTouches {
    /// Creates a simulation that draws `per_shape` touches of each shape on a matrix of this size. Taxels flip as
    /// `noise` says, and its dead taxels always read as inactive.
    pub fn new(size: MatrixSize, noise: Noise, per_shape: u64, seed: u64) -> Self {
        Self {
            size,
            noise,
            random_dead: 0,
            per_shape,
            seed,
        }
    }

    /// Returns the same touches with `count` additional dead taxels. They are drawn anew for each touch, and the
    /// classifier knows which they are. So touches are independent, and the standard error includes how much sensors
    /// with different dead taxels differ. The same seed draws the same dead taxels for any noise.
    #[must_use]
    pub fn with_random_dead(self, count: u32) -> Self {
        let random_dead = count;
        Self {
            random_dead,
            ..self
        }
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
    /// Draws touches of each shape, names the shape of each as the noise `assumed` says, and counts. The dead taxels
    /// of `assumed` are left out, and so are those drawn for each touch.
    ///
    /// Each imprint is put in a random place on the sensor of the touches where all of it fits. Imprints that fit
    /// nowhere are not drawn ([`Self::poses_too_large`] counts them): the rate is that of the others. A shape none of
    /// whose imprints fits has no touches.
    ///
    /// `progress` is called with the number of touches done since the last call, and stops the simulation by
    /// returning `Break`. Returns None if it was stopped, or if there is no touch.
    pub fn recognition_rate(
        &self,
        touches: &NoisyTouches,
        assumed: &Noise,
        progress: &dyn Progress,
    ) -> Option<RecognitionRate> {
        let judge = |touch: &Imprint, dead: &Imprint| {
            let known = match assumed.dead() {
                Some(known) => known.resized(dead.size()).union(dead),
                None => *dead,
            };
            let posterior = self.posterior_under(touch, &assumed.with_dead(known));
            Judgement {
                is_held: self.keys().find(&ImprintKey::of(touch)).is_some(),
                named: posterior.and_then(|own| first_of_most(own.into_iter().enumerate())),
            }
        };
        self.simulated(touches, progress, &judge)
    }

    /// Draws touches as [`Self::recognition_rate`] does. `judge` names the shape of each touch, given the dead taxels
    /// that were drawn for it.
    pub(super) fn simulated(
        &self,
        touches: &NoisyTouches,
        progress: &dyn Progress,
        judge: &(dyn Fn(&Imprint, &Imprint) -> Judgement + Sync),
    ) -> Option<RecognitionRate> {
        const CHUNK: u64 = 50;
        /// Chunks whose counts are held at a time: a billion touches would take gigabytes.
        const HELD: usize = 4096;
        let (size, per_shape) = (touches.size, touches.per_shape);
        let shifts = |key: usize| {
            let key = self.keys().get(key);
            shift_count((key.width, key.height), size)
        };
        let draws = Draw::all(self, shifts);
        let chunks = per_shape.div_ceil(CHUNK);
        let mut tasks =
            (0..draws.len()).flat_map(|shape| (0..chunks).map(move |chunk| (shape, chunk)));
        let stopped = AtomicBool::new(false);
        let rate = |(shape, chunk): (usize, u64)| {
            let number = chunk * draws.len() as u64 + shape as u64;
            let mut random = generator(touches.seed, number);
            // Tasks are numbered from the last one down: independent of all touches, and the same for any noise.
            let mut random_of_dead = generator(touches.seed, !number);
            let mut rate = ShapeRate::default();
            for _ in 0..CHUNK.min(per_shape - chunk * CHUNK) {
                if stopped.load(Ordering::Relaxed) {
                    break;
                }
                let Some(key) = draws[shape].key(&mut random) else {
                    break;
                };
                let dead = random_taxels(size, touches.random_dead, &mut random_of_dead);
                let touch = self.touch_of(key, touches, &mut random).without(&dead);
                rate.count(shape, &judge(&touch, &dead));
                if progress.add(1).is_break() {
                    stopped.store(true, Ordering::Relaxed);
                }
            }
            rate
        };
        let mut rates = vec![ShapeRate::default(); draws.len()];
        while !stopped.load(Ordering::Relaxed) {
            let held: Vec<(usize, u64)> = tasks.by_ref().take(HELD).collect();
            if held.is_empty() {
                break;
            }
            let counted: Vec<ShapeRate> = held.par_iter().map(|&task| rate(task)).collect();
            // In order, so that the sums have the same digits for any number of threads.
            for ((shape, _), counted) in held.into_iter().zip(counted) {
                rates[shape].add(counted);
            }
        }
        let weights = self.shapes().iter().map(|shape| shape.weight);
        let rates: Vec<(u32, ShapeRate)> = weights.zip(rates).collect();
        let rate = RecognitionRate::of(&rates);
        (!stopped.into_inner() && rate.touches > 0).then_some(rate)
    }

    fn touch_of(&self, key: usize, touches: &NoisyTouches, random: &mut Pcg64) -> Imprint {
        let (size, noise) = (touches.size, &touches.noise);
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

#[cfg(test)]
mod tests {
    use super::*;
    use crate::figure::Figure;
    use crate::pose::{Anchor, Ranges};
    use crate::progress::ToTheEnd;
    use crate::recognition::{NamedShape, Training};
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
        let touches = NoisyTouches::new(sensor.size(), noise, 2000, 0);
        let rate = model.recognition_rate(&touches, &noise, &ToTheEnd);
        let rate = rate.expect("not stopped");
        // The long one is always named, so only the confidence is left to chance.
        assert_eq!((rate.touches, rate.right), (4000, 2000));
        let weighted = (rate.weighted_touches(), rate.weighted_right());
        assert_eq!(weighted, (20_000, 18_000));
        assert_eq!((rate.accuracy(), rate.standard_error()), (0.9, 0.0));
        assert!((rate.mean_confidence() - 0.9).abs() < 0.002, "{rate:?}");
    }

    /// On a matrix as large as the shapes, one taxel tells them apart. If it is dead, the first shape is named.
    #[test]
    fn the_standard_error_includes_which_taxels_are_dead() {
        let sensor = Sensor::new(5, 1).expect("in range");
        let bar = |length| {
            Figure::rectangle(length, 1.0)
                .on(&sensor)
                .expect("in range")
        };
        let shapes = [("long", 5.0), ("bitten", 4.0)];
        let shapes = shapes.map(|(name, length)| NamedShape::new(name, bar(length)));
        let range = |text: &str| text.parse().expect("a range");
        let ranges = Ranges::new(["0", "0", "0", "1", "1"].map(range));
        let training = Training::new(shapes, sensor, Anchor::Corner, ranges);
        let model = training.expect("a set").run().expect("not stopped");
        let noise = Noise::new(0.0).expect("in range");
        let rate = |seed| {
            let touches = NoisyTouches::new(sensor.size(), noise, 200, seed).with_random_dead(2);
            let rate = model.recognition_rate(&touches, &noise, &ToTheEnd);
            rate.expect("not stopped")
        };
        let rates: Vec<RecognitionRate> = (0..100).map(rate).collect();
        let count = float(rates.len() as u64);
        let mean = rates.iter().map(RecognitionRate::accuracy).sum::<f64>() / count;
        let apart = rates.iter().map(|rate| (rate.accuracy() - mean).powi(2));
        let found = (apart.sum::<f64>() / (count - 1.0)).sqrt();
        let stated = rates.iter().map(RecognitionRate::standard_error);
        let stated = stated.sum::<f64>() / count;
        assert!(stated > 0.0);
        assert!((found / stated - 1.0).abs() < 0.3, "{found} {stated}");
    }

    /// The imprint of the bar is 5 taxels long, or 6 if the bar lies between taxels.
    #[test]
    fn touches_that_fit_nowhere_are_left_out_and_counted() {
        let sensor = Sensor::default();
        let bar = Figure::rectangle(5.2, 1.0).on(&sensor).expect("in range");
        let shapes = [NamedShape::new("bar", bar)];
        let range = |text: &str| text.parse().expect("a range");
        let ranges = Ranges::new(["5:5.9:0.1", "5", "0", "1", "1"].map(range));
        let training = Training::new(shapes, sensor, Anchor::Corner, ranges);
        let model = training.expect("a set").run().expect("not stopped");
        let too_large = [5, 6, 7].map(|columns| model.poses_too_large(MatrixSize::of(columns, 1)));
        assert_eq!(too_large, [vec![3], vec![0], vec![0]]);
        let noise = Noise::new(0.0).expect("in range");
        let rate = |columns| {
            let sensor = Sensor::new(columns, 1).expect("in range");
            let touches = NoisyTouches::new(sensor.size(), noise, 10, 0);
            let rate = model.recognition_rate(&touches, &noise, &ToTheEnd);
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
        assert_eq!(found.accuracy(), 230.0 / 400.0);
        // The variances are 25 and 16.
        let error = (9.0 * 25.0 + 16.0_f64).sqrt() / 400.0;
        assert!((found.standard_error() - error).abs() < 1e-15, "{found:?}");
    }

    #[test]
    fn examples() -> Result<(), Box<dyn std::error::Error>> {
        use crate::progress::ToTheEnd;
        use crate::recognition::{GridSteps, Noise, NoisyTouches, Training, equal_figures};
        let model = Training::fitting(equal_figures(), GridSteps::new(4, 15)?)?.run()?;
        let noise = Noise::new(0.01)?;
        let touches = NoisyTouches::new(model.sensor().size(), noise, 100, 0);
        let rate = model
            .recognition_rate(&touches, &noise, &ToTheEnd)
            .expect("not stopped");
        let touches = touches.with_random_dead(64);
        let fewer = model
            .recognition_rate(&touches, &noise, &ToTheEnd)
            .expect("not stopped");
        assert!(fewer.accuracy() < rate.accuracy());
        Ok(())
    }
}
