//! The keys of a model, arranged to be compared with an imprint in every place on its matrix.
//!
//! The distance of a key in a place is the number of taxels in which the imprint differs from the key put there. Inside
//! of the key's box that is a popcount of key ^ window, where the window is the part of the imprint below the box, cut
//! out once for all keys of one box; outside of it, it is the number of the imprint's own taxels.
//!
//! Keys stand in groups of one box and one number of taxels, n. If the imprint has C taxels and i of them lie inside of
//! the box, then C − i differ outside and at least |i − n| inside. So a sum over the box bounds the distance of a whole
//! group in a place, and the most taxels that any place has inside bound it in all places: most groups and places are
//! never looked at. What remains are dense loops over keys, compiled for the widest registers there are.

use std::ops::Range;
use std::sync::atomic::{AtomicU32, Ordering};

use rayon::prelude::*;

use crate::imprint::Imprint;
use crate::index::{narrow, wide};
use crate::recognition::key::{KeyRef, KeyTable, or_bits};

/// Keys that are compared with all windows before the next ones, so that their distances stay in the nearest cache.
const BLOCK: usize = 64;

/// Keys of one task. Fewer keys than this are compared on the calling thread.
const TASK: usize = 1 << 15;

/// All keys of a model, by box and number of taxels.
#[derive(Clone, Debug)]
pub(super) struct KeyIndex {
    boxes: Vec<KeyBox>,
    groups: Vec<Group>,
    /// The numbers of the keys in their table, group after group.
    numbers: Vec<u32>,
    /// Their taxels in the same order, each key in the words of its box.
    bits: Vec<u64>,
}

/// A box that keys have.
#[derive(Clone, Debug)]
pub(super) struct KeyBox {
    pub(super) width: u8,
    pub(super) height: u8,
    /// Words of a key.
    length: usize,
    /// The numbers of its keys in the table.
    pub(super) keys: Range<usize>,
}

/// Keys of one box and one number of taxels.
#[derive(Clone, Debug)]
struct Group {
    of: usize,
    count: u32,
    keys: Range<usize>,
    /// Where its taxels start.
    bits: usize,
}

/// A key in a place on a matrix, and how many taxels differ there.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) struct PlacedKey {
    pub(super) distance: u32,
    /// The number of the key in its table.
    pub(super) key: usize,
    /// The column and the row of its first taxel.
    pub(super) place: (u8, u8),
}

/// The number of places of a box on a matrix; 0 if it does not fit.
pub(super) fn places((width, height): (u8, u8), (columns, rows): (u8, u8)) -> u64 {
    let fits = |side: u8, of: u8| of.checked_sub(side).map_or(0, |rest| u64::from(rest) + 1);
    fits(width, columns) * fits(height, rows)
}

/// An observed imprint, without its dead taxels.
pub(super) struct Observed {
    seen: Imprint,
    /// What is not dead, if some taxels are.
    living: Option<Imprint>,
    count: u32,
    /// Active taxels above and left of each corner of a cell, and dead ones.
    active: Sums,
    dead: Option<Sums>,
}

/// Sums of the taxels above and left of each corner of a cell, row after row.
struct Sums {
    width: usize,
    sums: Vec<u16>,
}

impl Sums {
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

    /// Taxels inside of a box, in each of its places in reading order.
    fn inside(
        &self,
        (across, down): (usize, usize),
        (width, height): (usize, usize),
    ) -> impl Iterator<Item = u32> {
        (0..down).flat_map(move |row| {
            let top = &self.sums[row * self.width..][..across + width];
            let bottom = &self.sums[(row + height) * self.width..][..across + width];
            (0..across).map(move |column| {
                let (left, right) = (column, column + width);
                let below = u32::from(bottom[right]) + u32::from(top[left]);
                below - u32::from(top[right]) - u32::from(bottom[left])
            })
        })
    }
}

/// A place of a box on the observed matrix.
#[derive(Clone, Copy, Debug, Default)]
struct Place {
    column: u8,
    row: u8,
    /// Observed taxels inside of the box, and dead ones.
    inside: u32,
    dead: u32,
}

impl Observed {
    pub(super) fn new(imprint: &Imprint, dead: Option<&Imprint>) -> Self {
        let mut seen = *imprint;
        let living = dead.filter(|dead| !dead.is_empty()).map(|dead| {
            let mut living = Imprint::empty(imprint.columns(), imprint.rows());
            for row in 0..usize::from(imprint.rows()) {
                let dead = dead.words().get(row).map_or(0, |&word| word);
                living.set_word(row, !dead);
                seen.set_word(row, seen.words()[row] & !dead);
            }
            living
        });
        Self {
            count: seen.count(),
            active: Sums::of(&seen),
            dead: dead.filter(|_| living.is_some()).map(Sums::of),
            seen,
            living,
        }
    }

    /// The size of the matrix.
    pub(super) fn size(&self) -> (u8, u8) {
        (self.seen.columns(), self.seen.rows())
    }

    /// All places of a box, in reading order; none if it does not fit.
    fn places(&self, (width, height): (u8, u8)) -> impl Iterator<Item = Place> {
        let (columns, rows) = self.size();
        let fits = width <= columns && height <= rows;
        let across = if fits {
            usize::from(columns - width) + 1
        } else {
            0
        };
        let down = if fits {
            usize::from(rows - height) + 1
        } else {
            0
        };
        let size = (usize::from(width), usize::from(height));
        let inside = self.active.inside((across, down), size);
        let mut dead = self
            .dead
            .as_ref()
            .map(|dead| dead.inside((across, down), size));
        let corners = (0..=u8::MAX)
            .take(down)
            .flat_map(move |row| (0..=u8::MAX).take(across).map(move |column| (column, row)));
        corners
            .zip(inside)
            .map(move |((column, row), inside)| Place {
                column,
                row,
                inside,
                dead: dead
                    .as_mut()
                    .and_then(Iterator::next)
                    .map_or(0, |dead| dead),
            })
    }

    /// The least distance of a key of `count` taxels in a place. It grows with neither of the place's numbers.
    fn bound(&self, count: u32, place: Place) -> u32 {
        let apart = if place.inside > count {
            place.inside - count
        } else {
            // Dead taxels of a key do not count, however many of them it covers.
            (count - place.inside).saturating_sub(place.dead)
        };
        self.count - place.inside + apart
    }
}

/// What a group is compared with: parts of the observed imprint as large as its box, those of the least bounds first.
struct Windows {
    places: Vec<(Place, u32)>,
    /// For each place the taxels inside, as a key would have them, and which of them are not dead.
    bits: Vec<u64>,
    living: Vec<u64>,
}

impl Windows {
    /// Those in which keys of a group may have a distance of at most `most`.
    fn new(observed: &Observed, of: &KeyBox, count: u32, most: u32) -> Self {
        let places = observed.places((of.width, of.height));
        let bounded = places.map(|place| (place, observed.bound(count, place)));
        let mut places: Vec<_> = bounded.filter(|&(_, bound)| bound <= most).collect();
        // Stable: of equal bounds the first in reading order.
        places.sort_by_key(|&(_, bound)| bound);
        let mut bits = vec![0; places.len() * of.length];
        let mut living = vec![u64::MAX; places.len() * of.length];
        for (index, (place, _)) in places.iter().enumerate() {
            let own = index * of.length..(index + 1) * of.length;
            cut(&observed.seen, of, *place, &mut bits[own.clone()]);
            if let Some(imprint) = &observed.living {
                living[own.clone()].fill(0);
                cut(imprint, of, *place, &mut living[own]);
            }
        }
        Self {
            places,
            bits,
            living,
        }
    }
}

/// Cuts a window out of an imprint.
fn cut(imprint: &Imprint, of: &KeyBox, place: Place, bits: &mut [u64]) {
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
            index.boxes.push(KeyBox {
                width,
                height,
                length: first.bits.len(),
                keys: start..end,
            });
            for own in own.chunk_by(|one, other| one.0 == other.0) {
                let start = index.numbers.len();
                index.groups.push(Group {
                    of: index.boxes.len() - 1,
                    count: own[0].0.1,
                    keys: start..start + own.len(),
                    bits: index.bits.len(),
                });
                for &(_, number) in own {
                    index.numbers.push(narrow(number));
                    index.bits.extend_from_slice(keys.get(number).bits);
                }
            }
        }
        index
    }

    /// The boxes that keys have, by height and width.
    pub(super) fn boxes(&self) -> &[KeyBox] {
        &self.boxes
    }

    /// The key and place of the least distance; of equals that whose key has the lowest `rank`, then the first key, then
    /// the first place in reading order. None if no key fits the matrix.
    pub(super) fn nearest<R: Ord + Send>(
        &self,
        observed: &Observed,
        rank: impl Fn(usize) -> R + Sync,
    ) -> Option<PlacedKey> {
        let bounds = self.bounds(observed);
        // The most promising group rules out most others.
        let mut groups: Vec<(u32, usize)> = bounds.collect();
        groups.sort_unstable();
        let least = AtomicU32::new(u32::MAX);
        let task = |group: &Group, bound: u32, keys: Range<usize>| {
            let mut best: Option<(u32, R, usize, (u8, u8))> = None;
            let most = least.load(Ordering::Relaxed);
            if bound > most {
                return best;
            }
            let windows = Windows::new(observed, &self.boxes[group.of], group.count, most);
            self.compare(
                group,
                keys,
                &windows,
                observed,
                most,
                |key, place, distance| {
                    let key = wide(self.numbers[key]);
                    let own = (distance, rank(key), key, (place.row, place.column));
                    if best.as_ref().is_none_or(|best| own < *best) {
                        least.fetch_min(distance, Ordering::Relaxed);
                        best = Some(own);
                    }
                    distance
                },
            );
            best
        };
        let best = self.over(&groups, task, |one, other| match (one, other) {
            (Some(one), Some(other)) => Some(one.min(other)),
            (one, other) => one.or(other),
        });
        best.flatten()
            .map(|(distance, _, key, (row, column))| PlacedKey {
                distance,
                key,
                place: (column, row),
            })
    }

    /// How many places each key has at each distance from `least` to `most`: `take` adds them to a sum of type `S`, key by
    /// key.
    pub(super) fn counted<S: Send>(
        &self,
        observed: &Observed,
        (least, most): (u32, u32),
        none: impl Fn() -> S + Sync,
        take: impl Fn(&mut S, usize, &[u32]) + Sync,
        add: impl Fn(S, S) -> S + Send + Sync,
    ) -> S {
        let groups: Vec<(u32, usize)> = self
            .bounds(observed)
            .filter(|&(bound, _)| bound <= most)
            .collect();
        let width = wide(most - least) + 1;
        let task = |group: &Group, _: u32, keys: Range<usize>| {
            let mut sum = none();
            let windows = Windows::new(observed, &self.boxes[group.of], group.count, most);
            let mut at = vec![0_u32; BLOCK * width];
            for start in keys.clone().step_by(BLOCK) {
                let block = start..keys.end.min(start + BLOCK);
                // A bit for each key that has such a place.
                let mut found = 0_u64;
                self.compare(
                    group,
                    block,
                    &windows,
                    observed,
                    most,
                    |key, _, distance| {
                        found |= 1 << (key - start);
                        at[(key - start) * width + wide(distance - least)] += 1;
                        most
                    },
                );
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
        self.over(&groups, task, &add).unwrap_or_else(none)
    }

    /// For each group that fits the matrix a bound of its distances in all places, and its number.
    fn bounds(&self, observed: &Observed) -> impl Iterator<Item = (u32, usize)> {
        let mut bounds = Vec::with_capacity(self.boxes.len());
        for of in &self.boxes {
            let most = observed.places((of.width, of.height));
            bounds.push(most.reduce(|one, other| Place {
                inside: one.inside.max(other.inside),
                dead: one.dead.max(other.dead),
                ..one
            }));
        }
        let groups = self.groups.iter().enumerate();
        groups.filter_map(move |(number, group)| {
            Some((observed.bound(group.count, bounds[group.of]?), number))
        })
    }

    /// Gives each piece of some groups to `task`, in parallel where there are many keys, and adds up the results.
    fn over<S: Send>(
        &self,
        groups: &[(u32, usize)],
        task: impl Fn(&Group, u32, Range<usize>) -> S + Sync,
        add: impl Fn(S, S) -> S + Send + Sync,
    ) -> Option<S> {
        let pieces = groups.iter().flat_map(|&(bound, number)| {
            let group = &self.groups[number];
            let keys = group.keys.clone();
            let starts = keys.clone().step_by(TASK);
            starts.map(move |start| (group, bound, start..keys.end.min(start + TASK)))
        });
        let run = |(group, bound, keys): (&Group, u32, Range<usize>)| {
            pulp::Arch::new().dispatch(|| task(group, bound, keys))
        };
        if self.numbers.len() < TASK {
            return pieces.map(run).reduce(add);
        }
        let pieces: Vec<_> = pieces.collect();
        pieces.into_par_iter().map(run).reduce_with(add)
    }

    /// Calls `take` for each key and window whose distance is at most `most`, with the place of the key in this index; it
    /// answers up to which distance the next ones matter.
    #[expect(
        clippy::inline_always,
        reason = "so that it is compiled for the registers that are there"
    )]
    #[inline(always)]
    fn compare(
        &self,
        group: &Group,
        keys: Range<usize>,
        windows: &Windows,
        observed: &Observed,
        most: u32,
        take: impl FnMut(usize, Place, u32) -> u32,
    ) {
        match self.boxes[group.of].length {
            1 => self.compare_words::<1>(group, keys, windows, observed, most, take),
            2 => self.compare_words::<2>(group, keys, windows, observed, most, take),
            3 => self.compare_words::<3>(group, keys, windows, observed, most, take),
            4 => self.compare_words::<4>(group, keys, windows, observed, most, take),
            _ => self.compare_words::<0>(group, keys, windows, observed, most, take),
        }
    }

    /// The same for keys of `N` words; 0 for any number.
    #[expect(
        clippy::inline_always,
        reason = "so that it is compiled for the registers that are there"
    )]
    #[inline(always)]
    fn compare_words<const N: usize>(
        &self,
        group: &Group,
        keys: Range<usize>,
        windows: &Windows,
        observed: &Observed,
        mut most: u32,
        mut take: impl FnMut(usize, Place, u32) -> u32,
    ) {
        let length = self.boxes[group.of].length;
        let mut distances = [0_u32; BLOCK];
        for start in keys.clone().step_by(BLOCK) {
            let end = keys.end.min(start + BLOCK);
            let distances = &mut distances[..end - start];
            let skipped = start - group.keys.start;
            let bits = &self.bits[group.bits + skipped * length..][..distances.len() * length];
            for (index, &(place, bound)) in windows.places.iter().enumerate() {
                // Windows are in the order of their bounds.
                if bound > most {
                    break;
                }
                let outside = observed.count - place.inside;
                let window = &windows.bits[index * length..][..length];
                let living = &windows.living[index * length..][..length];
                if N == 0 {
                    differing(bits, window, living, outside, distances);
                } else {
                    differing_words::<N>(bits, window, living, outside, distances);
                }
                if distances.iter().all(|&distance| distance > most) {
                    continue;
                }
                for (key, &distance) in (start..end).zip(&*distances) {
                    if distance <= most {
                        most = take(key, place, distance);
                    }
                }
            }
        }
    }
}

/// The distance of each key of `N` words from a window: the taxels that differ inside, and those outside.
#[expect(
    clippy::inline_always,
    reason = "so that it is compiled for the registers that are there"
)]
#[inline(always)]
fn differing_words<const N: usize>(
    keys: &[u64],
    window: &[u64],
    living: &[u64],
    outside: u32,
    distances: &mut [u32],
) {
    let (Some(window), Some(living)) = (window.first_chunk::<N>(), living.first_chunk::<N>())
    else {
        return;
    };
    for (distance, key) in distances.iter_mut().zip(keys.chunks_exact(N)) {
        *distance = outside;
        for word in 0..N {
            *distance += ((key[word] ^ window[word]) & living[word]).count_ones();
        }
    }
}

/// The same for keys of any number of words, even none.
#[expect(
    clippy::inline_always,
    reason = "so that it is compiled for the registers that are there"
)]
#[inline(always)]
fn differing(keys: &[u64], window: &[u64], living: &[u64], outside: u32, distances: &mut [u32]) {
    for (index, distance) in distances.iter_mut().enumerate() {
        let key = &keys[index * window.len()..][..window.len()];
        let words = key.iter().zip(window).zip(living);
        let inside = words.map(|((key, window), living)| ((key ^ window) & living).count_ones());
        *distance = outside + inside.sum::<u32>();
    }
}
