//! The value of descriptors: the limit of one touch if only some descriptors of the imprint are known.

use std::collections::HashMap;

use rayon::prelude::*;

use crate::atlas::ImprintSummary;
use crate::description::{DESCRIPTORS, Description, Descriptor, Dimension, ExactValue, Value};

use crate::quote::{did_you_mean, shortened};
use crate::recognition::evaluation::Evaluation;
use crate::recognition::model::{Model, ShapeCount, add_count};

/// A descriptor that says something about the shape, because it does not change when the imprint is moved.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash)]
pub struct ShapeDescriptor(usize);

/// The error for a text that is not a list of descriptors, or not a rounding.
#[derive(Clone, Debug, PartialEq, Eq, thiserror::Error)]
#[error("{0}")]
pub struct GivenError(String);

impl ShapeDescriptor {
    /// Iterates over all of them, in the order of [`DESCRIPTORS`].
    pub fn all() -> impl Iterator<Item = Self> {
        let all = 0..DESCRIPTORS.len();
        all.filter(|&row| !DESCRIPTORS[row].of_place).map(Self)
    }

    /// Returns the row of the descriptor in the table.
    pub fn descriptor(self) -> &'static Descriptor {
        &DESCRIPTORS[self.0]
    }

    /// Returns the name used in JSON.
    pub fn key(self) -> &'static str {
        self.descriptor().key
    }

    /// Returns the value in a description, in steps if it is rounded. An empty imprint has no description; its counts
    /// are 0, so in large steps they equal small ones.
    fn value(self, roundings: &[Rounding], description: Option<&Description>) -> ExactValue {
        let own = self.descriptor();
        match roundings
            .iter()
            .find(|rounding| rounding.descriptor == self)
        {
            Some(rounding) => rounding.rounded(description.map_or(own.of_nothing, own.measure)),
            None => (own.exact)(description?),
        }
    }
}

impl std::str::FromStr for ShapeDescriptor {
    type Err = GivenError;

    fn from_str(text: &str) -> Result<Self, GivenError> {
        let text = text.trim();
        if let Some(own) = Self::all().find(|own| own.key() == text) {
            return Ok(own);
        }
        let keys: Vec<&str> = Self::all().map(Self::key).collect();
        let expected = format!("expected one of {}", keys.join(", "));
        Err(GivenError(if Descriptor::from_key(text).is_some() {
            format!("{text} depends on the position of the imprint; {expected}")
        } else {
            let (found, guess) = (shortened(text), did_you_mean(&shortened(text), keys));
            format!("descriptor {found:?} is unknown, {expected}{guess}")
        }))
    }
}

/// A descriptor that is measured in steps: values are rounded to the nearest multiple of the step. As text, its key and
/// the step: `cg_cd=0.01`.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Rounding {
    /// The descriptor that is measured in steps.
    pub descriptor: ShapeDescriptor,
    /// The step in the descriptor's own unit, from 1e-9 to 1e9.
    pub step: f64,
}

impl std::str::FromStr for Rounding {
    type Err = GivenError;

    fn from_str(text: &str) -> Result<Self, GivenError> {
        let error = || no_rounding(&shortened(text));
        let (descriptor, step) = text.split_once('=').ok_or_else(error)?;
        let step = step.trim().parse().map_err(|_| error())?;
        let descriptor = descriptor.parse()?;
        let rounding = Self { descriptor, step };
        // Below this a step is finer than the numbers themselves.
        if (1e-9..=1e9).contains(&step) {
            Ok(rounding)
        } else {
            Err(no_rounding(&rounding.to_string()))
        }
    }
}

fn no_rounding(found: &str) -> GivenError {
    GivenError(format!(
        "rounding {found:?}: expected a descriptor and a step from 1e-9 to 1e9, such as cg_cd=0.01"
    ))
}

impl std::fmt::Display for Rounding {
    fn fmt(&self, f: &mut std::fmt::Formatter<'_>) -> std::fmt::Result {
        write!(f, "{}={}", self.descriptor.key(), self.step)
    }
}

/// Descriptors that are known instead of the imprint itself; as text, their keys separated by commas: `na,p`. The text
/// leaves out the roundings, which have texts of their own.
///
/// Two imprints count as the same if all given descriptors of their main regions agree. Descriptors are compared
/// exactly ([`Descriptor::exact`]), or in steps of a [`Rounding`]. A missing value agrees only with a missing value.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct GivenDescriptors {
    /// The descriptors.
    pub descriptors: Vec<ShapeDescriptor>,
    /// The roundings of some of them.
    pub roundings: Vec<Rounding>,
}

impl GivenDescriptors {
    /// Returns the limit of one touch if only these descriptors are known.
    pub fn evaluate(&self, model: &Model) -> Evaluation {
        self.evaluate_described(model, &descriptions(model))
    }

    fn evaluate_described(
        &self,
        model: &Model,
        descriptions: &[Option<Description>],
    ) -> Evaluation {
        // Keys with the same values are one class; classes are in the order of their first keys.
        let mut classes: HashMap<Vec<ExactValue>, usize> = HashMap::new();
        let mut counts: Vec<Vec<ShapeCount>> = Vec::new();
        for (key, description) in descriptions.iter().enumerate() {
            let values = self.values(description.as_ref());
            let class = *classes.entry(values).or_insert(counts.len());
            if class == counts.len() {
                counts.push(Vec::new());
            }
            for &count in model.counts(key) {
                add_count(&mut counts[class], count);
            }
        }
        Evaluation::of_classes(model, counts.iter().map(Vec::as_slice))
    }

    fn values(&self, description: Option<&Description>) -> Vec<ExactValue> {
        let own = self.descriptors.iter();
        own.map(|own| own.value(&self.roundings, description))
            .collect()
    }
}

impl std::str::FromStr for GivenDescriptors {
    type Err = GivenError;

    fn from_str(text: &str) -> Result<Self, GivenError> {
        let descriptors = text.split(',').map(str::parse);
        let descriptors = descriptors.collect::<Result<_, _>>()?;
        Ok(Self {
            descriptors,
            roundings: Vec::new(),
        })
    }
}

/// Returns the description of each key, in their order; None for the empty key.
pub(super) fn descriptions(model: &Model) -> Vec<Option<Description>> {
    let describe = |key| ImprintSummary::of(&model.keys().imprint(key)?).description;
    let keys = (0..model.keys().len()).into_par_iter();
    keys.with_min_len(256).map(describe).collect()
}

impl Rounding {
    /// Returns the number of steps that is nearest to a number. Directions of 180° and −180° are the same one, if a
    /// whole number of steps makes a turn.
    #[expect(
        clippy::cast_possible_truncation,
        reason = "values of descriptors over a step of at least 1e-9 are far below 2⁶³"
    )]
    fn steps(&self, number: f64) -> i64 {
        let (steps, turn) = (round(number / self.step) as i64, 360.0 / self.step);
        let is_circular = self.descriptor.descriptor().dimension == Dimension::Direction;
        let whole_turn = turn.round();
        // A quotient of decimals may be off by a rounding error.
        let is_whole = (turn - whole_turn).abs() <= 4.0 * f64::EPSILON * turn;
        if is_circular && whole_turn >= 1.0 && is_whole {
            steps.rem_euclid(whole_turn as i64)
        } else {
            steps
        }
    }

    fn rounded(&self, value: Value) -> ExactValue {
        let (mut rounded, mut index) = ([0; 4], 0);
        value.each(|number| {
            rounded[index] = self.steps(number);
            index += 1;
        });
        (index > 0).then_some(rounded)
    }
}

/// Rounds to the nearest whole number. Equal values that were computed in different ways differ by rounding errors,
/// which must not separate them half way between two steps: there, all are rounded away from zero.
fn round(steps: f64) -> f64 {
    let halves = (2.0 * steps).round();
    let error = f64::max(1e-9, 16.0 * f64::EPSILON * steps.abs());
    if (2.0 * steps - halves).abs() <= error {
        (halves / 2.0).round()
    } else {
        steps.round()
    }
}

/// A descriptor that [`Model::choose_descriptors`] has chosen.
#[derive(Clone, Debug, PartialEq)]
pub struct ChosenDescriptor {
    /// The descriptor.
    pub descriptor: ShapeDescriptor,
    /// The limit of one touch if this descriptor and all those chosen before it are known.
    pub evaluation: Evaluation,
}

impl Model {
    /// Chooses descriptors one by one: each time the one with which the most touches are named right (among equals, the
    /// first in the table), until no descriptor improves the result. Returns them in the order in which they were
    /// chosen.
    pub fn choose_descriptors(&self, roundings: &[Rounding]) -> Vec<ChosenDescriptor> {
        let descriptions = descriptions(self);
        let mut given = GivenDescriptors {
            descriptors: Vec::new(),
            roundings: roundings.to_vec(),
        };
        let mut right = given.evaluate_described(self, &descriptions).right;
        let mut chosen = Vec::new();
        loop {
            let mut best = None;
            for descriptor in ShapeDescriptor::all() {
                if given.descriptors.contains(&descriptor) {
                    continue;
                }
                given.descriptors.push(descriptor);
                let evaluation = given.evaluate_described(self, &descriptions);
                given.descriptors.pop();
                if evaluation.right > right {
                    right = evaluation.right;
                    best = Some(ChosenDescriptor {
                        descriptor,
                        evaluation,
                    });
                }
            }
            let Some(best) = best else {
                return chosen;
            };
            given.descriptors.push(best.descriptor);
            chosen.push(best);
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn both_ends_of_a_turn_are_one_direction() {
        let steps = |text: &str, numbers: [f64; 3]| {
            let rounding: Rounding = text.parse().expect("a rounding");
            numbers.map(|number| rounding.steps(number))
        };
        let (turn, numbers) = ("cg_cd_direction=", [180.0, -179.9, -80.0]);
        assert_eq!(steps(&format!("{turn}180"), numbers), [1, 1, 0]);
        assert_eq!(steps(&format!("{turn}30"), numbers), [6, 6, 9]);
        assert_eq!(steps("cg_cd=30", numbers), [6, -6, -3]);
        // A turn is not a whole number of these steps.
        assert_eq!(steps(&format!("{turn}7"), numbers), [26, -26, -11]);
        assert_eq!(steps(&format!("{turn}720"), numbers), [0, 0, 0]);
    }

    #[test]
    fn rounding_errors_do_not_separate_equal_values_between_two_steps() {
        let rounding: Rounding = "cg_cd_direction=10".parse().expect("a rounding");
        let below = 45.0_f64.next_down().next_down();
        assert_eq!(
            [below, 45.0, 44.99].map(|own| rounding.steps(own)),
            [5, 5, 4]
        );
        assert_eq!([-below, -45.0].map(|own| rounding.steps(own)), [31, 31]);
    }

    #[test]
    fn steps_are_from_a_billionth_to_a_billion() {
        let is_read = |step: &str| format!("cg_cd={step}").parse::<Rounding>().is_ok();
        assert!(is_read("1e-9") && is_read("1e9"));
        for step in ["9e-10", "1.1e9", "0", "-1", "NaN", "inf"] {
            assert!(!is_read(step), "{step}");
        }
    }
}
