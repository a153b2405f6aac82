use crate::description::{Description, RegionKind, main_region, regions};
use crate::imprint::Imprint;
use crate::parameter::named;
use crate::recognition::fit::Fit;
use crate::recognition::likelihood::{NEGLIGIBLE, Noise, SearchMethod};
use crate::recognition::model::{Model, first_of_most};
use crate::recognition::posterior::{Odds, Posterior};
use crate::recognition::scan::Nearest;

/// The state of an answer: how far it can be trusted.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash)]
pub enum AnswerState {
    /// The model holds these imprints, and no other shape of the set leaves them in its poses.
    Certain,
    /// The shape fits, but others may, too: they leave these imprints less often, an imprint may be cut off, or taxels
    /// may flip, so that any shape may leave any imprint.
    Likely,
    /// Another shape is just as likely and fits as well.
    Tied,
    /// The shape is less likely than required.
    Rejected,
    /// No shape of the set fits.
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

/// The evidence: imprints of one shape in independent poses, how often taxels fail, and what is enough for an answer.
#[derive(Clone, Copy, Debug)]
pub struct Evidence<'a> {
    touches: &'a [Imprint],
    noise: Option<&'a Noise>,
    dead: Option<&'a Imprint>,
    /// A shape fits a touch if at most this many taxels differ. With None, 2 and one for every 20 taxels of the outline
    /// (CE of the main region); under a given noise at least as many as flip in 999 of 1,000 touches.
    pub tolerance: Option<u32>,
    /// An answer that is less probable than this, from 0 to 1, is rejected. With None, 0 or less, or NaN, no answer is
    /// rejected; with more than 1, every answer is.
    pub reject_below: Option<f64>,
}

impl<'a> Evidence<'a> {
    /// Creates evidence from touches whose taxels do not fail; any probability is enough for an answer. Each imprint
    /// lies on the whole matrix of its sensor ([`Model::recognise`]).
    pub fn of(touches: &'a [Imprint]) -> Self {
        Self {
            touches,
            noise: None,
            dead: None,
            tolerance: None,
            reject_below: None,
        }
    }

    /// Assumes that taxels fail as the noise says. Without any flips, only the imprints of the model's own poses count,
    /// and nothing is fitted. None leaves the evidence as it is.
    #[must_use]
    pub fn under(mut self, noise: impl Into<Option<&'a Noise>>) -> Self {
        self.noise = noise.into().or(self.noise);
        self
    }

    /// Leaves the active taxels of `dead` out, in place of those of the noise: they are stuck on or off, or there is no
    /// taxel. None leaves the evidence as it is.
    #[must_use]
    pub fn without(mut self, dead: impl Into<Option<&'a Imprint>>) -> Self {
        self.dead = dead.into().or(self.dead);
        self
    }

    /// Returns the noise that ranks the shapes.
    fn noise(&self) -> Noise {
        let noise = self.noise.copied().unwrap_or_default();
        self.dead.map_or(noise, |&dead| noise.with_dead(dead))
    }

    /// Returns how many taxels may differ from a fit of a touch.
    fn tolerance(&self, touch: &Imprint) -> u32 {
        self.tolerance.unwrap_or_else(|| {
            let regions = regions(touch);
            let main = main_region(&regions).map(|main| Description::of(&regions[main]).ce);
            let usual = 2 + main.unwrap_or_default() / 20;
            let flips = self.noise.map(|_| self.noise().most_flips(touch.size()));
            usual.max(flips.unwrap_or_default())
        })
    }
}

/// The shape that was touched, and how certain that is.
#[derive(Clone, Debug, PartialEq)]
pub struct Answer {
    /// How far the answer can be trusted.
    pub state: AnswerState,
    /// The number of the shape in the set: the one that fits best, of equals the likeliest; if several are tied, the
    /// first. None if rejected or unknown.
    pub shape: Option<usize>,
    /// All shapes that are equally likely, if the state is [`AnswerState::Tied`]; otherwise empty.
    pub tied: Vec<usize>,
    /// Whether an imprint reaches the rim of its matrix, or may reach it through dead taxels, so that it may be cut off.
    /// Such an answer is never certain.
    pub at_rim: bool,
    /// Every shape with a positive probability, the likeliest first; equally likely ones in the order of the set. Under
    /// noise, a shape may be missing if its probability is below 1e-9.
    pub ranking: Vec<(usize, f64)>,
    /// The keys that were compared.
    pub method: SearchMethod,
    /// The best fit of a likely shape; for several touches, to the one that differs most. None if nothing was fitted:
    /// without noise, without a touch, for an empty imprint, and if no imprint of the model fits the matrix.
    pub fit: Option<Fit>,
    /// The imprint of the model that is nearest to the first touch that no shape leaves, or to the last touch if shapes
    /// leave all of them. Dead taxels of the noise are left out. None without a touch, or if no key fits its matrix.
    pub nearest: Option<Nearest>,
}

/// The least probability of a shape that is fitted besides the likeliest one.
const LIKELY: f64 = 0.01;

/// The most shapes that are fitted.
const MOST_FITTED: usize = 3;

/// The fits of a shape to all touches.
struct ShapeFit {
    /// The logarithm of the shape's probability times the odds of as many flips as taxels differ.
    odds: f64,
    /// The taxels that differ, in all touches together.
    differs: u32,
    /// Whether each touch is fitted within the tolerance.
    fits: bool,
    worst: Fit,
}

impl Model {
    /// Names the shape that was touched. The posterior under the noise (1 % if none is given) ranks the shapes; the
    /// likeliest three of at least 1 % are then fitted in continuous pose ([`Model::fit`]). The one of the greatest
    /// probability, times that of as many flips as taxels differ from its fit, is the answer, if these are within the
    /// tolerance. So an answer is about poses in general, not
    /// only about those of the model. Under a noise of 0, only imprints that the model holds are named, by their counts.
    ///
    /// Without any touch, the answer is the prior. If a noise is given, no answer is certain, since any shape may leave
    /// any imprint; nor if taxels are dead.
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
    /// assert_eq!(answer.fit.expect("a shape was fitted").differs, 0);
    /// # Ok::<(), Box<dyn std::error::Error>>(())
    /// ```
    pub fn recognise(&self, evidence: Evidence<'_>) -> Answer {
        let (noise, touches) = (&evidence.noise(), evidence.touches);
        let may_flip = noise.flip() > 0.0;
        let (posterior, mut nearest) = match noise.dead() {
            None if !may_flip => (self.possible(touches), None),
            _ => self.posterior_of_touches(noise, touches),
        };
        let method = match nearest {
            Some(_) => SearchMethod::Scan,
            None => SearchMethod::Exact,
        };
        if !may_flip {
            let nearest_to = |touch| self.nearest(touch, noise.dead());
            nearest = first_unknown(touches.iter(), nearest_to);
        }
        let likeliest = posterior.ranking.iter().take(posterior.likeliest);
        let equals = likeliest.map(|&(shape, _)| shape).collect();
        let (equals, fit) = if may_flip && !touches.is_empty() {
            Self::best_fit(equals, &self.likely_fits(&posterior, evidence, noise))
        } else {
            (equals, None)
        };
        let alone = match may_flip {
            false => posterior.only(),
            // A taxel that is dead or may flip makes every shape possible.
            true if evidence.noise.is_some() || noise.dead().is_some() => None,
            true => self.possible(touches).only(),
        };
        let is_alone = alone.is_some() && alone == equals.first().copied();
        let at_rim = (touches.iter()).any(|touch| may_be_cut_off(touch, noise.dead()));
        let answer = Answer {
            state: AnswerState::Unknown,
            shape: None,
            tied: Vec::new(),
            at_rim,
            ranking: posterior.ranking,
            method,
            fit,
            nearest,
        };
        answer.decided(equals, is_alone, evidence.reject_below)
    }

    /// Returns the shapes that nothing tells apart after the fits, none if no shape fits, and the best fit. `equals` are
    /// the likeliest shapes.
    fn best_fit(mut equals: Vec<usize>, fits: &[ShapeFit]) -> (Vec<usize>, Option<Fit>) {
        let best = first_of_most(fits.iter().map(|fit| fit.odds).enumerate());
        let Some(best) = best.map(|(best, _)| &fits[best]) else {
            return (Vec::new(), None);
        };
        let is_worse =
            |fit: &ShapeFit, shape| fit.worst.shape == shape && fit.differs > best.differs;
        // Some of many that are equally likely were not fitted.
        equals.retain(|&shape| best.fits && !fits.iter().any(|fit| is_worse(fit, shape)));
        if best.fits && !equals.contains(&best.worst.shape) {
            equals = vec![best.worst.shape];
        }
        (equals, Some(best.worst.clone()))
    }

    /// Fits the likeliest shapes to all touches, the likeliest first.
    fn likely_fits(
        &self,
        posterior: &Posterior,
        evidence: Evidence<'_>,
        noise: &Noise,
    ) -> Vec<ShapeFit> {
        let mut fitted: Vec<ShapeFit> = Vec::new();
        let likely = posterior.ranking.iter().take(MOST_FITTED).enumerate();
        for (rank, &(shape, probability)) in likely {
            // No shape that is less likely can be better than one that fits exactly.
            let is_settled =
                rank >= posterior.likeliest && fitted.iter().any(|fit| fit.differs == 0);
            if is_settled || rank > 0 && probability < LIKELY {
                break;
            }
            let fits = evidence.touches.iter().map(|touch| {
                let fit = self.fit(shape, touch, noise.dead())?;
                Some((fit.differs <= evidence.tolerance(touch), fit))
            });
            let Some(fits) = fits.collect::<Option<Vec<(bool, Fit)>>>() else {
                continue;
            };
            let differs = fits.iter().map(|(_, fit)| fit.differs).sum();
            let flips = f64::from(differs) * libm::log(noise.ratio());
            let within = fits.iter().all(|&(fits, _)| fits);
            // Of equals, the first.
            let worst = fits.into_iter().rev().max_by_key(|(_, fit)| fit.differs);
            fitted.extend(worst.map(|(_, worst)| ShapeFit {
                odds: libm::log(probability) + flips,
                differs,
                fits: within,
                worst,
            }));
        }
        fitted
    }

    /// Returns the probabilities of the shapes under a noise, and the nearest imprint.
    fn posterior_of_touches(
        &self,
        noise: &Noise,
        touches: &[Imprint],
    ) -> (Posterior, Option<Nearest>) {
        let mut further = 0;
        loop {
            let (odds, nearest) = self.odds_under(noise, touches, further);
            let most = (odds.iter()).fold(f64::NEG_INFINITY, |most, [_, odds]| most.max(*odds));
            let sum = |which: usize| -> f64 {
                let own = odds.iter().map(|odds| odds[which]);
                own.map(|odds| libm::exp(odds - most)).sum()
            };
            let (least, all) = (sum(0), sum(1));
            // The sums are equal if nothing lies further away; `most` is not finite if no shape is possible.
            if all - least <= NEGLIGIBLE * least || !most.is_finite() {
                let odds: Vec<f64> = odds.into_iter().map(|[odds, _]| odds).collect();
                let posterior = Posterior::of_logarithms(&odds, touches.len());
                return (posterior, nearest);
            }
            further = 2 * further + 4;
        }
    }

    /// Returns a lower and an upper bound of ln(w Π P(touch | s)) for each shape, and the nearest imprint. Takes
    /// `further` more distances into account than one touch needs.
    fn odds_under(
        &self,
        noise: &Noise,
        touches: &[Imprint],
        further: u32,
    ) -> (Vec<[f64; 2]>, Option<Nearest>) {
        // The logarithms to add up for each shape: of its weight, and both bounds of each touch.
        let weights = self.log_weights().into_iter();
        let mut parts: Vec<[Vec<f64>; 2]> =
            weights.map(|weight| [vec![weight], vec![weight]]).collect();
        let mut nearest = Vec::new();
        for touch in touches {
            let Some(distances) = self.distances_further(touch, noise, further) else {
                nearest.push(None);
                let bounds = parts.iter_mut().flatten();
                bounds.for_each(|own| own.push(f64::NEG_INFINITY));
                continue;
            };
            let likelihoods = self.log_likelihoods(touch, &distances, noise);
            for ([lower, upper], likelihood) in parts.iter_mut().zip(likelihoods) {
                lower.push(likelihood[0]);
                upper.push(likelihood[1]);
            }
            nearest.push(Some(distances.nearest));
        }
        // Sorted, so that their sum does not depend on the order of the touches.
        let sum = |mut parts: Vec<f64>| -> f64 {
            parts.sort_by(f64::total_cmp);
            parts.into_iter().sum()
        };
        (
            parts.into_iter().map(|bounds| bounds.map(sum)).collect(),
            first_unknown(nearest.into_iter(), |nearest| nearest),
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
}

/// The nearest imprint of the first touch that no shape leaves, or of the last touch if shapes leave all of them.
fn first_unknown<T>(
    touches: impl Iterator<Item = T>,
    mut nearest: impl FnMut(T) -> Option<Nearest>,
) -> Option<Nearest> {
    let mut last = None;
    for touch in touches {
        last = nearest(touch);
        if last.as_ref().is_none_or(|near| near.distance > 0) {
            break;
        }
    }
    last
}

/// Returns true if the shape may reach beyond the matrix: a living taxel on the rim is active, or dead ones, which may
/// be covered, lead from an active taxel to the rim.
pub(super) fn may_be_cut_off(touch: &Imprint, dead: Option<&Imprint>) -> bool {
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

impl Answer {
    /// Returns the same answer, decided: `equals` are the shapes that nothing tells apart, none if no shape fits;
    /// `is_alone` says that only one shape leaves these imprints in the poses of the model.
    fn decided(mut self, equals: Vec<usize>, is_alone: bool, reject_below: Option<f64>) -> Self {
        let Some(&first) = equals.first() else {
            return self;
        };
        let probability = self.ranking.iter().find(|&&(shape, _)| shape == first);
        let probability = probability.map_or(0.0, |&(_, probability)| probability);
        if reject_below.is_some_and(|least| probability < least) {
            self.state = AnswerState::Rejected;
            return self;
        }
        self.shape = Some(first);
        self.state = if equals.len() > 1 {
            self.tied = equals;
            AnswerState::Tied
        } else if is_alone && !self.at_rim {
            AnswerState::Certain
        } else {
            AnswerState::Likely
        };
        self
    }
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
