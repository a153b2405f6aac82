//! Answers where taxels fail.

use std::collections::HashMap;

use crate::imprint::Imprint;
use crate::recognition::answer::{Answer, AnswerState, judged, ranked};
use crate::recognition::model::Model;
use crate::recognition::noise::{Method, Noise, Scanner};

/// A model that is asked for many imprints under one noise. What it prepares for a size of matrix it keeps.
///
/// Its prior is that of every pose in every place on the matrix; see [`Noise`].
#[derive(Debug)]
pub struct NoisyRecogniser<'a> {
    model: &'a Model,
    noise: Noise,
    scanners: HashMap<(u8, u8), Scanner<'a>>,
}

impl<'a> NoisyRecogniser<'a> {
    /// Asks a model under a noise.
    pub fn new(model: &'a Model, noise: Noise) -> Self {
        Self {
            model,
            noise,
            scanners: HashMap::new(),
        }
    }

    /// Returns the noise.
    pub fn noise(&self) -> &Noise {
        &self.noise
    }

    /// Says which shape was touched, and which keys that took. Of several touches of one shape the probabilities are
    /// multiplied. With noise no answer is certain, since any shape may leave any imprint.
    pub fn recognise(
        &mut self,
        touches: &[Imprint],
        reject_below: Option<f64>,
    ) -> (Answer, Method) {
        let weights = self
            .model
            .shapes()
            .iter()
            .map(|shape| f64::from(shape.weight).ln());
        let mut logarithms: Vec<f64> = weights.collect();
        let mut method = Method::Exact;
        for touch in touches {
            let size = (touch.columns(), touch.rows());
            let scanner = self
                .scanners
                .entry(size)
                .or_insert_with(|| Scanner::new(self.model, size.0, size.1));
            let Some(distances) = scanner.distances(touch, &self.noise) else {
                logarithms.fill(f64::NEG_INFINITY);
                continue;
            };
            method = method.max(distances.method);
            let likelihoods = scanner.likelihoods(&distances, &self.noise);
            for ((sum, likelihood), shape) in logarithms
                .iter_mut()
                .zip(likelihoods)
                .zip(self.model.shapes())
            {
                *sum += likelihood.ln() - f64::from(shape.weight).ln();
            }
        }
        let most = logarithms.iter().copied().fold(f64::NEG_INFINITY, f64::max);
        let odds = |own: &f64| {
            if most.is_finite() {
                (own - most).exp()
            } else {
                0.0
            }
        };
        let odds: Vec<f64> = logarithms.iter().map(odds).collect();
        let sum: f64 = odds.iter().sum();
        let shares = odds
            .iter()
            .map(|own| if sum > 0.0 { own / sum } else { 0.0 });
        let ranking = ranked(shares.enumerate());
        let at_rim = touches.iter().any(Imprint::touches_rim);
        let mut answer = judged(ranking, at_rim, reject_below);
        if answer.state == AnswerState::Certain && self.noise.flip() > 0.0 {
            answer.state = AnswerState::Likely;
        }
        (answer, method)
    }
}
