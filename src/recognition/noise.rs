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
//! the observed imprint are made once. A distance then is a few words of `and` and popcount. Most pairs are not even
//! looked at: the numbers of active taxels, in all and in each row and column, bound the distance from below.

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
    /// By number of active taxels, those of equal ones in the order of the model.
    templates: Vec<Template>,
    /// The templates' taxels as strings of bits.
    bits: Vec<u64>,
    /// Active taxels of each row and then of each column of each template.
    sums: Vec<u8>,
    /// Touches of each shape.
    totals: Vec<u64>,
}

/// A key that fits the matrix.
#[derive(Clone, Copy, Debug)]
struct Template {
    key: u32,
    count: u32,
    width: u8,
    height: u8,
    /// Where its bits and its sums start.
    bits: usize,
    length: usize,
    sums: usize,
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
    dead: u32,
    row_sums: Vec<u8>,
    column_sums: Vec<u8>,
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
        let cells = u32::from(imprint.columns()) * u32::from(imprint.rows());
        let dead = cells - living.count();
        Self {
            shifted: strings,
            living: (dead > 0).then(|| shifted(&living).0),
            words,
            count: seen.count(),
            dead,
            row_sums: row_sums(seen.words()).collect(),
            column_sums: column_sums(seen.words(), seen.columns()),
        }
    }
}

/// Active taxels of each row.
fn row_sums(rows: &[u64]) -> impl Iterator<Item = u8> + '_ {
    let count = |word: &u64| u8::try_from(word.count_ones()).expect("64 at most");
    rows.iter().map(count)
}

/// Active taxels of each column.
fn column_sums(rows: &[u64], columns: u8) -> Vec<u8> {
    let mut sums = vec![0; columns.into()];
    for &row in rows {
        let mut rest = row;
        while rest != 0 {
            sums[wide(rest.trailing_zeros())] += 1;
            rest &= rest - 1;
        }
    }
    sums
}

impl<'a> Scanner<'a> {
    /// Prepares the keys of a model for imprints of that many columns and rows; keys that do not fit are left out.
    pub fn new(model: &'a Model, columns: u8, rows: u8) -> Self {
        let mut scanner = Self {
            model,
            columns,
            rows,
            templates: Vec::new(),
            bits: Vec::new(),
            sums: Vec::new(),
            totals: vec![0; model.shapes().len()],
        };
        let keys = model.keys();
        let mut order: Vec<(u32, usize)> = (0..keys.len())
            .filter(|&key| keys.get(key).width <= columns && keys.get(key).height <= rows)
            .map(|key| (keys.get(key).count(), key))
            .collect();
        order.sort_unstable();
        for (count, key) in order {
            scanner.add(keys.get(key), count, key);
        }
        scanner
    }

    fn add(&mut self, key: KeyRef<'_>, count: u32, number: usize) {
        let (columns, start) = (usize::from(self.columns), self.bits.len());
        let rows: Vec<u64> = key.rows().collect();
        let length = match rows.len().checked_sub(1) {
            Some(last) => (last * columns + usize::from(key.width)).div_ceil(64),
            None => 0,
        };
        self.bits.resize(start + length, 0);
        for (row, &word) in rows.iter().enumerate() {
            or_bits(&mut self.bits[start..], row * columns, word);
        }
        self.templates.push(Template {
            key: crate::index::narrow(number),
            count,
            width: key.width,
            height: key.height,
            bits: start,
            length,
            sums: self.sums.len(),
        });
        self.sums.extend(row_sums(&rows));
        self.sums.extend(column_sums(&rows, key.width));
        let across = u64::from(self.columns - key.width) + 1;
        let down = u64::from(self.rows - key.height) + 1;
        for count in self.model.counts(number) {
            self.totals[usize::from(count.shape)] += count.poses * across * down;
        }
    }

    /// Returns the number of pairs of a key and a place on the matrix.
    pub fn pairs(&self) -> u64 {
        let places = |template: &Template| {
            let across = u64::from(self.columns - template.width) + 1;
            across * (u64::from(self.rows - template.height) + 1)
        };
        self.templates.iter().map(places).sum()
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
        let least = pulp::Arch::new().dispatch(|| self.least(&observed))?;
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
        let least = AtomicU32::new(u32::MAX);
        // From the keys with about as many taxels outwards, so that a small distance is found soon.
        let middle = self
            .templates
            .partition_point(|template| template.count < observed.count);
        let (fewer, more) = self.templates.split_at(middle);
        let scan = |template: &Template| {
            let most = least.load(Ordering::Relaxed);
            self.places(template, observed, most.saturating_sub(1), |distance| {
                least.fetch_min(distance, Ordering::Relaxed);
            });
        };
        more.par_iter().with_min_len(256).for_each(scan);
        fewer.par_iter().rev().with_min_len(256).for_each(scan);
        Some(least.into_inner()).filter(|_| !self.templates.is_empty())
    }

    /// Touches of each shape at the distances from `least` to `most`.
    fn histogram(&self, observed: &Observed, least: u32, most: u32) -> Vec<Vec<u64>> {
        let (shapes, width) = (self.totals.len(), wide(most - least) + 1);
        // Keys with so many taxels can be that near.
        let first = self
            .templates
            .partition_point(|own| own.count + most < observed.count);
        let last = self
            .templates
            .partition_point(|own| own.count <= observed.count + most + observed.dead);
        let chunks = self.templates[first..last].par_chunks(1024);
        let sums = chunks.map(|templates| {
            let mut sums = vec![0_u64; shapes * width];
            let mut places = vec![0_u64; width];
            pulp::Arch::new().dispatch(|| {
                for template in templates {
                    let mut any = false;
                    self.places(template, observed, most, |distance| {
                        places[wide(distance - least)] += 1;
                        any = true;
                    });
                    if !any {
                        continue;
                    }
                    for count in self.model.counts(wide(template.key)) {
                        let own = &mut sums[usize::from(count.shape) * width..][..width];
                        for (sum, places) in own.iter_mut().zip(&places) {
                            *sum += count.poses * places;
                        }
                    }
                    places.fill(0);
                }
            });
            sums
        });
        let add = |mut one: Vec<u64>, other: Vec<u64>| {
            one.iter_mut()
                .zip(other)
                .for_each(|(sum, more)| *sum += more);
            one
        };
        let sums = sums.reduce(|| vec![0; shapes * width], add);
        sums.chunks(width).map(<[u64]>::to_vec).collect()
    }

    /// Gives the distance in each place where it is at most `most`.
    #[inline(always)]
    fn places(
        &self,
        template: &Template,
        observed: &Observed,
        most: u32,
        mut take: impl FnMut(u32),
    ) {
        // Only the taxels that are not dead of a key count.
        let fewest = template.count.saturating_sub(observed.dead);
        if observed.count > template.count.saturating_add(most)
            || fewest > observed.count.saturating_add(most)
        {
            return;
        }
        if template.length == 0 {
            if observed.count <= most {
                take(observed.count);
            }
            return;
        }
        let bits = &self.bits[template.bits..][..template.length];
        let (width, height) = (usize::from(template.width), usize::from(template.height));
        let sums = &self.sums[template.sums..][..width + height];
        let (row_sums, column_sums) = sums.split_at(height);
        let bounded = observed.living.is_none();
        let (mut near_columns, mut columns) = ([0_u8; 64], 0);
        for column in 0..=usize::from(self.columns) - width {
            let own = &observed.column_sums[column..][..width];
            if !bounded || apart(own, column_sums, observed.count) <= most {
                near_columns[columns] = u8::try_from(column).expect("below 64");
                columns += 1;
            }
        }
        for row in 0..=usize::from(self.rows) - height {
            let own = &observed.row_sums[row..][..height];
            if bounded && apart(own, row_sums, observed.count) > most {
                continue;
            }
            for &column in &near_columns[..columns] {
                let place = row * usize::from(self.columns) + usize::from(column);
                let seen = &observed.shifted[place * observed.words..];
                let shared = shared(bits, seen);
                let count = match &observed.living {
                    None => template.count,
                    Some(living) => self::shared(bits, &living[place * observed.words..]),
                };
                let distance = observed.count + count - 2 * shared;
                if distance <= most {
                    take(distance);
                }
            }
        }
    }
}

/// Bits that both strings have, as far as the first goes.
#[inline(always)]
fn shared(bits: &[u64], seen: &[u64]) -> u32 {
    let both = bits.iter().zip(seen);
    both.map(|(bits, seen)| (bits & seen).count_ones()).sum()
}

/// A lower bound of the distance, by sums over rows or columns: those of the key and of the part of the imprint that it lies
/// on. What lies beside it, of `count` active taxels in all, differs.
#[inline(always)]
fn apart(seen: &[u8], own: &[u8], count: u32) -> u32 {
    let (mut inside, mut apart) = (0_u32, 0_u32);
    for (&seen, &own) in seen.iter().zip(own) {
        inside += u32::from(seen);
        apart += u32::from(seen.abs_diff(own));
    }
    apart + count - inside
}

/// A count as a number to compute with.
#[expect(
    clippy::cast_precision_loss,
    reason = "a probability has no more digits"
)]
fn float(count: u64) -> f64 {
    count as f64
}

/// The number of taxels of an imprint's key: its order among the templates.
impl KeyRef<'_> {
    fn count(self) -> u32 {
        self.bits.iter().map(|word| word.count_ones()).sum()
    }
}
