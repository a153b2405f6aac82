//! Sums per orientation, which show how much of a variance comes from the position and how much from the angle.
//!
//! As soon as all poses of an orientation have been added, only its contribution is stored. Incomplete orientations are
//! stored one by one.

use std::collections::BTreeMap;

use crate::atlas::feature::features;
use crate::atlas::sums::Wide;
use crate::atlas::values::{RowSums, Sum, Table};
use crate::index::{lower_word, wide};
use crate::pose::MAX_VALUES;

/// The sums of one orientation.
#[derive(Clone, Debug, Default, PartialEq, Eq)]
pub(crate) struct OrientationSums {
    poses: u64,
    /// The number of orientations with the same imprints, including this one.
    multiplicity: u64,
    sums: Vec<Sum>,
}

impl OrientationSums {
    /// Computes the sums over imprints; `counted` gives each imprint with the number of poses in one orientation that
    /// leave it.
    pub(crate) fn of(
        table: &Table,
        multiplicity: u64,
        counted: impl Iterator<Item = (u32, u64)>,
    ) -> Self {
        let mut rows = RowSums::new();
        for (id, count) in counted {
            rows.add(table.row(wide(id)), count);
        }
        Self {
            poses: rows.poses(),
            multiplicity,
            sums: rows.sums(),
        }
    }

    /// Returns true if these sums are possible for an orientation of `full` poses. Other sums, from a damaged file,
    /// could overflow later.
    fn is_sound(&self, full: u64) -> bool {
        let sound = |sum: &Sum| {
            let most = u128::from(sum.poses) << 58;
            sum.poses <= self.poses && sum.x.unsigned_abs() <= most && sum.y.unsigned_abs() <= most
        };
        self.poses <= full && self.multiplicity <= MAX_VALUES && self.sums.iter().all(sound)
    }
}

/// The parts of each feature's variance that come from the position and from the orientation.
#[derive(Clone, Debug, PartialEq, Eq)]
pub(crate) struct VarianceParts {
    full: u64,
    /// For each feature, over the complete orientations: the sum of sum²/poses, or of the vectors' lengths for a
    /// circular feature.
    between: Vec<Wide>,
    /// The incomplete orientations, by their number.
    open: BTreeMap<u64, OrientationSums>,
}

impl VarianceParts {
    pub(crate) fn new(full: u64) -> Self {
        Self {
            full,
            between: vec![Wide::default(); features().len()],
            open: BTreeMap::new(),
        }
    }

    /// Adds a part of an orientation. All parts of an orientation must have the same `multiplicity`.
    pub(crate) fn add(&mut self, orientation: u64, part: OrientationSums) {
        let sums = match self.open.remove(&orientation) {
            Some(mut sums) => {
                sums.poses += part.poses;
                for (sum, other) in sums.sums.iter_mut().zip(&part.sums) {
                    sum.merge(other);
                }
                sums
            }
            None => part,
        };
        if sums.poses >= self.full {
            close(&mut self.between, &sums);
        } else {
            self.open.insert(orientation, sums);
        }
    }

    pub(crate) fn merge(&mut self, other: Self) {
        for (sum, other) in self.between.iter_mut().zip(other.between) {
            *sum += other;
        }
        for (orientation, sums) in other.open {
            self.add(orientation, sums);
        }
    }

    /// Returns the parts as words: three per feature, then each incomplete orientation.
    pub(crate) fn words(&self) -> Vec<u64> {
        let halves = |sum: i128| {
            let bits = sum.cast_unsigned();
            [lower_word(bits), lower_word(bits >> 64)]
        };
        let mut words: Vec<u64> = self.between.iter().flat_map(|sum| sum.words()).collect();
        for (&orientation, sums) in &self.open {
            words.extend([orientation, sums.poses, sums.multiplicity]);
            for sum in &sums.sums {
                words.push(sum.poses);
                words.extend(halves(sum.x));
                words.extend(halves(sum.y));
            }
        }
        words
    }

    /// Creates the parts from words; None if the number of words is wrong, or if they are not possible for orientations
    /// of `full` poses.
    pub(crate) fn from_words(full: u64, words: &[u64]) -> Option<Self> {
        let count = features().len();
        let (between, open) = words.split_at_checked(3 * count)?;
        let whole =
            |words: &[u64]| (u128::from(words[0]) | u128::from(words[1]) << 64).cast_signed();
        let orientations = open.chunks_exact(3 + 5 * count);
        if !orientations.remainder().is_empty() {
            return None;
        }
        let orientation = |words: &[u64]| {
            let sum = |words: &[u64]| Sum {
                poses: words[0],
                x: whole(&words[1..3]),
                y: whole(&words[3..5]),
            };
            let sums = OrientationSums {
                poses: words[1],
                multiplicity: words[2],
                sums: words[3..].chunks_exact(5).map(sum).collect(),
            };
            sums.is_sound(full).then_some((words[0], sums))
        };
        let wide = |words: &[u64]| Wide::from_words([words[0], words[1], words[2]]);
        Some(Self {
            full,
            between: between.chunks_exact(3).map(wide).collect(),
            open: orientations.map(orientation).collect::<Option<_>>()?,
        })
    }

    /// Returns `between`, with every orientation taken as complete.
    pub(crate) fn closed(&self) -> Vec<Wide> {
        let mut between = self.between.clone();
        for sums in self.open.values() {
            close(&mut between, sums);
        }
        between
    }
}

fn close(between: &mut [Wide], orientation: &OrientationSums) {
    let features = between.iter_mut().zip(&orientation.sums).zip(features());
    for ((between, sum), feature) in features {
        if sum.poses == 0 {
            continue;
        }
        let part = if feature.circular {
            Wide::rounded(sum.length())
        } else {
            Wide::square_over(sum.total(), sum.poses)
        };
        *between += part.times(orientation.multiplicity);
    }
}
