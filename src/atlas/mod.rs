//! The atlas: every imprint of a sweep once, with how often and where it occurs, and what it looks like.
//!
//! Two imprints are the same when the same taxels are active. An imprint's number is that of its first occurrence in
//! the order of poses (see [`crate::pose::grid`]), the same for any number of threads. Descriptors are those of the main
//! region. Convention of this project.

pub(crate) mod packing;

pub(crate) mod counter;

pub mod feature;

pub(crate) mod canonical;

pub(crate) mod sums;

pub(crate) mod values;

pub(crate) mod variance;

pub mod statistics;

pub mod order;

pub mod histogram;

use rayon::prelude::*;

use crate::atlas::canonical::Classes;
use crate::atlas::counter::Census;
use crate::atlas::feature::{Note, describe, values};
use crate::atlas::packing::Layout;
use crate::imprint::Imprint;

/// Distinct imprints, counted and described.
#[derive(Clone, Debug)]
pub struct Atlas {
    layout: Layout,
    census: Census,
    notes: Vec<Note>,
}

/// A row of an atlas.
#[derive(Clone, Copy, Debug, PartialEq)]
#[non_exhaustive]
pub struct Entry {
    /// From 0, in order of first occurrence.
    pub id: u32,
    /// Which taxels are active.
    pub imprint: Imprint,
    /// In how many poses.
    pub count: u64,
    /// The number of the first of these in the grid.
    pub first_pose: u64,
    /// Pieces, holes and the description of its main region.
    pub note: Note,
}

impl Atlas {
    pub(crate) fn new(columns: u8, rows: u8) -> Self {
        let layout = Layout::new(columns, rows);
        Self {
            census: Census::new(layout.words()),
            layout,
            notes: Vec::new(),
        }
    }

    pub(crate) fn layout(&self) -> &Layout {
        &self.layout
    }

    /// Counts all of another census, each count so many times. The numbers here of its keys.
    pub(crate) fn add(&mut self, other: &Census, times: u64) -> Vec<u32> {
        let tallies = other.tallies().iter().enumerate();
        tallies
            .map(|(index, tally)| {
                let (key, hash) = (other.key(index), other.hash(index));
                let id = self.census.add(key, hash, tally.count * times, tally.first);
                u32::try_from(id).unwrap_or(u32::MAX)
            })
            .collect()
    }

    /// Adds all of another atlas of the same sensor.
    pub(crate) fn add_all(&mut self, other: &Self) {
        let ids = self.add(&other.census, 1);
        for (id, note) in ids.into_iter().zip(&other.notes) {
            if usize::try_from(id).is_ok_and(|id| id == self.notes.len()) {
                self.notes.push(*note);
            }
        }
    }

    /// Describes the imprints that are new since the last time.
    pub(crate) fn describe(&mut self) {
        let (layout, census) = (&self.layout, &self.census);
        self.notes.par_extend(
            (self.notes.len()..census.len())
                .into_par_iter()
                .with_min_len(256)
                .map(|index| describe(&layout.imprint(census.key(index)))),
        );
    }

    /// What is known of the imprints, in their order.
    pub(crate) fn notes(&self) -> &[Note] {
        &self.notes
    }

    /// How often the imprints occur, in their order.
    pub fn counts(&self) -> impl Iterator<Item = u64> + '_ {
        self.census.tallies().iter().map(|tally| tally.count)
    }

    /// Number of distinct imprints.
    pub fn len(&self) -> usize {
        self.notes.len()
    }

    /// Whether there is none, because no pose was gone through.
    pub fn is_empty(&self) -> bool {
        self.notes.is_empty()
    }

    /// The imprint of that number.
    pub fn entry(&self, id: u32) -> Option<Entry> {
        let index = usize::try_from(id).ok()?;
        let note = *self.notes.get(index)?;
        let tally = self.census.tallies()[index];
        Some(Entry {
            id,
            imprint: self.layout.imprint(self.census.key(index)),
            count: tally.count,
            first_pose: tally.first,
            note,
        })
    }

    /// All rows in order.
    pub fn entries(&self) -> impl Iterator<Item = Entry> + '_ {
        (0..u32::try_from(self.len()).unwrap_or(u32::MAX)).filter_map(|id| self.entry(id))
    }

    /// The number of an imprint; none where it does not occur.
    pub fn find(&self, imprint: &Imprint) -> Option<u32> {
        if (imprint.columns(), imprint.rows()) != (self.layout.columns(), self.layout.rows()) {
            return None;
        }
        let (key, hash) = self.layout.key(imprint);
        self.number(&key, hash)
    }

    /// The number of the imprint that has a key.
    pub(crate) fn number(&self, key: &[u64], hash: u64) -> Option<u32> {
        let index = self.census.find(key, hash)?;
        u32::try_from(index).ok()
    }

    /// A number of [`quantities`](crate::atlas::feature::quantities) of every imprint, in their order; none where it does not
    /// exist.
    pub fn values(&self, quantity: usize) -> Vec<Option<f64>> {
        let value = |note: &Note| {
            let mut found = None;
            values(note.description.as_ref()?, |index, value| {
                if index == quantity {
                    found = Some(value);
                }
            });
            found
        };
        self.notes
            .par_iter()
            .with_min_len(1024)
            .map(value)
            .collect()
    }

    /// How many poses leave no imprint.
    pub fn empty_poses(&self) -> u64 {
        let described = self.notes.iter().map(|note| note.description.is_some());
        let empty = described
            .zip(self.counts())
            .filter(|(described, _)| !described);
        empty.map(|(_, count)| count).sum()
    }

    /// How many imprints are distinct up to whole-cell shifts, and how many up to shifts, quarter turns and mirror
    /// images.
    pub fn distinct_classes(&self) -> (usize, usize) {
        let mut classes = Classes::new(self.layout.columns(), self.layout.rows());
        for index in 0..self.len() {
            classes.add(&self.layout.imprint(self.census.key(index)));
        }
        classes.counts()
    }
}
