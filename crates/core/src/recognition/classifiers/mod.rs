//! Classifiers that use descriptors of the imprint, as the paper does, and their results compared with the limit of
//! one touch.

mod features;

mod knn;

use rayon::prelude::*;

use crate::parameter::named;
use crate::parameter::number::share;
use crate::progress::Progress;
use crate::recognition::classifiers::features::{FeatureTable, LEAST_VARIANCE};
use crate::recognition::classifiers::knn::Sample;
use crate::recognition::confusion::ConfusionMatrix;
use crate::recognition::evaluation::Evaluation;
use crate::recognition::given::ShapeDescriptor;
use crate::recognition::model::Model;
use crate::recognition::templates::Templates;

pub use knn::PoseSample;

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

impl Classifier {
    /// All classifiers.
    pub const ALL: &'static [Self] = &[Self::Z, Self::Knn, Self::Template];

    /// Returns the name used on the command line.
    pub const fn name(self) -> &'static str {
        match self {
            Self::Z => "z",
            Self::Knn => "knn",
            Self::Template => "template",
        }
    }
}

named!(Classifier, "classifier", Classifier::ALL);

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
    /// The poses that [`Classifier::Knn`] drew at random; None for the other classifiers.
    pub sample: Option<PoseSample>,
}

type Scores = Vec<f64>;

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
        let evaluate =
            |scores: &(dyn Fn(usize) -> Scores + Sync)| evaluate(model, scores, progress);
        let features = || FeatureTable::new(model, settings.descriptors.as_deref());
        let sample = PoseSample {
            per_shape: settings.sample,
            seed: settings.seed,
        };
        let (evaluation, table) = match self {
            Self::Z => {
                let table = features();
                let classes = ClassMean::all(model, &table);
                let scores = |key| {
                    let row = table.row(key);
                    classes.iter().map(|class| class.distance(row)).collect()
                };
                (evaluate(&scores)?, Some(table))
            }
            Self::Knn => {
                let table = features();
                let touches = Sample::new(model, sample);
                let scores = |key| touches.scores(&table, settings.neighbours.max(1), key);
                (evaluate(&scores)?, Some(table))
            }
            Self::Template => {
                let templates = Templates::new(model, settings.templates.max(1));
                (evaluate(&|key| templates.scores(model, key))?, None)
            }
        };
        // For templates, imprints are compared, not features.
        let (features, dropped) = table
            .map(|table| (table.names, table.dropped))
            .unwrap_or_default();
        Some(ClassifierEvaluation {
            classifier: self,
            evaluation,
            features,
            dropped,
            sample: (self == Self::Knn && sample.is_drawn(model)).then_some(sample),
        })
    }
}

/// The mean of each feature over the poses of a class, and its variance.
struct ClassMean(Vec<(f64, f64)>);

impl ClassMean {
    fn all(model: &Model, table: &FeatureTable) -> Vec<Self> {
        let poses = u128::from(model.poses());
        let mut classes: Vec<_> = (model.shapes().iter())
            .map(|_| Self(vec![(0.0, LEAST_VARIANCE); table.names.len()]))
            .collect();
        let mut each = |add: fn(&mut (f64, f64), f64, f64)| {
            for key in 0..model.keys().len() {
                for count in model.counts(key) {
                    let part = share(count.poses.into(), poses);
                    let class = &mut classes[usize::from(count.shape)].0;
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

    /// Returns the square of the distance of a key's features from the mean, in standard deviations.
    fn distance(&self, row: &[f64]) -> f64 {
        let parts = row.iter().zip(&self.0);
        parts
            .map(|(value, (mean, variance))| (value - mean) * (value - mean) / variance)
            .sum()
    }
}

fn evaluate(
    model: &Model,
    scores: &(dyn Fn(usize) -> Scores + Sync),
    progress: &dyn Progress,
) -> Option<Evaluation> {
    let ranked = (0..model.keys().len()).into_par_iter().map(|key| {
        let ranked = first_two(&scores(key));
        progress.add(1).is_continue().then_some(ranked)
    });
    let ranked: Vec<[Option<usize>; 3]> = ranked.collect::<Option<_>>()?;
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
    Some(evaluation.finished())
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

#[cfg(test)]
mod tests {
    use std::sync::atomic::{AtomicU64, Ordering};

    use super::*;
    use crate::figure::Figure;
    use crate::progress::{ToTheEnd, stop_if};
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
            let reached = Classifier::Knn.evaluate(&model, &settings, &ToTheEnd);
            reached.expect("not stopped")
        };
        let all = reached(usize::MAX, 0);
        assert_eq!((&all, all.sample), (&reached(usize::MAX, 1), None));
        let some = reached(5, 0);
        assert_eq!(some.sample.map(|sample| sample.per_shape), Some(5));
        assert_ne!(some.evaluation, all.evaluation);
    }

    #[test]
    fn every_classifier_reports_all_keys_and_can_be_stopped() {
        let sensor = Sensor::default();
        let bar = Figure::rectangle(6.0, 3.0).on(&sensor).expect("in range");
        let steps = GridSteps::new(4, 45).expect("divisors");
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
        assert_eq!(first_two(&[2.0, 1.0, 1.0]), [Some(1), Some(2), Some(2)]);
        assert_eq!(first_two(&[2.0, 1.0, 3.0]), [Some(1), Some(0), None]);
        assert_eq!(first_two(&[2.0]), [Some(0), None, None]);
    }

    #[test]
    fn examples() -> Result<(), Box<dyn std::error::Error>> {
        use crate::progress::ToTheEnd;
        use crate::recognition::{
            Classifier, ClassifierSettings, Evaluation, GridSteps, Training, equal_figures,
        };
        let model = Training::fitting(equal_figures(), GridSteps::new(4, 15)?)?.run()?;
        let settings = ClassifierSettings::default();
        let result = Classifier::Knn
            .evaluate(&model, &settings, &ToTheEnd)
            .expect("not stopped");
        // No classifier of one touch is better than the model.
        assert!(result.evaluation.right <= Evaluation::of(&model).right);
        Ok(())
    }
}
