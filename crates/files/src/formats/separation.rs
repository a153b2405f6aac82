//! Errors against sizes, as files: comma-separated values, and curves to draw.

use std::fmt::Write;

use crate::formats::LinePlot;
use crate::formats::value::decimal;
use crate::recognition::{SeparationPoint, SizeAxis, SmallestSize};

/// The curve of one threshold.
#[derive(Clone, Debug)]
pub struct SeparationCurve {
    /// The threshold.
    pub threshold: f64,
    /// The limit of one touch at each size.
    pub points: Vec<SeparationPoint>,
    /// The smallest size that reaches the wanted error; None if none does, or none is wanted.
    pub smallest: Option<SmallestSize>,
}

/// Formats a value with at most six decimals.
pub fn short(value: f64) -> String {
    decimal(value, 6)
}

/// The words for the sizes on an axis. A coarser pitch makes the shapes smaller in cells, so "larger" alone would say
/// the opposite of what it means for a pitch.
#[derive(Clone, Copy, Debug)]
pub struct SizeWords {
    /// One value of the axis.
    pub noun: &'static str,
    /// Several of them.
    pub(crate) plural: &'static str,
    /// The value at which the shapes are smallest in cells.
    pub smallest: &'static str,
    /// A value at which they are smaller than at another one.
    pub smaller: &'static str,
    /// A value at which they are larger.
    pub larger: &'static str,
    /// The unit after a number, with a space before it; empty for scales.
    pub unit: &'static str,
}

impl SizeWords {
    /// Returns the words for an axis.
    pub const fn of(axis: SizeAxis) -> Self {
        match axis {
            SizeAxis::Scale => Self {
                noun: "scale",
                plural: "scales",
                smallest: "smallest",
                smaller: "smaller",
                larger: "larger",
                unit: "",
            },
            SizeAxis::Pitch => Self {
                noun: "pitch",
                plural: "pitches",
                smallest: "coarsest",
                smaller: "coarser",
                larger: "finer",
                unit: " mm",
            },
        }
    }

    /// Returns a number of larger sizes as the subject of a sentence, with `condition` after the noun and the verb
    /// "miss": `1 finer pitch misses`, `2 finer pitches miss`.
    pub fn larger_miss(&self, count: usize, condition: &str) -> String {
        match count {
            1 => format!("1 {} {}{condition} misses", self.larger, self.noun),
            more => format!("{more} {} {}{condition} miss", self.larger, self.plural),
        }
    }
}

/// Formats a value of the axis with its name and unit.
pub fn size_label(axis: SizeAxis, value: f64) -> String {
    let words = SizeWords::of(axis);
    format!("{} {}{}", words.noun, short(value), words.unit)
}

/// Returns a row of names, then a row for each size and threshold. Shares are written with all digits, counts as
/// whole numbers:
/// ```text
/// scale,threshold,error,touches,right,certain,keys,side
/// 0.5,0.5,0.44907407407407407,864,476,108,20,16
/// ```
pub fn csv(axis: SizeAxis, curves: &[SeparationCurve]) -> String {
    let mut text = format!(
        "{},threshold,error,touches,right,certain,keys,side\n",
        axis.name()
    );
    for point in curves.iter().flat_map(|curve| &curve.points) {
        let _ = writeln!(
            text,
            "{},{},{},{},{},{},{},{}",
            short(point.value),
            short(point.threshold),
            point.error(),
            point.touches,
            point.right,
            point.certain,
            point.keys,
            point.side
        );
    }
    text
}

/// Draws the curves over the sizes, or over the thresholds if there is only one size; and the wanted error.
pub fn drawing(axis: SizeAxis, curves: &[SeparationCurve], wanted: Option<f64>) -> LinePlot {
    let one_size = curves.iter().all(|curve| curve.points.len() == 1);
    if one_size && curves.len() > 1 {
        let points = curves.iter().flat_map(|curve| &curve.points);
        let points: Vec<_> = points
            .map(|point| (point.threshold, point.error()))
            .collect();
        let size = curves[0].points[0].value;
        let plot = LinePlot::new("threshold", "error").with_curve(&size_label(axis, size), &points);
        return with_wanted(plot, wanted, &points);
    }
    let label = match axis {
        SizeAxis::Pitch => "pitch / mm",
        _ => "scale",
    };
    let mut plot = LinePlot::new(label, "error");
    let mut all = Vec::new();
    for curve in curves {
        let points = curve.points.iter();
        let points: Vec<_> = points.map(|point| (point.value, point.error())).collect();
        plot = plot.with_curve(&format!("threshold {}", short(curve.threshold)), &points);
        all.extend(points);
    }
    with_wanted(plot, wanted, &all)
}

/// Adds a line at the wanted error, as long as the curves.
fn with_wanted(plot: LinePlot, wanted: Option<f64>, points: &[(f64, f64)]) -> LinePlot {
    let Some(wanted) = wanted else { return plot };
    let values = || points.iter().map(|point| point.0);
    let first = values().fold(f64::INFINITY, f64::min);
    let last = values().fold(0.0, f64::max);
    let line = [(first, wanted), (last, wanted)];
    plot.with_curve(&format!("wanted {}", short(wanted)), &line)
}
