//! Counts keys: stores each distinct key once, in the order of its first addition, with its count and its first pose.
//!
//! A key is found by its hash only if all of its words are equal.

use std::hash::{BuildHasher, RandomState};
use std::sync::OnceLock;

use hashbrown::HashTable;

use crate::imprint::Imprint;
use crate::index::{narrow, wide};
use crate::sensor::MatrixSize;

/// The number of occurrences of a key, and the number of the first pose with it.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(crate) struct Tally {
    pub(crate) count: u64,
    pub(crate) first: u64,
}

/// Counts keys that all have the same length.
#[derive(Clone, Debug)]
pub(crate) struct ImprintCounter {
    length: usize,
    keys: Vec<u64>,
    hashes: Vec<u64>,
    tallies: Vec<Tally>,
    /// The indices of the keys, found by their hashes.
    index: HashTable<u32>,
}

impl ImprintCounter {
    pub(crate) fn new(length: usize) -> Self {
        Self {
            length,
            keys: Vec::new(),
            hashes: Vec::new(),
            tallies: Vec::new(),
            index: HashTable::new(),
        }
    }

    pub(crate) fn len(&self) -> usize {
        self.tallies.len()
    }

    pub(crate) fn key(&self, index: usize) -> &[u64] {
        &self.keys[index * self.length..][..self.length]
    }

    pub(crate) fn hash(&self, index: usize) -> u64 {
        self.hashes[index]
    }

    pub(crate) fn tallies(&self) -> &[Tally] {
        &self.tallies
    }

    /// Adds `count` to the count of a key, and returns the key's index, from 0. `first` is the number of a pose that
    /// leaves it.
    #[inline]
    pub(crate) fn add(&mut self, key: &[u64], hash: u64, count: u64, first: u64) -> usize {
        if let Some(known) = self.find(key, hash) {
            let tally = &mut self.tallies[known];
            tally.count += count;
            tally.first = tally.first.min(first);
            return known;
        }
        self.insert(key, hash, Tally { count, first })
    }

    #[inline]
    pub(crate) fn find(&self, key: &[u64], hash: u64) -> Option<usize> {
        // Compares word by word, because a call costs more than these few words.
        let is_same = |&known: &u32| self.key(wide(known)).iter().eq(key);
        self.index.find(hash, is_same).map(|&known| wide(known))
    }

    /// Adds to the count of a known key, given by its index.
    pub(crate) fn count(&mut self, index: usize, count: u64) {
        self.tallies[index].count += count;
    }

    pub(crate) fn sort_by_first_pose(&mut self) -> Vec<usize> {
        // With the first poses beside the indices, comparisons need not look into the tallies.
        let firsts = self.tallies.iter().map(|tally| tally.first);
        let mut order: Vec<(u64, usize)> = firsts.zip(0..).collect();
        order.sort_unstable();
        let order: Vec<usize> = order.into_iter().map(|(_, index)| index).collect();
        let mut ordered = Self::new(self.length);
        for &index in &order {
            ordered.insert(self.key(index), self.hashes[index], self.tallies[index]);
        }
        *self = ordered;
        order
    }

    #[cold]
    fn insert(&mut self, key: &[u64], hash: u64, tally: Tally) -> usize {
        let index = self.tallies.len();
        self.keys.extend_from_slice(key);
        self.hashes.push(hash);
        self.tallies.push(tally);
        let hash_of = |&known: &u32| self.hashes[wide(known)];
        self.index.insert_unique(hash, narrow(index), hash_of);
        index
    }
}

// Packs imprints into short keys: several rows of the matrix share a word, so that a 16 × 16 imprint takes 32 bytes.
//
// Each row takes the smallest of 8, 16, 32 or 64 bits that holds the sensor's columns. The hash of a key is the
// exclusive or of one random number per active taxel (A. L. Zobrist, *A new hashing method with application for game
// playing*, 1970), so toggling a taxel changes it in one step. Keys with equal hashes are still compared in full, and
// no result depends on the hashes. The random numbers differ from run to run: if they were known, anybody could make
// an atlas of imprints with equal hashes, which would take minutes to merge.

/// The seed of the random numbers. The whole run has a single one, because hashes of one sweep are compared with those
/// of another.
static SEED: OnceLock<u64> = OnceLock::new();

/// The way in which the imprints of a sensor are packed.
#[derive(Clone, Debug)]
pub(crate) struct Layout {
    size: MatrixSize,
    /// The binary logarithm of the number of bits that a row takes: 3 to 6.
    log_width: u32,
    /// A random number per taxel, in reading order.
    numbers: Vec<u64>,
}

impl Layout {
    pub(crate) fn new(size: MatrixSize) -> Self {
        let log_width = size
            .columns()
            .next_power_of_two()
            .clamp(8, 64)
            .trailing_zeros();
        let mut seed = *SEED.get_or_init(|| RandomState::new().hash_one(0));
        let numbers = (0..size.cells()).map(|_| split_mix(&mut seed)).collect();
        Self {
            size,
            log_width,
            numbers,
        }
    }

    pub(crate) fn size(&self) -> MatrixSize {
        self.size
    }

    pub(crate) fn words(&self) -> usize {
        (usize::from(self.size.rows()) << self.log_width).div_ceil(64)
    }

    /// Returns the index of the word that holds a row, and by how many bits the row is shifted in it.
    pub(crate) fn slot(&self, row: usize) -> (usize, usize) {
        let bits = row << self.log_width;
        (bits / 64, bits % 64)
    }

    pub(crate) fn numbers(&self, row: usize) -> &[u64] {
        let columns = usize::from(self.size.columns());
        &self.numbers[row * columns..][..columns]
    }

    pub(crate) fn imprint(&self, key: &[u64]) -> Imprint {
        let mut imprint = Imprint::empty(self.size);
        for row in 0..usize::from(self.size.rows()) {
            let (word, shift) = self.slot(row);
            imprint.set_word(row, key[word] >> shift);
        }
        imprint
    }

    pub(crate) fn key(&self, imprint: &Imprint) -> (Vec<u64>, u64) {
        let mut key = vec![0; self.words()];
        let mut hash = 0;
        for (row, &bits) in imprint.words().iter().enumerate() {
            let (word, shift) = self.slot(row);
            key[word] |= bits << shift;
            hash ^= self.hash(row, bits);
        }
        (key, hash)
    }

    /// Writes the key of an imprint after a half turn, and returns its hash. The coordinates of a taxel's centre and
    /// those of its image sum up to `across` and `down`, which must be such that all active taxels stay on the matrix.
    pub(crate) fn half_turned(
        &self,
        key: &[u64],
        [across, down]: [i32; 2],
        turned: &mut [u64],
    ) -> u64 {
        // Column `i` becomes `across − 1 − i`, and row `j` becomes `down − 1 − j`. So the numbers of a bit and of its
        // image have the same sum for all taxels: the image is the key read backwards, shifted as a whole.
        let sum = (down - 1) * (1 << self.log_width) + across - 1;
        let words = (sum + 1).div_euclid(64);
        let left = (sum + 1).rem_euclid(64).unsigned_abs();
        let backwards = |word: i32| {
            let word = usize::try_from(word).ok().and_then(|word| key.get(word));
            word.map_or(0, |word| word.reverse_bits())
        };
        let mut before = backwards(words);
        for (place, turned) in (1..).zip(&mut *turned) {
            let word = backwards(words - place);
            *turned = before.unbounded_shr(64 - left) | word << left;
            before = word;
        }
        let rows = 0..usize::from(self.size.rows());
        rows.fold(0, |hash, row| hash ^ self.hash(row, self.row(turned, row)))
    }

    fn row(&self, key: &[u64], row: usize) -> u64 {
        let (word, shift) = self.slot(row);
        key[word] >> shift & u64::MAX >> (u64::BITS - u32::from(self.size.columns()))
    }

    pub(crate) fn hash(&self, row: usize, mut taxels: u64) -> u64 {
        let numbers = self.numbers(row);
        let mut hash = 0;
        while taxels != 0 {
            hash ^= numbers[wide(taxels.trailing_zeros())];
            taxels &= taxels - 1;
        }
        hash
    }
}

/// Returns the next number of a pseudo-random sequence: the generator of G. L. Steele, D. Lea and C. H. Flood (2014).
fn split_mix(state: &mut u64) -> u64 {
    *state = state.wrapping_add(0x9e37_79b9_7f4a_7c15);
    let mut mixed = *state;
    mixed = (mixed ^ mixed >> 30).wrapping_mul(0xbf58_476d_1ce4_e5b9);
    mixed = (mixed ^ mixed >> 27).wrapping_mul(0x94d0_49bb_1331_11eb);
    mixed ^ mixed >> 31
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_half_turned_key_is_the_key_of_the_half_turned_imprint() {
        for (columns, rows) in [
            (1, 1),
            (3, 64),
            (8, 8),
            (16, 16),
            (20, 5),
            (33, 7),
            (64, 64),
        ] {
            let size = MatrixSize::of(columns, rows);
            let layout = Layout::new(size);
            // An L, away from the sides if there is room.
            let left = columns / 3;
            let (top, right, bottom) = (rows / 3, columns - left / 2 - 1, rows - rows / 3 - 1);
            let stem = (top..=bottom).map(|row| (left, row));
            let foot = (left..=right).map(|column| (column, bottom));
            let taxels: Vec<(u8, u8)> = stem.chain(foot).collect();
            let imprint = |taxels: &[(u8, u8)]| {
                let mut words = vec![0; usize::from(rows)];
                for &(column, row) in taxels {
                    words[usize::from(row)] |= 1 << column;
                }
                let mut imprint = Imprint::empty(size);
                for (row, word) in words.into_iter().enumerate() {
                    imprint.set_word(row, word);
                }
                imprint
            };
            let (key, _) = layout.key(&imprint(&taxels));
            // These are the sums that keep all taxels on the matrix.
            for across in right + 1..=columns + left {
                for down in bottom + 1..=rows + top {
                    let image = |&(column, row): &(u8, u8)| (across - 1 - column, down - 1 - row);
                    let images: Vec<(u8, u8)> = taxels.iter().map(image).collect();
                    let mut turned = vec![0; layout.words()];
                    let sums = [i32::from(across), i32::from(down)];
                    let hash = layout.half_turned(&key, sums, &mut turned);
                    assert_eq!((turned, hash), layout.key(&imprint(&images)), "{sums:?}");
                }
            }
        }
    }
}
