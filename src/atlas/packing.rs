//! Imprints as short keys: several rows of the matrix in one word, so that a 16 × 16 imprint takes 32 bytes.
//!
//! Each row takes 8, 16, 32 or 64 bits, whichever is the first to hold the sensor's columns. A key's hash is the
//! exclusive or of one random number per active taxel (A. L. Zobrist, *A new hashing method with application for game
//! playing*, 1970), so toggling a taxel changes it in one step. Keys with equal hashes are still compared in full, and no
//! result depends on the hashes. The numbers are others in each run: with known ones, anybody could make an atlas of
//! imprints with equal hashes, which would take minutes to merge.

use std::hash::{BuildHasher, RandomState};
use std::sync::OnceLock;

use crate::imprint::Imprint;
use crate::index::from_first;

/// What the random numbers are made from: one for the whole run, since hashes of one sweep are compared with those of another.
static SEED: OnceLock<u64> = OnceLock::new();

/// How the imprints of a sensor are packed.
#[derive(Clone, Debug)]
pub(crate) struct Layout {
    /// Columns of the sensor.
    columns: u8,
    /// Rows of the sensor.
    rows: u8,
    /// The binary logarithm of the bits that a row takes: 3 to 6.
    log_width: u32,
    /// One number per taxel, in reading order.
    numbers: Vec<u64>,
}

impl Layout {
    pub(crate) fn new(columns: u8, rows: u8) -> Self {
        let log_width = columns.next_power_of_two().clamp(8, 64).trailing_zeros();
        let mut seed = *SEED.get_or_init(|| RandomState::new().hash_one(0));
        let numbers = (0..usize::from(columns) * usize::from(rows))
            .map(|_| split_mix(&mut seed))
            .collect();
        Self {
            columns,
            rows,
            log_width,
            numbers,
        }
    }

    pub(crate) fn columns(&self) -> u8 {
        self.columns
    }

    pub(crate) fn rows(&self) -> u8 {
        self.rows
    }

    /// Number of words in a key.
    pub(crate) fn words(&self) -> usize {
        (usize::from(self.rows) << self.log_width).div_ceil(64)
    }

    /// The word that holds a row, and by how much it is shifted there.
    pub(crate) fn slot(&self, row: usize) -> (usize, usize) {
        let bits = row << self.log_width;
        (bits / 64, bits % 64)
    }

    /// The numbers of a row's taxels.
    pub(crate) fn numbers(&self, row: usize) -> &[u64] {
        let columns = usize::from(self.columns);
        &self.numbers[row * columns..][..columns]
    }

    /// The imprint of a key.
    pub(crate) fn imprint(&self, key: &[u64]) -> Imprint {
        let mut imprint = Imprint::empty(self.columns, self.rows);
        for row in 0..usize::from(self.rows) {
            let (word, shift) = self.slot(row);
            imprint.set_word(row, key[word] >> shift);
        }
        imprint
    }

    /// The key of an imprint, and its hash.
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

    /// Writes the key of an imprint after a half turn, and returns its hash. The coordinates of a taxel's centre and of
    /// its image sum up to `across` and `down`, which must keep all active taxels on the matrix.
    pub(crate) fn half_turned(
        &self,
        key: &[u64],
        [across, down]: [i32; 2],
        turned: &mut [u64],
    ) -> u64 {
        turned.fill(0);
        let mut hash = 0;
        for row in 0..usize::from(self.rows) {
            let (word, shift) = self.slot(row);
            let bits = key[word] >> shift & u64::MAX >> (u64::BITS - u32::from(self.columns));
            if bits == 0 {
                continue;
            }
            // Column `i` goes to `across − 1 − i`; reversed it is at `63 − i`.
            let reversed = bits.reverse_bits();
            let apart = across - 64;
            let bits = if apart < 0 {
                reversed.unbounded_shr(apart.unsigned_abs())
            } else {
                reversed.unbounded_shl(apart.unsigned_abs())
            };
            let image = from_first(down - 1).saturating_sub(row);
            let (word, shift) = self.slot(image);
            turned[word] |= bits << shift;
            hash ^= self.hash(image, bits);
        }
        hash
    }

    /// What the taxels of a row add to a hash.
    pub(crate) fn hash(&self, row: usize, mut taxels: u64) -> u64 {
        let numbers = self.numbers(row);
        let mut hash = 0;
        while taxels != 0 {
            hash ^= numbers[taxels.trailing_zeros() as usize];
            taxels &= taxels - 1;
        }
        hash
    }
}

/// The generator of G. L. Steele, D. Lea and C. H. Flood (2014): a sequence of numbers from one seed.
fn split_mix(state: &mut u64) -> u64 {
    *state = state.wrapping_add(0x9e37_79b9_7f4a_7c15);
    let mut mixed = *state;
    mixed = (mixed ^ mixed >> 30).wrapping_mul(0xbf58_476d_1ce4_e5b9);
    mixed = (mixed ^ mixed >> 27).wrapping_mul(0x94d0_49bb_1331_11eb);
    mixed ^ mixed >> 31
}
