use rand_pcg::Pcg64;
use rayon::prelude::*;

use crate::index::wide;
use crate::progress::Progress;
use crate::recognition::model::{Model, add_log_counts, first_of_most, float};
use crate::recognition::random::generator;
use crate::recognition::simulation::Draw;

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
            let run = |counts: RunCounts, run: u64| {
                let task = run.wrapping_mul(shapes).wrapping_add(shape as u64);
                let mut random = generator(seed, task);
                let length = self.run_until(until, draw, shape, &mut random);
                let flow = progress.add(1);
                flow.is_continue().then(|| counts.with(length))
            };
            (0..runs)
                .into_par_iter()
                .try_fold(RunCounts::default, run)
                .try_reduce(RunCounts::default, |one, other| Some(one.sum(&other)))
        };
        let counts = draws.iter().enumerate().map(of_shape);
        counts.map(|own| Some(own?.summary())).collect()
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

/// The counts of the runs of a shape. They are whole numbers, so their order does not matter, and they take no more
/// memory for more runs.
#[derive(Default)]
struct RunCounts {
    runs: u64,
    right: u64,
    /// The number of runs of each length, from 0 touches on, that reached the probability.
    of_length: Vec<u64>,
}

impl RunCounts {
    /// Counts a run: its number of touches, and whether it ended with the right shape; None if it was abandoned.
    fn with(mut self, run: Option<(u32, bool)>) -> Self {
        self.runs += 1;
        if let Some((length, right)) = run {
            let length = wide(length);
            self.right += u64::from(right);
            let longest = self.of_length.len().max(length + 1);
            self.of_length.resize(longest, 0);
            self.of_length[length] += 1;
        }
        self
    }

    fn sum(mut self, other: &Self) -> Self {
        self.runs += other.runs;
        self.right += other.right;
        let longest = self.of_length.len().max(other.of_length.len());
        self.of_length.resize(longest, 0);
        for (own, more) in self.of_length.iter_mut().zip(&other.of_length) {
            *own += more;
        }
        self
    }

    /// Returns the mean and its standard error. Both are None if a run was abandoned: without it, the mean would be too
    /// small.
    fn summary(&self) -> TouchesUntil {
        let runs = self.runs;
        let reached = self.of_length.iter().sum();
        let sum_of = |value: &dyn Fn(f64) -> f64| -> f64 {
            let lengths = (0..).map(float).zip(&self.of_length);
            lengths
                .map(|(length, &runs)| value(length) * float(runs))
                .sum()
        };
        let mean = (reached == runs && runs > 0).then(|| sum_of(&|length| length) / float(runs));
        let standard_error = mean.filter(|_| runs > 1).map(|mean| {
            let squares = sum_of(&|length| (length - mean) * (length - mean));
            (squares / float(runs - 1) / float(runs)).sqrt()
        });
        TouchesUntil {
            mean,
            standard_error,
            reached,
            runs,
            right: self.right,
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::figure::Figure;
    use crate::pose::{Anchor, Ranges};
    use crate::progress::{ToTheEnd, stop_if};
    use crate::recognition::{NamedShape, Noise, NoisyTouches, Training};
    use crate::sensor::Sensor;

    fn summary(runs: &[Option<(u32, bool)>]) -> TouchesUntil {
        let counts = runs.iter().copied();
        let half = counts
            .clone()
            .take(1)
            .fold(RunCounts::default(), RunCounts::with);
        let rest = counts.skip(1).fold(RunCounts::default(), RunCounts::with);
        half.sum(&rest).summary()
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
        let known = summary(&[Some((2, true)), Some((4, true))]);
        assert_eq!((known.mean, known.standard_error), (Some(3.0), Some(1.0)));
        let unknown = summary(&[Some((2, true)), None, Some((4, true))]);
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
        let touches = NoisyTouches::new(sensor.size(), noise, 10, 0);
        let rate = model.recognition_rate(&touches, &noise, &ToTheEnd);
        assert_eq!(rate.map(|rate| (rate.touches, rate.right)), Some((20, 10)));
        // One is always named right, the other never: the accuracy is ½ for every seed.
        let error = rate.map(|rate| (rate.accuracy(), rate.standard_error()));
        assert_eq!(error, Some((0.5, 0.0)));
    }

    #[test]
    fn a_single_run_has_a_mean_but_no_error() {
        let found = summary(&[Some((3, true))]);
        assert_eq!((found.mean, found.standard_error), (Some(3.0), None));
        let found = summary(&[Some((3, true)), Some((5, false))]);
        assert_eq!((found.mean, found.standard_error), (Some(4.0), Some(1.0)));
        assert_eq!((found.reached, found.right), (2, 1));
    }
}
