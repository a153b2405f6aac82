//! The paper's descriptors of a region, in one table.
//!
//! The panel, tables, JSON and statistics iterate over [`DESCRIPTORS`]; no other part of the program lists the
//! descriptors. Coordinates and units are those of the sensory plane: a taxel has the coordinates of its centre,
//! lengths are in cell sides, areas in cells, and directions in degrees counter-clockwise from +x as seen on the
//! screen. A value that does not exist is [`Value::None`], never a number that is not finite. Points are those of
//! [`glam`].

use glam::DVec2;
use serde::{Serialize, Serializer};

use crate::description::measures::{ChainSteps, Description, ExactValue, direction, ratios, whole};
use crate::description::region::RegionKind;
use crate::imprint::Bounds;

/// The value of a descriptor.
#[derive(Clone, Copy, Debug, PartialEq, Serialize)]
#[serde(untagged)]
pub enum Value {
    /// The descriptor does not exist for this region.
    None,
    /// A whole number.
    Count(u32),
    /// A number.
    Number(f64),
    /// A point of the plane.
    Point(#[serde(serialize_with = "coordinates")] DVec2),
    /// Two directions.
    Pair([f64; 2]),
    /// A rectangle of whole taxels.
    Rect(Bounds),
}

fn coordinates<S: Serializer>(point: &DVec2, serializer: S) -> Result<S::Ok, S::Error> {
    point.to_array().serialize(serializer)
}

impl Value {
    /// Calls `take` with each number of the value, in the order of [`Descriptor::parts`].
    pub(crate) fn each(self, mut take: impl FnMut(f64)) {
        match self {
            Self::None => {}
            Self::Count(count) => take(f64::from(count)),
            Self::Number(number) => take(number),
            Self::Point(point) => [point.x, point.y].into_iter().for_each(take),
            Self::Pair(pair) => pair.into_iter().for_each(take),
            Self::Rect(rect) => {
                let sides = [rect.left, rect.top, rect.right, rect.bottom];
                sides.into_iter().map(f64::from).for_each(take);
            }
        }
    }
}

/// The quantity that a descriptor measures. It decides how a value is converted to millimetres.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash)]
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

/// A row of [`DESCRIPTORS`].
#[derive(Clone, Copy, Debug)]
pub struct Descriptor {
    /// The name in JSON and CSV.
    pub key: &'static str,
    /// The symbol on the screen: that of the paper, if there is one.
    pub symbol: &'static str,
    /// A description in a few words.
    pub name: &'static str,
    /// The quantity that it measures.
    pub dimension: Dimension,
    /// The numbers of a value, in its order, as suffixes of the key; a single empty one for a count or a number. A
    /// value that exists has exactly these numbers.
    pub parts: &'static [&'static str],
    /// Whether it is part of the JSON answers. Their form is fixed; the other descriptors can be computed from those in
    /// them.
    pub in_answer: bool,
    /// Whether a shift of the whole imprint changes its value: it says where an imprint lies, not which shape it has.
    pub of_place: bool,
    /// The value if there is no region: 0 for counts and sums of taxels, and [`Value::None`] for the others.
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
            parts: &[""],
            in_answer: true,
            of_place: false,
            of_nothing: Value::None,
            measure,
            exact,
        }
    }

    const fn with_parts(self, parts: &'static [&'static str]) -> Self {
        Self { parts, ..self }
    }

    /// Marks a descriptor of the imprint's position.
    const fn of_place(mut self) -> Self {
        self.of_place = true;
        self
    }

    const fn zero_of_nothing(mut self, zero: Value) -> Self {
        self.of_nothing = zero;
        self
    }

    const fn not_in_answers(mut self) -> Self {
        self.in_answer = false;
        self
    }

    /// Returns the description for a region of a kind, in a few words.
    pub fn name_of(&self, kind: RegionKind) -> &'static str {
        match kind {
            // The taxels of a hole are inactive.
            RegionKind::Hole if self.key == "na" => "inactive taxels",
            _ => self.name,
        }
    }

    /// Returns the descriptor with a key, such as `"na"`; None if there is none.
    pub fn from_key(key: &str) -> Option<&'static Self> {
        DESCRIPTORS.iter().find(|descriptor| descriptor.key == key)
    }
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
    .with_parts(&["_x", "_y"])
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
    .with_parts(&["_left", "_top", "_right", "_bottom"])
    .of_place(),
    Descriptor::new(
        "cd",
        "CD",
        "rectangle's centre",
        Dimension::Length,
        |d| Value::Point(d.cd()),
        |d| Some(ratios(d.doubled_centre().map(i64::from), 2)),
    )
    .with_parts(&["_x", "_y"])
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
    .with_parts(&["_1", "_2"]),
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
    ),
];

#[cfg(test)]
mod tests {
    use super::*;
    use crate::description::regions;
    use crate::imprint::Imprint;

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

    #[test]
    fn a_descriptor_tells_its_parts_its_place_and_its_value_of_nothing() {
        let parts = |key| Descriptor::from_key(key).expect("in the table").parts;
        assert_eq!(parts("cg"), ["_x", "_y"]);
        assert_eq!(parts("cg_cd_direction"), [""]);
        let zeros = DESCRIPTORS
            .iter()
            .filter(|descriptor| descriptor.of_nothing != Value::None);
        let zeros: Vec<&str> = zeros.map(|descriptor| descriptor.key).collect();
        assert_eq!(zeros, ["na", "nae", "ce", "num_x", "num_y", "area"]);
        let na = Descriptor::from_key("na").expect("in the table");
        assert_eq!(na.name_of(RegionKind::Exterior), "active taxels");
        assert_eq!(na.name_of(RegionKind::Hole), "inactive taxels");
        let of_place = DESCRIPTORS.iter().filter(|descriptor| descriptor.of_place);
        let of_place: Vec<&str> = of_place.map(|descriptor| descriptor.key).collect();
        assert_eq!(of_place, ["num_x", "num_y", "cg", "rect", "cd"]);
        assert!(Descriptor::from_key("colour").is_none());
    }
}
