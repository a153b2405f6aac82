use crate::description::{RegionKind, regions};
use crate::imprint::Imprint;
use crate::parameter::named;
use crate::recognition::likelihood::{NEGLIGIBLE, Noise, SearchMethod};
use crate::recognition::model::Model;
use crate::recognition::posterior::{Odds, Posterior};
use crate::recognition::scan::Nearest;

/// The state of an answer: how far it can be trusted.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash)]
pub enum AnswerState {
    /// No other shape of the set leaves these imprints.
    Certain,
    /// Other shapes leave these imprints less often, an imprint may be cut off, or taxels may flip, so that any shape
    /// may leave any imprint.
    Likely,
    /// Another shape leaves these imprints just as often.
    Tied,
    /// The likeliest shape is less likely than required.
    Rejected,
    /// No shape of the set leaves these imprints.
    Unknown,
}

named!(
    AnswerState,
    "state",
    [
        Certain "certain",
        Likely "likely",
        Tied "tied",
        Rejected "rejected",
        Unknown "unknown",
    ]
);

/// The evidence: imprints of one shape in independent poses, how often taxels fail, and the least probability that is
/// enough for an answer.
#[derive(Clone, Copy, Debug)]
pub struct Evidence<'a> {
    touches: &'a [Imprint],
    noise: Option<&'a Noise>,
    /// An answer that is less probable than this, from 0 to 1, is rejected. With None, 0 or less, or NaN, no answer is
    /// rejected; with more than 1, every answer is.
    pub reject_below: Option<f64>,
}

impl<'a> Evidence<'a> {
    /// Creates evidence from touches of a sensor whose taxels never fail; any probability is enough for an answer. Each
    /// imprint lies on the whole matrix of its sensor ([`Model::recognise`]).
    pub fn of(touches: &'a [Imprint]) -> Self {
        Self {
            touches,
            noise: None,
            reject_below: None,
        }
    }

    /// Assumes that taxels fail as the noise says, and a prior uniform over poses and places. None means that taxels
    /// never fail.
    #[must_use]
    pub fn under(mut self, noise: impl Into<Option<&'a Noise>>) -> Self {
        self.noise = noise.into();
        self
    }
}

/// The shape that was touched, and how certain that is.
#[derive(Clone, Debug, PartialEq)]
pub struct Answer {
    /// How far the answer can be trusted.
    pub state: AnswerState,
    /// The number of the shape in the set; if several are tied, the first. None if rejected or unknown.
    pub shape: Option<usize>,
    /// All shapes that are equally likely, if the state is [`AnswerState::Tied`]; otherwise empty.
    pub tied: Vec<usize>,
    /// Whether an imprint reaches the rim of its matrix, or may reach it through dead taxels, so that it may be cut off.
    /// Such an answer is never certain.
    pub at_rim: bool,
    /// Every shape with a positive probability, the likeliest first; equally likely ones in the order of the set. Under
    /// noise, a shape may be missing if its probability is below 1e-9.
    pub ranking: Vec<(usize, f64)>,
    /// The keys that were compared; for several touches, those of the touch that needed the most.
    pub method: SearchMethod,
}

impl Model {
    /// Names the shape that was touched. Without any touch, the answer is the prior. If taxels may flip, no answer is
    /// certain, since any shape may leave any imprint.
    ///
    /// Touches are imprints on the whole matrix of their sensor, which may be of another size than the model's. One
    /// that is cropped to its taxels reaches the rim, so it may be cut off, and the answer is not certain
    /// ([`Answer::at_rim`]). The model must hold all poses: of a shard ([`Model::shard`]), only its own poses count.
    ///
    /// ```
    /// use taxel_core::prelude::*;
    /// use taxel_core::recognition::{AnswerState, Evidence, NamedShape, Training};
    ///
    /// let sensor = Sensor::default();
    /// let shapes = [
    ///     NamedShape::new("square", Figure::rectangle(4.0, 4.0).on(&sensor)?),
    ///     NamedShape::new("bar", Figure::rectangle(8.0, 2.0).on(&sensor)?),
    /// ];
    /// let ranges = Ranges::default().with(Axis::Angle, "0:345:15".parse()?);
    /// let model = Training::new(shapes, sensor, Anchor::Centre, ranges)?.run()?;
    ///
    /// let touch = "......\n.####.\n.####.\n.####.\n.####.\n......".parse()?;
    /// let answer = model.recognise(Evidence::of(&[touch]));
    /// assert_eq!((answer.state, answer.shape), (AnswerState::Certain, Some(0)));
    /// # Ok::<(), Box<dyn std::error::Error>>(())
    /// ```
    pub fn recognise(&self, evidence: Evidence<'_>) -> Answer {
        let dead = evidence.noise.and_then(Noise::dead);
        let at_rim = (evidence.touches.iter()).any(|touch| may_be_cut_off(touch, dead));
        let Some(noise) = evidence.noise else {
            let posterior = self.possible(evidence.touches);
            return decide(posterior, at_rim, evidence.reject_below);
        };
        let (posterior, method) = self.posterior_of_touches(noise, evidence.touches);
        let mut answer = decide(posterior, at_rim, evidence.reject_below);
        if answer.state == AnswerState::Certain && noise.flip() > 0.0 {
            answer.state = AnswerState::Likely;
        }
        Answer { method, ..answer }
    }

    /// Returns the probabilities of the shapes under a noise, and which keys were compared.
    fn posterior_of_touches(
        &self,
        noise: &Noise,
        touches: &[Imprint],
    ) -> (Posterior, SearchMethod) {
        let mut further = 0;
        loop {
            let (odds, method) = self.odds_under(noise, touches, further);
            let most = (odds.iter()).fold(f64::NEG_INFINITY, |most, [_, odds]| most.max(*odds));
            let sum = |which: usize| -> f64 {
                let own = odds.iter().map(|odds| odds[which]);
                own.map(|odds| libm::exp(odds - most)).sum()
            };
            let (least, all) = (sum(0), sum(1));
            // The sums are equal if nothing lies further away; `most` is not finite if no shape is possible.
            if all - least <= NEGLIGIBLE * least || !most.is_finite() {
                let odds: Vec<f64> = odds.into_iter().map(|[odds, _]| odds).collect();
                return (Posterior::of_logarithms(&odds, touches.len()), method);
            }
            further = 2 * further + 4;
        }
    }

    /// Returns a lower and an upper bound of ln(w Π P(touch | s)) for each shape, and which keys were compared. Takes
    /// `further` more distances into account than one touch needs.
    fn odds_under(
        &self,
        noise: &Noise,
        touches: &[Imprint],
        further: u32,
    ) -> (Vec<[f64; 2]>, SearchMethod) {
        // The logarithms to add up for each shape: of its weight, and both bounds of each touch.
        let weights = self.log_weights().into_iter();
        let mut parts: Vec<[Vec<f64>; 2]> =
            weights.map(|weight| [vec![weight], vec![weight]]).collect();
        let mut method = SearchMethod::Exact;
        for touch in touches {
            let Some(distances) = self.distances_further(touch, noise, further) else {
                let bounds = parts.iter_mut().flatten();
                bounds.for_each(|own| own.push(f64::NEG_INFINITY));
                continue;
            };
            method = method.max(distances.method);
            let likelihoods = self.log_likelihoods(touch, &distances, noise);
            for ([lower, upper], likelihood) in parts.iter_mut().zip(likelihoods) {
                lower.push(likelihood[0]);
                upper.push(likelihood[1]);
            }
        }
        // Sorted, so that their sum does not depend on the order of the touches.
        let sum = |mut parts: Vec<f64>| -> f64 {
            parts.sort_by(f64::total_cmp);
            parts.into_iter().sum()
        };
        (
            parts.into_iter().map(|bounds| bounds.map(sum)).collect(),
            method,
        )
    }

    /// Returns the probabilities of the shapes that leave all of the touches.
    fn possible(&self, touches: &[Imprint]) -> Posterior {
        let shapes = self.shapes().iter();
        let mut factors: Vec<Vec<u64>> = shapes.map(|shape| vec![shape.weight.into()]).collect();
        for touch in touches {
            let mut counts = self.counts_of(touch).iter().peekable();
            for (shape, factors) in factors.iter_mut().enumerate() {
                let own = counts.next_if(|count| usize::from(count.shape) == shape);
                factors.push(own.map_or(0, |own| own.poses));
            }
        }
        let odds = factors.into_iter().map(Odds::of).enumerate();
        let odds = odds.filter_map(|(shape, odds)| Some((shape, odds?)));
        Posterior::of_odds(odds.collect())
    }

    /// Returns the imprint of the model that is nearest to the first touch that no shape leaves, or to the last touch
    /// if shapes leave all of them. Dead taxels of the noise are left out. None without a touch, or if no key fits its
    /// matrix.
    pub fn nearest_of(&self, evidence: Evidence<'_>) -> Option<Nearest> {
        let dead = evidence.noise.and_then(Noise::dead);
        let mut last = None;
        for touch in evidence.touches {
            last = self.nearest_without(touch, dead);
            if last.as_ref().is_none_or(|near| near.distance > 0) {
                break;
            }
        }
        last
    }
}

/// Returns true if the shape may reach beyond the matrix: a living taxel on the rim is active, or dead ones, which may
/// be covered, lead from an active taxel to the rim.
fn may_be_cut_off(touch: &Imprint, dead: Option<&Imprint>) -> bool {
    let Some(dead) = dead else {
        return touch.touches_rim();
    };
    let living = touch.without(dead);
    let pieces = regions(&touch.union(dead)).into_iter();
    let mut pieces = pieces.filter(|region| region.kind() == RegionKind::Exterior);
    pieces.any(|piece| {
        let taxels = piece.taxels();
        taxels.touches_rim() && !taxels.intersection(&living).is_empty()
    })
}

fn decide(posterior: Posterior, at_rim: bool, reject_below: Option<f64>) -> Answer {
    let Posterior {
        ranking,
        likeliest,
        possible,
    } = posterior;
    let mut answer = Answer {
        state: AnswerState::Unknown,
        shape: None,
        tied: Vec::new(),
        at_rim,
        ranking,
        method: SearchMethod::Exact,
    };
    let Some(&(first, most)) = answer.ranking.first() else {
        return answer;
    };
    answer.shape = Some(first);
    answer.state = if reject_below.is_some_and(|least| most < least) {
        answer.shape = None;
        AnswerState::Rejected
    } else if likeliest > 1 {
        let tied = answer.ranking.iter().take(likeliest);
        answer.tied = tied.map(|&(shape, _)| shape).collect();
        AnswerState::Tied
    } else if possible == 1 && !at_rim {
        AnswerState::Certain
    } else {
        AnswerState::Likely
    };
    answer
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn an_imprint_may_be_cut_off_at_the_rim_also_behind_dead_taxels() {
        let imprint = |text: &str| -> Imprint { text.parse().expect("an imprint") };
        let touch = imprint("......\n......\n..##..\n......\n......");
        for (dead, expected) in [
            // One dead taxel does not lead to the rim, two do.
            ("......\n......\n.#....\n......\n......", false),
            ("......\n......\n##....\n......\n......", true),
            ("#.....\n.#....\n......\n......\n......", true),
            ("#.....\n......\n......\n......\n......", false),
            // The bar itself may be dead: then nothing is known to be active.
            ("......\n......\n######\n......\n......", false),
        ] {
            assert_eq!(
                may_be_cut_off(&touch, Some(&imprint(dead))),
                expected,
                "{dead}"
            );
        }
        assert!(!may_be_cut_off(&touch, None));
        let touch = imprint("..#\n...");
        assert!(may_be_cut_off(&touch, None));
        // A dead taxel that is active says nothing.
        assert!(!may_be_cut_off(&touch, Some(&imprint("..#\n..."))));
    }
}
