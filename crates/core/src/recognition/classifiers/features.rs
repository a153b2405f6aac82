use std::collections::HashMap;

use crate::atlas::{feature_values, features};
use crate::description::{Description, Descriptor, ExactValue, Value};
use crate::parameter::number::share;
use crate::recognition::given::{GivenTable, ShapeDescriptor};
use crate::recognition::model::Model;

/// The number added to single variances, which only have to differ from 0.
pub(super) const LEAST_VARIANCE: f64 = 1e-9;

/// The features of all keys, in units of their deviation.
pub(super) struct FeatureTable {
    pub(super) names: Vec<String>,
    pub(super) dropped: Vec<(String, &'static str)>,
    /// A row of features for each key.
    values: Vec<f64>,
}

impl FeatureTable {
    pub(super) fn new(model: &Model, descriptors: Option<&[ShapeDescriptor]>) -> Self {
        let table = GivenTable::new(model);
        let keys = table.descriptions().len();
        let wanted =
            |key: &str| descriptors.is_none_or(|own| own.iter().any(|one| one.key() == key));
        let (mut names, mut dropped) = (Vec::new(), Vec::new());
        let mut kept: Vec<(Vec<f64>, f64, f64)> = Vec::new();
        for (name, descriptor, column) in columns(table.descriptions()) {
            if descriptor.changes_under.shift || !wanted(descriptor.key) {
                continue;
            }
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
        let mut values = vec![0.0; keys * kept.len()];
        for (index, (column, mean, variance)) in kept.iter().enumerate() {
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

    pub(super) fn row(&self, key: usize) -> &[f64] {
        &self.values[key * self.names.len()..][..self.names.len()]
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
    for (feature, column) in features().iter().zip(&mut columns) {
        equalise(column, descriptions, feature.descriptor);
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

/// Makes the values of a feature equal where its descriptor is exactly equal: computed from other sums, they differ by a
/// rounding error, and nearest neighbours would then not be equally near.
fn equalise(
    column: &mut [f64],
    descriptions: &[Option<Description>],
    descriptor: &'static Descriptor,
) {
    let mut known: HashMap<ExactValue, f64> = HashMap::new();
    for (value, description) in column.iter_mut().zip(descriptions) {
        if let Some(description) = description {
            *value = *known
                .entry((descriptor.exact)(description))
                .or_insert(*value);
        }
    }
}

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

#[cfg(test)]
mod tests {
    use super::*;
    use crate::figure::Figure;
    use crate::recognition::model::NamedShape;
    use crate::recognition::sets::GridSteps;
    use crate::recognition::training::Training;
    use crate::sensor::Sensor;

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
