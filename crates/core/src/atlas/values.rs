//! A table of the values of all features of all imprints, from which statistics are computed.
//!
//! The values are fixed-point numbers ([`crate::atlas::sums`]), because each one is added once per orientation.

use rayon::prelude::*;

use crate::atlas::feature::{FEATURE_COUNT, ImprintSummary, feature_values, features};
use crate::atlas::sums::{fixed, signed};
use crate::geometry::Real;
use crate::index::wide;

/// The number of rows in a part of a table. A single vector of all rows would be copied whenever it grows, and its
/// memory filled on one thread.
const PART: usize = 256;

/// The values of all features of the imprints of an atlas, one row per imprint.
#[derive(Clone, Debug)]
pub(crate) struct Table {
    width: usize,
    /// The rows. All parts except the last have [`PART`] rows.
    parts: Vec<Part>,
    imprints: usize,
    /// The smallest and the largest value of each feature; infinity and minus infinity where none exists.
    extremes: Vec<(f64, f64)>,
}

#[derive(Clone, Debug)]
struct Part {
    values: Vec<i64>,
    missing: Vec<u32>,
}

/// The values of all features of an imprint.
#[derive(Clone, Copy, Debug)]
pub(crate) struct FeatureRow<'a> {
    /// The value of each feature, 0 if it does not exist. A circular feature has two values: its cosine and its sine.
    pub(crate) values: &'a [i64],
    /// The features that do not exist, with feature `i` in bit `i`.
    pub(crate) missing: u32,
}

/// The missing features of an imprint without values: all of them.
const ALL_MISSING: u32 = (1 << FEATURE_COUNT) - 1;

/// Checks at compile time that [`Row::missing`] has a bit for each feature.
const _: () = assert!(FEATURE_COUNT < 32);

const NOTHING: (f64, f64) = (f64::INFINITY, f64::NEG_INFINITY);

fn width(circular: bool) -> usize {
    if circular { 2 } else { 1 }
}

pub(crate) fn row_width() -> usize {
    let widths = features().iter().map(|feature| width(feature.circular));
    widths.sum()
}

/// Returns for each feature the position of its first value in a row, and whether it is circular.
pub(crate) fn columns() -> Vec<(usize, bool)> {
    let all = features().iter().map(|feature| feature.circular);
    let columns = all.scan(0, |next, circular| {
        let column = *next;
        *next += width(circular);
        Some((column, circular))
    });
    columns.collect()
}

impl Default for Table {
    fn default() -> Self {
        Self {
            width: row_width(),
            parts: Vec::new(),
            imprints: 0,
            extremes: vec![NOTHING; features().len()],
        }
    }
}

impl Table {
    pub(crate) fn extend(&mut self, summaries: &[ImprintSummary]) {
        let (columns, width) = (columns(), self.width);
        let new = &summaries[self.imprints.min(summaries.len())..];
        let room = self.imprints.next_multiple_of(PART) - self.imprints;
        let (first, rest) = new.split_at(room.min(new.len()));
        if let Some(part) = self.parts.last_mut() {
            note(first, &columns, width, part, &mut self.extremes);
        }
        let parts = rest.par_chunks(PART).map(|summaries| {
            let mut part = Part {
                values: Vec::with_capacity(width * PART),
                missing: Vec::with_capacity(PART),
            };
            let mut extremes = vec![NOTHING; columns.len()];
            note(summaries, &columns, width, &mut part, &mut extremes);
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

    pub(crate) fn row(&self, index: usize) -> FeatureRow<'_> {
        let (part, row) = (&self.parts[index / PART], index % PART);
        FeatureRow {
            values: &part.values[row * self.width..][..self.width],
            missing: part.missing[row],
        }
    }

    /// Returns the smallest and the largest value of a feature; None if no imprint has a value.
    pub(crate) fn extremes(&self, feature: usize) -> Option<(f64, f64)> {
        let (low, high) = self.extremes[feature];
        (low <= high).then_some((low, high))
    }
}

/// Adds the rows of imprints to a part of a table, and their values to the extremes.
fn note(
    summaries: &[ImprintSummary],
    columns: &[(usize, bool)],
    width: usize,
    part: &mut Part,
    extremes: &mut [(f64, f64)],
) {
    for summary in summaries {
        let start = part.values.len();
        part.values.resize(start + width, 0);
        let row = &mut part.values[start..];
        let mut missing = ALL_MISSING;
        let mut note = |index: usize, value: f64| {
            missing &= !(1 << index);
            let (column, circular) = columns[index];
            if circular {
                let (sin, cos) = libm::sincos(value.to_radians());
                (row[column], row[column + 1]) = (signed(cos), signed(sin));
            } else {
                row[column] = fixed(value);
            }
            let (low, high) = &mut extremes[index];
            (*low, *high) = (Real::min(*low, value), Real::max(*high, value));
        };
        if let Some(description) = &summary.description {
            feature_values(description, &mut note);
        }
        part.missing.push(missing);
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

impl Sum {
    pub(crate) fn merge(&mut self, other: &Self) {
        self.poses += other.poses;
        self.x += other.x;
        self.y += other.y;
    }

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
}

/// The sums of the columns of a table, each row times the number of poses that leave its imprint.
///
/// For each orientation, the rows of all of its imprints are added up, which is a large part of a sweep with many
/// imprints. So all columns are added in the same way, whether they have a value or not.
#[derive(Clone, Debug)]
pub(crate) struct RowSums {
    /// The number of poses, with or without a value.
    poses: u64,
    columns: Vec<i128>,
    /// The number of poses in which each feature does not exist.
    missing: Vec<u64>,
}

impl RowSums {
    pub(crate) fn new() -> Self {
        Self {
            poses: 0,
            columns: vec![0; row_width()],
            missing: vec![0; FEATURE_COUNT],
        }
    }

    /// Adds a row, times the number of poses that leave its imprint.
    pub(crate) fn add(&mut self, row: FeatureRow, poses: u64) {
        self.poses += poses;
        // One multiplication of the processor is enough: both numbers fit into 64 bits with their signs.
        let times = i128::from(poses.cast_signed());
        for (sum, &value) in self.columns.iter_mut().zip(row.values) {
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
        for (sum, other) in self.columns.iter_mut().zip(&other.columns) {
            *sum += other;
        }
        for (poses, other) in self.missing.iter_mut().zip(&other.missing) {
            *poses += other;
        }
    }

    pub(crate) fn poses(&self) -> u64 {
        self.poses
    }

    pub(crate) fn sums(&self) -> Vec<Sum> {
        let features = columns().into_iter().zip(&self.missing);
        let sum = |((column, circular), missing): ((usize, bool), &u64)| Sum {
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
