use std::collections::BTreeMap;

use rand_core::SeedableRng;
use rand_pcg::Pcg64;

use crate::recognition::classifiers::features::FeatureTable;
use crate::recognition::model::{Model, float};
use crate::recognition::simulation::Draw;

/// Poses that a classifier drew at random.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash)]
pub struct PoseSample {
    /// The number of poses of each shape.
    pub per_shape: usize,
    /// The seed for drawing these poses.
    pub seed: u64,
}

impl PoseSample {
    /// Returns true if poses are drawn, because these are fewer than each shape has.
    pub(super) fn is_drawn(self, model: &Model) -> bool {
        (self.per_shape as u64) < model.poses()
    }
}

/// The touches that vote: a random sample, or all touches.
pub(super) struct Sample {
    touches: Vec<SampledTouches>,
    shapes: usize,
}

/// Touches of one shape that leave the same key.
struct SampledTouches {
    key: usize,
    shape: usize,
    /// The number of the touches, each of which is a vote.
    votes: u64,
}

impl Sample {
    pub(super) fn new(model: &Model, sample: PoseSample) -> Self {
        let shapes = model.shapes().len();
        let touches = if sample.is_drawn(model) {
            Self::drawn(model, sample)
        } else {
            let own = |key| {
                let counts = model.counts(key).iter();
                counts.map(move |count| SampledTouches {
                    key,
                    shape: usize::from(count.shape),
                    votes: count.poses,
                })
            };
            (0..model.keys().len()).flat_map(own).collect()
        };
        Self { touches, shapes }
    }

    /// Draws touches. Returns them in the order of their keys.
    fn drawn(model: &Model, sample: PoseSample) -> Vec<SampledTouches> {
        let mut random = Pcg64::seed_from_u64(sample.seed);
        let mut votes = BTreeMap::new();
        for (shape, draw) in Draw::all(model, |_| 1).iter().enumerate() {
            for key in (0..sample.per_shape).filter_map(|_| draw.key(&mut random)) {
                *votes.entry((key, shape)).or_insert(0) += 1;
            }
        }
        let votes = votes.into_iter();
        votes
            .map(|((key, shape), votes)| SampledTouches { key, shape, votes })
            .collect()
    }

    /// Returns minus the votes of each shape. All touches as near as the last neighbour vote too, since many touches
    /// have the same features.
    pub(super) fn scores(&self, table: &FeatureTable, neighbours: usize, key: usize) -> Vec<f64> {
        let row = table.row(key);
        let mut last = (usize::MAX, 0.0);
        let mut distances: Vec<(f64, usize, u64)> = Vec::with_capacity(self.touches.len());
        for touches in &self.touches {
            if touches.key != last.0 {
                let parts = row.iter().zip(table.row(touches.key));
                let distance = parts.map(|(one, two)| (one - two) * (one - two)).sum();
                last = (touches.key, distance);
            }
            distances.push((last.1, touches.shape, touches.votes));
        }
        let mut scores = vec![0.0; self.shapes];
        let Some(rank) = neighbours.min(distances.len()).checked_sub(1) else {
            return scores;
        };
        let order = |one: &(f64, usize, u64), other: &(f64, usize, u64)| one.0.total_cmp(&other.0);
        // Each entry has at least one vote, so the first `neighbours` entries include the last neighbour.
        distances.select_nth_unstable_by(rank, order);
        distances[..=rank].sort_unstable_by(order);
        let mut nearer = 0;
        let last = distances[..=rank].iter().find(|(_, _, votes)| {
            nearer += u128::from(*votes);
            nearer >= neighbours as u128
        });
        let farthest = last.unwrap_or(&distances[rank]).0;
        for (_, shape, votes) in distances.iter().filter(|own| own.0 <= farthest) {
            scores[*shape] -= float(*votes);
        }
        scores
    }
}
