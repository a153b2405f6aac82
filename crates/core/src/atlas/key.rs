//! Keys: the part of an imprint that does not depend on where it lies.

use std::hash::BuildHasher;

use hashbrown::{DefaultHashBuilder, HashTable};

use crate::imprint::Imprint;
use crate::index::{narrow, wide};
use crate::sensor::MatrixSize;

/// The key of an imprint: its active taxels, of all its pieces, cropped to their bounding box. The key of an empty
/// imprint has sides of 0.
///
/// Keys are ordered by height, width, and the taxels in reading order.
///
/// ```
/// use taxel_core::prelude::*;
/// use taxel_core::atlas::ImprintKey;
///
/// let here: Imprint = "....\n.##.\n..#.".parse().unwrap();
/// let there: Imprint = "##\n.#".parse().unwrap();
/// assert_eq!(ImprintKey::of(&here), ImprintKey::of(&there));
/// ```
#[derive(Clone, Debug, Default, PartialEq, Eq, PartialOrd, Ord, Hash)]
pub struct ImprintKey {
    height: u8,
    width: u8,
    bits: Vec<u64>,
}

impl ImprintKey {
    /// Returns the key of an imprint.
    pub fn of(imprint: &Imprint) -> Self {
        let mut key = Self::default();
        key.set(imprint);
        key
    }

    /// Makes this the key of another imprint.
    pub fn set(&mut self, imprint: &Imprint) {
        match imprint.bounds() {
            Some(bounds) => {
                let rows = bounds.words(imprint).iter().map(|row| row >> bounds.left);
                self.pack(bounds.right - bounds.left, bounds.bottom - bounds.top, rows);
            }
            None => self.pack(0, 0, std::iter::empty()),
        }
    }

    fn pack(&mut self, width: u8, height: u8, rows: impl Iterator<Item = u64>) {
        (self.width, self.height) = (width, height);
        self.bits.clear();
        self.bits.resize(words(width, height), 0);
        for (index, row) in rows.enumerate() {
            or_bits(&mut self.bits, index * usize::from(width), row);
        }
    }

    /// Returns the key of the image whose rows come first in order, among the images under quarter turns and mirroring
    /// that are at least as wide as high.
    pub(crate) fn first_image(&self) -> Self {
        let rows: Vec<u64> = self.borrowed().rows().collect();
        let mut turned = vec![0; self.width.into()];
        for (row, word) in rows.iter().enumerate() {
            for (column, turned) in turned.iter_mut().enumerate() {
                *turned |= (word >> column & 1) << row;
            }
        }
        let (width, height) = (self.width.max(self.height), self.width.min(self.height));
        let mut images = vec![rows, turned];
        images.retain(|rows| rows.len() == usize::from(height));
        let mirrored = |row: &u64| row.reverse_bits() >> (64 - width);
        for index in 0..images.len() {
            images.push(images[index].iter().map(mirrored).collect());
        }
        for index in 0..images.len() {
            images.push(images[index].iter().rev().copied().collect());
        }
        let first = images.into_iter().min().unwrap_or_default();
        let mut key = Self::default();
        key.pack(width, height, first.into_iter());
        key
    }

    pub(crate) fn borrowed(&self) -> KeyRef<'_> {
        KeyRef {
            height: self.height,
            width: self.width,
            bits: &self.bits,
        }
    }
}

fn words(width: u8, height: u8) -> usize {
    (usize::from(width) * usize::from(height)).div_ceil(64)
}

pub(crate) fn or_bits(bits: &mut [u64], place: usize, row: u64) {
    let (word, shift) = (place / 64, place % 64);
    bits[word] |= row << shift;
    let rest = row.unbounded_shr(narrow(64 - shift));
    if rest != 0 {
        bits[word + 1] |= rest;
    }
}

/// A reference to a key of a table.
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord, Hash)]
pub(crate) struct KeyRef<'a> {
    pub(crate) height: u8,
    pub(crate) width: u8,
    pub(crate) bits: &'a [u64],
}

impl KeyRef<'_> {
    pub(crate) fn count(self) -> u32 {
        self.bits.iter().map(|word| word.count_ones()).sum()
    }

    /// Iterates over the rows from the top, bit `i` for column `i`.
    pub(crate) fn rows(self) -> impl Iterator<Item = u64> {
        let mask = u64::MAX.unbounded_shr(64 - u32::from(self.width));
        (0..usize::from(self.height)).map(move |row| {
            let place = row * usize::from(self.width);
            let (word, shift) = (place / 64, place % 64);
            let low = self.bits[word] >> shift;
            let high = self.bits.get(word + 1).copied().unwrap_or_default();
            (low | high.unbounded_shl(narrow(64 - shift))) & mask
        })
    }

    pub(crate) fn imprint(self) -> Option<Imprint> {
        let mut imprint = Imprint::empty(MatrixSize::new(self.width, self.height).ok()?);
        for (row, word) in self.rows().enumerate() {
            imprint.set_word(row, word);
        }
        Some(imprint)
    }
}

/// A table of many keys, each in as few words as its box needs, found by a seeded hash.
#[derive(Clone, Debug, Default)]
pub struct KeyTable {
    sizes: Vec<(u8, u8)>,
    starts: Vec<usize>,
    bits: Vec<u64>,
    index: HashTable<u32>,
    hasher: DefaultHashBuilder,
}

impl PartialEq for KeyTable {
    fn eq(&self, other: &Self) -> bool {
        (&self.sizes, &self.bits) == (&other.sizes, &other.bits)
    }
}

impl Eq for KeyTable {}

impl KeyTable {
    /// Returns the number of keys.
    pub fn len(&self) -> usize {
        self.sizes.len()
    }

    /// Returns true if the table has no key.
    pub fn is_empty(&self) -> bool {
        self.sizes.is_empty()
    }

    /// Returns the imprint of a key, on a matrix of exactly its size; None for the empty key.
    ///
    /// # Panics
    /// Panics if there are not that many keys.
    pub fn imprint(&self, index: usize) -> Option<Imprint> {
        self.get(index).imprint()
    }

    /// Returns the number of a key, from 0; None if the table does not have it.
    pub fn find(&self, key: &ImprintKey) -> Option<usize> {
        self.find_ref(key.borrowed(), self.hasher.hash_one(key.borrowed()))
    }

    fn find_ref(&self, key: KeyRef<'_>, hash: u64) -> Option<usize> {
        let found = self.index.find(hash, |&index| self.get(wide(index)) == key);
        found.map(|&index| wide(index))
    }

    pub(crate) fn get(&self, index: usize) -> KeyRef<'_> {
        key_at(&self.sizes, &self.starts, &self.bits, index)
    }

    /// Adds a key. Returns false if the table has it already.
    pub fn add(&mut self, key: &ImprintKey) -> bool {
        let next = self.len();
        self.intern(key.borrowed()) == next
    }

    pub(crate) fn intern(&mut self, key: KeyRef<'_>) -> usize {
        let hash = self.hasher.hash_one(key);
        if let Some(index) = self.find_ref(key, hash) {
            return index;
        }
        let index = self.len();
        self.sizes.push((key.height, key.width));
        self.starts.push(self.bits.len());
        self.bits.extend_from_slice(key.bits);
        let (sizes, starts, bits, hasher) = (&self.sizes, &self.starts, &self.bits, &self.hasher);
        let hash_of = |&index: &u32| hasher.hash_one(key_at(sizes, starts, bits, wide(index)));
        self.index.insert_unique(hash, narrow(index), hash_of);
        index
    }

    /// Returns the same keys in their order, and for each its number in this table.
    pub(crate) fn sorted(&self) -> (Self, Vec<usize>) {
        let mut order: Vec<usize> = (0..self.len()).collect();
        order.sort_unstable_by_key(|&index| self.get(index));
        let mut sorted = Self::default();
        for &index in &order {
            sorted.intern(self.get(index));
        }
        (sorted, order)
    }
}

fn key_at<'a>(sizes: &[(u8, u8)], starts: &[usize], bits: &'a [u64], index: usize) -> KeyRef<'a> {
    let (height, width) = sizes[index];
    KeyRef {
        height,
        width,
        bits: &bits[starts[index]..][..words(width, height)],
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn keys_give_back_their_imprints_of_any_size() {
        let mut table = KeyTable::default();
        for side in [1_u8, 7, 8, 9, 31, 63, 64] {
            let mut imprint = Imprint::empty(MatrixSize::of(64, 64));
            // Both corners, and a pattern that no shift repeats.
            for place in 0..side {
                imprint.set(place, place, true);
                imprint.set(side - 1, place.wrapping_mul(5) % side, true);
            }
            let key = ImprintKey::of(&imprint);
            assert_eq!(
                key.borrowed().imprint(),
                Some(imprint.resized(MatrixSize::of(side, side)))
            );
            assert_eq!((key.width, key.height), (side, side));
            let index = table.intern(key.borrowed());
            assert_eq!(
                (table.intern(key.borrowed()), table.find(&key)),
                (index, Some(index))
            );
            assert_eq!(table.imprint(index), key.borrowed().imprint());
        }
        assert_eq!(table.len(), 7);
        let (sorted, order) = table.sorted();
        assert_eq!(order, [0, 1, 2, 3, 4, 5, 6]);
        assert!((1..sorted.len()).all(|index| sorted.get(index - 1) < sorted.get(index)));
    }

    /// The imprint looks like none of its images.
    #[test]
    fn the_images_of_an_imprint_have_one_first_image() {
        let read = |text: &str| ImprintKey::of(&text.parse().expect("rows"));
        let images = [
            ".#..\n####\n#...",
            "..#.\n####\n...#",
            "#...\n####\n.#..",
            "...#\n####\n..#.",
            "##.\n.##\n.#.\n.#.",
            ".##\n##.\n.#.\n.#.",
            ".#.\n.#.\n.##\n##.",
            ".#.\n.#.\n##.\n.##",
        ]
        .map(read);
        let first = images[0].first_image();
        assert_eq!((first.width, first.height), (4, 3));
        for (index, image) in images.iter().enumerate() {
            assert_eq!(image.first_image(), first, "{image:?}");
            assert!(images[..index].iter().all(|other| other != image));
        }
        assert_eq!(first.first_image(), first);
        let square = |text: &str| read(text).first_image();
        assert_eq!(square("##\n#."), square(".#\n##"));
        assert_ne!(square("##\n#."), square("##\n##"));
        let nothing = ImprintKey::default();
        assert_eq!(nothing.first_image(), nothing);
    }
}
