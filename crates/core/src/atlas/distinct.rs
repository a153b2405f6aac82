use rayon::prelude::*;

use crate::atlas::counter::{ImprintCounter, Layout};
use crate::atlas::feature::{ImprintSummary, features};
use crate::imprint::Imprint;
use crate::index::{narrow, wide};
use crate::sensor::{MAX_SIDE, MatrixSize};

/// The distinct imprints of a sweep, counted and described.
#[derive(Clone, Debug)]
pub struct Atlas {
    layout: Layout,
    counter: ImprintCounter,
    summaries: Vec<ImprintSummary>,
}

impl PartialEq for Atlas {
    fn eq(&self, other: &Self) -> bool {
        self.entries().eq(other.entries())
    }
}

/// An imprint of an atlas.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct AtlasEntry {
    /// The number of the imprint, from 0, in the order of first occurrence.
    pub id: u32,
    /// The imprint.
    pub imprint: Imprint,
    /// The number of poses that leave the imprint.
    pub count: u64,
    /// The number of the first of these poses in the grid.
    pub first_pose: u64,
    /// The number of pieces and holes, and the description of the main region.
    pub summary: ImprintSummary,
}

/// An imprint of an atlas that lies at another place than a given one.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct ShiftedImprint {
    /// The number of the imprint.
    pub id: u32,
    /// The columns by which the given one lies further to the right; negative if it lies further to the left.
    pub right: i8,
    /// The rows by which the given one lies further down; negative if it lies further up.
    pub down: i8,
}

/// The numbers of distinct imprints if images of the same imprint count as one.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct DistinctClasses {
    /// The number up to shifts by whole taxels.
    pub up_to_shifts: usize,
    /// The number up to shifts, quarter turns and mirror images.
    pub up_to_symmetry: usize,
}

impl Atlas {
    pub(crate) fn new(size: MatrixSize) -> Self {
        let layout = Layout::new(size);
        Self {
            counter: ImprintCounter::new(layout.words()),
            layout,
            summaries: Vec::new(),
        }
    }

    pub(crate) fn layout(&self) -> &Layout {
        &self.layout
    }

    /// Adds the imprints of a counter, with their counts times `multiplicity`. Returns the number that each imprint has
    /// in this atlas.
    pub(crate) fn add(&mut self, other: &ImprintCounter, multiplicity: u64) -> Vec<u32> {
        let tallies = other.tallies().iter().enumerate();
        tallies
            .map(|(index, tally)| {
                let (key, hash) = (other.key(index), other.hash(index));
                let id = self
                    .counter
                    .add(key, hash, tally.count * multiplicity, tally.first);
                narrow(id)
            })
            .collect()
    }

    pub(crate) fn add_all(&mut self, other: &Self) {
        let ids = self.add(&other.counter, 1);
        for (id, summary) in ids.into_iter().zip(&other.summaries) {
            if wide(id) == self.summaries.len() {
                self.summaries.push(*summary);
            }
        }
    }

    /// Describes the imprints that were added since the last call.
    pub(crate) fn describe(&mut self) {
        let (layout, counter) = (&self.layout, &self.counter);
        self.summaries.par_extend(
            (self.summaries.len()..counter.len())
                .into_par_iter()
                .with_min_len(256)
                .map(|index| ImprintSummary::of(&layout.imprint(counter.key(index)))),
        );
    }

    /// Numbers the imprints in the order of their first poses. All imprints must be described.
    pub(crate) fn sort_by_first_pose(&mut self) {
        let order = self.counter.sort_by_first_pose();
        self.summaries = order.iter().map(|&old| self.summaries[old]).collect();
    }

    pub(crate) fn summaries(&self) -> &[ImprintSummary] {
        &self.summaries
    }

    /// Iterates over the numbers of poses that leave the imprints, in their order.
    pub fn counts(&self) -> impl DoubleEndedIterator<Item = u64> + ExactSizeIterator {
        self.counter.tallies().iter().map(|tally| tally.count)
    }

    /// Iterates over the numbers of the first poses that leave the imprints, in their order.
    pub fn first_poses(&self) -> impl DoubleEndedIterator<Item = u64> + ExactSizeIterator {
        self.counter.tallies().iter().map(|tally| tally.first)
    }

    /// Returns the number of distinct imprints.
    pub fn len(&self) -> usize {
        self.summaries.len()
    }

    /// Returns true if there are no imprints, because no pose was swept.
    pub fn is_empty(&self) -> bool {
        self.summaries.is_empty()
    }

    /// Returns the imprint with a number; None if there is none.
    pub fn entry(&self, id: u32) -> Option<AtlasEntry> {
        let index = wide(id);
        let summary = self.summaries.get(index)?;
        Some(self.described(index, summary))
    }

    fn described(&self, index: usize, summary: &ImprintSummary) -> AtlasEntry {
        let tally = self.counter.tallies()[index];
        AtlasEntry {
            id: narrow(index),
            imprint: self.layout.imprint(self.counter.key(index)),
            count: tally.count,
            first_pose: tally.first,
            summary: *summary,
        }
    }

    /// Iterates over all imprints in order.
    pub fn entries(&self) -> impl DoubleEndedIterator<Item = AtlasEntry> + ExactSizeIterator {
        let summaries = self.summaries.iter().enumerate();
        summaries.map(|(index, summary)| self.described(index, summary))
    }

    /// Returns the number of an imprint; None if no pose leaves it.
    pub fn find(&self, imprint: &Imprint) -> Option<u32> {
        if imprint.size() != self.layout.size() {
            return None;
        }
        let (key, hash) = self.layout.key(imprint);
        self.number(&key, hash)
    }

    /// Returns the nearest imprint that differs from the given one only by a shift of whole taxels. None if there is no
    /// such imprint.
    pub fn find_shifted(&self, imprint: &Imprint) -> Option<ShiftedImprint> {
        let size = self.layout.size();
        let bounds = imprint.bounds()?;
        let (wide, high) = (bounds.columns().len(), bounds.rows().len());
        let mut nearest: Option<ShiftedImprint> = None;
        for top in 0..=size.rows().checked_sub(u8::try_from(high).ok()?)? {
            for left in 0..=size.columns().checked_sub(u8::try_from(wide).ok()?)? {
                // Both are at most 64.
                let right = bounds.left.cast_signed() - left.cast_signed();
                let down = bounds.top.cast_signed() - top.cast_signed();
                let far = |right: i8, down: i8| right.unsigned_abs() + down.unsigned_abs();
                if nearest.is_some_and(|own| far(own.right, own.down) <= far(right, down)) {
                    continue;
                }
                let mut moved = Imprint::empty(size);
                for (row, from) in (usize::from(top)..).zip(bounds.rows()) {
                    let word = imprint.words()[usize::from(from)] >> bounds.left;
                    moved.set_word(row, word << left);
                }
                if let Some(id) = self.find(&moved) {
                    nearest = Some(ShiftedImprint { id, right, down });
                }
            }
        }
        nearest
    }

    /// Returns the number of the imprint that has a key.
    pub(crate) fn number(&self, key: &[u64], hash: u64) -> Option<u32> {
        let index = self.counter.find(key, hash)?;
        u32::try_from(index).ok()
    }

    /// Returns the value of a feature for every imprint, in their order; None if it does not exist. `feature` is its
    /// index in [`features`]; with any other index, all are None.
    pub fn values(&self, feature: usize) -> Vec<Option<f64>> {
        let feature = features().get(feature);
        let value = |summary: &ImprintSummary| feature?.value(summary.description.as_ref()?);
        self.summaries
            .par_iter()
            .with_min_len(1024)
            .map(value)
            .collect()
    }

    /// Returns the number of poses in which no taxel is active.
    pub fn empty_poses(&self) -> u64 {
        let described = self
            .summaries
            .iter()
            .map(|summary| summary.description.is_some());
        let empty = described
            .zip(self.counts())
            .filter(|(described, _)| !described);
        empty.map(|(_, count)| count).sum()
    }

    /// Counts the imprints that remain distinct if images of the same imprint count as one. This takes a moment for
    /// millions of imprints.
    pub fn distinct_classes(&self) -> DistinctClasses {
        let mut classes = Classes::new(self.layout.size());
        for index in 0..self.len() {
            classes.add(&self.layout.imprint(self.counter.key(index)));
        }
        let (up_to_shifts, up_to_symmetry) = classes.counts();
        DistinctClasses {
            up_to_shifts,
            up_to_symmetry,
        }
    }
}

// The canonical form of imprints that differ only by a shift, a quarter turn or a mirror image.
//
// First, the active taxels are moved to the top left corner. There are eight images under quarter turns and mirroring.
// Only those that are at least as wide as high are considered: four, or all eight if the bounds are a square. The
// canonical form is the image whose rows come first in order. Rows are compared as whole numbers, from the top.

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
    use std::collections::HashSet;

    use super::*;
    use crate::figure::Figure;
    use crate::pose::{Anchor, PoseGrid, Ranges};
    use crate::sensor::Sensor;
    use crate::sweep::Sweep;

    #[test]
    fn the_first_of_equally_near_imprints_is_found() {
        let sensor = Sensor::default();
        let bar = Figure::rectangle(3.0, 1.0).on(&sensor).expect("in range");
        let found = |x0: &str, y0: &str| {
            let ranges = [x0, y0, "0", "1", "1"].map(|range| range.parse().expect("a range"));
            let grid = PoseGrid::new(bar.into(), sensor, Anchor::Corner, Ranges::new(ranges));
            let atlas = Sweep::new(&grid.expect("in range")).run().atlas;
            let mut between = Imprint::empty(MatrixSize::of(16, 16));
            (4..7).for_each(|column| between.set(column, 4, true));
            atlas.find_shifted(&between)
        };
        let first = |right, down| Some(ShiftedImprint { id: 0, right, down });
        assert_eq!(found("2:6:4", "4"), first(2, 0));
        assert_eq!(found("4", "2:6:4"), first(0, 2));
    }

    #[test]
    fn examples_of_distinct() -> Result<(), Box<dyn std::error::Error>> {
        use crate::prelude::*;
        let sensor = Sensor::default();
        let bar = Source::from(Figure::rectangle(3.0, 1.0).on(&sensor)?);
        let ranges = Ranges::new(
            ["2:2.9:0.1", "2", "0", "1", "1"].map(|range| range.parse().expect("a range")),
        );
        let grid = PoseGrid::new(bar, sensor, Anchor::Corner, ranges)?;
        let result = Sweep::new(&grid).run();
        let atlas = &result.atlas;
        let moved = Figure::rectangle(3.0, 1.0).at(7.0, 1.0).on(&sensor)?;
        let imprint = Plane::new(sensor).touch(&moved);
        assert_eq!(atlas.find(&imprint), None);
        // Up to 2.4 the bar covers columns 2 to 4, from 2.6 on columns 3 to 5, which are nearer.
        let found = atlas.find_shifted(&imprint).expect("the bar");
        assert_eq!((found.id, found.right, found.down), (2, 4, -1));
        Ok(())
    }

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
