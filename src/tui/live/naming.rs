//! The answers of a model about the shown imprint: the likeliest shape and the nearest imprint, while frames arrive.
//!
//! A worker answers one imprint at a time, always the newest; neither its training nor its search delays drawing.

use crate::imprint::Imprint;
use crate::recognition::{AnswerState, Evidence, Model, Noise, UnexplainedDifference};
use crate::storage::ModelChoice;

/// The answer of a model about an imprint.
#[derive(Clone, Debug, PartialEq)]
pub struct NamedImprint {
    /// The imprint.
    pub imprint: Imprint,
    /// How far the answer can be trusted.
    pub state: AnswerState,
    /// The likeliest shapes: one, several in a tie, or none for an imprint that no shape leaves.
    pub names: Vec<String>,
    /// The probability of the likeliest shape.
    pub probability: Option<f64>,
    /// The shape with the nearest imprint, and the number of taxels in which that imprint differs.
    pub nearest: Option<(String, u32)>,
    /// The difference to the nearest imprint, if the noise does not explain it.
    pub unexplained: Option<UnexplainedDifference>,
}

impl NamedImprint {
    /// Computes the answer of a model about an imprint, under a noise if one is given. A single touch is the
    /// evidence, because the frames of a source may show different shapes.
    pub fn new(model: &Model, imprint: &Imprint, noise: Option<&Noise>) -> Self {
        let touches = [*imprint];
        let evidence = Evidence::of(&touches).under(noise);
        let answer = model.recognise(evidence);
        let name = |shape: usize| model.shapes()[shape].name.clone();
        let shapes = match answer.state {
            AnswerState::Tied => answer.tied,
            _ => answer.shape.into_iter().collect(),
        };
        let nearest = model.nearest_of(evidence);
        let distance = nearest.as_ref().map_or(0, |nearest| nearest.distance);
        let unexplained = noise.and_then(|noise| noise.unexplained(imprint, distance));
        Self {
            imprint: *imprint,
            state: answer.state,
            names: shapes.into_iter().map(name).collect(),
            probability: answer.ranking.first().map(|&(_, probability)| probability),
            nearest: nearest.map(|nearest| (name(nearest.shape), nearest.distance)),
            unexplained: unexplained.filter(|_| !answer.ranking.is_empty()),
        }
    }
}

/// A request to name the imprints of frames by a model.
#[derive(Clone, Debug, PartialEq)]
pub struct NamingRequest {
    /// The number of this request. Answers carry it, so late ones of an earlier model can be dropped.
    pub number: u64,
    /// The set of shapes.
    pub choice: ModelChoice,
    /// The noise: how often a taxel flips.
    pub noise: Option<Noise>,
}

/// The model of the page, and its last answer.
#[derive(Clone, Debug)]
pub struct Naming {
    /// The request that is answered.
    pub request: NamingRequest,
    /// The last answer.
    pub answer: Option<Box<NamedImprint>>,
    /// Why there are no answers.
    pub failure: Option<String>,
    /// Whether an answer is on its way.
    asked: bool,
}

impl Naming {
    /// Creates the state without any answer.
    pub fn new(request: NamingRequest) -> Self {
        Self {
            request,
            answer: None,
            failure: None,
            asked: false,
        }
    }

    /// Returns true if an imprint is to be asked for now, and notes that it is.
    pub fn ask(&mut self, imprint: &Imprint) -> bool {
        let known = self
            .answer
            .as_ref()
            .is_some_and(|own| own.imprint == *imprint);
        let asks = !self.asked && !known && self.failure.is_none() && !imprint.is_empty();
        self.asked |= asks;
        asks
    }

    /// Takes an answer.
    pub fn take(&mut self, answer: NamedImprint) {
        self.asked = false;
        self.answer = Some(Box::new(answer));
    }

    /// Notes why there are no answers.
    pub fn fail(&mut self, reason: String) {
        self.asked = false;
        self.failure = Some(reason);
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::sensor::MatrixSize;

    #[test]
    fn one_imprint_is_asked_for_at_a_time_and_none_twice() {
        let mut naming = Naming::new(NamingRequest {
            number: 1,
            choice: ModelChoice::Figures,
            noise: None,
        });
        let [one, other]: [Imprint; 2] = ["##", "#."].map(|text| text.parse().expect("rows"));
        assert!(!naming.ask(&Imprint::empty(
            MatrixSize::new(2, 1).expect("an allowed size")
        )));
        assert!(naming.ask(&one));
        assert!(!naming.ask(&other));
        naming.take(NamedImprint {
            imprint: one,
            state: AnswerState::Unknown,
            names: Vec::new(),
            probability: None,
            nearest: None,
            unexplained: None,
        });
        assert!(!naming.ask(&one));
        assert!(naming.ask(&other));
        naming.fail("no model".to_owned());
        assert!(!naming.ask(&other));
    }
}
