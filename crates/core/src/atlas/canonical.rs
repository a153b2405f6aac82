//! The canonical form of imprints that differ only by a shift, a quarter turn or a mirror image.
//!
//! First, the active taxels are moved to the top left corner. There are eight images under quarter turns and mirroring.
//! Only those that are at least as wide as high are considered: four, or all eight if the bounds are a square. The
//! canonical form is the image whose rows come first in order. Rows are compared as whole numbers, from the top.

use crate::atlas::counter::ImprintCounter;
use crate::atlas::packing::Layout;
use crate::imprint::Imprint;
use crate::index::wide;
use crate::sensor::{MAX_SIDE, MatrixSize};

/// Counts distinct imprints up to shifts, and up to shifts, quarter turns and mirror images.
#[derive(Debug)]
pub(crate) struct Classes {
    layout: Layout,
    shifts: ImprintCounter,
    symmetry: ImprintCounter,
    key: Vec<u64>,
}

#[derive(Clone, Copy)]
struct Block {
    width: usize,
    height: usize,
    rows: [u64; MAX_SIDE as usize],
}

impl Classes {
    pub(crate) fn new(size: MatrixSize) -> Self {
        // The layout is square, so that a quarter turn fits.
        let layout = Layout::new(size.union(size.transposed()));
        let words = layout.words();
        Self {
            layout,
            shifts: ImprintCounter::new(words),
            symmetry: ImprintCounter::new(words),
            key: vec![0; words],
        }
    }

    pub(crate) fn counts(&self) -> (usize, usize) {
        (self.shifts.len(), self.symmetry.len())
    }

    pub(crate) fn add(&mut self, imprint: &Imprint) {
        let block = Block::of(imprint);
        let hash = self.pack(&block, |row| block.rows[row]);
        let known = self.shifts.len();
        self.shifts.add(&self.key, hash, 1, 0);
        if self.shifts.len() == known {
            // The class under more symmetries is known too.
            return;
        }
        let turned = block.transposed();
        let wide = |block: &Block| block.width >= block.height;
        let mut best: Option<(Block, bool)> = None;
        for block in [block, turned].into_iter().filter(wide) {
            for block in [block, block.mirrored()] {
                for upwards in [false, true] {
                    if best.is_none_or(|(best, down)| block.before(upwards, &best, down)) {
                        best = Some((block, upwards));
                    }
                }
            }
        }
        if let Some((block, upwards)) = best {
            let hash = self.pack(&block, |row| block.row(row, upwards));
            self.symmetry.add(&self.key, hash, 1, 0);
        }
    }

    /// Packs a block into the key, and returns its hash.
    fn pack(&mut self, block: &Block, row: impl Fn(usize) -> u64) -> u64 {
        self.key.fill(0);
        let mut hash = 0;
        for index in 0..block.height {
            let (word, shift) = self.layout.slot(index);
            let taxels = row(index);
            self.key[word] |= taxels << shift;
            hash ^= self.layout.hash(index, taxels);
        }
        hash
    }
}

impl Block {
    fn of(imprint: &Imprint) -> Self {
        let mut block = Self {
            width: 0,
            height: 0,
            rows: [0; MAX_SIDE as usize],
        };
        if let Some(bounds) = imprint.bounds() {
            block.width = usize::from(bounds.right - bounds.left);
            for (slot, row) in block.rows.iter_mut().zip(bounds.rows()) {
                *slot = imprint.words()[usize::from(row)] >> bounds.left;
            }
            block.height = bounds.rows().len();
        }
        block
    }

    fn row(&self, index: usize, upwards: bool) -> u64 {
        self.rows[if upwards {
            self.height - 1 - index
        } else {
            index
        }]
    }

    /// Returns true if the rows of this block come before those of another block of the same size.
    fn before(&self, upwards: bool, other: &Self, other_upwards: bool) -> bool {
        let rows = (0..self.height).map(|index| self.row(index, upwards));
        rows.lt((0..self.height).map(|index| other.row(index, other_upwards)))
    }

    fn mirrored(mut self) -> Self {
        for row in &mut self.rows[..self.height] {
            *row = row.reverse_bits() >> (64 - self.width);
        }
        self
    }

    fn transposed(&self) -> Self {
        let mut turned = Self {
            width: self.height,
            height: self.width,
            rows: [0; MAX_SIDE as usize],
        };
        for (index, &row) in self.rows[..self.height].iter().enumerate() {
            let mut rest = row;
            while rest != 0 {
                turned.rows[wide(rest.trailing_zeros())] |= 1 << index;
                rest &= rest - 1;
            }
        }
        turned
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use std::collections::HashSet;

    /// The odd factor of a hash that anybody can compute, and its inverse modulo 2^64.
    const FACTOR: (u64, u64) = (0x9e37_79b9_7f4a_7c15, 0xf1de_83e1_9937_733d);

    /// Returns an imprint with a taxel in its top left corner. Its first three words are given; the
    /// fourth is such that all imprints have the same value of a hash without a seed.
    fn crafted(words: [u64; 3]) -> Imprint {
        let mix = |hash: u64, word: u64| {
            let mixed = (hash.rotate_left(29) ^ word).wrapping_mul(FACTOR.0);
            mixed ^ mixed >> 32
        };
        let before = words.into_iter().fold(0, mix);
        let wanted = 0x1234_5678_9abc_def0_u64;
        let last = before.rotate_left(29) ^ (wanted ^ wanted >> 32).wrapping_mul(FACTOR.1);
        assert_eq!(mix(before, last), wanted);
        let mut imprint = Imprint::empty(MatrixSize::of(16, 16));
        for (row, word) in (0..).zip(words.into_iter().chain([last])) {
            for quarter in 0..4 {
                imprint.set_word(4 * row + quarter, word >> (16 * quarter));
            }
        }
        imprint
    }

    /// Keys with equal hashes are compared one by one, so as many as here would take n² / 2 comparisons.
    #[test]
    fn nobody_can_make_imprints_whose_classes_have_equal_hashes() {
        let size = MatrixSize::of(16, 16);
        let (mut classes, layout) = (Classes::new(size), Layout::new(size));
        for number in 0..1000 {
            let imprint = crafted([number << 16 | 1, number, 1]);
            classes.add(&imprint);
            let newest = classes.shifts.len() - 1;
            assert_eq!(classes.shifts.hash(newest), layout.key(&imprint).1);
        }
        let (shifts, symmetry) = classes.counts();
        assert_eq!(shifts, 1000, "all are different");
        for (counter, count) in [(&classes.shifts, shifts), (&classes.symmetry, symmetry)] {
            let hashes: HashSet<u64> = (0..count).map(|index| counter.hash(index)).collect();
            assert_eq!(hashes.len(), count);
        }
    }
}
