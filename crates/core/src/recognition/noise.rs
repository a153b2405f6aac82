//! The noise of a sensor: each taxel flips with probability e, independently of the others, or is dead. See
//! [`likelihood`](super::likelihood) for what follows from it.

use std::fmt;

use crate::imprint::Imprint;
use crate::index::narrow;

/// The largest change of a probability that leaving out far keys may cause.
pub(super) const NEGLIGIBLE: f64 = 1e-9;

/// The probability that a taxel flips, from 0 to below ½, and the taxels that are known to be dead.
///
/// Each taxel flips with probability e, independently of the others, so an imprint of the shape s has the probability
/// ```text
/// P(imprint | s) = Σ over keys k and shifts of  n[s, k] · e^d (1 − e)^(cells − d)  / T[s]
/// ```
/// where `n[s, k]` is the number of poses in which s leaves k, d the number of taxels in which the imprint and the
/// shifted key differ, and `T[s]` the number of touches of s: its poses, times the shifts of the key on the matrix. So
/// the prior is uniform over every pose in every place on the matrix. Taxels that are known to be dead are left out of
/// d and of `cells`.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Noise {
    flip: f64,
    dead: Option<Imprint>,
}

/// The error for a probability that is out of range.
#[derive(Clone, Copy, Debug, PartialEq, thiserror::Error)]
#[error("noise {found}: {}", self.expected())]
pub struct NoiseError {
    /// The given probability.
    pub found: f64,
}

impl NoiseError {
    /// Returns the part of the message that says what was expected, for a place that shows the number itself.
    #[must_use]
    pub fn expected(&self) -> &'static str {
        "expected a probability from 0 to below 0.5"
    }
}

/// A difference that a noise does not explain: more taxels of a touch differ from every imprint of a model than are
/// likely to flip.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct UnexplainedDifference {
    /// The number of taxels that differ from the nearest imprint.
    pub found: u32,
    /// The number of taxels that are expected to flip.
    pub expected: f64,
}

impl fmt::Display for UnexplainedDifference {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        let expected = match libm::round(self.expected) {
            few if few < 1.0 => "less than 1 is".to_owned(),
            1.0 => "about 1 is".to_owned(),
            many => format!("about {many} are"),
        };
        let found = self.found;
        write!(
            f,
            "{found} taxels differ, {expected} expected at this noise: perhaps none of these shapes"
        )
    }
}

/// A noise does not explain a difference if a difference at least as large is less probable than this. A posterior
/// compares the shapes of a set only with each other, so it names one of them even if the touch is far from all. If a
/// shape of the set left the touch, its own imprint is no nearer than the nearest one, so fewer than one such touch
/// in a million is reported as unexplained.
const EXPLAINED: f64 = 1e-6;

impl Noise {
    /// Creates a noise in which every taxel flips with this probability.
    ///
    /// # Errors
    /// Returns an error if the probability is not from 0 to below ½.
    pub fn new(flip: f64) -> Result<Self, NoiseError> {
        if (0.0..0.5).contains(&flip) {
            Ok(Self { flip, dead: None })
        } else {
            Err(NoiseError { found: flip })
        }
    }

    /// Returns the same noise with the active taxels of `dead` as its dead taxels, in place of those that it had. They
    /// are stuck on or off, so they are ignored. Taxels beyond an imprint do not matter.
    #[must_use]
    pub fn with_dead(self, dead: Imprint) -> Self {
        let dead = (!dead.is_empty()).then_some(dead);
        Self { dead, ..self }
    }

    /// Returns the probability that a taxel flips.
    pub fn flip(&self) -> f64 {
        self.flip
    }

    /// Returns the dead taxels, which are left out; None if all taxels count.
    pub fn dead(&self) -> Option<&Imprint> {
        self.dead.as_ref()
    }

    /// Checks whether this noise explains that a touch differs from its nearest imprint in `found` taxels. Returns
    /// None if it does; otherwise the numbers.
    pub fn unexplained(&self, touch: &Imprint, found: u32) -> Option<UnexplainedDifference> {
        let size = touch.size();
        let dead = self.dead.map_or(0, |dead| dead.resized(size).count());
        let cells = narrow(size.cells()) - dead;
        (self.at_least(found, cells) < EXPLAINED).then(|| UnexplainedDifference {
            found,
            expected: self.flip * f64::from(cells),
        })
    }

    fn at_least(&self, least: u32, cells: u32) -> f64 {
        // As logarithms: the first terms may be too small for an `f64`.
        let mut term = f64::from(cells) * libm::log1p(-self.flip);
        let mut sum = 0.0;
        for flips in 0..=cells {
            if flips >= least {
                sum += libm::exp(term);
            }
            let ways = f64::from(cells - flips) / f64::from(flips + 1);
            term += libm::log(ways) + libm::log(self.ratio());
        }
        sum
    }

    /// Returns the factor by which each differing taxel makes a touch less probable.
    pub(super) fn ratio(&self) -> f64 {
        self.flip / (1.0 - self.flip)
    }

    /// Returns how many distances beyond the least one matter, if all touches together, without regard to their
    /// distances, are at most `odds` times as probable as the nearest one.
    pub(super) fn reach(&self, odds: f64) -> u32 {
        if self.flip == 0.0 {
            return 0;
        }
        // The nearest touch weighs 1, all touches beyond D at most odds · ratio^(D + 1 − least).
        let steps = libm::log(NEGLIGIBLE / odds) / libm::log(self.ratio());
        #[expect(
            clippy::cast_possible_truncation,
            clippy::cast_sign_loss,
            reason = "from 0 to 4096, the most taxels of a matrix"
        )]
        let beyond = steps.ceil().clamp(1.0, 4097.0) as u32;
        beyond - 1
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::sensor::MatrixSize;

    #[test]
    fn a_noise_explains_differences_down_to_one_in_a_million() {
        let touch = Imprint::empty(MatrixSize::of(16, 16));
        let noise = Noise::new(0.01).expect("in range");
        assert!(noise.at_least(0, 256) > 1.0 - 1e-12);
        // The Poisson distribution with the same mean gives 2.4e-6 and 4.7e-7 here.
        assert_eq!(noise.unexplained(&touch, 13), None);
        let found = noise.unexplained(&touch, 14).expect("not explained");
        assert_eq!(
            found.to_string(),
            "14 taxels differ, about 3 are expected at this noise: perhaps none of these shapes"
        );
        // No flips are expected in a dead row.
        let dead = "################".parse().expect("a row");
        let found = noise.with_dead(dead).unexplained(&touch, 14);
        assert_eq!(found.map(|own| own.expected), Some(2.4));
        // The largest matrix, where the probability of no flip is too small for an `f64`.
        let most = Noise::new(0.49).expect("in range");
        let largest = Imprint::empty(MatrixSize::of(64, 64));
        assert_eq!(most.unexplained(&largest, 2100), None);
        assert!(most.unexplained(&largest, 2300).is_some());
    }

    #[test]
    fn examples() -> Result<(), Box<dyn std::error::Error>> {
        use crate::recognition::Noise;
        let touch = "#...\n....\n....\n....".parse()?;
        let noise = Noise::new(0.01)?;
        assert_eq!(noise.unexplained(&touch, 2), None);
        assert!(noise.unexplained(&touch, 8).is_some());
        Ok(())
    }
}
