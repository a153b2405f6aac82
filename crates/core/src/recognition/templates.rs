use crate::imprint::Imprint;
use crate::recognition::model::Model;

pub(super) struct Templates(Vec<Vec<Template>>);

/// An imprint, and how many of its taxels lie above each row and left of each column. An empty imprint has no rows.
struct Template {
    words: Vec<u64>,
    above: Vec<u32>,
    left: Vec<u32>,
}

impl Templates {
    pub(super) fn new(model: &Model, most: usize) -> Self {
        let mut all: Vec<Vec<(std::cmp::Reverse<u64>, usize)>> =
            vec![Vec::new(); model.shapes().len()];
        for key in 0..model.keys().len() {
            for count in model.counts(key) {
                all[usize::from(count.shape)].push((std::cmp::Reverse(count.poses), key));
            }
        }
        let templates = |mut own: Vec<(std::cmp::Reverse<u64>, usize)>| {
            own.sort_unstable();
            let first = own.iter().take(most);
            let imprints = first.map(|&(_, key)| model.keys().imprint(key));
            imprints
                .map(|imprint| Template::of(imprint.as_ref()))
                .collect()
        };
        Self(all.into_iter().map(templates).collect())
    }

    /// Returns, for each shape, the least number of taxels that differ from a key, over all templates of the shape
    /// and all their shifts.
    pub(super) fn scores(&self, model: &Model, key: usize) -> Vec<f64> {
        let touch = Template::of(model.keys().imprint(key).as_ref());
        let own = |templates: &Vec<Template>| {
            let least = templates.iter().fold(None, |least, template| {
                Some(touch.distance(template, least.unwrap_or(u32::MAX)))
            });
            least.map_or(f64::INFINITY, f64::from)
        };
        self.0.iter().map(own).collect()
    }
}

impl Template {
    fn of(imprint: Option<&Imprint>) -> Self {
        let words = imprint.map_or(Vec::new(), |imprint| imprint.words().to_vec());
        let columns = imprint.map_or(0, Imprint::columns);
        let in_row = |word: &u64| word.count_ones();
        let in_column = |column| {
            words
                .iter()
                .map(|word| u32::from(word >> column & 1 == 1))
                .sum()
        };
        Self {
            above: sums_before(words.iter().map(in_row)),
            left: sums_before((0..columns).map(in_column)),
            words,
        }
    }

    fn count(&self) -> u32 {
        self.above[self.words.len()]
    }

    /// Returns the least number of taxels in which two imprints differ, over all shifts of one against the other;
    /// `most` if it is not below that.
    fn distance(&self, other: &Self, most: u32) -> u32 {
        let sum = self.count() + other.count();
        // Only shifts at which more taxels than this coincide matter. Rows and columns alone rule out most shifts.
        let mut shared = sum.saturating_sub(most) / 2;
        let mut least = most.min(sum);
        for down in shifts(&self.above, &other.above) {
            if in_common(&self.above, &other.above, down) <= shared {
                continue;
            }
            let (first, skipped) = starts(down);
            let pairs = || self.words[first..].iter().zip(&other.words[skipped..]);
            for across in shifts(&self.left, &other.left) {
                if in_common(&self.left, &other.left, across) <= shared {
                    continue;
                }
                let (right, left) = starts(across);
                let common = pairs()
                    .map(|(own, word)| (own & (word >> left) << right).count_ones())
                    .sum();
                if common > shared {
                    shared = common;
                    least = least.min(sum - 2 * shared);
                }
            }
        }
        least
    }
}

fn sums_before(values: impl Iterator<Item = u32>) -> Vec<u32> {
    let mut sum = 0;
    let after = values.map(|value| {
        sum += value;
        sum
    });
    std::iter::once(0).chain(after).collect()
}

/// Returns the shifts at which rows, or columns, of two imprints meet.
fn shifts(own: &[u32], other: &[u32]) -> std::ops::Range<isize> {
    2 - other.len().cast_signed()..own.len().cast_signed() - 1
}

/// Returns the first rows, or columns, of the two imprints that meet at a shift.
fn starts(shift: isize) -> (usize, usize) {
    let start = |shift: isize| shift.max(0).unsigned_abs();
    (start(shift), start(-shift))
}

/// Returns the most taxels that two imprints can have in common at a shift, by the rows or columns that meet there.
fn in_common(own: &[u32], other: &[u32], shift: isize) -> u32 {
    let (first, skipped) = starts(shift);
    let length = (own.len() - first).min(other.len() - skipped) - 1;
    let within = |sums: &[u32], start: usize| sums[start + length] - sums[start];
    within(own, first).min(within(other, skipped))
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::sensor::MatrixSize;

    #[test]
    fn distances_take_the_best_shift() {
        let read = |text: &str| text.parse::<Imprint>().expect("an imprint");
        for (one, other, expected) in [
            ("##.#", "#.#", 1),
            ("#.\n##", "##\n.#\n.#", 3),
            ("#", "###\n###", 5),
            ("#..\n...\n..#", "#..\n...\n..#", 0),
        ] {
            let (one, other) = (
                Template::of(Some(&read(one))),
                Template::of(Some(&read(other))),
            );
            assert_eq!(one.distance(&other, u32::MAX), expected);
            assert_eq!(other.distance(&one, u32::MAX), expected);
            // The result never exceeds the given bound.
            assert_eq!(one.distance(&other, expected + 1), expected);
            assert_eq!(one.distance(&other, expected), expected);
            assert_eq!(one.distance(&other, 0), 0);
        }
        let (nothing, four) = (Template::of(None), Template::of(Some(&read("##\n##"))));
        assert_eq!(nothing.distance(&four, u32::MAX), 4);
        assert_eq!(four.distance(&nothing, 3), 3);
        assert_eq!(nothing.distance(&nothing, 9), 0);
    }

    /// Compares with all shifts one by one, taxel by taxel.
    #[test]
    fn no_shift_is_missed() {
        let mut word = 0x9E37_79B9_7F4A_7C15_u64;
        let mut random = |below: u64| {
            word = word.wrapping_mul(6_364_136_223_846_793_005).wrapping_add(1);
            (word >> 33) % below
        };
        for _ in 0..300 {
            let mut imprint = || {
                let side = |random: u64| u8::try_from(random + 1).expect("small");
                let (columns, rows) = (side(random(9)), side(random(9)));
                let mut imprint = Imprint::empty(MatrixSize::of(columns, rows));
                for row in 0..rows {
                    for column in 0..columns {
                        imprint.set(column, row, random(3) > 0);
                    }
                }
                imprint
            };
            let (one, other) = (imprint(), imprint());
            let taxels = |imprint: &Imprint| {
                let active = imprint.active();
                active
                    .map(|(x, y)| (i16::from(x), i16::from(y)))
                    .collect::<Vec<_>>()
            };
            let (own, others) = (taxels(&one), taxels(&other));
            let shifts = (-9..=9).flat_map(|down| (-9..=9).map(move |across| (across, down)));
            let common = |(across, down)| {
                let moved = others.iter().map(|&(x, y)| (x + across, y + down));
                moved.filter(|taxel| own.contains(taxel)).count()
            };
            let most = shifts.map(common).max().expect("there are shifts");
            let expected = u32::try_from(own.len() + others.len() - 2 * most).expect("small");
            let (one, other) = (Template::of(Some(&one)), Template::of(Some(&other)));
            assert_eq!(one.distance(&other, u32::MAX), expected);
            assert_eq!(one.distance(&other, expected + 1), expected);
            assert_eq!(one.distance(&other, expected), expected);
        }
    }
}
