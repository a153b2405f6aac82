//! Gaussians of the features, one for each class.

use std::iter;
use std::sync::Arc;

use nalgebra::{Cholesky, DMatrix, DVector, DVectorView, Dyn};

use crate::parameter::number::share;
use crate::recognition::classifiers::features::{FeatureTable, LEAST_VARIANCE};
use crate::recognition::model::Model;

/// The number added to a variance of 1, so that covariances of dependent features can be inverted. It is ten times as
/// large until rounding errors permit that.
const RIDGE: f64 = 0.001;

/// The Gaussian of one class.
pub(super) struct Gaussian {
    mean: DVector<f64>,
    spread: Spread,
    /// ln |Σ|.
    log_determinant: f64,
    /// −2 ln P(class).
    prior: f64,
}

/// The covariance Σ of a class.
#[derive(Clone)]
enum Spread {
    /// The variances of independent features.
    Diagonal(DVector<f64>),
    /// The factor of any covariance.
    Full(Arc<Cholesky<f64, Dyn>>),
}

impl Gaussian {
    /// Returns the Gaussian of each class, with independent features.
    pub(super) fn diagonal(model: &Model, table: &FeatureTable) -> Vec<Self> {
        let means = means(model, table);
        let mut variances = vec![DVector::zeros(table.names.len()); means.len()];
        each_deviation(model, table, &means, |shape, part, away| {
            variances[shape].zip_apply(away, |sum, away| *sum += part * away * away);
        });
        let spreads = variances.into_iter();
        let spreads = spreads.map(|own| Spread::Diagonal(own.add_scalar(LEAST_VARIANCE)));
        Self::all(model, means, spreads)
    }

    /// Returns the Gaussian of each class, with its own covariance, or with the mean covariance of all if `common`.
    pub(super) fn full(model: &Model, table: &FeatureTable, common: bool) -> Vec<Self> {
        let (means, width) = (means(model, table), table.names.len());
        let mut covariances = vec![DMatrix::zeros(width, width); means.len()];
        each_deviation(model, table, &means, |shape, part, away| {
            covariances[shape].ger(part, away, away, 1.0);
        });
        if !common {
            return Self::all(model, means, covariances.iter().map(Spread::full));
        }
        let mut pooled = DMatrix::zeros(width, width);
        for (shape, covariance) in model.shapes().iter().zip(covariances) {
            pooled += covariance * share(shape.weight.into(), model.weights());
        }
        Self::all(model, means, iter::repeat(Spread::full(&pooled)))
    }

    fn all(
        model: &Model,
        means: Vec<DVector<f64>>,
        spreads: impl Iterator<Item = Spread>,
    ) -> Vec<Self> {
        let classes = means.into_iter().zip(spreads).zip(model.shapes());
        classes
            .map(|((mean, spread), shape)| Self {
                mean,
                log_determinant: spread.log_determinant(),
                spread,
                prior: -2.0 * libm::log(share(shape.weight.into(), model.weights())),
            })
            .collect()
    }

    /// Returns the square of the distance of a key's features from the mean, in standard deviations.
    pub(super) fn distance(&self, row: &[f64]) -> f64 {
        match &self.spread {
            Spread::Diagonal(variances) => {
                let parts = row.iter().zip(self.mean.iter().zip(variances));
                parts
                    .map(|(value, (mean, variance))| (value - mean) * (value - mean) / variance)
                    .sum()
            }
            Spread::Full(factor) => {
                let away = vector(row) - &self.mean;
                away.dot(&factor.solve(&away))
            }
        }
    }

    /// Returns −2 ln of the density of a key's features times the prior of the class, up to a constant.
    pub(super) fn score(&self, row: &[f64]) -> f64 {
        self.distance(row) + self.log_determinant + self.prior
    }
}

impl Spread {
    /// Factors a covariance after adding the least ridge that makes this possible. Every finite covariance has one; of
    /// any other, only the variances are used.
    fn full(covariance: &DMatrix<f64>) -> Self {
        let ridges = iter::successors(Some(RIDGE), |ridge| Some(10.0 * ridge));
        let mut ridges = ridges.take_while(|ridge| ridge.is_finite());
        let factor = ridges.find_map(|ridge| {
            let mut covariance = covariance.clone();
            for index in 0..covariance.nrows() {
                covariance[(index, index)] += ridge;
            }
            Cholesky::new(covariance)
        });
        match factor {
            Some(factor) => Self::Full(Arc::new(factor)),
            None => Self::Diagonal(covariance.diagonal().add_scalar(RIDGE)),
        }
    }

    fn log_determinant(&self) -> f64 {
        let logarithms = |sides: &DVector<f64>| sides.iter().map(|&side| libm::log(side)).sum();
        match self {
            Self::Diagonal(variances) => logarithms(variances),
            Self::Full(factor) => 2.0 * logarithms(&factor.l_dirty().diagonal()),
        }
    }
}

/// Returns the mean of each class, over all its poses.
fn means(model: &Model, table: &FeatureTable) -> Vec<DVector<f64>> {
    let mut means = vec![DVector::zeros(table.names.len()); model.shapes().len()];
    for (key, shape, part) in pose_shares(model) {
        means[shape].axpy(part, &vector(table.row(key)), 1.0);
    }
    means
}

/// Calls `add` with each shape that leaves a key, the share of its poses that do, and the deviation of the key's
/// features from the mean of the shape.
fn each_deviation(
    model: &Model,
    table: &FeatureTable,
    means: &[DVector<f64>],
    mut add: impl FnMut(usize, f64, &DVector<f64>),
) {
    for (key, shape, part) in pose_shares(model) {
        add(shape, part, &(vector(table.row(key)) - &means[shape]));
    }
}

/// Iterates over the keys, the shapes that leave each, and the share of the shape's poses that do.
fn pose_shares(model: &Model) -> impl Iterator<Item = (usize, usize, f64)> + '_ {
    let poses = u128::from(model.poses());
    (0..model.keys().len()).flat_map(move |key| {
        let counts = model.counts(key).iter();
        counts.map(move |count| (key, count.shape.into(), share(count.poses.into(), poses)))
    })
}

/// Returns features as a vector.
fn vector(row: &[f64]) -> DVectorView<'_, f64> {
    DVectorView::from_slice(row, row.len())
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Twice the same feature, with a variance beside which the usual ridge is a rounding error.
    #[test]
    fn a_class_of_large_dependent_features_is_measured_in_its_own_deviations() {
        let variance = 1e20;
        let spread = Spread::full(&DMatrix::from_element(2, 2, variance));
        let log_determinant = spread.log_determinant();
        assert!((50.0..92.2).contains(&log_determinant), "{log_determinant}");
        let class = Gaussian {
            mean: DVector::zeros(2),
            spread,
            log_determinant,
            prior: 0.0,
        };
        let deviation = f64::sqrt(variance);
        let distance = class.distance(&[deviation, deviation]);
        assert!((distance - 1.0).abs() < 1e-3, "{distance}");
    }

    #[test]
    fn the_usual_ridge_is_enough_for_dependent_features() {
        let spread = Spread::full(&DMatrix::from_element(2, 2, 1.0));
        let exact = libm::log(2.0 * RIDGE + RIDGE * RIDGE);
        assert!((spread.log_determinant() - exact).abs() < 1e-9);
    }
}
