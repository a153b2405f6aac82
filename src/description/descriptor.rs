//! The paper's descriptors of a region, in one table.
//!
//! The panel, tables, JSON and statistics iterate over [`DESCRIPTORS`]; nothing else in the program lists them.
//! Coordinates and units are those of the sensory plane: a taxel has the coordinates of its centre, lengths are in cell
//! sides, areas in cells, and directions in degrees counter-clockwise from +x as seen on the screen. A value that does
//! not exist is [`Value::None`], never a number that is not finite. Points are [`glam`]'s.

use std::f64::consts::PI;

use glam::DVec2;

use crate::description::chain::{ChainSteps, OutlineCounts};
use crate::description::region::{Region, RegionKind};
use crate::imprint::{Bounds, Imprint};

/// The counts and sums of one region, from which every descriptor follows. Coordinates and lengths are in cell sides,
/// directions in degrees counter-clockwise from +x as seen on the screen. If its fields are changed to numbers that no region
/// has, descriptors may be of no use, or NaN, but nothing panics.
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
    /// Whether a piece or a hole is described.
    pub kind: RegionKind,
    /// Taxels of the region.
    pub na: u32,
    /// Taxels of the region with everything it encloses.
    pub nae: u32,
    /// Outline taxels of the filled region.
    pub ce: u32,
    /// Sum of the taxels' x coordinates.
    pub num_x: f64,
    /// Sum of their y coordinates.
    pub num_y: f64,
    /// The steps around the filled region.
    pub steps: ChainSteps,
    /// The circumscribed rectangle.
    pub rect: Bounds,
}

impl Description {
    /// Counts and sums of a region.
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

    /// Centre of gravity of the region's taxels.
    pub fn cg(&self) -> DVec2 {
        DVec2::new(self.num_x, self.num_y) / f64::from(self.na)
    }

    /// Centre of the circumscribed rectangle.
    pub fn cd(&self) -> DVec2 {
        let middle = |low: u8, high: u8| f64::from(u16::from(low) + u16::from(high)) / 2.0;
        DVec2::new(
            middle(self.rect.left, self.rect.right),
            middle(self.rect.top, self.rect.bottom),
        )
    }

    fn sides(&self) -> DVec2 {
        DVec2::new(
            f64::from(self.rect.right) - f64::from(self.rect.left),
            f64::from(self.rect.bottom) - f64::from(self.rect.top),
        )
    }

    /// P, the length of the outline.
    pub fn p(&self) -> f64 {
        self.steps.length()
    }

    /// F = P²/NAE.
    pub fn f(&self) -> f64 {
        self.p() * self.p() / f64::from(self.nae)
    }

    /// The number of taxels of the circumscribed rectangle.
    pub fn area(&self) -> u32 {
        self.rect.area()
    }

    /// The longer side of the rectangle divided by the shorter one.
    pub fn side_ratio(&self) -> f64 {
        let sides = self.sides();
        sides.max_element() / sides.min_element()
    }

    /// NA divided by the area of the rectangle, above 0 up to 1.
    pub fn filling(&self) -> f64 {
        f64::from(self.na) / f64::from(self.area())
    }

    /// The distance of CG and CD.
    pub fn cg_cd(&self) -> f64 {
        self.cg().distance(self.cd())
    }

    /// The directions of the rectangle's two diagonals, 0 to below 180 degrees.
    pub fn diagonals(&self) -> [f64; 2] {
        let sides = self.sides();
        let rising = libm::atan2(sides.y, sides.x).to_degrees();
        [rising, 180.0 - rising]
    }

    /// The width and height of the rectangle.
    fn whole_sides(&self) -> [i64; 2] {
        let rect = self.rect;
        [(rect.left, rect.right), (rect.top, rect.bottom)]
            .map(|(low, high)| i64::from(high) - i64::from(low))
    }

    /// Twice the sums of the coordinates, which are whole.
    fn doubled_sums(&self) -> [i64; 2] {
        #[expect(
            clippy::cast_possible_truncation,
            reason = "at most 4096 coordinates of at most 64"
        )]
        [self.num_x, self.num_y].map(|sum| (2.0 * sum) as i64)
    }

    /// Twice the coordinates of the rectangle's centre, which are whole.
    fn doubled_centre(&self) -> [i64; 2] {
        let rect = self.rect;
        [(rect.left, rect.right), (rect.top, rect.bottom)]
            .map(|(low, high)| i64::from(low) + i64::from(high))
    }

    /// The vector from the centre of gravity to the rectangle's centre, in units of 1/(2 NA).
    fn exact_cg_to_cd(&self) -> [i64; 2] {
        let (sums, centre) = (self.doubled_sums(), self.doubled_centre());
        [0, 1].map(|axis| (i64::from(self.na) * centre[axis]).saturating_sub(sums[axis]))
    }

    /// P²/NAE as a + b√2.
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

    /// 4π·NAE/P²; None of a single taxel, whose P is 0.
    pub fn roundness(&self) -> Option<f64> {
        let length = self.p();
        (length > 0.0).then(|| 4.0 * PI * f64::from(self.nae) / (length * length))
    }

    /// The direction from CG to CD, above −180 up to 180 degrees; None if they are less than 1e-9 apart.
    pub fn cg_cd_direction(&self) -> Option<f64> {
        let way = self.cd() - self.cg();
        // Upwards is counter-clockwise; 0 − y rather than −y, whose zero would be negative and point to −180.
        (way.length() >= 1e-9).then(|| libm::atan2(0.0 - way.y, way.x).to_degrees())
    }
}

/// Taxels, sum of their columns and sum of their rows.
fn sums(taxels: &Imprint, bounds: Bounds) -> (u32, u32, u32) {
    let (mut count, mut columns, mut rows) = (0, 0, 0);
    for row in bounds.rows() {
        let mut word = taxels.words()[usize::from(row)];
        let mut in_row = 0;
        // Run by run: the columns of a run add up to its length times their mean.
        while word != 0 {
            let first = word.trailing_zeros();
            let length = (word >> first).trailing_ones();
            columns += length * (2 * first + length - 1) / 2;
            in_row += length;
            word &= u64::MAX.unbounded_shl(first + length);
        }
        count += in_row;
        rows += u32::from(row) * in_row;
    }
    (count, columns, rows)
}

/// A descriptor's value.
#[derive(Clone, Copy, Debug, PartialEq)]
#[non_exhaustive]
pub enum Value {
    /// Does not exist for this region.
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

/// What a descriptor's number measures, and so how it converts to millimetres.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash)]
#[non_exhaustive]
pub enum Dimension {
    /// Taxels, or another pure count.
    Count,
    /// Cell sides; times the pitch in mm.
    Length,
    /// Cells; times the square of the pitch in mm².
    Area,
    /// Degrees, counter-clockwise from +x as seen on the screen.
    Direction,
    /// A pure number.
    Ratio,
    /// A share, shown in %.
    Share,
}

/// Whether a descriptor changes when the whole imprint is moved, turned or mirrored on its matrix.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash)]
#[non_exhaustive]
pub struct ChangesUnder {
    /// Moved by whole taxels.
    pub shift: bool,
    /// Turned by 90°.
    pub quarter_turn: bool,
    /// Mirrored left to right.
    pub mirror: bool,
}

impl ChangesUnder {
    /// The same for every position and orientation of the imprint.
    const NOTHING: Self = Self {
        shift: false,
        quarter_turn: false,
        mirror: false,
    };
    /// Depends on where the imprint lies.
    const SHIFTS: Self = Self {
        shift: true,
        quarter_turn: true,
        mirror: true,
    };
}

/// A descriptor's value as whole numbers, so that equal values are equal exactly: ratios in lowest terms, lengths as
/// numbers of steps. None where the value does not exist.
pub type ExactValue = Option<[i64; 4]>;

/// A row of [`DESCRIPTORS`].
#[derive(Clone, Copy, Debug)]
#[non_exhaustive]
pub struct Descriptor {
    /// Its name in JSON and CSV.
    pub key: &'static str,
    /// Its name on the screen: that of the paper, if it has one.
    pub symbol: &'static str,
    /// A description in a few words.
    pub name: &'static str,
    /// What it counts.
    pub dimension: Dimension,
    /// Whether the JSON answers contain it. Their form is fixed; the other descriptors can be computed from those in
    /// it.
    pub in_answer: bool,
    /// What changes it. One that changes with shifts alone says nothing about the shape.
    pub changes_under: ChangesUnder,
    /// Its value if there is nothing to describe: 0 for counts and sums of taxels; the others do not exist.
    ///
    /// ```
    /// use taxel::description::{DESCRIPTORS, Value};
    /// let zeros = DESCRIPTORS.iter().filter(|descriptor| descriptor.of_nothing != Value::None);
    /// let zeros: Vec<&str> = zeros.map(|descriptor| descriptor.key).collect();
    /// assert_eq!(zeros, ["na", "nae", "ce", "num_x", "num_y", "area"]);
    /// ```
    pub of_nothing: Value,
    /// How it follows from the counts and sums.
    pub measure: fn(&Description) -> Value,
    /// Two imprints have the same value exactly if this is the same. Unlike [`Self::measure`], it does not round.
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

    /// One that says where the imprint lies.
    const fn of_place(self) -> Self {
        Self {
            changes_under: ChangesUnder::SHIFTS,
            ..self
        }
    }

    /// One that counts or sums up taxels, and so is 0 without any.
    const fn zero_of_nothing(self, zero: Value) -> Self {
        Self {
            of_nothing: zero,
            ..self
        }
    }

    /// One that changes with quarter turns, and perhaps with mirror images.
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

    /// One that the answers leave out.
    const fn not_in_answers(self) -> Self {
        Self {
            in_answer: false,
            ..self
        }
    }

    /// Returns its description for a region of that kind, in a few words. The taxels of a hole are inactive.
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

    /// Returns the descriptor with that key, such as `"na"`.
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

/// Counts, exactly.
fn whole<const N: usize>(numbers: [u32; N]) -> [i64; 4] {
    let mut exact = [0; 4];
    for (slot, number) in exact.iter_mut().zip(numbers) {
        *slot = i64::from(number);
    }
    exact
}

/// Two ratios with one positive denominator, each in lowest terms.
fn ratios(numerators: [i64; 2], denominator: i64) -> [i64; 4] {
    let [one, other] = numerators.map(|numerator| {
        // 0 only for a description whose fields were changed.
        let common = gcd(numerator.unsigned_abs(), denominator.unsigned_abs()).max(1);
        [numerator / common, denominator / common]
    });
    [one[0], one[1], other[0], other[1]]
}

/// The direction of a vector; None if its length is 0.
fn direction([x, y]: [i64; 2]) -> ExactValue {
    let common = gcd(x.unsigned_abs(), y.unsigned_abs());
    (common > 0).then(|| [x / common, y / common, 0, 0])
}

/// The greatest common divisor of numbers far below 2⁶³; 0 for two zeros.
fn gcd(one: u64, other: u64) -> i64 {
    let (mut one, mut other) = (one, other);
    while other > 0 {
        (one, other) = (other, one % other);
    }
    one.cast_signed()
}

/// The table, in the paper's order; `roundness` is what image analysis uses instead of F.
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
        |d| Some(ratios(d.doubled_centre(), 2)),
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
        |d| direction(d.whole_sides()),
    )
    .of_orientation(false),
    Descriptor::new(
        "side_ratio",
        "Ratio",
        "long / short side",
        Dimension::Ratio,
        |d| Value::Number(d.side_ratio()),
        |d| {
            let [width, height] = d.whole_sides();
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
    fn fields_that_no_region_has_are_no_panic() {
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
