//! The likelihood of an imprint with failing taxels ([`Noise`]): each flips with probability e.
//!
//! The sums are of integers: for each shape, how many touches lie at each distance. So one scan serves any e, and
//! neither threads nor the order of keys matter. Only distances up to D are kept: D follows from e, the weights and the
//! least distance, and larger distances change no probability by more than 1e-9. If several touches contradict each
//! other, what is improbable for one of them may decide, so D grows until this holds for all of them together.
//!
//! [`scan`](super::scan) finds the near keys.

use crate::imprint::Imprint;
use crate::index::{narrow, wide};
use crate::parameter::named;
use crate::recognition::model::{Model, ScanTables, float};
use crate::recognition::scan::{Nearest, Observed, shift_count};
use crate::sensor::MatrixSize;

/// The keys that were compared for an answer.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash)]
pub enum SearchMethod {
    /// The key of the imprint itself.
    Exact,
    /// All keys in all places.
    Scan,
}

named!(SearchMethod, "method", [Exact "exact", Scan "scan"]);

/// The number of touches of each shape at each distance from an imprint.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct Distances {
    /// The nearest touch.
    pub nearest: Nearest,
    /// For each shape, the number of touches at each distance from that of the nearest on.
    pub touches: Vec<Vec<u64>>,
}

impl Model {
    /// Returns P(shape | imprint) for each shape of the set, with failing taxels ([`Noise`]); None if no key fits the
    /// matrix, or, without noise, if no shape leaves the imprint. Of a shard, only its own poses count.
    ///
    /// The prior is uniform over every pose in every place on the matrix. The first call sorts the keys for scans and
    /// takes longer.
    pub fn posterior_under(&self, imprint: &Imprint, noise: &Noise) -> Option<Vec<f64>> {
        let distances = self.distances(imprint, noise)?;
        let totals = self.touches_on(imprint.size());
        let own = self.shapes().iter().zip(&distances.touches).zip(totals);
        let likelihoods = own.map(|((shape, touches), total)| match total {
            0 => 0.0,
            total => weighed(touches, noise) / float(total) * f64::from(shape.weight),
        });
        let likelihoods: Vec<f64> = likelihoods.collect();
        let sum: f64 = likelihoods.iter().sum();
        (sum > 0.0).then(|| likelihoods.into_iter().map(|own| own / sum).collect())
    }

    /// Returns a lower and an upper bound of ln P(imprint | s) for each shape, plus a common number: without and with
    /// all touches beyond `distances`. Both are −∞ for a shape if none of its imprints fits the matrix.
    pub(super) fn log_likelihoods(
        &self,
        imprint: &Imprint,
        distances: &Distances,
        noise: &Noise,
    ) -> Vec<[f64; 2]> {
        let fall = libm::log(noise.ratio());
        let all = narrow(imprint.size().cells());
        let bounds = |(touches, total): (&Vec<u64>, u64)| {
            if total == 0 {
                return [f64::NEG_INFINITY; 2];
            }
            // From the shape's own nearest touch on, so that no sum is too small for an `f64`.
            let from = touches.iter().position(|&touches| touches > 0);
            let least = from.map_or(f64::NEG_INFINITY, |from| {
                let sum = libm::log(weighed(&touches[from..], noise) / float(total));
                if from == 0 {
                    sum
                } else {
                    sum + float(from as u64) * fall
                }
            });
            let reached = touches.len() as u64;
            let beyond = if u64::from(distances.nearest.distance) + reached > u64::from(all) {
                f64::NEG_INFINITY
            } else {
                float(reached) * fall
            };
            [least, log_of_sum(least, beyond)]
        };
        let totals = self.touches_on(imprint.size());
        let own = distances.touches.iter().zip(totals);
        own.map(bounds).collect()
    }

    /// Returns the number of touches of each shape on a matrix of this size: its poses, in every place where they
    /// fit.
    fn touches_on(&self, size: MatrixSize) -> Vec<u64> {
        let mut sums = vec![0; self.shapes().len()];
        let ScanTables { index, poses } = self.scan_tables();
        for (own, poses) in index.boxes().iter().zip(poses.chunks(sums.len())) {
            let places = shift_count((own.width, own.height), size);
            for (sum, poses) in sums.iter_mut().zip(poses) {
                *sum += poses * places;
            }
        }
        sums
    }

    /// Returns how many touches of each shape lie at the distances from an imprint that matter under a noise. None if
    /// no key fits the matrix, or, without noise, if no shape leaves the imprint.
    pub fn distances(&self, imprint: &Imprint, noise: &Noise) -> Option<Distances> {
        self.distances_further(imprint, noise, 0)
    }

    /// Returns the same as [`Self::distances`], with `further` more distances.
    pub(super) fn distances_further(
        &self,
        imprint: &Imprint,
        noise: &Noise,
        further: u32,
    ) -> Option<Distances> {
        let totals = self.touches_on(imprint.size());
        // All touches of a shape together weigh w; the nearest one weighs w / T of its shape.
        let weights = self.shapes().iter().map(|shape| f64::from(shape.weight));
        let of_all: f64 = weights.clone().sum();
        let of_one = totals.iter().zip(weights);
        let odds = of_one.map(|(&total, weight)| float(total) / weight * of_all);
        let reach = noise.reach(odds.fold(1.0, f64::max)) + further;
        let observed = Observed::new(imprint, noise.dead());
        let nearest = self.nearest_to(&observed)?;
        let least = nearest.distance;
        if noise.flip() == 0.0 && least > 0 {
            return None;
        }
        // No distance is larger than the number of taxels.
        let all = narrow(imprint.size().cells());
        let most = all.min(least + reach);
        Some(Distances {
            nearest,
            touches: self.histogram(&observed, least, most),
        })
    }

    fn histogram(&self, observed: &Observed, least: u32, most: u32) -> Vec<Vec<u64>> {
        let (shapes, width) = (self.shapes().len(), wide(most - least) + 1);
        let take = |sums: &mut Vec<u64>, key: usize, places: &[u32]| {
            for count in self.counts(key) {
                let own = &mut sums[usize::from(count.shape) * width..][..width];
                for (sum, &places) in own.iter_mut().zip(places) {
                    *sum += count.poses * u64::from(places);
                }
            }
        };
        let none = || vec![0_u64; shapes * width];
        let sums = (self.scan_tables().index).counted(observed, (least, most), none, take, added);
        sums.chunks(width).map(<[u64]>::to_vec).collect()
    }
}

/// Returns the sum of touches at increasing distances, each weighted by the probability of its distance.
fn weighed(touches: &[u64], noise: &Noise) -> f64 {
    // From far to near, so that small numbers are added first.
    let touches = touches.iter().rev();
    touches.fold(0.0, |sum, &touches| sum * noise.ratio() + float(touches))
}

/// Returns ln(e^one + e^other).
fn log_of_sum(one: f64, other: f64) -> f64 {
    let (low, high) = (one.min(other), one.max(other));
    if low == f64::NEG_INFINITY {
        return high;
    }
    high + libm::log1p(libm::exp(low - high))
}

fn added(mut one: Vec<u64>, other: Vec<u64>) -> Vec<u64> {
    one.iter_mut()
        .zip(other)
        .for_each(|(sum, more)| *sum += more);
    one
}

/// The largest change of a probability that leaving out far keys may cause.
pub(super) const NEGLIGIBLE: f64 = 1e-9;

/// The probability that a taxel flips, from 0 to below ½, and the taxels that are known to be dead.
///
/// Each taxel flips with probability e, independently of the others, so an imprint of the shape s has the probability
/// ```text
/// P(imprint | s) = Σ over keys k and shifts of  n[s, k] · e^d (1 − e)^(cells − d)  / T[s]
/// ```
/// where `n[s, k]` is the number of poses in which s leaves k, d the number of taxels in which the imprint and the
/// shifted key differ, and `T[s]` the number of touches of s: its poses, times the shifts of the key on the matrix. So
/// the prior is uniform over every pose in every place on the matrix. Taxels that are known to be dead are left out of
/// d and of `cells`.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Noise {
    flip: f64,
    dead: Option<Imprint>,
}

/// The error for a probability that is out of range.
#[derive(Clone, Copy, Debug, PartialEq, thiserror::Error)]
#[error("noise {found}: {}", self.expected())]
pub struct NoiseError {
    /// The given probability.
    pub found: f64,
}

impl NoiseError {
    /// Returns the part of the message that says what was expected, for a place that shows the number itself.
    #[must_use]
    pub fn expected(&self) -> &'static str {
        "expected a probability from 0 to below 0.5"
    }
}

impl Default for Noise {
    /// One taxel of a hundred: under this noise shapes are ranked if none is given, because a touch between the poses
    /// of a model differs in a few taxels from their imprints.
    fn default() -> Self {
        Self {
            flip: 0.01,
            dead: None,
        }
    }
}

impl Noise {
    /// Creates a noise in which every taxel flips with this probability.
    ///
    /// # Errors
    /// Returns an error if the probability is not from 0 to below ½.
    pub fn new(flip: f64) -> Result<Self, NoiseError> {
        if (0.0..0.5).contains(&flip) {
            Ok(Self { flip, dead: None })
        } else {
            Err(NoiseError { found: flip })
        }
    }

    /// Returns the same noise with the active taxels of `dead` as its dead taxels, in place of those that it had. They
    /// are stuck on or off, so they are ignored. Taxels beyond an imprint do not matter.
    #[must_use]
    pub fn with_dead(self, dead: Imprint) -> Self {
        let dead = (!dead.is_empty()).then_some(dead);
        Self { dead, ..self }
    }

    /// Returns the probability that a taxel flips.
    pub fn flip(&self) -> f64 {
        self.flip
    }

    /// Returns the dead taxels, which are left out; None if all taxels count.
    pub fn dead(&self) -> Option<&Imprint> {
        self.dead.as_ref()
    }

    /// Returns the fewest taxels of a matrix such that no more flip in 999 of 1,000 touches.
    pub(super) fn most_flips(&self, size: MatrixSize) -> u32 {
        let dead = self.dead.map_or(0, |dead| dead.resized(size).count());
        let cells = narrow(size.cells()) - dead;
        // As logarithms: the first terms may be too small for an `f64`.
        let mut term = f64::from(cells) * libm::log1p(-self.flip);
        let mut sum = libm::exp(term);
        let mut flips = 0;
        while sum < 0.999 && flips < cells {
            let ways = f64::from(cells - flips) / f64::from(flips + 1);
            term += libm::log(ways) + libm::log(self.ratio());
            sum += libm::exp(term);
            flips += 1;
        }
        flips
    }

    /// Returns the factor by which each differing taxel makes a touch less probable.
    pub(super) fn ratio(&self) -> f64 {
        self.flip / (1.0 - self.flip)
    }

    /// Returns how many distances beyond the least one matter, if all touches together, without regard to their
    /// distances, are at most `odds` times as probable as the nearest one.
    pub(super) fn reach(&self, odds: f64) -> u32 {
        if self.flip == 0.0 {
            return 0;
        }
        // The nearest touch weighs 1, all touches beyond D at most odds · ratio^(D + 1 − least).
        let steps = libm::log(NEGLIGIBLE / odds) / libm::log(self.ratio());
        #[expect(
            clippy::cast_possible_truncation,
            clippy::cast_sign_loss,
            reason = "from 0 to 4096, the most taxels of a matrix"
        )]
        let beyond = steps.ceil().clamp(1.0, 4097.0) as u32;
        beyond - 1
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::figure::Figure;
    use crate::pose::{Anchor, Axis, Ranges};
    use crate::recognition::{NamedShape, Training};
    use crate::sensor::Sensor;

    fn rectangles() -> Model {
        let sensor = Sensor::default();
        let shapes = [(5.0, 3.0), (5.0, 3.3), (4.2, 4.2)].map(|(length, width)| {
            let figure = Figure::rectangle(length, width).on(&sensor);
            NamedShape::new(format!("{length} × {width}"), figure.expect("in range"))
        });
        let range = |text: &str| text.parse().expect("a range");
        let ranges = Ranges::default()
            .with(Axis::X0, range("5:5.9:0.1"))
            .with(Axis::Y0, range("5:5.9:0.1"))
            .with(Axis::Angle, range("0:350:10"));
        let training = Training::new(shapes, sensor, Anchor::Corner, ranges).expect("a set");
        training.run().expect("nothing is cut off")
    }

    #[test]
    fn many_tasks_on_several_threads_find_what_one_finds() {
        let model = rectangles();
        let tasks = model.keys().len() / 64;
        assert!(tasks > 4, "{tasks} tasks");
        let mut touch = Imprint::empty(MatrixSize::of(16, 16));
        for row in 3..7 {
            touch.set_word(row, 0b1111_1000);
        }
        touch.toggle(12, 12);
        let noise = Noise::new(0.03).expect("in range");
        let with = |threads| {
            let pool = rayon::ThreadPoolBuilder::new().num_threads(threads).build();
            let found = || (model.distances(&touch, &noise), model.nearest(&touch, None));
            pool.expect("threads").install(found)
        };
        let one = with(1);
        assert!(one.0.is_some() && one.1.is_some());
        for _ in 0..10 {
            assert_eq!((with(2), with(4)), (one.clone(), one.clone()));
        }
    }

    #[test]
    fn a_mask_of_another_size_is_cut_or_filled_up() {
        let model = rectangles();
        let touch: Imprint = "......\n.####.\n.####.\n.####.\n.#....\n......"
            .parse()
            .expect("an imprint");
        let mask = |columns, rows| {
            let mut dead = Imprint::empty(MatrixSize::of(columns, rows));
            dead.set(1, 4, true);
            let noise = Noise::new(0.01).expect("in range").with_dead(dead);
            model.posterior_under(&touch, &noise)
        };
        let own = mask(6, 6);
        assert!(own.is_some());
        assert_eq!((mask(2, 5), mask(64, 64)), (own.clone(), own));
    }

    #[test]
    fn a_strong_noise_counts_no_distance_beyond_the_matrix() {
        let noise = Noise::new(0.4999).expect("in range");
        let touch = Imprint::empty(MatrixSize::of(16, 16));
        let distances = rectangles().distances(&touch, &noise).expect("they fit");
        for touches in &distances.touches {
            assert_eq!(
                distances.nearest.distance as usize + touches.len(),
                16 * 16 + 1
            );
        }
    }

    #[test]
    fn a_likelihood_has_an_upper_bound_until_every_distance_is_counted() {
        let sensor = Sensor::default();
        let dot = Figure::rectangle(1.0, 1.0).on(&sensor).expect("in range");
        let range = |text: &str| text.parse().expect("a range");
        let ranges = Ranges::default()
            .with(Axis::X0, range("5"))
            .with(Axis::Y0, range("5"))
            .with(Axis::Angle, range("0"));
        let training = Training::new(
            [NamedShape::new("dot", dot)],
            sensor,
            Anchor::Corner,
            ranges,
        );
        let model = training.expect("a set").run().expect("not stopped");
        let noise = Noise::new(0.1).expect("in range");
        let touch: Imprint = "#.".parse().expect("an imprint");
        let bounds = |touches: &[u64]| {
            let distances = Distances {
                nearest: model.nearest(&touch, None).expect("it fits"),
                touches: vec![touches.to_vec()],
            };
            model.log_likelihoods(&touch, &distances, &noise)[0]
        };
        // In the other place both taxels differ.
        let [least, most] = bounds(&[1, 0, 1]);
        assert_eq!(least, most);
        let exact = least;
        let [least, most] = bounds(&[1, 0]);
        assert!(least < exact && exact <= most, "{least} {exact} {most}");
    }

    #[test]
    fn few_touches_flip_more_taxels_than_the_quantile_says() {
        let size = MatrixSize::of(16, 16);
        let noise = |flip| Noise::new(flip).expect("in range");
        // By sums of exact fractions.
        for (flip, expected) in [(0.001, 3), (0.01, 9), (0.02, 13), (0.1, 41), (0.49, 150)] {
            assert_eq!(noise(flip).most_flips(size), expected, "{flip}");
        }
        // The largest matrix, where the probability of no flip is too small for an `f64`.
        assert_eq!(noise(0.49).most_flips(MatrixSize::of(64, 64)), 2106);
        // No flips are expected in dead taxels.
        let all = "#".repeat(16);
        let dead = [all.as_str(); 16].join("\n").parse().expect("rows");
        assert_eq!(noise(0.1).with_dead(dead).most_flips(size), 0);
    }
}
