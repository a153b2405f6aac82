//! The keys of a model, arranged for comparison with an imprint in every place on its matrix.
//!
//! The distance of a key in a place is the number of taxels in which the imprint differs from the key put there. Inside
//! the key's box this is a popcount of key ^ window, where the window is the part of the imprint under the box,
//! extracted once for all keys with the same box; outside, it is the number of the imprint's own taxels.
//!
//! Keys are grouped by their box and their number of taxels, n. If the imprint has C taxels and i of them lie inside
//! the box, then C − i differ outside and at least |i − n| inside. So a sum over the box bounds the distance of a whole
//! group in one place, and the largest number of taxels inside any place bounds it in all places: most groups and
//! places are never compared. What remains are dense loops over keys.

use std::cmp::Reverse;
use std::ops::Range;
use std::sync::atomic::{AtomicU32, Ordering};

use rayon::prelude::*;

use crate::atlas::{ImprintKey, KeyRef, KeyTable, or_bits};
use crate::imprint::Imprint;
use crate::index::{narrow, wide};
use crate::recognition::model::{Model, first_of_most};
use crate::sensor::MatrixSize;

/// The number of keys that are compared with all windows before the next ones, so that their counts stay in the cache.
const BLOCK: usize = 64;

/// The number of keys of one task. Fewer keys than this are compared on the calling thread. Tests use a smaller number,
/// because their models have few keys.
const TASK: usize = if cfg!(test) { 64 } else { 1 << 15 };

/// All keys of a model, by box and number of taxels.
#[derive(Clone, Debug)]
pub(super) struct KeyIndex {
    boxes: Vec<KeyBox>,
    groups: Vec<Group>,
    numbers: Vec<u32>,
    bits: Vec<u64>,
}

/// A box, and the keys that have it.
#[derive(Clone, Debug)]
pub(super) struct KeyBox {
    pub(super) width: u8,
    pub(super) height: u8,
    length: usize,
    /// The numbers of its keys in the table.
    pub(super) keys: Range<usize>,
    /// The groups of the box, in the order of their numbers of taxels.
    groups: Range<usize>,
}

/// Keys of one box and one number of taxels.
#[derive(Clone, Debug)]
struct Group {
    count: u32,
    keys: Range<usize>,
    bits: usize,
}

/// A key in a place on a matrix, and how many taxels differ there.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) struct PlacedKey {
    pub(super) distance: u32,
    pub(super) key: usize,
    /// The column and the row of its corner.
    pub(super) place: [u8; 2],
}

/// Returns the number of places of a box on a matrix; 0 if it does not fit.
pub(super) fn shift_count((width, height): (u8, u8), size: MatrixSize) -> u64 {
    let fits = |side: u8, of: u8| of.checked_sub(side).map_or(0, |rest| u64::from(rest) + 1);
    fits(width, size.columns()) * fits(height, size.rows())
}

/// An observed imprint, without its dead taxels.
pub(super) struct Observed {
    seen: Imprint,
    /// The taxels that are not dead; None if no taxel is.
    living: Option<Imprint>,
    count: u32,
    /// Sums of active taxels; `dead` has those of dead ones, if there are any.
    active: IntegralImage,
    dead: Option<IntegralImage>,
}

/// A summed-area table: the number of taxels above and left of each corner of a cell, row after row.
struct IntegralImage {
    width: usize,
    sums: Vec<u16>,
}

impl IntegralImage {
    fn of(imprint: &Imprint) -> Self {
        let width = usize::from(imprint.columns()) + 1;
        let mut sums = vec![0_u16; width * (usize::from(imprint.rows()) + 1)];
        for (row, &word) in imprint.words().iter().enumerate() {
            let (above, below) = sums[row * width..].split_at_mut(width);
            let mut in_row = 0;
            for column in 1..width {
                in_row += u16::from(word >> (column - 1) & 1 == 1);
                below[column] = above[column] + in_row;
            }
        }
        Self { width, sums }
    }

    fn inside(&self, (column, row): (usize, usize), (width, height): (usize, usize)) -> u32 {
        let at = |column: usize, row: usize| u32::from(self.sums[row * self.width + column]);
        let (right, bottom) = (column + width, row + height);
        at(right, bottom) + at(column, row) - at(right, row) - at(column, bottom)
    }
}

/// A position of a box on the observed matrix.
#[derive(Clone, Copy, Debug, Default)]
struct BoxPosition {
    column: u8,
    row: u8,
    inside: u32,
    dead: u32,
}

impl Observed {
    pub(super) fn new(imprint: &Imprint, dead: Option<&Imprint>) -> Self {
        let size = imprint.size();
        // Fitted to the matrix of the imprint: what lies beyond it is dropped.
        let dead = dead.map(|dead| dead.resized(size));
        let dead = dead.filter(|dead| !dead.is_empty());
        let seen = dead.map_or(*imprint, |dead| imprint.without(&dead));
        let living = dead.map(|dead| {
            let mut living = Imprint::empty(size);
            for (row, &word) in dead.words().iter().enumerate() {
                living.set_word(row, !word);
            }
            living
        });
        Self {
            count: seen.count(),
            active: IntegralImage::of(&seen),
            dead: dead.as_ref().map(IntegralImage::of),
            seen,
            living,
        }
    }

    /// Visits all places of a box in reading order; none if the box does not fit.
    fn each_place(&self, (width, height): (u8, u8), mut visit: impl FnMut(BoxPosition)) {
        let (columns, rows) = (self.seen.columns(), self.seen.rows());
        let size = (usize::from(width), usize::from(height));
        if width > columns {
            return;
        }
        for row in 0..(rows + 1).saturating_sub(height) {
            for column in 0..=columns - width {
                let corner = (usize::from(column), usize::from(row));
                let dead = self.dead.as_ref();
                visit(BoxPosition {
                    column,
                    row,
                    inside: self.active.inside(corner, size),
                    dead: dead.map_or(0, |dead| dead.inside(corner, size)),
                });
            }
        }
    }

    /// Returns a lower bound of the distance of a key of `count` taxels in a place. More taxels inside, active or
    /// dead, never make it larger.
    fn bound(&self, count: u32, place: BoxPosition) -> u32 {
        let apart = if place.inside > count {
            place.inside - count
        } else {
            // Dead taxels of a key do not count, however many of them it covers.
            (count - place.inside).saturating_sub(place.dead)
        };
        self.count - place.inside + apart
    }
}

/// The windows that the keys of a box are compared with: parts of the observed imprint as large as the box, those with
/// the most taxels first.
struct Windows {
    places: Vec<BoxPosition>,
    length: usize,
    /// The taxels inside each place, in the layout of keys; `living` has those that are not dead.
    bits: Vec<u64>,
    living: Vec<u64>,
}

impl Windows {
    fn new(observed: &Observed, of: &KeyBox, most: u32) -> Self {
        let mut places = Vec::new();
        observed.each_place((of.width, of.height), |place| {
            if observed.count - place.inside <= most {
                places.push(place);
            }
        });
        // The sort is stable: of equals, the first in reading order comes first.
        places.sort_by_key(|place| Reverse(place.inside));
        let mut bits = vec![0; places.len() * of.length];
        let mut living = vec![u64::MAX; places.len() * of.length];
        for (index, &place) in places.iter().enumerate() {
            let own = index * of.length..(index + 1) * of.length;
            cut(&observed.seen, of, place, &mut bits[own.clone()]);
            if let Some(imprint) = &observed.living {
                living[own.clone()].fill(0);
                cut(imprint, of, place, &mut living[own]);
            }
        }
        Self {
            places,
            length: of.length,
            bits,
            living,
        }
    }

    /// Returns a lower bound of the distance of a key of `count` taxels in any of the windows; None without a window.
    fn bound(&self, observed: &Observed, count: u32) -> Option<u32> {
        let bounds = self.places.iter();
        bounds.map(|&place| observed.bound(count, place)).min()
    }
}

fn cut(imprint: &Imprint, of: &KeyBox, place: BoxPosition, bits: &mut [u64]) {
    let mask = u64::MAX.unbounded_shr(64 - u32::from(of.width));
    let rows = &imprint.words()[usize::from(place.row)..];
    for (index, &row) in rows.iter().take(usize::from(of.height)).enumerate() {
        let row = row.unbounded_shr(place.column.into()) & mask;
        or_bits(bits, index * usize::from(of.width), row);
    }
}

impl KeyIndex {
    pub(super) fn new(keys: &KeyTable) -> Self {
        let size = |key: KeyRef<'_>| (key.height, key.width);
        let mut order: Vec<_> = (0..keys.len())
            .map(|number| (keys.get(number), number))
            .map(|(key, number)| ((size(key), key.count()), number))
            .collect();
        order.sort_unstable();
        let mut index = Self {
            boxes: Vec::new(),
            groups: Vec::new(),
            numbers: Vec::with_capacity(keys.len()),
            bits: Vec::new(),
        };
        for own in order.chunk_by(|((one, _), _), ((other, _), _)| one == other) {
            let ((height, width), start) = (own[0].0.0, index.numbers.len());
            let first = keys.get(own[0].1);
            // The table is in the order of boxes, too.
            let end = start + own.len();
            let groups = index.groups.len();
            for own in own.chunk_by(|one, other| one.0 == other.0) {
                let start = index.numbers.len();
                index.groups.push(Group {
                    count: own[0].0.1,
                    keys: start..start + own.len(),
                    bits: index.bits.len(),
                });
                for &(_, number) in own {
                    index.numbers.push(narrow(number));
                    index.bits.extend_from_slice(keys.get(number).bits);
                }
            }
            index.boxes.push(KeyBox {
                width,
                height,
                length: first.bits.len(),
                keys: start..end,
                groups: groups..index.groups.len(),
            });
        }
        index
    }

    pub(super) fn boxes(&self) -> &[KeyBox] {
        &self.boxes
    }

    /// Returns the `count` keys nearest to an imprint, the nearest first, each in its nearest place; among equals the
    /// one whose key has the lowest `rank`, then the first key, then the first place in reading order.
    pub(super) fn nearest<R: Ord + Send>(
        &self,
        observed: &Observed,
        count: usize,
        rank: impl Fn(usize) -> R + Sync,
    ) -> Vec<PlacedKey> {
        // No key is wanted that is farther than this.
        let most = AtomicU32::new(u32::MAX);
        let task = |group: &Group, windows: &Windows, keys: Range<usize>| {
            let mut near: Vec<(u32, R, usize, (u8, u8))> = Vec::new();
            let before = most.load(Ordering::Relaxed);
            let mut limit = before;
            let take = |key: usize, place: BoxPosition, distance: u32| {
                let key = wide(self.numbers[key]);
                let own = (distance, rank(key), key, (place.row, place.column));
                match near.iter().position(|(.., other, _)| *other == key) {
                    Some(known) if near[known] <= own => return limit,
                    Some(known) => drop(near.remove(known)),
                    None => {}
                }
                near.insert(near.partition_point(|other| *other < own), own);
                near.truncate(count);
                if near.len() == count {
                    limit = near[count - 1].0;
                    most.fetch_min(limit, Ordering::Relaxed);
                }
                limit
            };
            self.compare(group, keys, windows, observed, before, take);
            near
        };
        let nearest = |mut one: Vec<_>, other: Vec<_>| {
            one.extend(other);
            one.sort_unstable();
            // The first group is compared twice.
            one.dedup();
            one.truncate(count);
            one
        };
        // The best distances in the most promising group rule out most other groups.
        let Some((of, group)) = self.promising(observed) else {
            return Vec::new();
        };
        let windows = Windows::new(observed, of, u32::MAX);
        let keys = group.keys.start..group.keys.end.min(group.keys.start + TASK);
        let first = task(group, &windows, keys);
        let others = self.over(observed, &most, task, nearest);
        let near = nearest(first, others.unwrap_or_default()).into_iter();
        let placed = near.map(|(distance, _, key, (row, column))| PlacedKey {
            distance,
            key,
            place: [column, row],
        });
        placed.collect()
    }

    /// Returns the group of the least bound, with its box. None if no key fits the matrix.
    fn promising(&self, observed: &Observed) -> Option<(&KeyBox, &Group)> {
        let bounds = self.boxes.iter().filter_map(|of| {
            let mut most: Option<BoxPosition> = None;
            observed.each_place((of.width, of.height), |place| {
                let most = most.get_or_insert(place);
                most.inside = most.inside.max(place.inside);
                most.dead = most.dead.max(place.dead);
            });
            let most = most?;
            let groups = self.groups[of.groups.clone()].iter();
            let bounds = groups.map(|group| (observed.bound(group.count, most), of, group));
            bounds.min_by_key(|&(bound, ..)| bound)
        });
        let (_, of, group) = bounds.min_by_key(|&(bound, ..)| bound)?;
        Some((of, group))
    }

    /// Counts, for each key, its places at each distance from `least` to `most`; `take` adds the counts to a sum of
    /// type `S`, key by key.
    pub(super) fn counted<S: Send>(
        &self,
        observed: &Observed,
        (least, most): (u32, u32),
        none: impl Fn() -> S + Sync,
        take: impl Fn(&mut S, usize, &[u32]) + Sync,
        add: impl Fn(S, S) -> S + Send + Sync,
    ) -> S {
        let width = wide(most - least) + 1;
        let task = |group: &Group, windows: &Windows, keys: Range<usize>| {
            let mut sum = none();
            let mut at = vec![0_u32; BLOCK * width];
            for start in keys.clone().step_by(BLOCK) {
                let block = start..keys.end.min(start + BLOCK);
                // A bit for each key of the block that has a place near enough.
                let mut found = 0_u64;
                let count = |key: usize, _: BoxPosition, distance: u32| {
                    found |= 1 << (key - start);
                    at[(key - start) * width + wide(distance - least)] += 1;
                    most
                };
                self.compare(group, block, windows, observed, most, count);
                while found != 0 {
                    let key = wide(found.trailing_zeros());
                    found &= found - 1;
                    let own = &mut at[key * width..][..width];
                    take(&mut sum, wide(self.numbers[start + key]), own);
                    own.fill(0);
                }
            }
            sum
        };
        let sum = self.over(observed, &AtomicU32::new(most), task, add);
        sum.unwrap_or_else(none)
    }

    /// Calls `task` for each piece of the groups that may have a distance of at most `most`, in parallel if there are
    /// many keys, and adds up the results.
    fn over<S: Send>(
        &self,
        observed: &Observed,
        most: &AtomicU32,
        task: impl Fn(&Group, &Windows, Range<usize>) -> S + Sync,
        add: impl Fn(S, S) -> S + Send + Sync,
    ) -> Option<S> {
        let most = || most.load(Ordering::Relaxed);
        let whole_box = |of: &KeyBox| {
            let windows = Windows::new(observed, of, most());
            let groups = self.groups[of.groups.clone()].iter();
            let near = groups.filter(|group| {
                let bound = windows.bound(observed, group.count);
                bound.is_some_and(|bound| bound <= most())
            });
            let pieces = near.flat_map(|group| {
                let starts = group.keys.clone().step_by(TASK);
                starts.map(move |start| (group, start..group.keys.end.min(start + TASK)))
            });
            let run = |(group, keys): (&Group, Range<usize>)| task(group, &windows, keys);
            if of.keys.len() < TASK {
                return pieces.map(run).reduce(&add);
            }
            let pieces: Vec<_> = pieces.collect();
            pieces.into_par_iter().map(run).reduce_with(&add)
        };
        if self.numbers.len() < TASK {
            return self.boxes.iter().filter_map(whole_box).reduce(&add);
        }
        let boxes = self.boxes.par_iter().filter_map(whole_box);
        boxes.reduce_with(&add)
    }

    /// Calls `take` for each of some keys of a group and each window whose distance is at most `most`, with the
    /// number of the key in this index. `take` returns the largest distance that still matters.
    fn compare(
        &self,
        group: &Group,
        keys: Range<usize>,
        windows: &Windows,
        observed: &Observed,
        most: u32,
        take: impl FnMut(usize, BoxPosition, u32) -> u32,
    ) {
        let skipped = group.bits + (keys.start - group.keys.start) * windows.length;
        let comparison = Comparison {
            bits: &self.bits[skipped..][..keys.len() * windows.length],
            keys,
            count: group.count,
            windows,
            observed,
            most,
            take,
        };
        match windows.length {
            1 => comparison.words::<1>(),
            2 => comparison.words::<2>(),
            3 => comparison.words::<3>(),
            4 => comparison.words::<4>(),
            _ => comparison.words::<0>(),
        }
    }
}

/// Keys of one group, and the windows that they are compared with.
struct Comparison<'a, F> {
    keys: Range<usize>,
    bits: &'a [u64],
    count: u32,
    windows: &'a Windows,
    observed: &'a Observed,
    most: u32,
    take: F,
}

impl<F: FnMut(usize, BoxPosition, u32) -> u32> Comparison<'_, F> {
    /// Compares keys of `N` words; 0 for any number.
    fn words<const N: usize>(mut self) {
        let length = self.windows.length;
        let mut distances = [0_u32; BLOCK];
        let mut start = 0;
        while start < self.keys.len() {
            let distances = &mut distances[..BLOCK.min(self.keys.len() - start)];
            let bits = &self.bits[start * length..][..distances.len() * length];
            for (index, &place) in self.windows.places.iter().enumerate() {
                if self.observed.bound(self.count, place) > self.most {
                    continue;
                }
                let window = &self.windows.bits[index * length..][..length];
                let living = &self.windows.living[index * length..][..length];
                let outside = self.observed.count - place.inside;
                differing::<N>(bits, window, living, outside, distances);
                let mut any = false;
                for &distance in &*distances {
                    any |= distance <= self.most;
                }
                if any {
                    for (key, &distance) in distances.iter().enumerate() {
                        if distance <= self.most {
                            let key = self.keys.start + start + key;
                            self.most = (self.take)(key, place, distance);
                        }
                    }
                }
            }
            start += BLOCK;
        }
    }
}

/// Computes the distance of each key of `N` words (0 for any number) from a window: the taxels that differ inside,
/// and those outside.
fn differing<const N: usize>(
    keys: &[u64],
    window: &[u64],
    living: &[u64],
    outside: u32,
    distances: &mut [u32],
) {
    let length = if N == 0 { window.len() } else { N };
    let (window, living) = (&window[..length], &living[..length]);
    let keys = &keys[..distances.len() * length];
    for (index, distance) in distances.iter_mut().enumerate() {
        let key = &keys[index * length..][..length];
        *distance = outside;
        for word in 0..length {
            *distance += ((key[word] ^ window[word]) & living[word]).count_ones();
        }
    }
}

/// An imprint that a shape of a model leaves, placed where it is most similar to an observed one.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct Nearest {
    /// The number of the shape in the set that leaves the imprint most often.
    pub shape: usize,
    /// The number of taxels that differ.
    pub distance: u32,
    /// The imprint, on the matrix of the observed one.
    pub imprint: Imprint,
    /// The number of the imprint's key in the model.
    pub key: usize,
}

impl Model {
    /// Returns the imprint of this model that differs least from an observed one, over all keys and all their shifts on
    /// the observed matrix, without the taxels of `dead`; among equals, the one that a single shape leaves in the most poses, then the first. None if
    /// no key fits the matrix.
    ///
    /// The first call sorts the keys for scans and takes longer.
    pub fn nearest(&self, observed: &Imprint, dead: Option<&Imprint>) -> Option<Nearest> {
        self.nearest_to(&Observed::new(observed, dead))
    }

    pub(super) fn nearest_to(&self, observed: &Observed) -> Option<Nearest> {
        let nearest = |key, distance, imprint| Nearest {
            shape: self.most_frequent(key).0,
            distance,
            imprint,
            key,
        };
        // With dead taxels, the key of the imprint alone is not enough: a dead taxel may be a hole in it.
        if observed.living.is_none()
            && let Some(key) = self.keys().find(&ImprintKey::of(&observed.seen))
        {
            return Some(nearest(key, 0, observed.seen));
        }
        let rank = |key: usize| Reverse(self.most_frequent(key).1);
        let found = (self.scan_tables().index).nearest(observed, 1, rank);
        let found = found.first()?;
        let mut imprint = Imprint::empty(observed.seen.size());
        let [column, row] = found.place;
        for (index, word) in self.keys().get(found.key).rows().enumerate() {
            imprint.set_word(usize::from(row) + index, word << column);
        }
        Some(nearest(found.key, found.distance, imprint))
    }

    /// Returns the shape that leaves a key most often (the first among equals), and how often.
    ///
    /// # Panics
    /// Panics if there are not that many keys.
    pub fn most_frequent(&self, key: usize) -> (usize, u128) {
        let most = first_of_most(self.weighted_shapes(self.counts(key)));
        most.expect("every key is left by some shape")
    }
}
