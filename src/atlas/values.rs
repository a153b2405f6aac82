//! The values of all features of all imprints, in rows: what statistics are summed up from.
//!
//! They are fixed-point numbers ([`crate::atlas::sums`]), because each one is added once per orientation.

use rayon::prelude::*;

use crate::atlas::feature::{ImprintSummary, feature_values, features};
use crate::atlas::sums::{fixed, signed};

/// Rows in a part of a table. One vector of all rows would be copied whenever it grows, and fill pages on one thread.
const PART: usize = 256;

/// The values of all features of the imprints of an atlas.
#[derive(Clone, Debug)]
pub(crate) struct Table {
    /// The length of a row.
    width: usize,
    /// A row per imprint: each feature, [`NONE`] where it does not exist; of a direction its cosine and sine. All parts
    /// but the last have [`PART`] rows.
    parts: Vec<Vec<i64>>,
    /// The number of rows.
    imprints: usize,
    /// The smallest and the largest value of each feature; infinity and minus infinity where none exists.
    extremes: Vec<(f64, f64)>,
}

/// No value.
pub(crate) const NONE: i64 = i64::MIN;

/// Nothing yet between the smallest and the largest value.
const NOTHING: (f64, f64) = (f64::INFINITY, f64::NEG_INFINITY);

/// How many values of a row a feature takes.
fn width(circular: bool) -> usize {
    if circular { 2 } else { 1 }
}

/// Where the values of each feature stand in a row, and whether it is circular.
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
    /// Of no imprint.
    fn default() -> Self {
        let widths = features().iter().map(|feature| width(feature.circular));
        Self {
            width: widths.sum(),
            parts: Vec::new(),
            imprints: 0,
            extremes: vec![NOTHING; features().len()],
        }
    }
}

impl Table {
    /// Adds the values of the imprints that are not in it yet.
    pub(crate) fn extend(&mut self, summaries: &[ImprintSummary]) {
        let (columns, width) = (columns(), self.width);
        let new = &summaries[self.imprints.min(summaries.len())..];
        let room = self.imprints.next_multiple_of(PART) - self.imprints;
        let (first, rest) = new.split_at(room.min(new.len()));
        if let Some(part) = self.parts.last_mut() {
            note(first, &columns, width, part, &mut self.extremes);
        }
        let parts = rest.par_chunks(PART).map(|summaries| {
            let mut part = Vec::with_capacity(width * PART);
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

    /// The values of an imprint.
    pub(crate) fn row(&self, index: usize) -> &[i64] {
        &self.parts[index / PART][index % PART * self.width..][..self.width]
    }

    /// The smallest and the largest value of a feature; None if no imprint has one.
    pub(crate) fn extremes(&self, feature: usize) -> Option<(f64, f64)> {
        let (low, high) = self.extremes[feature];
        (low <= high).then_some((low, high))
    }
}

/// Adds rows of the values of imprints.
fn note(
    summaries: &[ImprintSummary],
    columns: &[(usize, bool)],
    width: usize,
    part: &mut Vec<i64>,
    extremes: &mut [(f64, f64)],
) {
    for summary in summaries {
        let start = part.len();
        part.resize(start + width, NONE);
        let Some(description) = &summary.description else {
            continue;
        };
        let row = &mut part[start..];
        feature_values(description, |index, value| {
            let (column, circular) = columns[index];
            if circular {
                let (sin, cos) = libm::sincos(value.to_radians());
                (row[column], row[column + 1]) = (signed(cos), signed(sin));
            } else {
                row[column] = fixed(value);
            }
            let (low, high) = &mut extremes[index];
            (*low, *high) = (low.min(value), high.max(value));
        });
    }
}
