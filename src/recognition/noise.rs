//! Recognition where taxels fail: each flips with probability e, independently of the others.
//!
//! ```text
//! P(imprint | s) = Σ over keys k and shifts of  n[s, k] · e^d (1 − e)^(cells − d)  / T[s]
//! ```
//! with d the number of taxels in which the imprint and the shifted key differ, and T[s] the number of touches of s: its
//! poses, times the shifts of the key on the matrix. So the prior is that of every pose in every place on the matrix.
//! Taxels that are known to be dead are left out of d and of `cells`.
//!
//! What is summed are integers: for each shape, how many touches lie at each distance. So one scan serves any e, and
//! neither threads nor the order of keys matter. Only distances up to D are kept: D follows from e and the least distance,
//! and what lies beyond changes no probability by more than 1e-9.
//!
//! **Speed.** The matrix is one string of bits, so a shift of a key is a shift of the string, and the shifted strings of
//! the observed imprint are made once. A distance then is a few words of `and` and popcount. Keys stand in groups of one
//! box and one number of taxels. How many of the observed taxels lie inside of a box in a place bounds the distance of the
//! whole group there: those outside differ, and so does what the numbers inside differ by. Most places are never looked
//! at. Noise, scan and bounds stand in one file, longer than most, because each is correct only beside the others.

use std::sync::atomic::{AtomicU32, Ordering};

use rayon::prelude::*;

use crate::imprint::Imprint;
use crate::index::wide;
use crate::recognition::key::{KeyRef, or_bits};
use crate::recognition::model::Model;

/// What a probability may change by leaving out far keys.
const NEGLIGIBLE: f64 = 1e-9;

/// The probability that a taxel flips, from 0 to below ½, and the taxels that are known to be dead.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Noise {
    flip: f64,
    dead: Option<Imprint>,
}

/// A probability that is out of range.
#[derive(Clone, Copy, Debug, PartialEq, thiserror::Error)]
#[error("noise {found}: expected a probability from 0 to below 0.5")]
#[non_exhaustive]
pub struct NoiseError {
    /// What was given.
    pub found: f64,
}

impl Noise {
    /// Every taxel flips with this probability.
    ///
    /// # Errors
    /// If it is not from 0 to below ½.
    pub fn new(flip: f64) -> Result<Self, NoiseError> {
        if (0.0..0.5).contains(&flip) {
            Ok(Self { flip, dead: None })
        } else {
            Err(NoiseError { found: flip })
        }
    }

    /// The active taxels of `dead` say nothing: they are stuck on or off.
    #[must_use]
    pub fn without(self, dead: Imprint) -> Self {
        let dead = (!dead.is_empty()).then_some(dead);
        Self { dead, ..self }
    }

    /// Returns the probability that a taxel flips.
    pub fn flip(&self) -> f64 {
        self.flip
    }

    /// Returns the taxels that are left out; None if all count.
    pub fn dead(&self) -> Option<&Imprint> {
        self.dead.as_ref()
    }

    /// Distances beyond the least one that matter, if sums of all touches are at most `touches`.
    fn reach(&self, touches: f64) -> u32 {
        if self.flip == 0.0 {
            return 0;
        }
        let ratio = (self.flip / (1.0 - self.flip)).ln();
        // The nearest touch weighs at least 1, all beyond D at most touches · ratio^(D + 1 − least).
        let steps = (NEGLIGIBLE / touches).ln() / ratio;
        #[expect(
            clippy::cast_possible_truncation,
            clippy::cast_sign_loss,
            reason = "from 0 to 4096, the most taxels of a matrix"
        )]
        let beyond = steps.ceil().clamp(1.0, 4097.0) as u32;
        beyond - 1
    }
}

/// Which keys an answer needed, the fewest first.
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord)]
#[non_exhaustive]
pub enum Method {
    /// The key of the imprint itself.
    Exact,
    /// Those that differ from it by one taxel at most.
    OneFlip,
    /// All keys at all places.
    Scan,
}

impl Method {
    /// Returns its name in JSON.
    pub const fn name(self) -> &'static str {
        match self {
            Self::Exact => "exact",
            Self::OneFlip => "one-flip",
            Self::Scan => "scan",
        }
    }
}

/// For each shape, how many touches lie at each distance from an imprint.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct Distances {
    /// The least distance of any touch.
    pub least: u32,
    /// Touches of each shape at the distances from `least` on.
    pub touches: Vec<Vec<u64>>,
    /// Which keys were looked at.
    pub method: Method,
}

/// All keys of a model, ready to be compared with imprints on matrices of one size.
///
/// ```
/// use taxel::prelude::*;
/// use taxel::recognition::{NamedShape, Noise, Scanner, Training};
///
/// let sensor = Sensor::default();
/// let shapes = [
///     NamedShape::new("square", Figure::rectangle(4.0, 4.0).on(&sensor)?),
///     NamedShape::new("bar", Figure::rectangle(8.0, 2.0).on(&sensor)?),
/// ];
/// let ranges = Ranges::default().with(Axis::Angle, "0:345:15".parse()?);
/// let model = Training::new(shapes, sensor, Anchor::Centre, ranges)?.run()?;
///
/// // A square with a taxel missing and one too many: no shape leaves it, but a square nearly does.
/// let touch = "......#.\n.####...\n.####...\n.###....\n.####...\n........".parse()?;
/// assert_eq!(model.posterior(&touch), None);
/// let scanner = Scanner::new(&model, 8, 6);
/// let posterior = scanner.posterior(&touch, &Noise::new(0.01)?).expect("keys fit");
/// assert!(posterior[0] > 0.99);
/// # Ok::<(), Box<dyn std::error::Error>>(())
/// ```
#[derive(Debug)]
pub struct Scanner<'a> {
    model: &'a Model,
    columns: u8,
    rows: u8,
    groups: Vec<Group>,
    /// The numbers of the keys, group after group.
    keys: Vec<u32>,
    /// The keys' taxels as strings of bits, in the same order.
    bits: Vec<u64>,
    /// Touches of each shape.
    totals: Vec<u64>,
}

/// Keys of one box and one number of taxels.
#[derive(Clone, Copy, Debug)]
struct Group {
    width: u8,
    height: u8,
    count: u32,
    /// Words of a string.
    length: usize,
    /// Where its keys and their bits start, and how many there are.
    first: usize,
    bits: usize,
    keys: usize,
}

/// An observed imprint, without its dead taxels, in all places.
struct Observed {
    /// For each shift the imprint's string of bits, shifted down by it.
    shifted: Vec<u64>,
    /// The same of the taxels that are not dead, if some are.
    living: Option<Vec<u64>>,
    /// Words of a string.
    words: usize,
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
            let mut in_row = 0;
            for column in 1..width {
                in_row += u16::from(word >> (column - 1) & 1 == 1);
                sums[(row + 1) * width + column] = sums[row * width + column] + in_row;
            }
        }
        Self { width, sums }
    }

    /// Taxels inside of a box.
    fn inside(&self, (column, row): (usize, usize), (width, height): (usize, usize)) -> u32 {
        let at = |column: usize, row: usize| u32::from(self.sums[row * self.width + column]);
        let (right, bottom) = (column + width, row + height);
        at(right, bottom) + at(column, row) - at(right, row) - at(column, bottom)
    }
}

/// The string of bits of a matrix, and its copies shifted down by 0, 1, … bits.
fn shifted(imprint: &Imprint) -> (Vec<u64>, usize) {
    let (columns, rows) = (usize::from(imprint.columns()), usize::from(imprint.rows()));
    let words = (columns * rows).div_ceil(64);
    let mut bits = vec![0; words + 1];
    for (row, &word) in imprint.words().iter().enumerate() {
        or_bits(&mut bits, row * columns, word);
    }
    let mut all = Vec::with_capacity(columns * rows * words);
    for shift in 0..columns * rows {
        let (skipped, by) = (shift / 64, shift % 64);
        for word in 0..words {
            let low = bits.get(skipped + word).map_or(0, |&word| word);
            let high = bits.get(skipped + word + 1).map_or(0, |&word| word);
            all.push(if by == 0 {
                low
            } else {
                low >> by | high << (64 - by)
            });
        }
    }
    (all, words)
}

impl Observed {
    fn new(imprint: &Imprint, dead: Option<&Imprint>) -> Self {
        let mut living = Imprint::empty(imprint.columns(), imprint.rows());
        for row in 0..usize::from(imprint.rows()) {
            let dead = dead.and_then(|dead| dead.words().get(row));
            living.set_word(row, !dead.map_or(0, |&word| word));
        }
        let mut seen = *imprint;
        for (row, &word) in living.words().iter().enumerate() {
            seen.set_word(row, word & imprint.words()[row]);
        }
        let (strings, words) = shifted(&seen);
        Self {
            shifted: strings,
            living: dead.map(|_| shifted(&living).0),
            words,
            count: seen.count(),
            active: Sums::of(&seen),
            dead: dead.filter(|dead| !dead.is_empty()).map(Sums::of),
        }
    }
}

impl<'a> Scanner<'a> {
    /// Prepares the keys of a model for imprints of that many columns and rows; keys that do not fit are left out.
    pub fn new(model: &'a Model, columns: u8, rows: u8) -> Self {
        let mut scanner = Self {
            model,
            columns,
            rows,
            groups: Vec::new(),
            keys: Vec::new(),
            bits: Vec::new(),
            totals: vec![0; model.shapes().len()],
        };
        let keys = model.keys();
        let mut order: Vec<_> = (0..keys.len())
            .map(|number| (keys.get(number), number))
            .filter(|(key, _)| key.width <= columns && key.height <= rows)
            .map(|(key, number)| ((key.height, key.width, key.count()), number))
            .collect();
        order.sort_unstable();
        for own in order.chunk_by(|one, other| one.0 == other.0) {
            let (height, width, count) = own[0].0;
            let length = match usize::from(height).checked_sub(1) {
                Some(last) => (last * usize::from(columns) + usize::from(width)).div_ceil(64),
                None => 0,
            };
            scanner.groups.push(Group {
                width,
                height,
                count,
                length,
                first: scanner.keys.len(),
                bits: scanner.bits.len(),
                keys: own.len(),
            });
            for &(_, number) in own {
                scanner.add(keys.get(number), length, number);
            }
        }
        scanner
    }

    fn add(&mut self, key: KeyRef<'_>, length: usize, number: usize) {
        let (columns, start) = (usize::from(self.columns), self.bits.len());
        self.bits.resize(start + length, 0);
        for (row, word) in key.rows().enumerate() {
            or_bits(&mut self.bits[start..], row * columns, word);
        }
        self.keys.push(crate::index::narrow(number));
        let places = self.places(key.width, key.height);
        for count in self.model.counts(number) {
            self.totals[usize::from(count.shape)] += count.poses * places;
        }
    }

    /// Number of places of a box on the matrix.
    fn places(&self, width: u8, height: u8) -> u64 {
        (u64::from(self.columns - width) + 1) * (u64::from(self.rows - height) + 1)
    }

    /// Returns the number of pairs of a key and a place on the matrix.
    pub fn pairs(&self) -> u64 {
        let pairs = self.groups.iter();
        let pairs = pairs.map(|group| group.keys as u64 * self.places(group.width, group.height));
        pairs.sum()
    }

    /// Returns P(shape | imprint) for each shape of the set; None if no key fits the matrix, or, without noise, if no shape
    /// leaves the imprint.
    ///
    /// # Panics
    /// If the imprint has another size than the scanner.
    pub fn posterior(&self, imprint: &Imprint, noise: &Noise) -> Option<Vec<f64>> {
        self.posterior_of(&self.distances(imprint, noise)?, noise)
    }

    /// Returns P(shape | imprint), given how many touches lie at each distance.
    pub fn posterior_of(&self, distances: &Distances, noise: &Noise) -> Option<Vec<f64>> {
        let likelihoods = self.likelihoods(distances, noise);
        let sum: f64 = likelihoods.iter().sum();
        (sum > 0.0).then(|| likelihoods.into_iter().map(|own| own / sum).collect())
    }

    /// P(imprint | s) · w for each shape, all times one number.
    pub(super) fn likelihoods(&self, distances: &Distances, noise: &Noise) -> Vec<f64> {
        let ratio = noise.flip / (1.0 - noise.flip);
        let shapes = distances.touches.iter().zip(&self.totals);
        let likelihood = |(touches, &total): (&Vec<u64>, &u64)| {
            if total == 0 {
                return 0.0;
            }
            // From far to near: a sum of small numbers first.
            let sum = touches
                .iter()
                .rev()
                .fold(0.0, |sum, &touches| sum * ratio + float(touches));
            sum / float(total)
        };
        let weights = self
            .model
            .shapes()
            .iter()
            .map(|shape| f64::from(shape.weight));
        shapes
            .map(likelihood)
            .zip(weights)
            .map(|(own, weight)| own * weight)
            .collect()
    }

    /// Returns how many touches of each shape lie at the distances from an imprint that matter. None if there is none.
    ///
    /// # Panics
    /// If the imprint has another size than the scanner.
    pub fn distances(&self, imprint: &Imprint, noise: &Noise) -> Option<Distances> {
        assert_eq!(
            (imprint.columns(), imprint.rows()),
            (self.columns, self.rows),
            "an imprint of the size that the keys were prepared for"
        );
        let touches: f64 = self.totals.iter().map(|&total| float(total)).sum();
        let reach = noise.reach(touches.max(1.0));
        if noise.dead.is_none() && reach <= 1 {
            let near = self.near(imprint, reach);
            if near.is_some() || noise.flip == 0.0 {
                return near;
            }
        }
        let observed = Observed::new(imprint, noise.dead.as_ref());
        let least = self.least(&observed)?;
        let most = least + reach;
        Some(Distances {
            least,
            touches: self.histogram(&observed, least, most),
            method: Method::Scan,
        })
    }

    /// By looking up keys: those of the imprint itself, and, if more matter, of all imprints that differ by one taxel. None
    /// if that is not enough.
    fn near(&self, imprint: &Imprint, reach: u32) -> Option<Distances> {
        let at = |imprint: &Imprint, sums: &mut [u64]| {
            for count in self.model.counts_of(imprint) {
                sums[usize::from(count.shape)] += count.poses;
            }
        };
        let mut sums = [vec![0; self.totals.len()], vec![0; self.totals.len()]];
        at(imprint, &mut sums[0]);
        let exact = sums[0].iter().any(|&sum| sum > 0);
        let transposed = |sums: &[Vec<u64>]| {
            let shapes = 0..self.totals.len();
            shapes
                .map(|shape| sums.iter().map(|sums| sums[shape]).collect())
                .collect()
        };
        if reach == 0 {
            return exact.then(|| Distances {
                least: 0,
                touches: transposed(&sums[..1]),
                method: Method::Exact,
            });
        }
        if !exact {
            // The least distance may be 1, but then distances of 2 matter too.
            return None;
        }
        let mut flipped = *imprint;
        for row in 0..self.rows {
            for column in 0..self.columns {
                flipped.toggle(column, row);
                at(&flipped, &mut sums[1]);
                flipped.toggle(column, row);
            }
        }
        Some(Distances {
            least: 0,
            touches: transposed(&sums),
            method: Method::OneFlip,
        })
    }

    /// The least distance of any key in any place.
    fn least(&self, observed: &Observed) -> Option<u32> {
        // The most promising group first: what it reaches rules out most others.
        let bound = |group: &Group| {
            let places = self.places_within(group, observed, u32::MAX);
            places.into_iter().map(|(_, bound)| bound).min()
        };
        let mut groups: Vec<(u32, usize)> = (0..self.groups.len())
            .into_par_iter()
            .filter_map(|index| Some((bound(&self.groups[index])?, index)))
            .collect();
        groups.sort_unstable();
        let least = AtomicU32::new(u32::MAX);
        groups.into_par_iter().for_each(|(bound, index)| {
            let most = least.load(Ordering::Relaxed);
            if bound >= most {
                return;
            }
            let group = &self.groups[index];
            let places = self.places_within(group, observed, most.saturating_sub(1));
            let chunks = (0..group.keys.div_ceil(CHUNK)).into_par_iter();
            chunks.for_each(|chunk| {
                let mut best = u32::MAX;
                pulp::Arch::new().dispatch(|| {
                    self.compare(group, chunk, &places, observed, |_, distance| {
                        best = best.min(distance);
                    });
                });
                least.fetch_min(best, Ordering::Relaxed);
            });
        });
        Some(least.into_inner()).filter(|&least| least < u32::MAX)
    }

    /// Touches of each shape at the distances from `least` to `most`.
    fn histogram(&self, observed: &Observed, least: u32, most: u32) -> Vec<Vec<u64>> {
        let (shapes, width) = (self.totals.len(), wide(most - least) + 1);
        let groups = self.groups.par_iter().map(|group| {
            let places = self.places_within(group, observed, most);
            if places.is_empty() {
                return vec![0; shapes * width];
            }
            let chunks = (0..group.keys.div_ceil(CHUNK))
                .into_par_iter()
                .map(|chunk| self.histogram_of(group, chunk, &places, observed, (least, width)));
            chunks.reduce(|| vec![0; shapes * width], added)
        });
        let sums = groups.reduce(|| vec![0; shapes * width], added);
        sums.chunks(width).map(<[u64]>::to_vec).collect()
    }

    /// The part of one chunk of a group: for each shape `width` distances from `least` on.
    fn histogram_of(
        &self,
        group: &Group,
        chunk: usize,
        places: &[(usize, u32)],
        observed: &Observed,
        (least, width): (u32, usize),
    ) -> Vec<u64> {
        let mut sums = vec![0_u64; self.totals.len() * width];
        // Places at each distance, of one key after the other.
        let mut at = vec![0_u64; width];
        let mut last = None;
        let mut end = |key: usize, at: &mut [u64]| {
            for count in self.model.counts(wide(self.keys[key])) {
                let own = &mut sums[usize::from(count.shape) * width..][..width];
                for (sum, places) in own.iter_mut().zip(&*at) {
                    *sum += count.poses * places;
                }
            }
            at.fill(0);
        };
        pulp::Arch::new().dispatch(|| {
            self.compare(group, chunk, places, observed, |key, distance| {
                let beyond = wide(distance - least);
                if beyond >= width {
                    return;
                }
                if let Some(last) = last.replace(key).filter(|&last| last != key) {
                    end(last, &mut at);
                }
                at[beyond] += 1;
            });
        });
        if let Some(last) = last {
            end(last, &mut at);
        }
        sums
    }

    /// The places on the matrix where keys of a group may have a distance of at most `most`, by the number of their first
    /// bit, each with the least distance that is possible there.
    fn places_within(&self, group: &Group, observed: &Observed, most: u32) -> Vec<(usize, u32)> {
        let size = (usize::from(group.width), usize::from(group.height));
        let mut places = Vec::new();
        for row in 0..=usize::from(self.rows) - size.1 {
            for column in 0..=usize::from(self.columns) - size.0 {
                let inside = observed.active.inside((column, row), size);
                let dead = observed.dead.as_ref();
                let dead = dead.map_or(0, |dead| dead.inside((column, row), size));
                // Dead taxels of a key do not count, however many of them it covers.
                let apart = if inside > group.count {
                    inside - group.count
                } else {
                    (group.count - inside).saturating_sub(dead)
                };
                let bound = observed.count - inside + apart;
                if bound <= most {
                    places.push((row * usize::from(self.columns) + column, bound));
                }
            }
        }
        places
    }

    /// Gives the distance of each key of a chunk of a group in each of some places: the keys one after the other.
    #[expect(
        clippy::inline_always,
        reason = "so that it is compiled for the registers that are there"
    )]
    #[inline(always)]
    fn compare(
        &self,
        group: &Group,
        chunk: usize,
        places: &[(usize, u32)],
        observed: &Observed,
        take: impl FnMut(usize, u32),
    ) {
        match group.length {
            _ if observed.living.is_some() => {
                self.compare_any(group, chunk, places, observed, take);
            }
            1 => self.compare_words::<1>(group, chunk, places, observed, take),
            2 => self.compare_words::<2>(group, chunk, places, observed, take),
            3 => self.compare_words::<3>(group, chunk, places, observed, take),
            4 => self.compare_words::<4>(group, chunk, places, observed, take),
            _ => self.compare_any(group, chunk, places, observed, take),
        }
    }

    /// The same for keys of a fixed number of words, without dead taxels.
    #[expect(
        clippy::inline_always,
        reason = "so that it is compiled for the registers that are there"
    )]
    #[inline(always)]
    fn compare_words<const N: usize>(
        &self,
        group: &Group,
        chunk: usize,
        places: &[(usize, u32)],
        observed: &Observed,
        mut take: impl FnMut(usize, u32),
    ) {
        // The strings of the places side by side, so that the inner loop reads on.
        let strings: Vec<[u64; N]> = places
            .iter()
            .map(|&(place, _)| {
                let string = &observed.shifted[place * observed.words..];
                std::array::from_fn(|word| string.get(word).map_or(0, |&word| word))
            })
            .collect();
        let sum = observed.count + group.count;
        let (keys, bits) = self.chunk(group, chunk);
        for (key, bits) in keys.zip(bits.chunks_exact(N)) {
            for string in &strings {
                let mut shared = 0;
                for word in 0..N {
                    shared += (bits[word] & string[word]).count_ones();
                }
                take(key, sum - 2 * shared);
            }
        }
    }

    /// The same for keys of any number of words, and with dead taxels.
    #[expect(
        clippy::inline_always,
        reason = "so that it is compiled for the registers that are there"
    )]
    #[inline(always)]
    fn compare_any(
        &self,
        group: &Group,
        chunk: usize,
        places: &[(usize, u32)],
        observed: &Observed,
        mut take: impl FnMut(usize, u32),
    ) {
        let (keys, bits) = self.chunk(group, chunk);
        for (index, key) in keys.enumerate() {
            let bits = &bits[index * group.length..][..group.length];
            for &(place, _) in places {
                let shared = shared(bits, &observed.shifted[place * observed.words..]);
                let count = match &observed.living {
                    None => group.count,
                    Some(living) => self::shared(bits, &living[place * observed.words..]),
                };
                take(key, observed.count + count - 2 * shared);
            }
        }
    }

    /// The keys of a chunk, by their places in the scanner, and their bits.
    fn chunk(&self, group: &Group, chunk: usize) -> (std::ops::Range<usize>, &[u64]) {
        let (start, end) = (chunk * CHUNK, group.keys.min((chunk + 1) * CHUNK));
        let bits = &self.bits[group.bits + start * group.length..group.bits + end * group.length];
        (group.first + start..group.first + end, bits)
    }
}

/// Keys that are compared in one piece.
const CHUNK: usize = 4096;

/// Sums added up.
fn added(mut one: Vec<u64>, other: Vec<u64>) -> Vec<u64> {
    one.iter_mut()
        .zip(other)
        .for_each(|(sum, more)| *sum += more);
    one
}

/// Bits that both strings have, as far as the first goes.
#[expect(
    clippy::inline_always,
    reason = "so that it is compiled for the registers that are there"
)]
#[inline(always)]
fn shared(bits: &[u64], seen: &[u64]) -> u32 {
    let both = bits.iter().zip(seen);
    both.map(|(bits, seen)| (bits & seen).count_ones()).sum()
}

/// A count as a number to compute with.
#[expect(
    clippy::cast_precision_loss,
    reason = "a probability has no more digits"
)]
fn float(count: u64) -> f64 {
    count as f64
}

impl KeyRef<'_> {
    /// Its active taxels.
    fn count(self) -> u32 {
        self.bits.iter().map(|word| word.count_ones()).sum()
    }
}
