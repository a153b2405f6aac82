//! The paper's descriptors of a region, in one table.
//!
//! Panel, tables, JSON and statistics walk [`DESCRIPTORS`]; nothing else in the program lists them. Frame and units
//! are those of the sensory plane: a taxel's coordinates are those of its centre, lengths are cell sides, areas
//! cells, directions degrees counter-clockwise from +x as seen on the screen. A value that does not exist is
//! [`Value::None`], never a number that is not finite. Points are [`glam`]'s.

use std::f64::consts::PI;

use glam::DVec2;

use crate::description::chain::{ChainSteps, OutlineCounts};
use crate::description::region::{Region, RegionKind};
use crate::imprint::{Bounds, Imprint};

/// What is counted and summed up of one region; every descriptor follows from it.
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
            f64::from(self.rect.right - self.rect.left),
            f64::from(self.rect.bottom - self.rect.top),
        )
    }

    fn area(&self) -> u32 {
        u32::from(self.rect.right - self.rect.left) * u32::from(self.rect.bottom - self.rect.top)
    }

    fn diagonals(&self) -> [f64; 2] {
        let sides = self.sides();
        let rising = sides.y.atan2(sides.x).to_degrees();
        [rising, 180.0 - rising]
    }

    fn cg_cd_direction(&self) -> Value {
        let way = self.cd() - self.cg();
        if way.length() < 1e-9 {
            return Value::None;
        }
        // Upwards is counter-clockwise; 0 − y rather than −y, whose zero would be negative and point to −180.
        Value::Number((0.0 - way.y).atan2(way.x).to_degrees())
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

/// What a descriptor's number counts, and so how it goes over into millimetres.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
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

/// A row of [`DESCRIPTORS`].
#[derive(Clone, Copy, Debug)]
#[non_exhaustive]
pub struct Descriptor {
    /// Its name in JSON and CSV.
    pub key: &'static str,
    /// Its name on the screen, the paper's where it has one.
    pub symbol: &'static str,
    /// What it is, in a few words.
    pub name: &'static str,
    /// What it counts.
    pub dimension: Dimension,
    /// Whether it stands in the JSON answers, whose form is fixed; the others can be computed from these.
    pub in_answer: bool,
    /// How it follows from the counts and sums.
    pub measure: fn(&Description) -> Value,
}

const fn row(
    key: &'static str,
    symbol: &'static str,
    name: &'static str,
    dimension: Dimension,
    measure: fn(&Description) -> Value,
) -> Descriptor {
    Descriptor {
        key,
        symbol,
        name,
        dimension,
        in_answer: true,
        measure,
    }
}

/// The table, in the paper's order; `roundness` is what image analysis uses in place of F.
pub const DESCRIPTORS: &[Descriptor] = &[
    row("na", "NA", "active taxels", Dimension::Count, |d| {
        Value::Count(d.na)
    }),
    row("nae", "NAE", "filled taxels", Dimension::Count, |d| {
        Value::Count(d.nae)
    }),
    row("ce", "CE", "outline taxels", Dimension::Count, |d| {
        Value::Count(d.ce)
    }),
    row("num_x", "NumX", "sum of x", Dimension::Length, |d| {
        Value::Number(d.num_x)
    }),
    row("num_y", "NumY", "sum of y", Dimension::Length, |d| {
        Value::Number(d.num_y)
    }),
    row("cg", "CG", "centre of gravity", Dimension::Length, |d| {
        Value::Point(d.cg())
    }),
    row("p", "P", "outline length", Dimension::Length, |d| {
        Value::Number(d.steps.length())
    }),
    row("f", "F", "P²/NAE", Dimension::Ratio, |d| {
        Value::Number(d.steps.length() * d.steps.length() / f64::from(d.nae))
    }),
    Descriptor {
        in_answer: false,
        ..row(
            "roundness",
            "Round",
            "4π·NAE/P²",
            Dimension::Ratio,
            |d| {
                let length = d.steps.length();
                if length > 0.0 {
                    Value::Number(4.0 * PI * f64::from(d.nae) / (length * length))
                } else {
                    Value::None
                }
            },
        )
    },
    row(
        "rect",
        "Rect",
        "upright rectangle",
        Dimension::Length,
        |d| Value::Rect(d.rect),
    ),
    row("cd", "CD", "rectangle's centre", Dimension::Length, |d| {
        Value::Point(d.cd())
    }),
    row("area", "Area", "rectangle's taxels", Dimension::Area, |d| {
        Value::Count(d.area())
    }),
    row(
        "diagonals",
        "Diag",
        "its diagonals",
        Dimension::Direction,
        |d| Value::Pair(d.diagonals()),
    ),
    row(
        "side_ratio",
        "Ratio",
        "long / short side",
        Dimension::Ratio,
        |d| {
            let sides = d.sides();
            Value::Number(sides.max_element() / sides.min_element())
        },
    ),
    row("filling", "Fill", "NA/Area", Dimension::Share, |d| {
        Value::Number(f64::from(d.na) / f64::from(d.area()))
    }),
    row(
        "cg_cd",
        "CG-CD",
        "distance CG to CD",
        Dimension::Length,
        |d| Value::Number(d.cg().distance(d.cd())),
    ),
    row(
        "cg_cd_direction",
        "dir",
        "direction CG to CD",
        Dimension::Direction,
        Description::cg_cd_direction,
    ),
];
