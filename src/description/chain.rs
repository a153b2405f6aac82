//! The outline of a filled region, as a closed chain of steps between the centres of its outline taxels.

use crate::imprint::{Bounds, Imprint};

/// The numbers of steps of a closed chain between the centres of the outline taxels of a filled region. They are whole,
/// so the length is the same number on every machine.
///
/// They are counted in 2 × 2 windows of taxels: a window adds a straight step if exactly two neighbours in it belong to
/// the region, a diagonal step if three taxels do, two diagonal steps if only two on a diagonal do, and none otherwise.
/// So a part that is one taxel wide counts twice, out and back, and a single taxel has length 0.
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
            Self::count::<4, 16>(filled, bounds)
        } else {
            Self::count::<1, 64>(filled, bounds)
        }
    }

    /// Counts the region with `ROWS` rows in each word, `BITS` bits per row.
    fn count<const ROWS: usize, const BITS: u32>(filled: &Imprint, bounds: Bounds) -> Self {
        let (full, rest) = bounds.words(filled).as_chunks::<ROWS>();
        // The first row goes into the lowest bits.
        let join = |rows: &[u64]| {
            let add = |word: u64, &row: &u64| word.unbounded_shl(BITS) | row >> bounds.left;
            rows.iter().rev().fold(0, add)
        };
        // The windows below the last row add nothing: they contain at most two taxels, and those are neighbours.
        let rest = (!rest.is_empty()).then(|| join(rest));
        let mut words = full.iter().map(|rows| join(rows)).chain(rest);
        let (mut counts, mut diagonals) = ([0; 4], 0);
        // Counts the taxels, those with four neighbours, the windows with many, and those with three: side by side, so
        // that a processor can count two at once.
        let mut add = |inside: [u64; 2], [many, three, across]: [u64; 3]| {
            for (count, word) in counts.iter_mut().zip([inside[0], inside[1], many, three]) {
                *count += u64::from(word.count_ones());
            }
            // Diagonals are rare.
            if across != 0 {
                diagonals += across.count_ones();
            }
        };
        let (mut before, mut following) = (0, words.next());
        while let Some(here) = following {
            following = words.next();
            let above = here.unbounded_shl(BITS) | before >> (u64::BITS - BITS);
            let below = here.unbounded_shr(BITS) | following.unwrap_or(0) << (u64::BITS - BITS);
            let inner = here & here << 1 & here >> 1 & above & below;
            // Bit i of the four words holds the corners of a window. One window lies left of column 0, so the words are
            // shifted up, not down. The window to the right of column 63 is lost by this, and is added separately.
            add([here, inner], windows(above << 1, above, here << 1, here));
            if ROWS == 1 {
                add([0; 2], windows(above >> 63, 0, here >> 63, 0));
            }
            before = here;
        }
        #[expect(
            clippy::cast_possible_truncation,
            reason = "an imprint has 4096 taxels"
        )]
        let [taxels, inner, many, three] = counts.map(|count: u64| count as u32);
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
