//! The values of all quantities of all imprints, in rows: what statistics walk.

use rayon::prelude::*;

use crate::atlas::feature::{Note, quantities, values};

/// The values of all quantities of the imprints of an atlas.
#[derive(Clone, Debug)]
pub(crate) struct Table {
    /// The length of a row.
    width: usize,
    /// A row per imprint: each quantity, NaN where it does not exist; a direction with its cosine and sine.
    values: Vec<f64>,
}

/// How many values of a row a quantity takes.
fn width(circular: bool) -> usize {
    if circular { 3 } else { 1 }
}

/// Where the values of each quantity stand in a row, and whether it is circular.
pub(crate) fn places() -> Vec<(usize, bool)> {
    let all = quantities().iter().map(|quantity| quantity.circular);
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
        let widths = quantities().iter().map(|quantity| width(quantity.circular));
        Self {
            width: widths.sum(),
            values: Vec::new(),
        }
    }
}

impl Table {
    /// Adds the values of the imprints that are not in it yet.
    pub(crate) fn extend(&mut self, notes: &[Note]) {
        let (places, width) = (places(), self.width);
        let known = self.values.len() / width;
        let new = &notes[known.min(notes.len())..];
        let start = self.values.len();
        self.values.resize(notes.len() * width, f64::NAN);
        self.values[start..]
            .par_chunks_mut(width)
            .with_min_len(256)
            .zip(new)
            .for_each(|(row, note)| {
                let Some(description) = &note.description else {
                    return;
                };
                values(description, |index, value| {
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
