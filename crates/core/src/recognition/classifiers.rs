//! Classifiers that use descriptors of the imprint, as the paper does, and their results compared with the limit of
//! one touch.

use std::cmp::Reverse;
use std::collections::{BTreeMap, HashMap};

use rand_core::SeedableRng;
use rand_pcg::Pcg64;
use rayon::prelude::*;

use crate::atlas::{Feature, features};
use crate::description::{Description, ExactValue, Value};
use crate::imprint::Imprint;
use crate::parameter::named;
use crate::parameter::number::share;
use crate::progress::Progress;
use crate::recognition::evaluation::{ConfusionMatrix, Evaluation};
use crate::recognition::given::{self, ShapeDescriptor};
use crate::recognition::model::{Model, first_of_most, float};
use crate::recognition::simulation::Draw;

/// A classifier that uses descriptors or samples. The best classifier is the model itself.
///
/// All of them name the same touches as the [`Evaluation`] of the model counts, in which a pose counts with the weight
/// of its shape. They learn from poses, of which each shape has equally many: a weight does not change the mean, the
/// sample or the templates of a shape. They name the nearest shape, however likely it is.
///
/// Means and deviations are those of all poses, exact except for rounding; samples are drawn with a seed.
/// Features are numbers of the main region that do not change under shifts, each in units of its deviation over all
/// touches. A direction counts as its cosine and its sine, both 0 if it does not exist. Other features that do not
/// exist for some imprint, constants, and copies of others (NA and NAE of solid shapes) are left out.
///
/// Source: R. O. Duda, P. E. Hart and D. G. Stork, *Pattern Classification*, 2001, chapters 2 to 4.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash)]
pub enum Classifier {
    /// The nearest class mean, in units of each class's standard deviation.
    Z,
    /// The nearest touches of a sample.
    Knn,
    /// The nearest of the most frequent imprints, by the number of taxels that differ.
    Template,
}

named!(
    Classifier,
    "classifier",
    [Z "z", Knn "knn", Template "template"]
);

/// The settings of classifiers: which descriptors and how many samples they use.
#[derive(Clone, Debug, PartialEq)]
pub struct ClassifierSettings {
    /// The descriptors that the features come from; None for all descriptors that do not change under shifts.
    pub descriptors: Option<Vec<ShapeDescriptor>>,
    /// The number of neighbours of [`Classifier::Knn`] that vote.
    pub neighbours: usize,
    /// The number of poses of each shape that [`Classifier::Knn`] draws.
    pub sample: usize,
    /// The seed for drawing these poses.
    pub seed: u64,
    /// The number of imprints of each shape that [`Classifier::Template`] compares with.
    pub templates: usize,
}

impl Default for ClassifierSettings {
    fn default() -> Self {
        Self {
            descriptors: None,
            neighbours: 1,
            sample: 2000,
            seed: 0,
            templates: 100,
        }
    }
}

/// The result of a classifier on a model's touches.
#[derive(Clone, Debug, PartialEq)]
pub struct ClassifierEvaluation {
    /// The classifier.
    pub classifier: Classifier,
    /// The counts, as for the best classifier. `information_bits` is the information that the given name has about the
    /// shape.
    pub evaluation: Evaluation,
    /// The features that the classifier used; empty for [`Classifier::Template`].
    pub features: Vec<String>,
    /// The features that were left out, with the reason.
    pub dropped: Vec<(String, &'static str)>,
    /// How many poses of each shape [`Classifier::Knn`] drew at random, and the seed; None if it took all, and for the
    /// other classifiers.
    pub sample: Option<(usize, u64)>,
}

impl Classifier {
    /// Trains the classifier on a model's touches and classifies all of them.
    ///
    /// Ties go to the first shape in the order of the set. `progress` is called from time to time, from any thread,
    /// with the number of keys of the model that were classified since the last call, and stops the evaluation by
    /// returning `Break`. Returns None if it was stopped.
    pub fn evaluate(
        self,
        model: &Model,
        settings: &ClassifierSettings,
        progress: &dyn Progress,
    ) -> Option<ClassifierEvaluation> {
        let is_drawn = self == Self::Knn && (settings.sample as u64) < model.poses();
        let sample = is_drawn.then_some((settings.sample, settings.seed));
        let table = match self {
            Self::Template => FeatureTable::default(),
            Self::Z | Self::Knn => FeatureTable::new(model, settings.descriptors.as_deref()),
        };
        let evaluation = match self {
            Self::Z => {
                let classes = class_moments(model, &table);
                evaluate(model, progress, &|key| distances(&classes, table.row(key)))
            }
            Self::Knn => {
                let voters = voters(model, sample);
                let neighbours = settings.neighbours.max(1);
                let shapes = model.shapes().len();
                let scores = |key| votes(&voters, &table, neighbours, key, shapes);
                evaluate(model, progress, &scores)
            }
            Self::Template => {
                let templates = templates(model, settings.templates.max(1));
                let scores = |key| {
                    let touch = Template::of(model.keys().imprint(key).as_ref());
                    let own = templates.iter();
                    own.map(|templates| touch.nearest(templates)).collect()
                };
                evaluate(model, progress, &scores)
            }
        };
        Some(ClassifierEvaluation {
            classifier: self,
            evaluation: evaluation?,
            features: table.names,
            dropped: table.dropped,
            sample,
        })
    }
}

/// Names every touch of a model by the shape of the lowest score.
fn evaluate(
    model: &Model,
    progress: &dyn Progress,
    scores: &(dyn Fn(usize) -> Vec<f64> + Sync),
) -> Option<Evaluation> {
    let ranked = (0..model.keys().len()).into_par_iter().map(|key| {
        let ranked = first_two(&scores(key));
        progress.add(1).is_continue().then_some(ranked)
    });
    let ranked: Vec<_> = ranked.collect::<Option<_>>()?;
    let mut evaluation = Evaluation::new(model);
    evaluation.keys = ranked.len();
    for (key, (named, second, is_tied)) in ranked.into_iter().enumerate() {
        for (shape, touches) in model.weighted_shapes(model.counts(key)) {
            evaluation.confusion.add(shape, named, touches);
            if named == shape {
                evaluation.right += touches;
            }
            if named == shape || second == Some(shape) {
                evaluation.right_in_top_two += touches;
            }
            if is_tied {
                evaluation.tied += touches;
            }
        }
    }
    evaluation.information_bits = information(&evaluation.confusion);
    Some(evaluation.finished())
}

/// The shape with the lowest score, the one with the second lowest, and whether they are tied.
fn first_two(scores: &[f64]) -> (usize, Option<usize>, bool) {
    let all = || scores.iter().map(|score| -score).enumerate();
    let first = first_of_most(all()).map_or(0, |(shape, _)| shape);
    let second = first_of_most(all().filter(|&(shape, _)| shape != first));
    let second = second.map(|(shape, _)| shape);
    let is_tied = second.is_some_and(|second| scores[first] == scores[second]);
    (first, second, is_tied)
}

fn information(confusion: &ConfusionMatrix) -> f64 {
    let shapes = 0..confusion.shapes();
    let rows: Vec<u128> = (shapes.clone())
        .map(|shape| confusion.touches_of(shape))
        .collect();
    let columns: Vec<u128> = shapes.map(|shape| confusion.touches_named(shape)).collect();
    let total = rows.iter().sum();
    let bits = confusion.cells().map(|(touched, named, touches)| {
        let ratio = share(touches, rows[touched]) / share(columns[named], total);
        share(touches, total) * libm::log2(ratio)
    });
    bits.sum()
}

/// For each class, the mean of each feature over its poses, and its variance.
fn class_moments(model: &Model, table: &FeatureTable) -> Vec<Vec<(f64, f64)>> {
    let poses = u128::from(model.poses());
    let mut classes = vec![vec![(0.0, LEAST_VARIANCE); table.names.len()]; model.shapes().len()];
    let mut each = |add: fn(&mut (f64, f64), f64, f64)| {
        for key in 0..model.keys().len() {
            for count in model.counts(key) {
                let part = share(count.poses.into(), poses);
                let class = &mut classes[usize::from(count.shape)];
                for (own, &value) in class.iter_mut().zip(table.row(key)) {
                    add(own, part, value);
                }
            }
        }
    };
    each(|(mean, _), part, value| *mean += part * value);
    each(|(mean, variance), part, value| *variance += part * (value - *mean) * (value - *mean));
    classes
}

/// The squares of the distances of a key's features from the means of the classes, in standard deviations.
fn distances(classes: &[Vec<(f64, f64)>], row: &[f64]) -> Vec<f64> {
    let distance = |class: &Vec<(f64, f64)>| {
        let parts = row.iter().zip(class);
        parts
            .map(|(value, (mean, variance))| (value - mean) * (value - mean) / variance)
            .sum()
    };
    classes.iter().map(distance).collect()
}

/// The number added to single variances, which only have to differ from 0.
const LEAST_VARIANCE: f64 = 1e-9;

/// The features of all keys, in units of their deviation.
#[derive(Default)]
struct FeatureTable {
    names: Vec<String>,
    dropped: Vec<(String, &'static str)>,
    /// A row of features for each key.
    values: Vec<f64>,
}

impl FeatureTable {
    fn new(model: &Model, descriptors: Option<&[ShapeDescriptor]>) -> Self {
        let descriptions = given::descriptions(model);
        let (mut names, mut dropped) = (Vec::new(), Vec::new());
        let mut kept: Vec<(Vec<f64>, f64, f64)> = Vec::new();
        let is_wanted = |feature: &&Feature| {
            let own = ShapeDescriptor::all().find(|own| own.key() == feature.descriptor.key);
            own.is_some_and(|own| descriptors.is_none_or(|given| given.contains(&own)))
        };
        let wanted = features().iter().filter(is_wanted);
        for (name, column) in wanted.flat_map(|own| columns(own, &descriptions)) {
            let (mean, variance) = moments(model, &column);
            let reason = if column.iter().any(|value| value.is_nan()) {
                "does not exist for some imprints"
            } else if variance <= LEAST_VARIANCE * (1.0 + mean * mean) {
                "constant"
            } else if kept.iter().any(|(own, ..)| *own == column) {
                "a copy of another"
            } else {
                names.push(name);
                kept.push((column, mean, variance));
                continue;
            };
            dropped.push((name, reason));
        }
        let row = |key: usize| {
            let own = kept.iter();
            own.map(move |(own, mean, variance)| (own[key] - mean) / variance.sqrt())
        };
        let values = (0..descriptions.len()).flat_map(row).collect();
        Self {
            names,
            dropped,
            values,
        }
    }

    fn row(&self, key: usize) -> &[f64] {
        &self.values[key * self.names.len()..][..self.names.len()]
    }
}

/// The values of a feature for every key, NaN where it does not exist, with their name; of a direction, the cosines and
/// the sines.
///
/// Where its descriptor is exactly equal, values are made equal: computed from other sums, they differ by a rounding
/// error, and nearest neighbours would then not be equally near.
fn columns(feature: &Feature, descriptions: &[Option<Description>]) -> Vec<(String, Vec<f64>)> {
    let descriptor = feature.descriptor;
    // Counts of an empty imprint are 0; other features of it do not exist.
    let nothing = match descriptor.of_nothing {
        Value::None => f64::NAN,
        _ => 0.0,
    };
    let mut known: HashMap<ExactValue, f64> = HashMap::new();
    let values = descriptions.iter().map(|description| {
        let Some(description) = description else {
            return nothing;
        };
        let value = feature.value(description).unwrap_or(nothing);
        *known
            .entry((descriptor.exact)(description))
            .or_insert(value)
    });
    let values: Vec<f64> = values.collect();
    if !feature.circular {
        return vec![(feature.key.clone(), values)];
    }
    let part = |suffix: &str, of: fn(f64) -> f64| {
        let values = values.iter().map(|degrees| {
            if degrees.is_nan() {
                0.0
            } else {
                of(degrees.to_radians())
            }
        });
        (format!("{}_{suffix}", feature.key), values.collect())
    };
    vec![part("cos", libm::cos), part("sin", libm::sin)]
}

fn moments(model: &Model, column: &[f64]) -> (f64, f64) {
    let touches = u128::from(model.poses()) * model.weights();
    let mean_of = |value: &dyn Fn(f64) -> f64| {
        let keys = column.iter().enumerate().map(|(key, &own)| {
            let counts = model.weighted_shapes(model.counts(key));
            let weight: u128 = counts.map(|(_, touches)| touches).sum();
            share(weight, touches) * value(own)
        });
        keys.sum::<f64>()
    };
    let mean = mean_of(&|value| value);
    (mean, mean_of(&|value| (value - mean) * (value - mean)))
}

/// Touches of one shape that leave the same key: the key, the shape and the number of touches, each of which is a vote.
type Voters = (usize, usize, u64);

/// The touches that vote, in the order of their keys: a random sample, or all touches.
fn voters(model: &Model, sample: Option<(usize, u64)>) -> Vec<Voters> {
    let mut votes = BTreeMap::new();
    if let Some((sample, seed)) = sample {
        let mut random = Pcg64::seed_from_u64(seed);
        for (shape, draw) in Draw::all(model, |_| 1).iter().enumerate() {
            for key in (0..sample).filter_map(|_| draw.key(&mut random)) {
                *votes.entry((key, shape)).or_insert(0) += 1;
            }
        }
    } else {
        for key in 0..model.keys().len() {
            let counts = model.counts(key).iter();
            votes.extend(counts.map(|count| ((key, usize::from(count.shape)), count.poses)));
        }
    }
    let votes = votes.into_iter();
    votes
        .map(|((key, shape), votes)| (key, shape, votes))
        .collect()
}

/// Minus the votes of each shape. All touches as near as the last neighbour vote too, since many touches have the same
/// features.
fn votes(
    voters: &[Voters],
    table: &FeatureTable,
    neighbours: usize,
    key: usize,
    shapes: usize,
) -> Vec<f64> {
    let row = table.row(key);
    let mut distances: Vec<(f64, usize, u64)> = Vec::with_capacity(voters.len());
    for alike in voters.chunk_by(|one, other| one.0 == other.0) {
        let parts = row.iter().zip(table.row(alike[0].0));
        let distance = parts.map(|(one, two)| (one - two) * (one - two)).sum();
        let own = alike.iter();
        distances.extend(own.map(|&(_, shape, votes)| (distance, shape, votes)));
    }
    let mut scores = vec![0.0; shapes];
    let Some(rank) = neighbours.min(distances.len()).checked_sub(1) else {
        return scores;
    };
    let order = |one: &(f64, usize, u64), other: &(f64, usize, u64)| one.0.total_cmp(&other.0);
    // Each entry has at least one vote, so the first `neighbours` entries include the last neighbour.
    distances.select_nth_unstable_by(rank, order);
    distances[..=rank].sort_unstable_by(order);
    let mut nearer = 0;
    let last = distances[..=rank].iter().find(|(_, _, votes)| {
        nearer += u128::from(*votes);
        nearer >= neighbours as u128
    });
    let farthest = last.unwrap_or(&distances[rank]).0;
    for (_, shape, votes) in distances.iter().filter(|own| own.0 <= farthest) {
        scores[*shape] -= float(*votes);
    }
    scores
}

/// The most frequent imprints of each shape.
fn templates(model: &Model, most: usize) -> Vec<Vec<Template>> {
    let mut all: Vec<Vec<(Reverse<u64>, usize)>> = vec![Vec::new(); model.shapes().len()];
    for key in 0..model.keys().len() {
        for count in model.counts(key) {
            all[usize::from(count.shape)].push((Reverse(count.poses), key));
        }
    }
    let templates = |mut own: Vec<(Reverse<u64>, usize)>| {
        own.sort_unstable();
        let first = own.iter().take(most);
        let imprints = first.map(|&(_, key)| model.keys().imprint(key));
        imprints
            .map(|imprint| Template::of(imprint.as_ref()))
            .collect()
    };
    all.into_iter().map(templates).collect()
}

/// An imprint, and how many of its taxels lie above each row and left of each column. An empty imprint has no rows.
struct Template {
    words: Vec<u64>,
    above: Vec<u32>,
    left: Vec<u32>,
}

impl Template {
    fn of(imprint: Option<&Imprint>) -> Self {
        let words = imprint.map_or(Vec::new(), |imprint| imprint.words().to_vec());
        let columns = imprint.map_or(0, Imprint::columns);
        let in_column = |column: u8| {
            let taxels = words.iter().map(|word| u32::from(word >> column & 1 == 1));
            taxels.sum()
        };
        Self {
            above: sums_before(words.iter().map(|word| word.count_ones())),
            left: sums_before((0..columns).map(in_column)),
            words,
        }
    }

    fn count(&self) -> u32 {
        self.above[self.words.len()]
    }

    /// Returns the least number of taxels that differ from any of some templates, over all their shifts.
    fn nearest(&self, templates: &[Self]) -> f64 {
        let least = templates
            .iter()
            .fold(u32::MAX, |least, template| self.distance(template, least));
        if templates.is_empty() {
            f64::INFINITY
        } else {
            f64::from(least)
        }
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
    use std::sync::atomic::{AtomicU64, Ordering};

    use super::*;
    use crate::figure::Figure;
    use crate::progress::{ToTheEnd, stop_if};
    use crate::recognition::model::NamedShape;
    use crate::recognition::training::{GridSteps, Training};
    use crate::sensor::{MatrixSize, Sensor};

    #[test]
    fn a_sample_larger_than_the_poses_takes_all_poses() {
        let sensor = Sensor::default();
        let shapes = [
            ("square", Figure::rectangle(3.0, 3.0).on(&sensor)),
            ("bar", Figure::rectangle(6.0, 3.0).on(&sensor)),
        ];
        let shapes = shapes.map(|(name, figure)| NamedShape::new(name, figure.expect("in range")));
        let steps = GridSteps::of(10, "0:315:45");
        let training = Training::fitting(shapes.to_vec(), steps).expect("they fit");
        let model = training.run().expect("not stopped");
        let reached = |sample, seed| {
            let settings = ClassifierSettings {
                sample,
                seed,
                neighbours: 3,
                ..ClassifierSettings::default()
            };
            let reached = Classifier::Knn.evaluate(&model, &settings, &ToTheEnd);
            reached.expect("not stopped")
        };
        let all = reached(usize::MAX, 0);
        assert_eq!((&all, all.sample), (&reached(usize::MAX, 1), None));
        let some = reached(5, 0);
        assert_eq!(some.sample, Some((5, 0)));
        assert_ne!(some.evaluation, all.evaluation);
    }

    #[test]
    fn every_classifier_reports_all_keys_and_can_be_stopped() {
        let sensor = Sensor::default();
        let bar = Figure::rectangle(6.0, 3.0).on(&sensor).expect("in range");
        let steps = GridSteps::of(4, "0:315:45");
        let training = Training::fitting(vec![NamedShape::new("bar", bar)], steps);
        let model = training.expect("it fits").run().expect("not stopped");
        for &classifier in Classifier::ALL {
            let keys = AtomicU64::new(0);
            let settings = ClassifierSettings::default();
            let add = |more| {
                keys.fetch_add(more, Ordering::Relaxed);
                stop_if(false)
            };
            assert!(classifier.evaluate(&model, &settings, &add).is_some());
            assert_eq!(keys.into_inner(), model.keys().len() as u64);
            assert_eq!(
                classifier.evaluate(&model, &settings, &|_| stop_if(true)),
                None
            );
        }
    }

    #[test]
    fn ties_go_to_the_first() {
        assert_eq!(first_two(&[2.0, 1.0, 1.0]), (1, Some(2), true));
        assert_eq!(first_two(&[2.0, 1.0, 3.0]), (1, Some(0), false));
        assert_eq!(first_two(&[2.0]), (0, None, false));
    }

    #[test]
    fn an_empty_imprint_does_not_remove_counts_from_the_features() {
        let sensor = Sensor::default();
        let shapes = [
            ("tri", Figure::triangle(1.2).on(&sensor)),
            ("bar", Figure::rectangle(6.0, 3.0).on(&sensor)),
        ];
        let shapes = shapes.map(|(name, figure)| NamedShape::new(name, figure.expect("in range")));
        let steps = GridSteps::of(10, "0:315:45");
        let training = Training::fitting(shapes.to_vec(), steps).expect("they fit");
        let model = training.run().expect("not stopped");
        let table = FeatureTable::new(&model, None);
        assert!(given::descriptions(&model).iter().any(Option::is_none));
        for count in ["na", "nae", "ce", "area"] {
            let kept = table.names.iter().any(|name| name == count);
            let copy = table.dropped.iter();
            let copy =
                copy.filter(|(name, reason)| name == count && *reason == "a copy of another");
            assert!(kept || copy.count() == 1, "{count}: {:?}", table.dropped);
        }
    }

    #[test]
    fn distances_take_the_best_shift() {
        let read = |text: &str| text.parse::<Imprint>().expect("an imprint");
        for (one, other, expected) in [
            ("##.#", "#.#", 1),
            ("#.\n##", "##\n.#\n.#", 3),
            ("#", "###\n###", 5),
            ("#..\n...\n..#", "#..\n...\n..#", 0),
        ] {
            let [one, other] = [one, other].map(|text| Template::of(Some(&read(text))));
            assert_eq!(one.distance(&other, u32::MAX), expected);
            assert_eq!(other.distance(&one, u32::MAX), expected);
            // The result never exceeds the given bound.
            assert_eq!(one.distance(&other, expected + 1), expected);
            assert_eq!(one.distance(&other, 0), 0);
        }
    }

    #[test]
    fn an_empty_imprint_differs_in_all_taxels() {
        let read = |text: &str| text.parse::<Imprint>().expect("an imprint");
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
