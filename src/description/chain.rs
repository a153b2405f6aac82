//! The outline of a filled region as a chain of taxel centres, and the number of its taxels.
//!
//! The length of the closed polygon through the centres of successive outline taxels is a sum over windows: each 2 × 2
//! window of centres adds 1 if two neighbours in it belong to the region, √2 if three do, 2√2 if just two on a diagonal
//! do, and nothing otherwise. So a part one taxel wide counts out and back, and a single taxel counts nothing.

use crate::imprint::{Bounds, Imprint};

/// The steps of a chain by their kind, so that the length is the same number on every machine.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Hash)]
#[non_exhaustive]
pub struct ChainSteps {
    /// Steps to a taxel beside, above or below: length 1.
    pub straight: u32,
    /// Steps to a taxel across a corner: length √2.
    pub diagonal: u32,
}

impl ChainSteps {
    /// The length of the closed chain; cell sides.
    pub fn length(&self) -> f64 {
        f64::from(self.straight) + f64::from(self.diagonal) * std::f64::consts::SQRT_2
    }
}

/// Masks of the 2 × 2 windows, by their corners: [three, four or just a diagonal active; three; just a diagonal].
fn windows(upper_left: u64, upper_right: u64, lower_left: u64, lower_right: u64) -> [u64; 3] {
    let (upper, lower) = (upper_left & upper_right, lower_left & lower_right);
    let (either_upper, either_lower) = (upper_left ^ upper_right, lower_left ^ lower_right);
    let three = upper & either_lower | lower & either_upper;
    let across = either_upper & either_lower & (upper_left ^ lower_left);
    [three | across | upper & lower, three, across]
}

/// What is counted of a filled region.
#[derive(Clone, Copy, Debug)]
pub(super) struct OutlineCounts {
    /// Its taxels.
    pub(super) taxels: u32,
    /// Those with at least one of their four neighbours outside the region.
    pub(super) rim: u32,
    /// The steps around it.
    pub(super) steps: ChainSteps,
}

impl OutlineCounts {
    /// Counts a region without holes; `bounds` are its bounds.
    ///
    /// Regions are narrow, and counting a word's bits takes a dozen steps unless the processor is known to have an
    /// instruction for it. So four rows share a word if a column stays free between them.
    pub(super) fn of(filled: &Imprint, bounds: Bounds) -> Self {
        if bounds.right - bounds.left < 16 {
            Self::count::<16>(filled, bounds)
        } else {
            Self::count::<64>(filled, bounds)
        }
    }

    /// Counts it with `BITS` bits per row.
    fn count<const BITS: u32>(filled: &Imprint, bounds: Bounds) -> Self {
        let rows = &filled.words()[usize::from(bounds.top)..usize::from(bounds.bottom)];
        let mut words = rows.chunks((u64::BITS / BITS) as usize).map(|rows| {
            // The first row into the lowest bits.
            let join = |word: u64, &row: &u64| word.unbounded_shl(BITS) | row >> bounds.left;
            rows.iter().rev().fold(0, join)
        });
        let (mut taxels, mut inner, mut counts) = (0, 0, [0; 3]);
        // Below the last row nothing is active.
        let mut following = || words.next().unwrap_or(0);
        let (mut before, mut here) = (0, following());
        // One word more where the last one is full: a window reaches below the last row.
        for _ in 0..=rows.len() / (u64::BITS / BITS) as usize {
            let next = following();
            let above = here.unbounded_shl(BITS) | before >> (u64::BITS - BITS);
            let below = here.unbounded_shr(BITS) | next << (u64::BITS - BITS);
            taxels += here.count_ones();
            inner += (here & here << 1 & here >> 1 & above & below).count_ones();
            // Bit i of the four words: a window's corners. One window lies left of column 0, so shift up, not down;
            // a taxel in column 63 loses its window to the right, which is added by itself.
            let mut add = |[many, three, across]: [u64; 3]| {
                counts[0] += many.count_ones();
                counts[1] += three.count_ones();
                // Rare.
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
                // Each taxel is a corner of four windows; and by Euler's formula there are four windows with one taxel
                // more than there are with three and twice those with a diagonal. So those with two neighbours, which
                // have one step each, follow from the other kinds.
                straight: 2 * taxels.saturating_sub(1 + many),
                diagonal: three + 2 * across,
            },
        }
    }
}
