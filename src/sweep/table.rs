//! The values of all quantities of all imprints, in rows: what statistics walk.

use rayon::prelude::*;

use super::quantity::{Note, quantities, values};

/// The values of all quantities of the imprints of an atlas.
#[derive(Clone, Debug, Default)]
pub(super) struct Table {
    /// A row per imprint: each quantity, NaN where it does not exist; a direction with its cosine and sine.
    values: Vec<f64>,
}

/// Where the values of each quantity stand in a row, and the row's length.
pub(super) fn places() -> (impl Iterator<Item = (usize, bool)>, usize) {
    let width = |circular: bool| if circular { 3 } else { 1 };
    let all = quantities().iter().map(|quantity| quantity.circular);
    let places = all.clone().scan(0, move |next, circular| {
        let place = *next;
        *next += width(circular);
        Some((place, circular))
    });
    (places, all.map(width).sum())
}

impl Table {
    /// Adds the values of the imprints that are not in it yet.
    pub(super) fn extend(&mut self, notes: &[Note]) {
        let (places, width) = (places().0.collect::<Vec<_>>(), places().1);
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

    pub(super) fn row(&self, index: usize) -> &[f64] {
        let width = places().1;
        &self.values[index * width..][..width]
    }
}
