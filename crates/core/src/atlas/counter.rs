//! Counts keys: stores each distinct key once, in the order of its first addition, with its count and its first pose.
//!
//! The counter is an open hash table of indices; the keys are stored beside it. A slot holds the upper half of a hash
//! and an index, so nearly all comparisons end there. A key is found only if all of its words are equal.

use std::hash::{BuildHasher, RandomState};
use std::sync::OnceLock;

use crate::imprint::Imprint;
use crate::index::{index, wide};
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
    /// The slots: the upper half of the hash and index + 1, or 0 if empty. Their number is a power of two, and at most
    /// half are taken.
    slots: Vec<u64>,
}

const INDEX: u64 = 0xffff_ffff;

impl ImprintCounter {
    pub(crate) fn new(length: usize) -> Self {
        Self {
            length,
            keys: Vec::new(),
            hashes: Vec::new(),
            tallies: Vec::new(),
            slots: vec![0; 512],
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
        match self.probe(key, hash) {
            Ok(known) => {
                let tally = &mut self.tallies[known];
                tally.count += count;
                tally.first = tally.first.min(first);
                known
            }
            Err(slot) => self.insert(slot, key, hash, Tally { count, first }),
        }
    }

    #[inline]
    fn probe(&self, key: &[u64], hash: u64) -> Result<usize, usize> {
        let mask = self.slots.len() - 1;
        let mut slot = index(hash & mask as u64);
        loop {
            let held = self.slots[slot];
            if held == 0 {
                return Err(slot);
            }
            if (held ^ hash) & !INDEX == 0 {
                let known = index((held & INDEX) - 1);
                // Compares word by word, because a call costs more than these few words.
                if self.key(known).iter().eq(key) {
                    return Ok(known);
                }
            }
            slot = (slot + 1) & mask;
        }
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
        let mut ordered = Self {
            length: self.length,
            keys: Vec::with_capacity(self.keys.len()),
            hashes: order.iter().map(|&index| self.hashes[index]).collect(),
            tallies: order.iter().map(|&index| self.tallies[index]).collect(),
            slots: Vec::new(),
        };
        for &index in &order {
            ordered.keys.extend_from_slice(self.key(index));
        }
        ordered.slots = ordered.slots_for(self.slots.len());
        *self = ordered;
        order
    }

    pub(crate) fn find(&self, key: &[u64], hash: u64) -> Option<usize> {
        self.probe(key, hash).ok()
    }

    #[cold]
    fn insert(&mut self, slot: usize, key: &[u64], hash: u64, tally: Tally) -> usize {
        let index = self.tallies.len();
        self.keys.extend_from_slice(key);
        self.hashes.push(hash);
        self.tallies.push(tally);
        self.slots[slot] = hash & !INDEX | (index as u64 + 1);
        if self.tallies.len() * 2 > self.slots.len() {
            self.slots = self.slots_for(self.slots.len() * 2);
        }
        index
    }

    /// Returns a table of `count` slots, a power of two, with the slots of all keys.
    fn slots_for(&self, count: usize) -> Vec<u64> {
        let mask = count - 1;
        let mut slots = vec![0; count];
        for (known, &hash) in self.hashes.iter().enumerate() {
            let mut slot = index(hash & mask as u64);
            while slots[slot] != 0 {
                slot = (slot + 1) & mask;
            }
            slots[slot] = hash & !INDEX | (known as u64 + 1);
        }
        slots
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
