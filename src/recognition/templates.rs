//! Template matching: imprints compared taxel by taxel, without any feature.

use crate::imprint::Imprint;
use crate::recognition::model::Model;

/// The most frequent imprints of each shape.
///
/// None is the imprint of nothing.
pub(super) struct Templates(Vec<Vec<Option<Imprint>>>);

impl Templates {
    pub(super) fn new(model: &Model, most: usize) -> Self {
        let mut all: Vec<Vec<(std::cmp::Reverse<u64>, usize)>> =
            vec![Vec::new(); model.shapes().len()];
        for key in 0..model.keys().len() {
            for count in model.counts(key) {
                all[usize::from(count.shape)].push((std::cmp::Reverse(count.poses), key));
            }
        }
        let imprints = |mut own: Vec<(std::cmp::Reverse<u64>, usize)>| {
            own.sort_unstable();
            let first = own.iter().take(most);
            first.map(|&(_, key)| model.keys().imprint(key)).collect()
        };
        Self(all.into_iter().map(imprints).collect())
    }

    /// The least number of taxels that differ, over all templates of a shape and all their shifts.
    pub(super) fn scores(&self, model: &Model, key: usize) -> Vec<f64> {
        let imprint = model.keys().imprint(key);
        let own = |templates: &Vec<Option<Imprint>>| {
            let distances = templates.iter().map(|template| match (&imprint, template) {
                (Some(imprint), Some(template)) => distance(imprint, template),
                (Some(only), None) | (None, Some(only)) => only.count(),
                (None, None) => 0,
            });
            distances.min().map_or(f64::INFINITY, f64::from)
        };
        self.0.iter().map(own).collect()
    }
}

/// The least number of taxels in which two imprints differ, over all shifts of one against the other.
fn distance(one: &Imprint, other: &Imprint) -> u32 {
    let sum = one.count() + other.count();
    let mut shared = 0;
    let (rows, columns) = (i32::from(one.rows()), i32::from(one.columns()));
    for down in 1 - i32::from(other.rows())..rows {
        let first = usize::try_from(down.max(0)).expect("not negative");
        let skipped = usize::try_from((-down).max(0)).expect("not negative");
        let pairs = || {
            one.words()[first..]
                .iter()
                .zip(&other.words()[skipped.min(other.words().len())..])
        };
        for across in 1 - i32::from(other.columns())..columns {
            let moved = |word: u64| {
                if across < 0 {
                    word >> across.unsigned_abs()
                } else {
                    word.unbounded_shl(across.unsigned_abs())
                }
            };
            let common = pairs()
                .map(|(own, &word)| (own & moved(word)).count_ones())
                .sum();
            shared = shared.max(common);
        }
    }
    sum - 2 * shared
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn distances_take_the_best_shift() {
        let read = |text: &str| text.parse::<Imprint>().expect("an imprint");
        assert_eq!(distance(&read("##.#"), &read("#.#")), 1);
        assert_eq!(distance(&read("#.\n##"), &read("##\n.#\n.#")), 3);
        assert_eq!(distance(&read("#"), &read("###\n###")), 5);
        assert_eq!(distance(&read("#..\n...\n..#"), &read("#..\n...\n..#")), 0);
    }
}
