use rayon::prelude::*;

use crate::atlas::counter::{ImprintCounter, Layout};
use crate::atlas::feature::{ImprintSummary, features};
use crate::atlas::key::{ImprintKey, KeyTable};
use crate::imprint::Imprint;
use crate::index::{narrow, wide};
use crate::sensor::MatrixSize;

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

    /// The summaries of the imprints, in their order.
    pub fn summaries(&self) -> &[ImprintSummary] {
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
        (wide(id) < self.len()).then(|| self.described(wide(id)))
    }

    fn described(&self, index: usize) -> AtlasEntry {
        let tally = self.counter.tallies()[index];
        AtlasEntry {
            id: narrow(index),
            imprint: self.layout.imprint(self.counter.key(index)),
            count: tally.count,
            first_pose: tally.first,
            summary: self.summaries[index],
        }
    }

    /// Iterates over all imprints in order.
    pub fn entries(&self) -> impl DoubleEndedIterator<Item = AtlasEntry> + ExactSizeIterator {
        (0..self.len()).map(|index| self.described(index))
    }

    /// Returns the number of an imprint; None if no pose leaves it.
    pub fn find(&self, imprint: &Imprint) -> Option<u32> {
        if imprint.size() != self.layout.size() {
            return None;
        }
        let (key, hash) = self.layout.key(imprint);
        self.number(&key, hash)
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
        let all = self.summaries.iter().zip(self.counts());
        let empty = all.filter(|(summary, _)| summary.description.is_none());
        empty.map(|(_, count)| count).sum()
    }

    /// Counts the imprints that remain distinct if images of the same imprint count as one. This takes a moment for
    /// millions of imprints.
    pub fn distinct_classes(&self) -> DistinctClasses {
        let (mut shifts, mut symmetry) = (KeyTable::default(), KeyTable::default());
        let mut key = ImprintKey::default();
        for index in 0..self.len() {
            key.set(&self.layout.imprint(self.counter.key(index)));
            // If the class under shifts is known, the one under more symmetries is known too.
            if shifts.add(&key) {
                symmetry.add(&key.first_image());
            }
        }
        DistinctClasses {
            up_to_shifts: shifts.len(),
            up_to_symmetry: symmetry.len(),
        }
    }
}
