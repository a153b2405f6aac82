//! The counts and sums of a region, and what is measured from them.
//!
//! Coordinates, units and directions are those of [`descriptor`](super::descriptor).

use std::f64::consts::PI;

use glam::DVec2;

use crate::description::region::{Region, RegionKind};
use crate::imprint::{Bounds, Imprint};

/// The counts and sums of one region, from which all descriptors are computed. Coordinates and lengths are in cell
/// sides, directions in degrees counter-clockwise from +x as seen on the screen. If the fields are changed to numbers
/// that no region has, descriptors may be meaningless or NaN, but nothing panics.
///
/// ```
/// use taxel_core::prelude::*;
///
/// let imprint: Imprint = ".##.\n####\n".parse()?;
/// let own = Description::of(&regions(&imprint)[0]);
/// assert_eq!((own.na, own.area(), own.filling(), own.side_ratio()), (6, 8, 0.75, 2.0));
/// assert_eq!(own.cg_cd_direction(), Some(90.0));
/// # Ok::<(), Box<dyn std::error::Error>>(())
/// ```
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Description {
    /// The kind of the region: a piece or a hole.
    pub kind: RegionKind,
    /// NA: the number of taxels of the region.
    pub na: u32,
    /// NAE: the number of taxels of the region and everything that it encloses.
    pub nae: u32,
    /// CE: the number of outline taxels of the filled region.
    pub ce: u32,
    /// `NumX`: the sum of the taxels' x coordinates.
    pub num_x: f64,
    /// `NumY`: the sum of the taxels' y coordinates.
    pub num_y: f64,
    /// The steps of the chain around the filled region.
    pub steps: ChainSteps,
    /// The upright rectangle around the region.
    pub rect: Bounds,
}

impl Description {
    /// Computes the counts and sums of a region.
    pub fn of(region: &Region) -> Self {
        let (filled, rect) = (region.filled(), region.bounds());
        let (na, columns, rows) = sums(region.taxels(), rect);
        let counted = OutlineCounts::of(filled, rect);
        let half = f64::from(na) / 2.0;
        Self {
            kind: region.kind(),
            na,
            nae: counted.taxels,
            ce: counted.rim,
            num_x: f64::from(columns) + half,
            num_y: f64::from(rows) + half,
            steps: counted.steps,
            rect,
        }
    }

    /// Returns CG, the centre of gravity of the region's taxels.
    pub fn cg(&self) -> DVec2 {
        DVec2::new(self.num_x, self.num_y) / f64::from(self.na)
    }

    /// Returns CD, the centre of the upright rectangle.
    pub fn cd(&self) -> DVec2 {
        DVec2::from(self.doubled_centre().map(f64::from)) / 2.0
    }

    /// Returns P, the length of the outline of the filled region in cell sides: that of the chain between the centres
    /// of its outline taxels ([`ChainSteps`]), so 0 for a single taxel.
    pub fn p(&self) -> f64 {
        self.steps.length()
    }

    /// Returns F = P²/NAE.
    pub fn f(&self) -> f64 {
        self.p() * self.p() / f64::from(self.nae)
    }

    /// Returns the number of taxels in the upright rectangle.
    pub fn area(&self) -> u32 {
        self.rect.area()
    }

    /// Returns the longer side of the upright rectangle divided by the shorter one.
    pub fn side_ratio(&self) -> f64 {
        let [width, height] = self.whole_sides().map(f64::from);
        width.max(height) / width.min(height)
    }

    /// Returns NA divided by the area of the upright rectangle: above 0, up to 1.
    pub fn filling(&self) -> f64 {
        f64::from(self.na) / f64::from(self.area())
    }

    /// Returns the distance between CG and CD.
    pub fn cg_cd(&self) -> f64 {
        self.cg().distance(self.cd())
    }

    /// Returns the directions of the two diagonals of the upright rectangle, from 0 to below 180 degrees.
    pub fn diagonals(&self) -> [f64; 2] {
        let [width, height] = self.whole_sides().map(f64::from);
        let rising = libm::atan2(height, width).to_degrees();
        [rising, 180.0 - rising]
    }

    pub(super) fn whole_sides(&self) -> [i32; 2] {
        let rect = self.rect;
        [(rect.left, rect.right), (rect.top, rect.bottom)]
            .map(|(low, high)| i32::from(high) - i32::from(low))
    }

    /// Returns `NumX` and `NumY`, doubled so that they are whole.
    pub(super) fn doubled_sums(&self) -> [i64; 2] {
        #[expect(
            clippy::cast_possible_truncation,
            reason = "at most 4096 coordinates of at most 64"
        )]
        [self.num_x, self.num_y].map(|sum| (2.0 * sum) as i64)
    }

    /// Returns the coordinates of CD, doubled so that they are whole.
    pub(super) fn doubled_centre(&self) -> [i32; 2] {
        let rect = self.rect;
        [(rect.left, rect.right), (rect.top, rect.bottom)]
            .map(|(low, high)| i32::from(low) + i32::from(high))
    }

    /// Returns the vector from CG to CD, in units of 1/(2 NA).
    pub(super) fn exact_cg_to_cd(&self) -> [i64; 2] {
        let (sums, centre) = (self.doubled_sums(), self.doubled_centre());
        [0, 1].map(|axis| (i64::from(self.na) * i64::from(centre[axis])).saturating_sub(sums[axis]))
    }

    /// Returns P²/NAE exactly, as the ratios a and b of a + b√2.
    pub(super) fn exact_compactness(&self) -> [i64; 4] {
        let [straight, diagonal] = [self.steps.straight, self.steps.diagonal].map(i64::from);
        let times = |one: i64, other: i64| one.saturating_mul(other);
        ratios(
            [
                times(straight, straight).saturating_add(times(2 * diagonal, diagonal)),
                times(2 * straight, diagonal),
            ],
            i64::from(self.nae),
        )
    }

    /// Returns 4π·NAE/P²; None for a single taxel, whose P is 0.
    pub fn roundness(&self) -> Option<f64> {
        let length = self.p();
        (length > 0.0).then(|| 4.0 * PI * f64::from(self.nae) / (length * length))
    }

    /// Returns the direction from CG to CD, above −180 and up to 180 degrees; None if they are less than 1e-9 apart.
    pub fn cg_cd_direction(&self) -> Option<f64> {
        let way = self.cd() - self.cg();
        // Upwards is counter-clockwise. 0 − y, not −y: that would make a zero negative, and atan2 return −180.
        (way.length_squared() >= 1e-18).then(|| libm::atan2(0.0 - way.y, way.x).to_degrees())
    }
}

/// Returns the number of taxels, the sum of their columns and the sum of their rows.
fn sums(taxels: &Imprint, bounds: Bounds) -> (u32, u32, u32) {
    let (mut count, mut doubled, mut rows) = (0, 0, 0);
    for (row, &word) in (u32::from(bounds.top)..).zip(bounds.words(taxels)) {
        let (mut rest, mut in_row) = (word, 0);
        // Works run by run: the columns of a run add up to its length times the mean of the first and the last.
        while rest != 0 {
            // Adding its first taxel carries through the run, to the first gap behind it.
            let carried = rest.wrapping_add(rest & rest.wrapping_neg());
            let (first, end) = (rest.trailing_zeros(), carried.trailing_zeros());
            doubled += (end - first) * (first + end - 1);
            in_row += end - first;
            rest &= carried;
        }
        count += in_row;
        rows += row * in_row;
    }
    (count, doubled / 2, rows)
}

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

/// The value of a descriptor as whole numbers, so that equal values compare as equal: ratios in lowest terms, lengths
/// as numbers of steps. None if the value does not exist.
pub type ExactValue = Option<[i64; 4]>;

pub(super) fn whole<const N: usize>(numbers: [u32; N]) -> [i64; 4] {
    let mut exact = [0; 4];
    for (slot, number) in exact.iter_mut().zip(numbers) {
        *slot = i64::from(number);
    }
    exact
}

/// Returns two ratios with the same positive denominator, each in lowest terms.
pub(super) fn ratios(numerators: [i64; 2], denominator: i64) -> [i64; 4] {
    let [one, other] = numerators.map(|numerator| {
        // The divisor is 0 only if fields of the description were changed.
        let common = gcd(numerator.unsigned_abs(), denominator.unsigned_abs()).max(1);
        [numerator / common, denominator / common]
    });
    [one[0], one[1], other[0], other[1]]
}

/// Returns the direction of a vector in lowest terms; None if its length is 0.
pub(super) fn direction([x, y]: [i64; 2]) -> ExactValue {
    let common = gcd(x.unsigned_abs(), y.unsigned_abs());
    (common > 0).then(|| [x / common, y / common, 0, 0])
}

/// Returns the greatest common divisor of numbers far below 2⁶³; 0 for two zeros.
fn gcd(one: u64, other: u64) -> i64 {
    let (mut one, mut other) = (one, other);
    while other > 0 {
        (one, other) = (other, one % other);
    }
    one.cast_signed()
}
