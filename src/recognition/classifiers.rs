//! Classifiers that use descriptors of the imprint, as the paper does, and their results compared with the limit of
//! one touch.
//!
//! All of them see the same touches as the [`Evaluation`] of the model. Means, deviations and covariances are those of
//! all poses, exact except for rounding; samples are drawn with a seed. Features are numbers of the main region that do
//! not change under shifts, each in units of its deviation over all touches. A direction counts as its cosine and its
//! sine, both 0 if it does not exist. Other features that do not exist for some imprint, constants, and copies of
//! others (NA and NAE of solid shapes) are left out.
//!
//! Source: R. O. Duda, P. E. Hart and D. G. Stork, *Pattern Classification*, 2001, chapters 2 to 4.

use std::collections::BTreeMap;

use nalgebra::{Cholesky, DMatrix, DVector, Dyn};
use rand_core::SeedableRng;
use rand_pcg::Pcg64;
use rayon::prelude::*;

use crate::atlas::{feature_values, features};
use crate::description::{Description, Descriptor, Value};
use crate::parameter::named;
use crate::parameter::number::share;
use crate::recognition::confusion::ConfusionMatrix;
use crate::recognition::evaluation::Evaluation;
use crate::recognition::given::{GivenTable, ShapeDescriptor};
use crate::recognition::model::{Model, float};
use crate::recognition::simulation::Draw;
use crate::recognition::templates::Templates;

/// A classifier that uses descriptors or samples. The best classifier is the model itself.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash)]
#[non_exhaustive]
pub enum Classifier {
    /// The nearest class mean, in units of each class's standard deviation.
    Z,
    /// A Gaussian for each class, with independent features.
    Diagonal,
    /// Gaussians with a common covariance.
    Lda,
    /// A Gaussian for each class, with its own covariance.
    Qda,
    /// The nearest touches of a sample.
    Knn,
    /// The nearest of the most frequent imprints, by the number of taxels that differ.
    Template,
}

impl Classifier {
    /// All classifiers.
    pub const ALL: [Self; 6] = [
        Self::Z,
        Self::Diagonal,
        Self::Lda,
        Self::Qda,
        Self::Knn,
        Self::Template,
    ];

    /// Returns the name used on the command line.
    pub const fn name(self) -> &'static str {
        match self {
            Self::Z => "z",
            Self::Diagonal => "diagonal",
            Self::Lda => "lda",
            Self::Qda => "qda",
            Self::Knn => "knn",
            Self::Template => "template",
        }
    }

    /// Returns the classifier of that name.
    pub fn from_name(name: &str) -> Option<Self> {
        Self::ALL
            .into_iter()
            .find(|classifier| classifier.name() == name)
    }
}

named!(Classifier, "classifier", &Classifier::ALL);

/// The settings of classifiers: which descriptors and how many samples they use.
#[derive(Clone, Debug, PartialEq)]
#[non_exhaustive]
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
    /// Returns the default settings: all descriptors, 1 neighbour of 2,000 poses with seed 0, 100 templates.
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
#[non_exhaustive]
pub struct ClassifierEvaluation {
    /// The classifier.
    pub classifier: Classifier,
    /// The counts, as for the best classifier. `information_bits` is the information that the given name has about the
    /// shape; `certain` is 0, since these classifiers do not know when they are certain.
    pub evaluation: Evaluation,
    /// The features that the classifier used; empty for [`Classifier::Template`].
    pub features: Vec<String>,
    /// The features that were left out, with the reason.
    pub dropped: Vec<(String, &'static str)>,
    /// The poses that [`Classifier::Knn`] drew at random; None for the other classifiers.
    pub sample: Option<PoseSample>,
}

/// Poses that a classifier drew at random.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash)]
#[non_exhaustive]
pub struct PoseSample {
    /// The number of poses of each shape.
    pub per_shape: usize,
    /// The seed for drawing these poses.
    pub seed: u64,
}

/// Scores of the shapes for a key; the lowest is the best.
type Scores = Vec<f64>;

/// The number added to a variance of 1, so that covariances of dependent features can be inverted.
const RIDGE: f64 = 0.001;
/// The number added to single variances, which only have to differ from 0.
const LEAST_VARIANCE: f64 = 1e-9;

impl Classifier {
    /// Trains the classifier on a model's touches and classifies all of them.
    ///
    /// Ties go to the first shape in the order of the set.
    pub fn evaluate(self, model: &Model, settings: &ClassifierSettings) -> ClassifierEvaluation {
        self.evaluate_with_progress(model, settings, &|_| ())
    }

    /// Returns the same as [`Self::evaluate`]. `progress` is called from time to time, from any thread, with the number
    /// of keys of the model that were classified since the last call.
    pub fn evaluate_with_progress(
        self,
        model: &Model,
        settings: &ClassifierSettings,
        progress: &(dyn Fn(u64) + Sync),
    ) -> ClassifierEvaluation {
        let evaluate =
            |scores: &(dyn Fn(usize) -> Scores + Sync)| evaluate(model, scores, progress);
        let features = || FeatureTable::new(model, settings.descriptors.as_deref());
        let (evaluation, table) = match self {
            Self::Z => {
                let table = features();
                let classes = table.gaussians(model);
                let scores = |key| table.z_scores(&classes, key);
                (evaluate(&scores), Some(table))
            }
            Self::Diagonal => {
                let table = features();
                let classes = table.gaussians(model);
                let scores = |key| table.diagonal_scores(model, &classes, key);
                (evaluate(&scores), Some(table))
            }
            Self::Lda | Self::Qda => {
                let table = features();
                let classes = table.covariances(model, self == Self::Lda);
                let scores = |key| table.covariance_scores(model, &classes, key);
                (evaluate(&scores), Some(table))
            }
            Self::Knn => {
                let table = features();
                let sample = Sample::new(model, settings);
                let neighbours = settings.neighbours.max(1);
                let scores = |key| sample.scores(&table, neighbours, key);
                (evaluate(&scores), Some(table))
            }
            Self::Template => {
                let templates = Templates::new(model, settings.templates.max(1));
                (evaluate(&|key| templates.scores(model, key)), None)
            }
        };
        let (features, dropped) = match table {
            Some(table) => (table.names, table.dropped),
            // Imprints are compared, not features.
            None => (Vec::new(), Vec::new()),
        };
        ClassifierEvaluation {
            classifier: self,
            evaluation,
            features,
            dropped,
            sample: (self == Self::Knn && is_drawn(model, settings)).then_some(PoseSample {
                per_shape: settings.sample,
                seed: settings.seed,
            }),
        }
    }
}

/// Classifies every key by its scores.
fn evaluate(
    model: &Model,
    scores: &(dyn Fn(usize) -> Scores + Sync),
    progress: &(dyn Fn(u64) + Sync),
) -> Evaluation {
    let ranked: Vec<[Option<usize>; 3]> = (0..model.keys().len())
        .into_par_iter()
        .map(|key| {
            let ranked = first_two(&scores(key));
            progress(1);
            ranked
        })
        .collect();
    let mut evaluation = Evaluation::new(model);
    evaluation.keys = model.keys().len();
    for (key, [named, second, tie]) in ranked.into_iter().enumerate() {
        for &count in model.counts(key) {
            let (shape, touches) = (usize::from(count.shape), model.weighted(count));
            let Some(named) = named else { continue };
            evaluation.confusion.add(shape, named, touches);
            if named == shape {
                evaluation.right += touches;
            }
            if named == shape || second == Some(shape) {
                evaluation.right_in_top_two += touches;
            }
            if tie.is_some() {
                evaluation.tied += touches;
            }
        }
    }
    evaluation.information_bits = information(&evaluation.confusion);
    evaluation.finished()
}

/// Returns the shape with the lowest score, the one with the second lowest, and the second one again if the two are
/// tied.
fn first_two(scores: &[f64]) -> [Option<usize>; 3] {
    let lowest = |without: Option<usize>| {
        let open = (0..scores.len()).filter(|&shape| Some(shape) != without);
        open.reduce(|best, next| {
            if scores[next] < scores[best] {
                next
            } else {
                best
            }
        })
    };
    let first = lowest(None);
    let second = lowest(first);
    let tie = first
        .zip(second)
        .filter(|&(one, other)| scores[one] == scores[other]);
    [first, second, tie.map(|(_, second)| second)]
}

/// Returns how much the name tells about the shape, in bits.
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

/// The features of all keys, in units of their deviation.
struct FeatureTable {
    names: Vec<String>,
    dropped: Vec<(String, &'static str)>,
    /// A row of features for each key.
    values: Vec<f64>,
}

/// Mean and variance of each feature, of one class.
struct Gaussian {
    means: Vec<f64>,
    variances: Vec<f64>,
}

/// Mean and covariance of one class.
struct Covariance {
    mean: DVector<f64>,
    factor: Option<Cholesky<f64, Dyn>>,
    log_determinant: f64,
}

impl FeatureTable {
    fn new(model: &Model, descriptors: Option<&[ShapeDescriptor]>) -> Self {
        let table = GivenTable::new(model);
        let keys = table.descriptions().len();
        let wanted =
            |key: &str| descriptors.is_none_or(|own| own.iter().any(|one| one.key() == key));
        let (mut names, mut dropped) = (Vec::new(), Vec::new());
        let mut kept: Vec<Vec<f64>> = Vec::new();
        for (name, descriptor, column) in columns(table.descriptions()) {
            if descriptor.changes_under.shift || !wanted(descriptor.key) {
                continue;
            }
            let (mean, variance) = moments(model, &column);
            let reason = if column.iter().any(|value| value.is_nan()) {
                "does not exist for some imprints"
            } else if variance <= LEAST_VARIANCE * (1.0 + mean * mean) {
                "constant"
            } else if kept.contains(&column) {
                "a copy of another"
            } else {
                names.push(name);
                kept.push(column);
                continue;
            };
            dropped.push((name, reason));
        }
        let mut values = vec![0.0; keys * kept.len()];
        for (index, column) in kept.iter().enumerate() {
            let (mean, variance) = moments(model, column);
            for (key, value) in column.iter().enumerate() {
                values[key * kept.len() + index] = (value - mean) / variance.sqrt();
            }
        }
        Self {
            names,
            dropped,
            values,
        }
    }

    fn row(&self, key: usize) -> &[f64] {
        &self.values[key * self.names.len()..][..self.names.len()]
    }

    fn gaussians(&self, model: &Model) -> Vec<Gaussian> {
        let covariances = self.moments_of_classes(model);
        let gaussian = |(mean, covariance): (DVector<f64>, DMatrix<f64>)| Gaussian {
            means: mean.iter().copied().collect(),
            variances: covariance
                .diagonal()
                .iter()
                .map(|variance| variance + LEAST_VARIANCE)
                .collect(),
        };
        covariances.into_iter().map(gaussian).collect()
    }

    /// Returns mean and population covariance of each class, over all its poses.
    fn moments_of_classes(&self, model: &Model) -> Vec<(DVector<f64>, DMatrix<f64>)> {
        let (shapes, width) = (model.shapes().len(), self.names.len());
        let mut means = vec![DVector::zeros(width); shapes];
        let mut covariances = vec![DMatrix::zeros(width, width); shapes];
        let poses = u128::from(model.poses());
        for key in 0..model.keys().len() {
            for count in model.counts(key) {
                let part = share(count.poses.into(), poses);
                let row = self.row(key).iter();
                let mean = &mut means[usize::from(count.shape)];
                mean.iter_mut()
                    .zip(row)
                    .for_each(|(sum, value)| *sum += part * value);
            }
        }
        for key in 0..model.keys().len() {
            let row = DVector::from_column_slice(self.row(key));
            for count in model.counts(key) {
                let shape = usize::from(count.shape);
                let away = &row - &means[shape];
                let part = share(count.poses.into(), poses);
                covariances[shape].ger(part, &away, &away, 1.0);
            }
        }
        means.into_iter().zip(covariances).collect()
    }

    fn covariances(&self, model: &Model, common: bool) -> Vec<Covariance> {
        let classes = self.moments_of_classes(model);
        let ridge = DMatrix::identity(self.names.len(), self.names.len()) * RIDGE;
        let mut pooled = DMatrix::zeros(self.names.len(), self.names.len());
        for (shape, (_, covariance)) in model.shapes().iter().zip(&classes) {
            pooled += covariance * share(shape.weight.into(), model.weights());
        }
        let class = |(mean, covariance): (DVector<f64>, DMatrix<f64>)| {
            let matrix = if common { pooled.clone() } else { covariance } + &ridge;
            let factor = Cholesky::new(matrix);
            let log_determinant = factor.as_ref().map_or(0.0, |factor| {
                2.0 * factor
                    .l_dirty()
                    .diagonal()
                    .iter()
                    .map(|&side| libm::log(side))
                    .sum::<f64>()
            });
            Covariance {
                mean,
                factor,
                log_determinant,
            }
        };
        classes.into_iter().map(class).collect()
    }

    fn z_scores(&self, classes: &[Gaussian], key: usize) -> Scores {
        let distance = |class: &Gaussian| class.distance(self.row(key));
        classes.iter().map(distance).collect()
    }

    fn diagonal_scores(&self, model: &Model, classes: &[Gaussian], key: usize) -> Scores {
        let score = |(class, prior): (&Gaussian, f64)| {
            let logarithms: f64 = class
                .variances
                .iter()
                .map(|&variance| libm::log(variance))
                .sum();
            class.distance(self.row(key)) + logarithms + prior
        };
        classes.iter().zip(priors(model)).map(score).collect()
    }

    fn covariance_scores(&self, model: &Model, classes: &[Covariance], key: usize) -> Scores {
        let row = DVector::from_column_slice(self.row(key));
        let score = |(class, prior): (&Covariance, f64)| {
            let away = &row - &class.mean;
            let distance = match &class.factor {
                Some(factor) => away.dot(&factor.solve(&away)),
                None => away.norm_squared(),
            };
            distance + class.log_determinant + prior
        };
        classes.iter().zip(priors(model)).map(score).collect()
    }
}

/// Returns the features with their names and descriptors, and the value of each for every key, NaN where it does not
/// exist.
fn columns(
    descriptions: &[Option<Description>],
) -> impl Iterator<Item = (String, &'static Descriptor, Vec<f64>)> {
    // Counts of an empty imprint are 0; other features of it do not exist.
    let of_nothing = features().iter().map(|feature| {
        if feature.descriptor.of_nothing == Value::None {
            f64::NAN
        } else {
            0.0
        }
    });
    let mut columns: Vec<_> = of_nothing
        .map(|value| vec![value; descriptions.len()])
        .collect();
    for (key, description) in descriptions.iter().enumerate() {
        if let Some(description) = description {
            feature_values(description, |feature, value| columns[feature][key] = value);
        }
    }
    let all = features().iter().zip(columns);
    all.flat_map(|(feature, column)| {
        let descriptor = feature.descriptor;
        if !feature.circular {
            return vec![(feature.key.clone(), descriptor, column)];
        }
        let part = |suffix: &str, of: fn(f64) -> f64| {
            let values = column.iter().map(|degrees| {
                if degrees.is_nan() {
                    0.0
                } else {
                    of(degrees.to_radians())
                }
            });
            let name = format!("{}_{suffix}", feature.key);
            (name, descriptor, values.collect())
        };
        vec![part("cos", libm::cos), part("sin", libm::sin)]
    })
}

impl Gaussian {
    /// Returns the square of the distance from the mean, in standard deviations.
    fn distance(&self, row: &[f64]) -> f64 {
        let parts = row.iter().zip(self.means.iter().zip(&self.variances));
        parts
            .map(|(value, (mean, variance))| (value - mean) * (value - mean) / variance)
            .sum()
    }
}

/// Iterates over −2 ln P(shape) of each shape.
fn priors(model: &Model) -> impl Iterator<Item = f64> + '_ {
    let weights = model.weights();
    let shapes = model.shapes().iter();
    shapes.map(move |shape| -2.0 * libm::log(share(shape.weight.into(), weights)))
}

/// Returns mean and population variance of a feature over all touches of all shapes.
fn moments(model: &Model, column: &[f64]) -> (f64, f64) {
    let touches = u128::from(model.poses()) * model.weights();
    let mean_of = |value: &dyn Fn(f64) -> f64| {
        let keys = column.iter().enumerate().map(|(key, &own)| {
            let counts = model.counts(key).iter();
            let weight: u128 = counts.map(|&count| model.weighted(count)).sum();
            share(weight, touches) * value(own)
        });
        keys.sum::<f64>()
    };
    let mean = mean_of(&|value| value);
    (mean, mean_of(&|value| (value - mean) * (value - mean)))
}

/// Returns true if a sample is drawn, because it has fewer poses than each shape.
fn is_drawn(model: &Model, settings: &ClassifierSettings) -> bool {
    (settings.sample as u64) < model.poses()
}

/// The touches that vote: a random sample, or all touches.
struct Sample {
    /// The number of a key, a shape that leaves it, and the number of touches in which it does.
    touches: Vec<(usize, usize, u64)>,
    shapes: usize,
}

impl Sample {
    fn new(model: &Model, settings: &ClassifierSettings) -> Self {
        let shapes = model.shapes().len();
        let touches = if is_drawn(model, settings) {
            Self::drawn(model, settings)
        } else {
            let own = |key| {
                let counts = model.counts(key).iter();
                counts.map(move |count| (key, usize::from(count.shape), count.poses))
            };
            (0..model.keys().len()).flat_map(own).collect()
        };
        Self { touches, shapes }
    }

    /// Draws touches. Returns them in the order of their keys.
    fn drawn(model: &Model, settings: &ClassifierSettings) -> Vec<(usize, usize, u64)> {
        let mut random = Pcg64::seed_from_u64(settings.seed);
        let mut votes = BTreeMap::new();
        for (shape, draw) in Draw::all(model, |_| 1).iter().enumerate() {
            for key in (0..settings.sample).filter_map(|_| draw.key(&mut random)) {
                *votes.entry((key, shape)).or_insert(0) += 1;
            }
        }
        let votes = votes.into_iter();
        votes
            .map(|((key, shape), votes)| (key, shape, votes))
            .collect()
    }

    /// Returns minus the votes of each shape. All touches as near as the last neighbour vote too, since many touches
    /// have the same features.
    fn scores(&self, table: &FeatureTable, neighbours: usize, key: usize) -> Scores {
        let row = table.row(key);
        let mut last = (usize::MAX, 0.0);
        let mut distances: Vec<(f64, usize, u64)> = Vec::with_capacity(self.touches.len());
        for &(other, shape, votes) in &self.touches {
            if other != last.0 {
                let parts = row.iter().zip(table.row(other));
                last = (
                    other,
                    parts.map(|(one, two)| (one - two) * (one - two)).sum(),
                );
            }
            distances.push((last.1, shape, votes));
        }
        let mut scores = vec![0.0; self.shapes];
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
}

#[cfg(test)]
mod tests {
    use std::sync::atomic::{AtomicU64, Ordering};

    use super::*;
    use crate::figure::Figure;
    use crate::recognition::model::NamedShape;
    use crate::recognition::sets::GridSteps;
    use crate::recognition::training::Training;
    use crate::sensor::Sensor;

    #[test]
    fn a_sample_larger_than_the_poses_takes_all_poses() {
        let sensor = Sensor::default();
        let shapes = [
            ("square", Figure::rectangle(3.0, 3.0).on(&sensor)),
            ("bar", Figure::rectangle(6.0, 3.0).on(&sensor)),
        ];
        let shapes = shapes.map(|(name, figure)| NamedShape::new(name, figure.expect("in range")));
        let steps = GridSteps::new(10, 45).expect("divisors");
        let training = Training::fitting(shapes.to_vec(), steps).expect("they fit");
        let model = training.run().expect("not stopped");
        let reached = |sample, seed| {
            let settings = ClassifierSettings {
                sample,
                seed,
                neighbours: 3,
                ..ClassifierSettings::default()
            };
            Classifier::Knn.evaluate(&model, &settings)
        };
        let all = reached(usize::MAX, 0);
        assert_eq!((&all, all.sample), (&reached(usize::MAX, 1), None));
        let some = reached(5, 0);
        assert_eq!(some.sample.map(|sample| sample.per_shape), Some(5));
        assert_ne!(some.evaluation, all.evaluation);
    }

    #[test]
    fn the_progress_of_every_classifier_counts_all_keys() {
        let sensor = Sensor::default();
        let bar = Figure::rectangle(6.0, 3.0).on(&sensor).expect("in range");
        let steps = GridSteps::new(4, 45).expect("divisors");
        let training = Training::fitting(vec![NamedShape::new("bar", bar)], steps);
        let model = training.expect("it fits").run().expect("not stopped");
        for classifier in Classifier::ALL {
            let keys = AtomicU64::new(0);
            let add = |more| {
                keys.fetch_add(more, Ordering::Relaxed);
            };
            classifier.evaluate_with_progress(&model, &ClassifierSettings::default(), &add);
            assert_eq!(keys.into_inner(), model.keys().len() as u64);
        }
    }

    #[test]
    fn ties_go_to_the_first() {
        assert_eq!(first_two(&[2.0, 1.0, 1.0]), [Some(1), Some(2), Some(2)]);
        assert_eq!(first_two(&[2.0, 1.0, 3.0]), [Some(1), Some(0), None]);
        assert_eq!(first_two(&[2.0]), [Some(0), None, None]);
    }

    #[test]
    fn an_empty_imprint_does_not_remove_counts_from_the_features() {
        let sensor = Sensor::default();
        let shapes = [
            ("tri", Figure::triangle(1.2).on(&sensor)),
            ("bar", Figure::rectangle(6.0, 3.0).on(&sensor)),
        ];
        let shapes = shapes.map(|(name, figure)| NamedShape::new(name, figure.expect("in range")));
        let steps = GridSteps::new(10, 45).expect("divisors");
        let training = Training::fitting(shapes.to_vec(), steps).expect("they fit");
        let model = training.run().expect("not stopped");
        let table = FeatureTable::new(&model, None);
        let empty = GivenTable::new(&model);
        assert!(empty.descriptions().iter().any(Option::is_none));
        for count in ["na", "nae", "ce", "area"] {
            let kept = table.names.iter().any(|name| name == count);
            let copy = table.dropped.iter();
            let copy =
                copy.filter(|(name, reason)| name == count && *reason == "a copy of another");
            assert!(kept || copy.count() == 1, "{count}: {:?}", table.dropped);
        }
    }
}
