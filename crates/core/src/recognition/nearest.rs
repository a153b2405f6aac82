use std::cmp::Reverse;

use crate::imprint::Imprint;
use crate::recognition::key::ImprintKey;
use crate::recognition::model::{Model, first_of_most};
use crate::recognition::scan::Observed;

/// An imprint that a shape of a model leaves, placed where it is most similar to an observed one.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct Nearest {
    /// The number of the shape in the set that leaves the imprint most often.
    pub shape: usize,
    /// The number of taxels that differ.
    pub distance: u32,
    /// The imprint, on the matrix of the observed one.
    pub imprint: Imprint,
    /// The number of the imprint's key in the model.
    pub key: usize,
}

impl Model {
    /// Returns the imprint of this model that differs least from an observed one, over all keys and all their shifts on
    /// the observed matrix; among equals, the one that a single shape leaves in the most poses, then the first. None if
    /// no key fits the matrix.
    ///
    /// The first call sorts the keys for scans and takes longer.
    pub fn nearest(&self, observed: &Imprint) -> Option<Nearest> {
        self.nearest_without(observed, None)
    }

    pub(super) fn nearest_without(
        &self,
        observed: &Imprint,
        dead: Option<&Imprint>,
    ) -> Option<Nearest> {
        // With dead taxels, the key of the imprint alone is not enough: a dead taxel may be a hole in it.
        if dead.is_none()
            && let Some(key) = self.keys().find(&ImprintKey::of(observed))
        {
            return Some(Nearest {
                shape: self.most_frequent(key).0,
                distance: 0,
                imprint: *observed,
                key,
            });
        }
        let rank = |key: usize| Reverse(self.most_frequent(key).1);
        let found = (self.index()).nearest(&Observed::new(observed, dead), rank)?;
        let mut imprint = Imprint::empty(observed.size());
        let (column, row) = found.place;
        for (index, word) in self.keys().get(found.key).rows().enumerate() {
            imprint.set_word(usize::from(row) + index, word << column);
        }
        Some(Nearest {
            shape: self.most_frequent(found.key).0,
            distance: found.distance,
            imprint,
            key: found.key,
        })
    }

    /// Returns the shape that leaves a key most often (the first among equals), and how often.
    pub fn most_frequent(&self, key: usize) -> (usize, u128) {
        let most = first_of_most(self.weighted_shapes(self.counts(key)));
        most.expect("every key is left by some shape")
    }
}
