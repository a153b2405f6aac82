//! The outline of a filled region, as a closed chain of steps between the centres of its outline taxels.
//!
//! The length of that chain is computed from 2 × 2 windows of taxels: a window adds 1 if exactly two neighbours in it
//! belong to the region, √2 if three taxels do, 2√2 if only two on a diagonal do, and 0 otherwise. So a part that is
//! one taxel wide counts twice, out and back, and a single taxel has length 0.

use crate::imprint::{Bounds, Imprint};

/// The numbers of steps of a chain. They are whole, so the length is the same number on every machine.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Hash)]
#[non_exhaustive]
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

/// The counts of a filled region.
#[derive(Clone, Copy, Debug)]
pub(super) struct OutlineCounts {
    /// The number of its taxels.
    pub(super) taxels: u32,
    /// The number of its taxels with at least one of their four neighbours outside the region.
    pub(super) rim: u32,
    /// The steps of the chain around it.
    pub(super) steps: ChainSteps,
}

impl OutlineCounts {
    /// Counts a region without holes; `bounds` are its bounds.
    ///
    /// Most regions are narrow, and counting a word's bits takes a dozen steps unless the processor is known to have an
    /// instruction for it. So four rows share a word if at least one column stays free between them.
    pub(super) fn of(filled: &Imprint, bounds: Bounds) -> Self {
        if bounds.right - bounds.left < 16 {
            Self::count::<16>(filled, bounds)
        } else {
            Self::count::<64>(filled, bounds)
        }
    }

    /// Counts the region with `BITS` bits per row.
    fn count<const BITS: u32>(filled: &Imprint, bounds: Bounds) -> Self {
        let rows = &filled.words()[usize::from(bounds.top)..usize::from(bounds.bottom)];
        let mut words = rows.chunks((u64::BITS / BITS) as usize).map(|rows| {
            // The first row goes into the lowest bits.
            let join = |word: u64, &row: &u64| word.unbounded_shl(BITS) | row >> bounds.left;
            rows.iter().rev().fold(0, join)
        });
        let (mut taxels, mut inner, mut counts) = (0, 0, [0; 3]);
        // Below the last row nothing is active.
        let mut following = || words.next().unwrap_or(0);
        let (mut before, mut here) = (0, following());
        // If the last word is full, one more word is needed: the windows of the last row reach below it.
        for _ in 0..=rows.len() / (u64::BITS / BITS) as usize {
            let next = following();
            let above = here.unbounded_shl(BITS) | before >> (u64::BITS - BITS);
            let below = here.unbounded_shr(BITS) | next << (u64::BITS - BITS);
            taxels += here.count_ones();
            inner += (here & here << 1 & here >> 1 & above & below).count_ones();
            // Bit i of the four words holds the corners of a window. One window lies left of column 0, so the words are
            // shifted up, not down. The window to the right of column 63 is lost by this, and is added separately.
            let mut add = |[many, three, across]: [u64; 3]| {
                counts[0] += many.count_ones();
                counts[1] += three.count_ones();
                // Diagonals are rare.
                if across != 0 {
                    counts[2] += across.count_ones();
                }
            };
            add(windows(above << 1, above, here << 1, here));
            if BITS == u64::BITS {
                add(windows(above >> 63, 0, here >> 63, 0));
            }
            (before, here) = (here, next);
        }
        let [many, three, across] = counts;
        Self {
            taxels,
            rim: taxels - inner,
            steps: ChainSteps {
                // Each taxel is a corner of four windows. By Euler's formula, the number of windows with one taxel is
                // four, plus the number with three, plus twice the number with a diagonal. So the number of windows
                // with two neighbours, which have one step each, follows from the other kinds.
                straight: 2 * taxels.saturating_sub(1 + many),
                diagonal: three + 2 * across,
            },
        }
    }
}
