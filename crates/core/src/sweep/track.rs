//! Follows where the coverage of an ellipse passes through a level, from one row of the grid to the next.
//!
//! The area of a convex set in a moving cell rises to a plateau and falls again: its root is concave where it is not 0
//! (Brunn and Minkowski). So the coverage passes a level at most twice: there is at most one rising and one falling
//! passage. From one row to the next a passage moves smoothly, so the last three predict the next, and one step of
//! Newton's method usually suffices.
//!
//! **Certainty.** At a position the excess over the level is `e` and the slope `m`; within `e/m` and a little the slope
//! cannot change by more than `c` ([`EllipseBand::change`]). Then the distance to the passage is between `e/(m + c)`
//! and `e/(m − c)`. The passage counts as known once this interval is narrower than [`NEAR`] requires.

use crate::sweep::ellipse_band::EllipseBand;
use crate::sweep::span::{NEAR, STEEP};

/// A direction in which the coverage passes through a level, from left to right.
#[derive(Clone, Copy, PartialEq, Eq)]
pub(crate) enum Passage {
    Rising,
    Falling,
}

/// The positions of a passage in the last rows.
#[derive(Clone, Copy, Debug, Default)]
pub(crate) struct Track {
    positions: [f64; 3],
    known: usize,
}

impl Track {
    /// Extrapolates the next position; None for a new track.
    fn expected(&self) -> Option<f64> {
        let [last, before, first] = self.positions;
        match self.known {
            0 => None,
            1 => Some(last),
            2 => Some(2.0 * last - before),
            _ => Some(3.0 * (last - before) + first),
        }
    }

    pub(crate) fn note(&mut self, position: f64) {
        self.positions = [position, self.positions[0], self.positions[1]];
        self.known = (self.known + 1).min(3);
    }

    pub(crate) fn forget(&mut self) {
        self.known = 0;
    }

    /// Finds the passage through a level in the present band; None if it is not certain.
    pub(crate) fn follow(
        &mut self,
        band: &EllipseBand,
        level: f64,
        passage: Passage,
    ) -> Option<f64> {
        let mut u = self.expected()?;
        for _ in 0..4 {
            let (left, right) = (band.at(u), band.at(u + 1.0));
            let excess = band.coverage(&left, &right) - level;
            let slope = right.height - left.height;
            if (slope > 0.0) != (passage == Passage::Rising) {
                return None;
            }
            let way = excess / slope;
            let around = way.abs() * 1.5 + NEAR;
            let change = band.change(&left, around) + band.change(&right, around);
            let steep = slope.abs() - change;
            u -= way;
            let enough = slope.abs() <= 1.5 * steep && way.abs() * change <= 0.5 * NEAR * steep;
            if steep > STEEP && enough {
                self.note(u);
                return Some(u);
            }
        }
        None
    }
}
