//! The outline of a filled region, as a closed chain of steps between the centres of its outline taxels.

use crate::imprint::{Bounds, Imprint};

/// The numbers of steps of a closed chain between the centres of the outline taxels of a filled region. They are whole,
/// so the length is the same number on every machine.
///
/// They are counted in 2 × 2 windows of taxels: a window adds a straight step if exactly two neighbours in it belong to
/// the region, a diagonal step if three taxels do, two diagonal steps if only two on a diagonal do, and none otherwise.
/// So a part that is one taxel wide counts twice, out and back, and a single taxel has length 0.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Hash)]
pub struct ChainSteps {
    /// The number of steps to a taxel beside, above or below: length 1 each.
    pub straight: u32,
    /// The number of steps to a taxel across a corner: length √2 each.
    pub diagonal: u32,
}

impl ChainSteps {
    /// Returns the length of the closed chain, in cell sides.
    pub fn length(&self) -> f64 {
        f64::from(self.straight) + f64::from(self.diagonal) * std::f64::consts::SQRT_2
    }
}

/// Returns masks of the 2 × 2 windows with these corners: three or four active taxels or only a diagonal; exactly
/// three; only a diagonal.
fn windows(upper_left: u64, upper_right: u64, lower_left: u64, lower_right: u64) -> [u64; 3] {
    let (upper, lower) = (upper_left & upper_right, lower_left & lower_right);
    let (either_upper, either_lower) = (upper_left ^ upper_right, lower_left ^ lower_right);
    let three = upper & either_lower | lower & either_upper;
    let across = either_upper & either_lower & (upper_left ^ lower_left);
    [three | across | upper & lower, three, across]
}

#[derive(Clone, Copy, Debug)]
pub(super) struct OutlineCounts {
    pub(super) taxels: u32,
    pub(super) rim: u32,
    pub(super) steps: ChainSteps,
}

impl OutlineCounts {
    pub(super) fn of(filled: &Imprint, bounds: Bounds) -> Self {
        let words = bounds.words(filled);
        let (mut taxels, mut inner, mut many, mut three, mut diagonals) = (0, 0, 0, 0, 0);
        let mut above = 0;
        for (row, &here) in words.iter().enumerate() {
            // The windows below the last row add nothing: they contain at most two taxels, and those are neighbours.
            let below = words.get(row + 1).copied().unwrap_or(0);
            taxels += here.count_ones();
            inner += (here & here << 1 & here >> 1 & above & below).count_ones();
            // Bit i of the four words holds the corners of a window. One window lies left of column 0, so the words are
            // shifted up, not down. The window to the right of column 63 is lost by this, and is added separately.
            let beside = [above >> 63, 0, here >> 63, 0];
            for [upper_left, upper_right, lower_left, lower_right] in
                [[above << 1, above, here << 1, here], beside]
            {
                let own = windows(upper_left, upper_right, lower_left, lower_right);
                let [own_many, own_three, own_diagonals] = own.map(u64::count_ones);
                many += own_many;
                three += own_three;
                diagonals += own_diagonals;
            }
            above = here;
        }
        Self {
            taxels,
            rim: taxels - inner,
            steps: ChainSteps {
                // Each taxel is a corner of four windows. By Euler's formula, the number of windows with one taxel is
                // four, plus the number with three, plus twice the number with a diagonal. So the number of windows
                // with two neighbours, which have one step each, follows from the other kinds.
                straight: 2 * taxels.saturating_sub(1 + many),
                diagonal: three + 2 * diagonals,
            },
        }
    }
}
