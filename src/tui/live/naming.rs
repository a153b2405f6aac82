//! The answers of a model about the shown imprint: the likeliest shape and the nearest imprint, while frames arrive.
//!
//! A worker answers one imprint at a time, always the newest; neither its training nor its search delays drawing.

use crate::imprint::Imprint;
use crate::recognition::{AnswerState, Evidence, Model, Noise, UnexplainedDifference};
use crate::storage::ModelChoice;

#[derive(Clone, Debug, PartialEq)]
pub struct NamedImprint {
    pub imprint: Imprint,
    pub state: AnswerState,
    /// The likeliest shapes: one, several in a tie, or none for an imprint that no shape leaves.
    pub names: Vec<String>,
    pub probability: Option<f64>,
    pub nearest: Option<(String, u32)>,
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

#[derive(Clone, Debug, PartialEq)]
pub struct NamingRequest {
    /// The number of this request. Answers carry it, so late ones of an earlier model can be dropped.
    pub number: u64,
    pub choice: ModelChoice,
    /// The noise: how often a taxel flips.
    pub noise: Option<Noise>,
}

#[derive(Clone, Debug)]
pub struct Naming {
    pub request: NamingRequest,
    pub answer: Option<Box<NamedImprint>>,
    pub failure: Option<String>,
    asked: bool,
}

impl Naming {
    pub fn new(request: NamingRequest) -> Self {
        Self {
            request,
            answer: None,
            failure: None,
            asked: false,
        }
    }

    pub fn ask(&mut self, imprint: &Imprint) -> bool {
        let known = self
            .answer
            .as_ref()
            .is_some_and(|own| own.imprint == *imprint);
        let asks = !self.asked && !known && self.failure.is_none() && !imprint.is_empty();
        self.asked |= asks;
        asks
    }

    pub fn take(&mut self, answer: NamedImprint) {
        self.asked = false;
        self.answer = Some(Box::new(answer));
    }

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
