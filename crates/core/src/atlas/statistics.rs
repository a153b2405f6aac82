//! Statistics of every feature over all poses that have it, and how much of its variance comes from the position.
//!
//! All sums are whole multiples of 2⁻⁴⁰. So the result does not depend on threads, shards or symmetries.

use rayon::prelude::*;

use crate::atlas::feature::{COLUMNS, Feature, ROW_WIDTH, features};
use crate::atlas::values::{
    FeatureRow, ONE, RowSums, Sum, Table, VarianceParts, Wide, add_each, mean, signed_mean,
};
use crate::index::lower_word;

/// The statistics of a feature over all poses that have it, in the feature's own unit. If no pose has it, all values
/// that depend on poses are None.
///
/// The mean, the standard deviation and the coefficient of variation are weighted by how often each imprint occurs. The
/// variance of a feature is the mean of its variances at a fixed orientation (one angle, one pair of zooms), plus the
/// variance of its means at these orientations. [`Self::sd_position`] is the square root of the first part,
/// [`Self::sd_angle`] that of the second, so `sd² = sd_position² + sd_angle²`. Each orientation is weighted by its
/// number of poses with a value, which is usually the same for all.
///
/// **Directions** that go all around have a circular mean, that of the unit vectors. With `R` the length of the mean
/// vector, the deviation is `√(−2 ln R)` (K. V. Mardia, *Statistics of Directional Data*, 1972), in degrees. Logarithms
/// of `R` take the place of the variances: `sd_position` comes from the mean of the orientations' own `R`, `sd_angle`
/// from the difference between that mean and the overall `R`, and the squares add up as above. A direction has no
/// smallest or largest value, and no coefficient of variation.
#[derive(Clone, Copy, Debug)]
pub struct Statistic {
    /// The feature.
    pub feature: &'static Feature,
    /// The number of poses that have the feature.
    pub poses: u64,
    /// The smallest value; None for a direction.
    pub min: Option<f64>,
    /// The mean. For a direction, it is the circular mean, which is None if the directions cancel.
    pub mean: Option<f64>,
    /// The largest value; None for a direction.
    pub max: Option<f64>,
    /// The standard deviation of the population.
    pub sd: Option<f64>,
    /// The standard deviation divided by the mean; None for a direction, or if the mean is 0.
    pub cv: Option<f64>,
    /// The value of the continuous figure, if there is one.
    pub ideal: Option<f64>,
    /// The part of the deviation that comes from the position at a fixed angle.
    pub sd_position: Option<f64>,
    /// The part of the deviation that comes from the angle (and from the zooms).
    pub sd_angle: Option<f64>,
}

impl Statistic {
    /// Returns true if no part of the deviation is larger than the whole one, apart from rounding. In sums from a file
    /// it may be. The parts of a direction are limited when they are computed.
    pub(crate) fn has_possible_parts(&self) -> bool {
        let Some(sd) = self.sd.filter(|_| !self.feature.circular) else {
            return true;
        };
        let most = sd * (1.0 + 1e-9) + 2.0 * ROUNDING;
        let parts = [self.sd_position, self.sd_angle];
        parts.into_iter().flatten().all(|part| part <= most)
    }
}

/// A column of the statistics.
#[derive(Clone, Copy, Debug)]
pub struct StatisticColumn {
    /// The name in JSON.
    pub key: &'static str,
    /// The heading.
    pub title: &'static str,
    /// Returns the value for a feature.
    pub value: fn(&Statistic) -> Option<f64>,
}

/// All columns, in their order.
pub const STATISTIC_COLUMNS: &[StatisticColumn] = &[
    column("min", "min", |row| row.min),
    column("mean", "mean", |row| row.mean),
    column("max", "max", |row| row.max),
    column("sd", "sd", |row| row.sd),
    column("cv", "cv", |row| row.cv),
    column("ideal", "ideal", |row| row.ideal),
    column("sd_position", "sd pos", |row| row.sd_position),
    column("sd_angle", "sd angle", |row| row.sd_angle),
];

const fn column(
    key: &'static str,
    title: &'static str,
    value: fn(&Statistic) -> Option<f64>,
) -> StatisticColumn {
    StatisticColumn { key, title, value }
}

#[derive(Clone, Debug, Default)]
struct Totals {
    rows: RowSums,
    /// The squares of the values of each column.
    squares: [Squares; ROW_WIDTH],
}

/// A sum of squares, as the sum of the squares' lower words and the sum of their upper words. All poses together are
/// below 2⁴⁰, so neither overflows.
type Squares = [u128; 2];

impl Totals {
    fn add(&mut self, row: &FeatureRow, poses: u64) {
        self.rows.add(row, poses);
        for ([lower, upper], value) in self.squares.iter_mut().zip(&row.values) {
            let value = u128::from(value.unsigned_abs());
            let square = value * value;
            *lower += u128::from(lower_word(square)) * u128::from(poses);
            *upper += u128::from(lower_word(square >> 64)) * u128::from(poses);
        }
    }

    fn merged(mut self, other: &Self) -> Self {
        self.rows.merge(&other.rows);
        for (sums, others) in self.squares.iter_mut().zip(&other.squares) {
            add_each(sums, others);
        }
        self
    }
}

/// Computes the statistic of a feature from the sums of its values and of their squares. `between` is the part of
/// [`VarianceParts`].
fn statistic(
    feature: &'static Feature,
    sum: &Sum,
    squares: Squares,
    between: Wide,
    extremes: Option<(f64, f64)>,
) -> Statistic {
    let poses = sum.poses;
    let mut statistic = Statistic {
        feature,
        poses,
        min: None,
        mean: None,
        max: None,
        sd: None,
        cv: None,
        ideal: None,
        sd_position: None,
        sd_angle: None,
    };
    if poses == 0 {
        return statistic;
    }
    if feature.circular {
        directions(&mut statistic, sum, between);
        return statistic;
    }
    let (squares, of_mean) = (Wide::joined(squares), Wide::square_over(sum.total(), poses));
    let mean = mean(sum.total(), poses);
    let sd = (squares - of_mean).root_mean(poses);
    (statistic.min, statistic.max) = extremes.unzip();
    statistic.mean = Some(mean);
    statistic.sd = Some(sd);
    statistic.cv = (mean != 0.0).then(|| sd / mean.abs());
    statistic.sd_position = Some((squares - between).root_mean(poses));
    statistic.sd_angle = Some((between - of_mean).root_mean(poses));
    statistic
}

fn directions(statistic: &mut Statistic, sum: &Sum, between: Wide) {
    let [x, y] = [sum.x, sum.y].map(|part| signed_mean(part, sum.poses));
    // No vector is longer than its parts together. A damaged file may say otherwise, and so may rounding.
    let own = libm::hypot(x, y).min(1.0);
    let within = between.mean(sum.poses).clamp(own, 1.0);
    // Lengths that differ by no more than their rounding count as equal, because the root of the rounding would look
    // like a deviation.
    let within = if 1.0 - within < ROUNDING { 1.0 } else { within };
    let own = if within - own < ROUNDING { within } else { own };
    let Some(mean) = mean_direction(x, y) else {
        return;
    };
    let deviation = |length: f64| (-2.0 * libm::log(length)).max(0.0).sqrt().to_degrees();
    statistic.mean = Some(mean);
    statistic.sd = Some(deviation(own));
    statistic.sd_position = Some(deviation(within));
    statistic.sd_angle = Some(deviation(own / within));
}

/// Returns the circular mean of directions in degrees, given the mean of their unit vectors. None if the vectors
/// cancel, up to the rounding of their parts.
fn mean_direction(x: f64, y: f64) -> Option<f64> {
    (libm::hypot(x, y) >= 1e-11).then(|| libm::atan2(y, x).to_degrees() + 0.0)
}

/// The mean length of vectors is exact to less than this. The parts of the vectors are rounded to multiples of 2⁻⁴⁰,
/// and so is the length of the sum of an orientation.
const ROUNDING: f64 = 1.0 / ONE;

/// Returns the statistics of all features. `counts` says how often each imprint of the table occurs.
pub(crate) fn statistics(
    table: &Table,
    counts: &[u64],
    variance_parts: &VarianceParts,
    ideal: impl Fn(&str) -> Option<f64>,
) -> Vec<Statistic> {
    let totals = (0..counts.len())
        .into_par_iter()
        .with_min_len(1024)
        .fold(Totals::default, |mut totals, index| {
            totals.add(table.row(index), counts[index]);
            totals
        })
        .reduce(Totals::default, |one, other| one.merged(&other));
    let (sums, between) = (totals.rows.sums(), variance_parts.closed());
    let all = features().iter().zip(COLUMNS).enumerate();
    all.map(|(index, (feature, (column, _)))| {
        let squares = totals.squares[column];
        let extremes = table.extremes(index);
        let statistic = statistic(feature, &sums[index], squares, between[index], extremes);
        Statistic {
            ideal: ideal(&feature.key),
            ..statistic
        }
    })
    .collect()
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::atlas::values::signed;

    fn of_directions(groups: &[&[f64]]) -> Statistic {
        let feature = features().iter().find(|feature| feature.circular);
        let (mut sum, mut between) = (Sum::default(), Wide::default());
        for group in groups {
            let mut own = Sum::default();
            for direction in *group {
                let (sin, cos) = libm::sincos(direction.to_radians());
                own.poses += 1;
                own.x += i128::from(signed(cos));
                own.y += i128::from(signed(sin));
            }
            sum += own;
            between += Wide::rounded(own.length());
        }
        statistic(feature.expect("there is one"), &sum, [0; 2], between, None)
    }

    /// Returns the deviations of directions: in all, from the position and from the angle.
    fn deviations(groups: &[&[f64]]) -> [f64; 3] {
        let found = of_directions(groups);
        let found = [found.sd, found.sd_position, found.sd_angle];
        found.map(|sd| sd.expect("they do not cancel"))
    }

    #[test]
    fn equal_directions_have_no_deviation() {
        for first in 0..360 {
            let (one, other) = (f64::from(first) + 0.3, f64::from(first) + 40.7);
            assert_eq!(deviations(&[&[one; 7], &[one; 7]]), [0.0; 3]);
            // If two orientations have the same directions, all of the deviation comes from the position.
            let [sd, position, angle] = deviations(&[&[one, other], &[one, other]]);
            assert_eq!((sd, angle), (position, 0.0));
            let [sd, position, angle] = deviations(&[&[one; 3], &[other; 3]]);
            assert_eq!((sd, position), (angle, 0.0));
            assert!((sd - 20.41).abs() < 0.1, "{sd}");
        }
        // Directions that differ by a thousandth of a degree do differ.
        let [.., angle] = deviations(&[&[10.0], &[10.001]]);
        assert!((angle / 0.0005 - 1.0).abs() < 0.01, "{angle}");
    }

    #[test]
    fn directions_that_cancel_up_to_rounding_have_no_mean() {
        for first in 0..120 {
            let first = f64::from(first) + 0.3;
            let found = of_directions(&[&[first, first + 120.0, first + 240.0]]);
            assert_eq!((found.mean, found.sd), (None, None), "{first}");
        }
        let found = of_directions(&[&[0.3, 120.3, 240.4]]);
        assert!(found.mean.is_some() && found.sd.is_some());
    }
}
