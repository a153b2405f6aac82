//! A table of the values of all features of all imprints, from which statistics are computed.
//!
//! The values are fixed-point numbers ([`fixed`]), because each one is added once per orientation.

use std::collections::BTreeMap;
use std::ops::{AddAssign, Sub};

use rayon::prelude::*;

use crate::atlas::feature::{COLUMNS, FEATURE_COUNT, ImprintSummary, ROW_WIDTH, feature_values};
use crate::geometry::Real;
use crate::index::{lower_word, wide};
use crate::pose::MAX_VALUES;

/// The number of rows in a part of a table. A single vector of all rows would be copied whenever it grows, and its
/// memory filled on one thread.
const PART: usize = 256;

/// The values of all features of the imprints of an atlas, one row per imprint.
#[derive(Clone, Debug)]
pub(crate) struct Table {
    /// The rows. All parts except the last have [`PART`] rows.
    parts: Vec<Vec<FeatureRow>>,
    imprints: usize,
    extremes: Extremes,
}

/// The smallest and the largest value of each feature; infinity and minus infinity where none exists.
type Extremes = [(f64, f64); FEATURE_COUNT];

const NOTHING: Extremes = [(f64::INFINITY, f64::NEG_INFINITY); FEATURE_COUNT];

/// The values of all features of an imprint.
#[derive(Clone, Copy, Debug)]
pub(crate) struct FeatureRow {
    /// The value of each feature, 0 if it does not exist. A circular feature has two values: its cosine and its sine.
    pub(crate) values: [i64; ROW_WIDTH],
    /// The features that do not exist, with feature `i` in bit `i`.
    missing: u32,
}

/// Checks at compile time that [`FeatureRow::missing`] has a bit for each feature.
const _: () = assert!(FEATURE_COUNT < 32);

impl FeatureRow {
    /// Computes the values of an imprint, and adds them to the extremes.
    fn of(summary: &ImprintSummary, extremes: &mut Extremes) -> Self {
        let mut row = Self {
            values: [0; ROW_WIDTH],
            missing: (1 << FEATURE_COUNT) - 1,
        };
        let note = |index: usize, value: f64| {
            row.missing &= !(1 << index);
            let (column, circular) = COLUMNS[index];
            if circular {
                let (sin, cos) = libm::sincos(value.to_radians());
                (row.values[column], row.values[column + 1]) = (signed(cos), signed(sin));
            } else {
                row.values[column] = fixed(value);
            }
            let (low, high) = &mut extremes[index];
            (*low, *high) = (Real::min(*low, value), Real::max(*high, value));
        };
        if let Some(description) = &summary.description {
            feature_values(description, note);
        }
        row
    }
}

impl Default for Table {
    fn default() -> Self {
        Self {
            parts: Vec::new(),
            imprints: 0,
            extremes: NOTHING,
        }
    }
}

impl Table {
    pub(crate) fn extend(&mut self, summaries: &[ImprintSummary]) {
        let new = &summaries[self.imprints.min(summaries.len())..];
        let room = self.imprints.next_multiple_of(PART) - self.imprints;
        let (first, rest) = new.split_at(room.min(new.len()));
        if let Some(part) = self.parts.last_mut() {
            let extremes = &mut self.extremes;
            part.extend(first.iter().map(|own| FeatureRow::of(own, extremes)));
        }
        let parts = rest.par_chunks(PART).map(|summaries| {
            let (mut part, mut extremes) = (Vec::with_capacity(PART), NOTHING);
            let rows = summaries.iter();
            part.extend(rows.map(|own| FeatureRow::of(own, &mut extremes)));
            (part, extremes)
        });
        for (part, extremes) in parts.collect::<Vec<_>>() {
            self.parts.push(part);
            for ((low, high), other) in self.extremes.iter_mut().zip(extremes) {
                (*low, *high) = (low.min(other.0), high.max(other.1));
            }
        }
        self.imprints = summaries.len();
    }

    pub(crate) fn row(&self, index: usize) -> &FeatureRow {
        &self.parts[index / PART][index % PART]
    }

    /// Returns the smallest and the largest value of a feature; None if no imprint has a value.
    pub(crate) fn extremes(&self, feature: usize) -> Option<(f64, f64)> {
        let (low, high) = self.extremes[feature];
        (low <= high).then_some((low, high))
    }
}

/// The number of poses that have a feature, and the sum of its values; of a circular feature, the sums of its
/// cosines and sines.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub(crate) struct Sum {
    pub(crate) poses: u64,
    pub(crate) x: i128,
    pub(crate) y: i128,
}

impl AddAssign for Sum {
    fn add_assign(&mut self, other: Self) {
        self.poses += other.poses;
        self.x += other.x;
        self.y += other.y;
    }
}

impl Sum {
    /// Returns the sum of a feature that is not circular. It is not negative, except in a damaged file, where it counts
    /// as 0.
    pub(crate) fn total(&self) -> u128 {
        self.x.max(0).cast_unsigned()
    }

    /// Returns the length of the sum of the unit vectors.
    #[expect(clippy::cast_precision_loss, reason = "the nearest f64 is wanted")]
    pub(crate) fn length(&self) -> f64 {
        libm::hypot(self.x as f64, self.y as f64)
    }

    fn words(self) -> [u64; 5] {
        let [x, y] = [self.x, self.y].map(i128::cast_unsigned);
        let upper = |sum: u128| lower_word(sum >> 64);
        [self.poses, lower_word(x), upper(x), lower_word(y), upper(y)]
    }

    fn from_words(words: &[u64]) -> Self {
        let whole = |low: u64, high: u64| (u128::from(low) | u128::from(high) << 64).cast_signed();
        Self {
            poses: words[0],
            x: whole(words[1], words[2]),
            y: whole(words[3], words[4]),
        }
    }
}

/// The sums of the columns of a table, each row times the number of poses that leave its imprint.
///
/// For each orientation, the rows of all of its imprints are added up, which is a large part of a sweep with many
/// imprints. So all columns are added in the same way, whether they have a value or not.
#[derive(Clone, Debug, Default)]
pub(crate) struct RowSums {
    /// The number of poses, with or without a value.
    poses: u64,
    columns: [i128; ROW_WIDTH],
    /// The number of poses in which each feature does not exist.
    missing: [u64; FEATURE_COUNT],
}

impl RowSums {
    /// Adds a row, times the number of poses that leave its imprint.
    pub(crate) fn add(&mut self, row: &FeatureRow, poses: u64) {
        self.poses += poses;
        // One multiplication of the processor is enough: both numbers fit into 64 bits with their signs.
        let times = i128::from(poses.cast_signed());
        for (sum, &value) in self.columns.iter_mut().zip(&row.values) {
            *sum += i128::from(value) * times;
        }
        let mut missing = row.missing;
        while missing != 0 {
            self.missing[wide(missing.trailing_zeros())] += poses;
            missing &= missing - 1;
        }
    }

    pub(crate) fn merge(&mut self, other: &Self) {
        self.poses += other.poses;
        add_each(&mut self.columns, &other.columns);
        add_each(&mut self.missing, &other.missing);
    }

    pub(crate) fn sums(&self) -> Vec<Sum> {
        let features = COLUMNS.iter().zip(&self.missing);
        let sum = |(&(column, circular), missing): (&(usize, bool), &u64)| Sum {
            poses: self.poses - missing,
            x: self.columns[column],
            y: if circular {
                self.columns[column + 1]
            } else {
                0
            },
        };
        features.map(sum).collect()
    }
}

pub(crate) fn add_each<T: AddAssign + Copy>(sums: &mut [T], others: &[T]) {
    for (sum, other) in sums.iter_mut().zip(others) {
        *sum += *other;
    }
}

// Sums of whole numbers, which are the same in any order, wide enough never to overflow.
//
// Threads, shards and symmetries change the order in which a sweep adds up, and sums of `f64` would change in their
// last digits with it. So a value counts as the nearest multiple of 2⁻⁴⁰ (an error below 5e-13). Values are below 2¹⁸
// and poses at most 10¹² < 2⁴⁰, so a sum of values takes 98 bits and a sum of squares 156.

/// The number one in fixed point.
pub(crate) const ONE: f64 = 1_099_511_627_776.0;

/// Returns a number in [0, 2²³) in fixed point: the nearest multiple of 2⁻⁴⁰, as a whole number. Negative numbers
/// become 0.
#[expect(clippy::cast_possible_truncation, reason = "below 2^63")]
pub(crate) fn fixed(value: f64) -> i64 {
    // Not `round`, which is a function call unless the processor is known to have the instruction.
    Real::max(value * ONE + 0.5, 0.0) as i64
}

#[expect(clippy::cast_possible_truncation, reason = "at most 2^40")]
pub(crate) fn signed(value: f64) -> i64 {
    (value * ONE).round() as i64
}

/// Returns the mean of `count` fixed-point numbers with this sum.
#[expect(clippy::cast_precision_loss, reason = "the nearest f64 is wanted")]
pub(crate) fn mean(sum: u128, count: u64) -> f64 {
    let (whole, rest) = (sum / u128::from(count), sum % u128::from(count));
    (whole as f64 + rest as f64 / count as f64) / ONE
}

#[expect(clippy::cast_precision_loss, reason = "the nearest f64 is wanted")]
pub(crate) fn signed_mean(sum: i128, count: u64) -> f64 {
    sum as f64 / count as f64 / ONE
}

/// A whole number from 0 to 2¹⁹² − 1.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub(crate) struct Wide {
    high: u64,
    low: u128,
}

impl Wide {
    pub(crate) fn of(low: u128) -> Self {
        Self { high: 0, low }
    }

    /// Creates the number `lower + upper · 2⁶⁴`.
    pub(crate) fn joined([lower, upper]: [u128; 2]) -> Self {
        let (low, carry) = (upper << 64).overflowing_add(lower);
        // This is below 2⁶⁴, as the number is below 2¹⁹².
        let high = (upper >> 64) + u128::from(carry);
        Self {
            high: lower_word(high),
            low,
        }
    }

    /// Returns the product of a number below 2¹²⁸ and one below 2⁶⁴.
    pub(crate) fn product(value: u128, times: u64) -> Self {
        if times < 1 << 12 && value < 1 << 116 {
            return Self::of(value * u128::from(times));
        }
        let times = u128::from(times);
        Self::joined([
            (value & u128::from(u64::MAX)) * times,
            (value >> 64) * times,
        ])
    }

    pub(crate) fn times(self, times: u64) -> Self {
        let low = Self::product(self.low, times);
        Self {
            high: low.high.wrapping_add(self.high.wrapping_mul(times)),
            ..low
        }
    }

    /// Returns `⌊sum² / count⌋`, for a sum of at most 2⁴⁰ numbers below 2⁵⁸.
    ///
    /// With `sum = count·m + r`, it is `count·m² + 2·m·r + ⌊r²/count⌋`.
    pub(crate) fn square_over(sum: u128, count: u64) -> Self {
        let (mean, rest) = (sum / u128::from(count), sum % u128::from(count));
        let mut all = Self::product(mean * mean, count);
        all += Self::of(2 * mean * rest);
        all += Self::of(rest * rest / u128::from(count));
        all
    }

    /// Returns the root of the mean of `count` squares of fixed-point numbers, whose sum this is.
    #[expect(clippy::cast_precision_loss, reason = "the nearest f64 is wanted")]
    pub(crate) fn root_mean(self, count: u64) -> f64 {
        let sum = self.high as f64 * 2_f64.powi(128) + self.low as f64;
        (sum / count as f64).sqrt() / ONE
    }

    /// Rounds a number from 0 to 2¹²⁷.
    #[expect(
        clippy::cast_possible_truncation,
        clippy::cast_sign_loss,
        reason = "saturates"
    )]
    pub(crate) fn rounded(value: f64) -> Self {
        Self::of(value.round() as u128)
    }

    /// Returns the mean of `count` fixed-point numbers, whose sum this is; it must be below 2¹²⁸.
    pub(crate) fn mean(self, count: u64) -> f64 {
        mean(self.low, count)
    }

    pub(crate) fn words(self) -> [u64; 3] {
        [lower_word(self.low), lower_word(self.low >> 64), self.high]
    }

    pub(crate) fn from_words([first, second, high]: [u64; 3]) -> Self {
        Self {
            high,
            low: u128::from(first) | u128::from(second) << 64,
        }
    }
}

impl AddAssign for Wide {
    fn add_assign(&mut self, other: Self) {
        let (low, carry) = self.low.overflowing_add(other.low);
        self.low = low;
        self.high = self
            .high
            .wrapping_add(other.high)
            .wrapping_add(u64::from(carry));
    }
}

impl Sub for Wide {
    type Output = Self;
    /// Returns the difference, or 0 if it is negative: the numbers may then only differ by what was rounded down.
    fn sub(self, other: Self) -> Self {
        let (low, borrow) = self.low.overflowing_sub(other.low);
        let high = i128::from(self.high) - i128::from(other.high) - i128::from(borrow);
        u64::try_from(high).map_or_else(|_| Self::default(), |high| Self { high, low })
    }
}

// Sums per orientation, which show how much of a variance comes from the position and how much from the angle.
//
// As soon as all poses of an orientation have been added, only its contribution is stored. Incomplete orientations are
// stored one by one.

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
        let mut rows = RowSums::default();
        for (id, count) in counted {
            rows.add(table.row(wide(id)), count);
        }
        Self {
            poses: rows.poses,
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

    /// Adds what this orientation contributes to the sums of [`VarianceParts`].
    fn close(&self, between: &mut [Wide]) {
        for ((between, sum), (_, circular)) in between.iter_mut().zip(&self.sums).zip(COLUMNS) {
            if sum.poses > 0 {
                let part = if circular {
                    Wide::rounded(sum.length())
                } else {
                    Wide::square_over(sum.total(), sum.poses)
                };
                *between += part.times(self.multiplicity);
            }
        }
    }
}

/// The parts of each feature's variance that come from the position and from the orientation.
#[derive(Clone, Debug, PartialEq, Eq)]
pub(crate) struct VarianceParts {
    full: u64,
    /// For each feature, over the complete orientations: the sum of sum²/poses, or of the vectors' lengths for a
    /// circular feature.
    between: [Wide; FEATURE_COUNT],
    /// The incomplete orientations, by their number.
    open: BTreeMap<u64, OrientationSums>,
}

impl VarianceParts {
    pub(crate) fn new(full: u64) -> Self {
        Self {
            full,
            between: [Wide::default(); FEATURE_COUNT],
            open: BTreeMap::new(),
        }
    }

    /// Adds a part of an orientation. All parts of an orientation must have the same `multiplicity`.
    pub(crate) fn add(&mut self, orientation: u64, mut part: OrientationSums) {
        if let Some(known) = self.open.remove(&orientation) {
            part.poses += known.poses;
            add_each(&mut part.sums, &known.sums);
        }
        if part.poses >= self.full {
            part.close(&mut self.between);
        } else {
            self.open.insert(orientation, part);
        }
    }

    pub(crate) fn merge(&mut self, other: Self) {
        add_each(&mut self.between, &other.between);
        for (orientation, sums) in other.open {
            self.add(orientation, sums);
        }
    }

    /// Returns the parts as words: three per feature, then each incomplete orientation.
    pub(crate) fn words(&self) -> Vec<u64> {
        let mut words: Vec<u64> = self.between.iter().flat_map(|sum| sum.words()).collect();
        for (&orientation, own) in &self.open {
            words.extend([orientation, own.poses, own.multiplicity]);
            words.extend(own.sums.iter().flat_map(|sum| sum.words()));
        }
        words
    }

    /// Creates the parts from words; None if the number of words is wrong, or if they are not possible for orientations
    /// of `full` poses.
    pub(crate) fn from_words(full: u64, words: &[u64]) -> Option<Self> {
        let (between, open) = words.split_at_checked(3 * FEATURE_COUNT)?;
        let mut parts = Self::new(full);
        for (sum, words) in parts.between.iter_mut().zip(between.chunks_exact(3)) {
            *sum = Wide::from_words([words[0], words[1], words[2]]);
        }
        for words in open.chunks(3 + 5 * FEATURE_COUNT) {
            let (head, sums) = words.split_at_checked(3)?;
            let own = OrientationSums {
                poses: head[1],
                multiplicity: head[2],
                sums: sums.chunks_exact(5).map(Sum::from_words).collect(),
            };
            if sums.len() != 5 * FEATURE_COUNT || !own.is_sound(full) {
                return None;
            }
            parts.open.insert(head[0], own);
        }
        Some(parts)
    }

    /// Returns `between`, with every orientation taken as complete.
    pub(crate) fn closed(&self) -> [Wide; FEATURE_COUNT] {
        let mut between = self.between;
        for sums in self.open.values() {
            sums.close(&mut between);
        }
        between
    }
}
