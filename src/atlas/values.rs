//! The values of all features of all imprints, in rows: what statistics are summed up from.
//!
//! They are fixed-point numbers ([`crate::atlas::sums`]), because each one is added once per orientation.

use rayon::prelude::*;

use crate::atlas::feature::{ImprintSummary, feature_values, features};
use crate::atlas::sums::{fixed, signed};

/// The values of all features of the imprints of an atlas.
#[derive(Clone, Debug)]
pub(crate) struct Table {
    /// The length of a row.
    width: usize,
    /// A row per imprint: each feature, [`NONE`] where it does not exist; of a direction its cosine and sine.
    values: Vec<i64>,
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
pub(crate) fn places() -> Vec<(usize, bool)> {
    let all = features().iter().map(|feature| feature.circular);
    let places = all.scan(0, |next, circular| {
        let place = *next;
        *next += width(circular);
        Some((place, circular))
    });
    places.collect()
}

impl Default for Table {
    /// Of no imprint.
    fn default() -> Self {
        let widths = features().iter().map(|feature| width(feature.circular));
        Self {
            width: widths.sum(),
            values: Vec::new(),
            extremes: vec![NOTHING; features().len()],
        }
    }
}

impl Table {
    /// Adds the values of the imprints that are not in it yet.
    pub(crate) fn extend(&mut self, summaries: &[ImprintSummary]) {
        const TOGETHER: usize = 256;
        let (places, width) = (places(), self.width);
        let known = self.values.len() / width;
        let new = &summaries[known.min(summaries.len())..];
        let start = self.values.len();
        self.values.resize(summaries.len() * width, NONE);
        let extremes = self.values[start..]
            .par_chunks_mut(width * TOGETHER)
            .zip(new.par_chunks(TOGETHER))
            .map(|(rows, summaries)| {
                let mut extremes = vec![NOTHING; places.len()];
                for (row, summary) in rows.chunks_exact_mut(width).zip(summaries) {
                    note(summary, &places, row, &mut extremes);
                }
                extremes
            })
            .reduce(
                || vec![NOTHING; places.len()],
                |one, other| joined(&one, &other),
            );
        self.extremes = joined(&self.extremes, &extremes);
    }

    /// The values of an imprint.
    pub(crate) fn row(&self, index: usize) -> &[i64] {
        &self.values[index * self.width..][..self.width]
    }

    /// The smallest and the largest value of a feature; None if no imprint has one.
    pub(crate) fn extremes(&self, feature: usize) -> Option<(f64, f64)> {
        let (low, high) = self.extremes[feature];
        (low <= high).then_some((low, high))
    }
}

/// Writes the values of an imprint into a row.
fn note(
    summary: &ImprintSummary,
    places: &[(usize, bool)],
    row: &mut [i64],
    extremes: &mut [(f64, f64)],
) {
    let Some(description) = &summary.description else {
        return;
    };
    feature_values(description, |index, value| {
        let (place, circular) = places[index];
        if circular {
            let (sin, cos) = value.to_radians().sin_cos();
            (row[place], row[place + 1]) = (signed(cos), signed(sin));
        } else {
            row[place] = fixed(value);
        }
        let (low, high) = &mut extremes[index];
        (*low, *high) = (low.min(value), high.max(value));
    });
}

/// The extremes of two parts together.
fn joined(one: &[(f64, f64)], other: &[(f64, f64)]) -> Vec<(f64, f64)> {
    let both = one.iter().zip(other);
    both.map(|(one, other)| (one.0.min(other.0), one.1.max(other.1)))
        .collect()
}
