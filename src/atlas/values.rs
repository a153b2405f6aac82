//! The values of all features of all imprints, in rows: what statistics walk.

use rayon::prelude::*;

use crate::atlas::feature::{ImprintSummary, feature_values, features};

/// The values of all features of the imprints of an atlas.
#[derive(Clone, Debug)]
pub(crate) struct Table {
    /// The length of a row.
    width: usize,
    /// A row per imprint: each feature, NaN where it does not exist; a direction with its cosine and sine.
    values: Vec<f64>,
}

/// How many values of a row a feature takes.
fn width(circular: bool) -> usize {
    if circular { 3 } else { 1 }
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
        }
    }
}

impl Table {
    /// Adds the values of the imprints that are not in it yet.
    pub(crate) fn extend(&mut self, summaries: &[ImprintSummary]) {
        let (places, width) = (places(), self.width);
        let known = self.values.len() / width;
        let new = &summaries[known.min(summaries.len())..];
        let start = self.values.len();
        self.values.resize(summaries.len() * width, f64::NAN);
        self.values[start..]
            .par_chunks_mut(width)
            .with_min_len(256)
            .zip(new)
            .for_each(|(row, summary)| {
                let Some(description) = &summary.description else {
                    return;
                };
                feature_values(description, |index, value| {
                    let (place, circular) = places[index];
                    row[place] = value;
                    if circular {
                        (row[place + 2], row[place + 1]) = value.to_radians().sin_cos();
                    }
                });
            });
    }

    pub(crate) fn row(&self, index: usize) -> &[f64] {
        &self.values[index * self.width..][..self.width]
    }
}
