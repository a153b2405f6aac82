//! Counts keys: stores each distinct key once, in the order of its first addition, with its count and its first pose.
//!
//! The counter is an open hash table of indices; the keys are stored beside it. A slot holds the upper half of a hash
//! and an index, so nearly all comparisons end there. A key is found only if all of its words are equal.

use crate::index::index;

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
            self.grow();
        }
        index
    }

    fn grow(&mut self) {
        self.slots = self.slots_for(self.slots.len() * 2);
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
