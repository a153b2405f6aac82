//! The imprint of a model that differs from an observed one in the fewest taxels.

use std::cmp::Reverse;

use crate::imprint::Imprint;
use crate::recognition::key::{KeyRef, or_bits};
use crate::recognition::model::Model;

/// An imprint that a shape of a model leaves, where it is most like an observed one.
#[derive(Clone, Debug, PartialEq, Eq)]
#[non_exhaustive]
pub struct Nearest {
    /// The shape that leaves it most often: its number in the set.
    pub shape: usize,
    /// Number of taxels that differ.
    pub distance: u32,
    /// The imprint, on the matrix of the observed one.
    pub imprint: Imprint,
    /// The number of its key.
    pub key: usize,
}

/// A key where it lies best on an observed matrix.
#[derive(Clone, Copy)]
struct Candidate {
    /// Its distance, and how often it occurs: the lower, the better.
    rank: (u32, Reverse<u128>),
    key: usize,
    column: usize,
    row: usize,
}

/// An imprint as one string of bits in reading order, so that a shift is a shift of the string.
struct Observed {
    columns: usize,
    rows: usize,
    bits: Vec<u64>,
    count: u32,
}

impl Observed {
    fn new(imprint: &Imprint) -> Self {
        let (columns, rows) = (usize::from(imprint.columns()), usize::from(imprint.rows()));
        // One word more, into which a shifted key may reach with zeros.
        let mut bits = vec![0; (columns * rows).div_ceil(64) + 1];
        for (row, &word) in imprint.words().iter().enumerate() {
            or_bits(&mut bits, row * columns, word);
        }
        Self {
            columns,
            rows,
            bits,
            count: imprint.count(),
        }
    }

    /// Number of active taxels shared with a string of bits that is shifted up by `place`.
    fn shared(&self, bits: &[u64], place: usize) -> u32 {
        let (word, shift) = (place / 64, place % 64);
        let mut shared = 0;
        if shift == 0 {
            for (own, &other) in self.bits[word..].iter().zip(bits) {
                shared += (own & other).count_ones();
            }
            return shared;
        }
        let mut carry = 0;
        for (own, &other) in self.bits[word..].iter().zip(bits.iter().chain(&[0])) {
            shared += (own & (other << shift | carry)).count_ones();
            carry = other >> (64 - shift);
        }
        shared
    }

    /// Writes a key as a string of bits with as many bits a row as this imprint has.
    fn spread(&self, key: KeyRef<'_>, bits: &mut Vec<u64>) {
        bits.clear();
        let length = (usize::from(key.height) - 1) * self.columns + usize::from(key.width);
        bits.resize(length.div_ceil(64), 0);
        for (row, word) in key.rows().enumerate() {
            or_bits(bits, row * self.columns, word);
        }
    }

    /// Where a key lies best: its distance there, and the column and the row of its corner. The first of equals in
    /// reading order.
    fn best(&self, key: KeyRef<'_>, bits: &[u64], count: u32) -> (u32, usize, usize) {
        let (across, down) = (
            self.columns - usize::from(key.width),
            self.rows - usize::from(key.height),
        );
        let mut best = (u32::MAX, 0, 0);
        for row in 0..=down {
            for column in 0..=across {
                let shared = self.shared(bits, row * self.columns + column);
                let distance = self.count + count - 2 * shared;
                if distance < best.0 {
                    best = (distance, column, row);
                }
            }
        }
        best
    }
}

impl Model {
    /// Returns the imprint of this model that differs least from an observed one, over all keys and all their shifts on
    /// the observed matrix; of equals that which is left in the most poses, then the first. None if no key fits the
    /// matrix.
    ///
    /// It compares with every key whose number of taxels allows a smaller distance than the best so far.
    pub fn nearest(&self, observed: &Imprint) -> Option<Nearest> {
        if let Some(key) = self
            .keys()
            .find(&crate::recognition::ImprintKey::of(observed))
        {
            return Some(Nearest {
                shape: self.most_frequent(key).0,
                distance: 0,
                imprint: *observed,
                key,
            });
        }
        let matrix = Observed::new(observed);
        let mut bits = Vec::new();
        let mut best: Option<Candidate> = None;
        for index in 0..self.keys().len() {
            let key = self.keys().get(index);
            if key.height > observed.rows() || key.width > observed.columns() {
                continue;
            }
            let count: u32 = key.bits.iter().map(|word| word.count_ones()).sum();
            let least = count.abs_diff(matrix.count);
            if best.is_some_and(|best| least > best.rank.0) {
                continue;
            }
            let (distance, column, row) = if key.height == 0 {
                (matrix.count, 0, 0)
            } else {
                matrix.spread(key, &mut bits);
                matrix.best(key, &bits, count)
            };
            let rank = (distance, Reverse(self.most_frequent(index).1));
            if best.is_none_or(|best| rank < best.rank) {
                best = Some(Candidate {
                    rank,
                    key: index,
                    column,
                    row,
                });
            }
        }
        let Candidate {
            rank,
            key,
            column,
            row,
        } = best?;
        let mut imprint = Imprint::empty(observed.columns(), observed.rows());
        for (index, word) in self.keys().get(key).rows().enumerate() {
            imprint.set_word(row + index, word << column);
        }
        Some(Nearest {
            shape: self.most_frequent(key).0,
            distance: rank.0,
            imprint,
            key,
        })
    }

    /// The shape that leaves a key most often, the first of equals, and how often.
    pub(super) fn most_frequent(&self, key: usize) -> (usize, u128) {
        let mut most = (0, 0);
        for &count in self.counts(key) {
            if self.weighted(count) > most.1 {
                most = (usize::from(count.shape), self.weighted(count));
            }
        }
        most
    }
}
