//! The paper's descriptors of a region, in one table.
//!
//! The panel, tables, JSON and statistics iterate over [`DESCRIPTORS`]; no other part of the program lists the
//! descriptors. Coordinates and units are those of the sensory plane: a taxel has the coordinates of its centre,
//! lengths are in cell sides, areas in cells, and directions in degrees counter-clockwise from +x as seen on the
//! screen. A value that does not exist is [`Value::None`], never a number that is not finite. Points are those of
//! [`glam`].

use std::f64::consts::PI;
use std::sync::atomic::{AtomicU64, Ordering};

use glam::DVec2;

use crate::description::chain::{ChainSteps, OutlineCounts};
use crate::description::region::{Region, RegionKind};
use crate::imprint::{Bounds, Imprint};
use crate::sensor::MAX_SIDE;

/// The counts and sums of one region, from which all descriptors are computed. Coordinates and lengths are in cell
/// sides, directions in degrees counter-clockwise from +x as seen on the screen. If the fields are changed to numbers
/// that no region has, descriptors may be meaningless or NaN, but nothing panics.
///
/// ```
/// use taxel::prelude::*;
///
/// let imprint: Imprint = ".##.\n####\n".parse()?;
/// let own = Description::of(&regions(&imprint)[0]);
/// assert_eq!((own.na, own.area(), own.filling(), own.side_ratio()), (6, 8, 0.75, 2.0));
/// assert_eq!(own.cg_cd_direction(), Some(90.0));
/// # Ok::<(), Box<dyn std::error::Error>>(())
/// ```
#[derive(Clone, Copy, Debug, PartialEq)]
#[non_exhaustive]
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

    fn sides(&self) -> DVec2 {
        DVec2::from(self.whole_sides().map(f64::from))
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
        let sides = self.sides();
        sides.max_element() / sides.min_element()
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
        let rising = rising_diagonal(self.whole_sides());
        [rising, 180.0 - rising]
    }

    /// Returns the width and the height of the upright rectangle.
    fn whole_sides(&self) -> [i32; 2] {
        let rect = self.rect;
        [(rect.left, rect.right), (rect.top, rect.bottom)]
            .map(|(low, high)| i32::from(high) - i32::from(low))
    }

    /// Returns `NumX` and `NumY`, doubled so that they are whole.
    fn doubled_sums(&self) -> [i64; 2] {
        #[expect(
            clippy::cast_possible_truncation,
            reason = "at most 4096 coordinates of at most 64"
        )]
        [self.num_x, self.num_y].map(|sum| (2.0 * sum) as i64)
    }

    /// Returns the coordinates of CD, doubled so that they are whole.
    fn doubled_centre(&self) -> [i32; 2] {
        let rect = self.rect;
        [(rect.left, rect.right), (rect.top, rect.bottom)]
            .map(|(low, high)| i32::from(low) + i32::from(high))
    }

    /// Returns the vector from CG to CD, in units of 1/(2 NA).
    fn exact_cg_to_cd(&self) -> [i64; 2] {
        let (sums, centre) = (self.doubled_sums(), self.doubled_centre());
        [0, 1].map(|axis| (i64::from(self.na) * i64::from(centre[axis])).saturating_sub(sums[axis]))
    }

    /// Returns P²/NAE exactly, as the ratios a and b of a + b√2.
    fn exact_compactness(&self) -> [i64; 4] {
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

/// Returns the direction of the rising diagonal of a rectangle of this width and height, in degrees. An arc
/// tangent takes as long as several other descriptors and there are few rectangles of whole taxels, so it is computed
/// once for each of them.
fn rising_diagonal([width, height]: [i32; 2]) -> f64 {
    const LARGEST: usize = MAX_SIDE as usize;
    /// The bits of each direction; 0 before it is computed, since no direction is 0.
    static COMPUTED: [[AtomicU64; LARGEST]; LARGEST] =
        [const { [const { AtomicU64::new(0) }; LARGEST] }; LARGEST];
    // Both sides are positive, so there is no quadrant to find: `atan2` would return the same number.
    let compute = || libm::atan(f64::from(height) / f64::from(width)).to_degrees();
    let slot = |side: i32| usize::try_from(side - 1).unwrap_or(usize::MAX);
    let row = COMPUTED.get(slot(width));
    let Some(computed) = row.and_then(|row| row.get(slot(height))) else {
        return compute();
    };
    match computed.load(Ordering::Relaxed) {
        0 => {
            let rising = compute();
            computed.store(rising.to_bits(), Ordering::Relaxed);
            rising
        }
        bits => f64::from_bits(bits),
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

/// The value of a descriptor.
#[derive(Clone, Copy, Debug, PartialEq)]
#[non_exhaustive]
pub enum Value {
    /// The descriptor does not exist for this region.
    None,
    /// A whole number.
    Count(u32),
    /// A number.
    Number(f64),
    /// A point of the plane.
    Point(DVec2),
    /// Two directions.
    Pair([f64; 2]),
    /// A rectangle of whole taxels.
    Rect(Bounds),
}

impl Value {
    /// Returns the number, if the value is a count or a single number.
    ///
    /// ```
    /// use taxel::description::Value;
    /// assert_eq!((Value::Count(3).number(), Value::None.number()), (Some(3.0), None));
    /// ```
    pub fn number(self) -> Option<f64> {
        match self {
            Self::Count(count) => Some(count.into()),
            Self::Number(number) => Some(number),
            _ => None,
        }
    }
}

/// The quantity that a descriptor measures. It decides how a value is converted to millimetres.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash)]
#[non_exhaustive]
pub enum Dimension {
    /// A number of taxels, or another pure count.
    Count,
    /// A length in cell sides; times the pitch, in mm.
    Length,
    /// An area in cells; times the square of the pitch, in mm².
    Area,
    /// A direction in degrees, counter-clockwise from +x as seen on the screen.
    Direction,
    /// A pure number.
    Ratio,
    /// A share, shown in %.
    Share,
}

/// The changes of a whole imprint on its matrix under which a descriptor changes.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash)]
#[non_exhaustive]
pub struct ChangesUnder {
    /// Whether a shift by whole taxels changes it.
    pub shift: bool,
    /// Whether a rotation by 90° changes it.
    pub quarter_turn: bool,
    /// Whether mirroring left to right changes it.
    pub mirror: bool,
}

impl ChangesUnder {
    /// For a descriptor that is the same for every position and orientation of the imprint.
    const NOTHING: Self = Self {
        shift: false,
        quarter_turn: false,
        mirror: false,
    };
    /// For a descriptor that depends on the position of the imprint.
    const SHIFTS: Self = Self {
        shift: true,
        quarter_turn: true,
        mirror: true,
    };
}

/// The value of a descriptor as whole numbers, so that equal values compare as equal: ratios in lowest terms, lengths
/// as numbers of steps. None if the value does not exist.
pub type ExactValue = Option<[i64; 4]>;

/// A row of [`DESCRIPTORS`].
#[derive(Clone, Copy, Debug)]
#[non_exhaustive]
pub struct Descriptor {
    /// The name in JSON and CSV.
    pub key: &'static str,
    /// The symbol on the screen: that of the paper, if there is one.
    pub symbol: &'static str,
    /// A description in a few words.
    pub name: &'static str,
    /// The quantity that it measures.
    pub dimension: Dimension,
    /// Whether it is part of the JSON answers. Their form is fixed; the other descriptors can be computed from those in
    /// them.
    pub in_answer: bool,
    /// The changes of the imprint that change its value. A descriptor that changes under shifts says where an imprint
    /// lies, not which shape it has.
    pub changes_under: ChangesUnder,
    /// The value if there is no region: 0 for counts and sums of taxels, and [`Value::None`] for the others.
    ///
    /// ```
    /// use taxel::description::{DESCRIPTORS, Value};
    /// let zeros = DESCRIPTORS.iter().filter(|descriptor| descriptor.of_nothing != Value::None);
    /// let zeros: Vec<&str> = zeros.map(|descriptor| descriptor.key).collect();
    /// assert_eq!(zeros, ["na", "nae", "ce", "num_x", "num_y", "area"]);
    /// ```
    pub of_nothing: Value,
    /// Computes the value from the counts and sums.
    pub measure: fn(&Description) -> Value,
    /// Computes the exact value. Two imprints have the same value if and only if this is the same; unlike
    /// [`Self::measure`], it does not round.
    pub exact: fn(&Description) -> ExactValue,
}

impl Descriptor {
    const fn new(
        key: &'static str,
        symbol: &'static str,
        name: &'static str,
        dimension: Dimension,
        measure: fn(&Description) -> Value,
        exact: fn(&Description) -> ExactValue,
    ) -> Self {
        Self {
            key,
            symbol,
            name,
            dimension,
            in_answer: true,
            changes_under: ChangesUnder::NOTHING,
            of_nothing: Value::None,
            measure,
            exact,
        }
    }

    /// Marks a descriptor of the imprint's position.
    const fn of_place(self) -> Self {
        Self {
            changes_under: ChangesUnder::SHIFTS,
            ..self
        }
    }

    /// Marks a count or sum of taxels, whose value is `zero` without a region.
    const fn zero_of_nothing(self, zero: Value) -> Self {
        Self {
            of_nothing: zero,
            ..self
        }
    }

    /// Marks a descriptor that changes under quarter turns, and under mirroring if `mirror` is true.
    const fn of_orientation(self, mirror: bool) -> Self {
        let changes_under = ChangesUnder {
            shift: false,
            quarter_turn: true,
            mirror,
        };
        Self {
            changes_under,
            ..self
        }
    }

    /// Marks a descriptor that JSON answers leave out.
    const fn not_in_answers(self) -> Self {
        Self {
            in_answer: false,
            ..self
        }
    }

    /// Returns the description for a region of a kind, in a few words. It differs for holes, whose taxels are inactive.
    ///
    /// ```
    /// use taxel::description::{Descriptor, RegionKind};
    /// let na = Descriptor::from_key("na").expect("in the table");
    /// assert_eq!(na.name_of(RegionKind::Exterior), "active taxels");
    /// assert_eq!(na.name_of(RegionKind::Hole), "inactive taxels");
    /// ```
    pub fn name_of(&self, kind: RegionKind) -> &'static str {
        match kind {
            RegionKind::Hole if self.key == "na" => "inactive taxels",
            _ => self.name,
        }
    }

    /// Returns the descriptor with a key, such as `"na"`; None if there is none.
    ///
    /// ```
    /// use taxel::description::Descriptor;
    /// let direction = Descriptor::from_key("cg_cd_direction").expect("in the table");
    /// assert!(direction.changes_under.mirror && !direction.changes_under.shift);
    /// assert!(Descriptor::from_key("colour").is_none());
    /// ```
    pub fn from_key(key: &str) -> Option<&'static Self> {
        DESCRIPTORS.iter().find(|descriptor| descriptor.key == key)
    }
}

/// Returns counts as an exact value.
fn whole<const N: usize>(numbers: [u32; N]) -> [i64; 4] {
    let mut exact = [0; 4];
    for (slot, number) in exact.iter_mut().zip(numbers) {
        *slot = i64::from(number);
    }
    exact
}

/// Returns two ratios with the same positive denominator, each in lowest terms.
fn ratios(numerators: [i64; 2], denominator: i64) -> [i64; 4] {
    let [one, other] = numerators.map(|numerator| {
        // The divisor is 0 only if fields of the description were changed.
        let common = gcd(numerator.unsigned_abs(), denominator.unsigned_abs()).max(1);
        [numerator / common, denominator / common]
    });
    [one[0], one[1], other[0], other[1]]
}

/// Returns the direction of a vector in lowest terms; None if its length is 0.
fn direction([x, y]: [i64; 2]) -> ExactValue {
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

/// The table of descriptors, in the paper's order; `roundness` is the measure that image analysis uses instead of F.
pub const DESCRIPTORS: &[Descriptor] = &[
    Descriptor::new(
        "na",
        "NA",
        "active taxels",
        Dimension::Count,
        |d| Value::Count(d.na),
        |d| Some(whole([d.na])),
    )
    .zero_of_nothing(Value::Count(0)),
    Descriptor::new(
        "nae",
        "NAE",
        "filled taxels",
        Dimension::Count,
        |d| Value::Count(d.nae),
        |d| Some(whole([d.nae])),
    )
    .zero_of_nothing(Value::Count(0)),
    Descriptor::new(
        "ce",
        "CE",
        "outline taxels",
        Dimension::Count,
        |d| Value::Count(d.ce),
        |d| Some(whole([d.ce])),
    )
    .zero_of_nothing(Value::Count(0)),
    Descriptor::new(
        "num_x",
        "NumX",
        "sum of x",
        Dimension::Length,
        |d| Value::Number(d.num_x),
        |d| Some(ratios([d.doubled_sums()[0], 0], 2)),
    )
    .of_place()
    .zero_of_nothing(Value::Number(0.0)),
    Descriptor::new(
        "num_y",
        "NumY",
        "sum of y",
        Dimension::Length,
        |d| Value::Number(d.num_y),
        |d| Some(ratios([d.doubled_sums()[1], 0], 2)),
    )
    .of_place()
    .zero_of_nothing(Value::Number(0.0)),
    Descriptor::new(
        "cg",
        "CG",
        "centre of gravity",
        Dimension::Length,
        |d| Value::Point(d.cg()),
        |d| Some(ratios(d.doubled_sums(), 2 * i64::from(d.na))),
    )
    .of_place(),
    Descriptor::new(
        "p",
        "P",
        "outline length",
        Dimension::Length,
        |d| Value::Number(d.p()),
        |d| Some(whole([d.steps.straight, d.steps.diagonal])),
    ),
    Descriptor::new(
        "f",
        "F",
        "P²/NAE",
        Dimension::Ratio,
        |d| Value::Number(d.f()),
        |d| Some(d.exact_compactness()),
    ),
    Descriptor::new(
        "roundness",
        "Round",
        "4π·NAE/P²",
        Dimension::Ratio,
        |d| d.roundness().map_or(Value::None, Value::Number),
        |d| (d.steps != ChainSteps::default()).then(|| d.exact_compactness()),
    )
    .not_in_answers(),
    Descriptor::new(
        "rect",
        "Rect",
        "upright rectangle",
        Dimension::Length,
        |d| Value::Rect(d.rect),
        |d| {
            let sides = [d.rect.left, d.rect.top, d.rect.right, d.rect.bottom];
            Some(whole(sides.map(u32::from)))
        },
    )
    .of_place(),
    Descriptor::new(
        "cd",
        "CD",
        "rectangle's centre",
        Dimension::Length,
        |d| Value::Point(d.cd()),
        |d| Some(ratios(d.doubled_centre().map(i64::from), 2)),
    )
    .of_place(),
    Descriptor::new(
        "area",
        "Area",
        "rectangle's taxels",
        Dimension::Area,
        |d| Value::Count(d.area()),
        |d| Some(whole([d.area()])),
    )
    .zero_of_nothing(Value::Count(0)),
    Descriptor::new(
        "diagonals",
        "Diag",
        "its diagonals",
        Dimension::Direction,
        |d| Value::Pair(d.diagonals()),
        |d| direction(d.whole_sides().map(i64::from)),
    )
    .of_orientation(false),
    Descriptor::new(
        "side_ratio",
        "Ratio",
        "long / short side",
        Dimension::Ratio,
        |d| Value::Number(d.side_ratio()),
        |d| {
            let [width, height] = d.whole_sides().map(i64::from);
            direction([width.max(height), width.min(height)])
        },
    ),
    Descriptor::new(
        "filling",
        "Fill",
        "NA/Area",
        Dimension::Share,
        |d| Value::Number(d.filling()),
        |d| Some(ratios([i64::from(d.na), 0], i64::from(d.area()))),
    ),
    Descriptor::new(
        "cg_cd",
        "CG-CD",
        "distance CG to CD",
        Dimension::Length,
        |d| Value::Number(d.cg_cd()),
        |d| {
            let [x, y] = d.exact_cg_to_cd();
            let unit = 2 * i64::from(d.na);
            let [x, y, unit] = [x, y, unit].map(|own| own.saturating_mul(own));
            Some(ratios([x.saturating_add(y), 0], unit))
        },
    ),
    Descriptor::new(
        "cg_cd_direction",
        "dir",
        "direction CG to CD",
        Dimension::Direction,
        |d| d.cg_cd_direction().map_or(Value::None, Value::Number),
        |d| direction(d.exact_cg_to_cd()),
    )
    .of_orientation(true),
];

#[cfg(test)]
mod tests {
    use super::*;
    use crate::description::regions;

    #[test]
    fn the_rising_diagonal_is_the_direction_of_the_corner() {
        let imprint: Imprint = "#".parse().expect("an imprint");
        let own = Description::of(&regions(&imprint)[0]);
        for (right, bottom) in
            (1..=64).flat_map(|right| (1..=64).map(move |bottom| (right, bottom)))
        {
            let rect = Bounds {
                right,
                bottom,
                ..own.rect
            };
            let [rising, _] = Description { rect, ..own }.diagonals();
            let corner = libm::atan2(bottom.into(), right.into()).to_degrees();
            assert_eq!(rising, corner, "{right} × {bottom}");
        }
    }

    #[test]
    fn fields_that_no_region_has_do_not_panic() {
        let imprint: Imprint = ".##.\n####".parse().expect("an imprint");
        let own = Description::of(&regions(&imprint)[0]);
        let (bounds, steps) = (own.rect, own.steps);
        let swapped = Bounds {
            left: bounds.right,
            right: bounds.left,
            ..bounds
        };
        let many = ChainSteps {
            straight: u32::MAX,
            diagonal: u32::MAX,
        };
        for rect in [bounds, swapped] {
            for steps in [steps, many] {
                for count in [0, 1, u32::MAX] {
                    for sum in [0.0, f64::NAN, 1e300, f64::NEG_INFINITY] {
                        let (na, nae, ce) = (count, count, count);
                        let (num_x, num_y, kind) = (sum, -sum, own.kind);
                        let odd = Description {
                            kind,
                            na,
                            nae,
                            ce,
                            num_x,
                            num_y,
                            steps,
                            rect,
                        };
                        for row in DESCRIPTORS {
                            let _ = ((row.measure)(&odd), (row.exact)(&odd));
                        }
                    }
                }
            }
        }
    }
}
