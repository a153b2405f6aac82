//! The errors of a set at several sizes and thresholds: as a table and a plot for people, as JSON and CSV, and as a
//! drawing.
//!
//! Each row is a training of its own: all shapes at this scale, or in cells of this pitch, on the smallest sensor that
//! holds them. A plot has the error on the y axis, from 0, and the size on the x axis, or the threshold if there is only
//! one size.

use std::fmt::Write;

use serde::Serialize;
use serde_json::Value;
use taxel_core::pose::DecimalRange;
use taxel_core::recognition::{SeparationPoint, SizeAxis, SmallestSize};
use taxel_files::formats::value::{decimal, grouped, percent};
use taxel_files::formats::{Plot, json};

use crate::cli::output::charset::Charset;
use crate::cli::output::evaluation::number;
use crate::cli::output::plot;

/// Returns the table and a plot for each threshold. `wanted` is the error of `--want`; the result of its search comes
/// last, in a sentence for each threshold.
pub(crate) fn text(
    axis: SizeAxis,
    sizes: &DecimalRange,
    curves: &[SeparationCurve],
    wanted: Option<f64>,
    charset: Charset,
) -> String {
    let mut text = format!(
        "{:<9} threshold    error  certain   imprints  sensor\n",
        axis.name()
    );
    for point in curves.iter().flat_map(|curve| &curve.points) {
        // Cannot fail: the text is kept in memory.
        let _ = writeln!(
            text,
            "{:<9} {:>9}  {:>7}  {:>7}  {:>9}  {side} × {side}",
            short(point.value),
            short(point.threshold),
            percent(point.error()),
            percent(point.certain_share()),
            grouped(point.keys as u64),
            side = point.side
        );
    }
    if sizes.count() > 1 {
        for curve in curves {
            let points = curve.points.iter();
            let points: Vec<_> = points.map(|point| (point.value, point.error())).collect();
            if curves.len() > 1 {
                let _ = writeln!(text, "\nthreshold {}", short(curve.threshold));
            } else {
                text.push('\n');
            }
            text += &plot::lines("error", axis.name(), &points, charset);
        }
    } else if curves.len() > 1 {
        let points = curves.iter().flat_map(|curve| &curve.points);
        let points: Vec<_> = points
            .map(|point| (point.threshold, point.error()))
            .collect();
        text.push('\n');
        text += &plot::lines("error", "threshold", &points, charset);
    }
    if let Some(wanted) = wanted {
        text.push('\n');
        text += &all_found(axis, sizes, curves, wanted);
    }
    charset.lines(&text)
}

pub(crate) fn all_found(
    axis: SizeAxis,
    sizes: &DecimalRange,
    curves: &[SeparationCurve],
    wanted: f64,
) -> String {
    let sentences = curves.iter().map(|curve| {
        let found = found(axis, sizes.step(), curve, wanted);
        if curves.len() > 1 {
            format!("threshold {}: {found}", short(curve.threshold))
        } else {
            found
        }
    });
    sentences.collect()
}

/// Returns what a search found, and how it searched. The steps are named because the error is not monotonic in the
/// size: a size between two that were tried may reach the wanted error as well.
fn found(axis: SizeAxis, step: f64, curve: &SeparationCurve, wanted: f64) -> String {
    let words = SizeWords::of(axis);
    let SizeWords {
        noun,
        smallest: extreme,
        smaller,
        larger,
        unit,
        ..
    } = words;
    let wanted = short(wanted);
    let Some(smallest) = &curve.smallest else {
        return format!("no {noun} that was tried has an error of at most {wanted}\n");
    };
    let mut text = format!(
        "the {extreme} {noun} with an error of at most {wanted} is {}{unit}: {}\n",
        short(smallest.point.value),
        percent(smallest.point.error())
    );
    if curve.points.len() == 1 {
        let _ = writeln!(text, "  no other {noun} was tried");
        return text;
    }
    if smallest.step > 0.0 {
        let (coarse, fine) = (short(step), short(smallest.step));
        let _ = writeln!(
            text,
            "  tried from the {extreme} on in steps of {coarse}{unit}, then in steps of {fine}{unit} just before the first that reaches it"
        );
    } else {
        let _ = writeln!(
            text,
            "  no {smaller} {noun} was tried; one may reach the error as well"
        );
    }
    let _ = match smallest.missed_again {
        0 => writeln!(
            text,
            "  every {larger} {noun} that was tried reaches it, too"
        ),
        count => writeln!(
            text,
            "  the error is not monotonic: {} it again",
            words.larger_miss(count, " that was tried")
        ),
    };
    text
}

/// Returns one object: the axis, the points, and with `--want` the results of its search, one for each threshold,
/// with null if no size reaches the error.
pub(crate) fn json_text(axis: SizeAxis, curves: &[SeparationCurve], wanted: Option<f64>) -> String {
    let point = |point: &SeparationPoint| PointJson {
        pitch_mm: (axis == SizeAxis::Pitch).then_some(point.value),
        scale: point.scale,
        threshold: point.threshold,
        error: point.error(),
        touches: number(point.touches),
        right: number(point.right),
        certain: number(point.certain),
        keys: point.keys,
        side: point.side,
    };
    let points = curves.iter().flat_map(|curve| &curve.points);
    let found = |error: f64, curve: &SeparationCurve| FoundJson {
        threshold: curve.threshold,
        error,
        smallest: curve.smallest.as_ref().map(|it| point(&it.point)),
        step: curve.smallest.as_ref().map(|it| it.step),
        missed_again: curve.smallest.as_ref().map(|it| it.missed_again),
    };
    let answer = CurvesJson {
        axis: axis.name(),
        points: points.map(point).collect(),
        want: wanted.map(|error| curves.iter().map(|curve| found(error, curve)).collect()),
    };
    json::text(&answer) + "\n"
}

#[derive(Serialize)]
struct CurvesJson {
    axis: &'static str,
    points: Vec<PointJson>,
    #[serde(skip_serializing_if = "Option::is_none")]
    want: Option<Vec<FoundJson>>,
}

#[derive(Serialize)]
struct PointJson {
    /// The pitch in mm, if pitches were given; `scale` follows from it.
    #[serde(skip_serializing_if = "Option::is_none")]
    pitch_mm: Option<f64>,
    scale: f64,
    threshold: f64,
    error: f64,
    touches: Value,
    right: Value,
    certain: Value,
    keys: usize,
    side: u8,
}

/// The result of a search; `smallest`, `step` and `missed_again` are null if no size reaches the error.
#[derive(Serialize)]
struct FoundJson {
    threshold: f64,
    error: f64,
    smallest: Option<PointJson>,
    /// The step of the search; 0 if the smallest scale that was tried reaches the error, so that smaller ones may
    /// reach it too.
    step: Option<f64>,
    /// The number of larger scales, that is, finer pitches, whose error is too large again.
    missed_again: Option<usize>,
}

/// The curve of one threshold.
#[derive(Clone, Debug)]
pub(crate) struct SeparationCurve {
    /// The threshold.
    pub(crate) threshold: f64,
    /// The limit of one touch at each size.
    pub(crate) points: Vec<SeparationPoint>,
    /// The smallest size that reaches the wanted error; None if none does, or none is wanted.
    pub(crate) smallest: Option<SmallestSize>,
}

/// Formats a value with at most six decimals.
pub(crate) fn short(value: f64) -> String {
    decimal(value, 6)
}

/// The words for the sizes on an axis. A coarser pitch makes the shapes smaller in cells, so "larger" alone would say
/// the opposite of what it means for a pitch.
#[derive(Clone, Copy, Debug)]
pub(crate) struct SizeWords {
    /// One value of the axis.
    pub(crate) noun: &'static str,
    /// Several of them.
    pub(crate) plural: &'static str,
    /// The value at which the shapes are smallest in cells.
    pub(crate) smallest: &'static str,
    /// A value at which they are smaller than at another one.
    pub(crate) smaller: &'static str,
    /// A value at which they are larger.
    pub(crate) larger: &'static str,
    /// The unit after a number, with a space before it; empty for scales.
    pub(crate) unit: &'static str,
}

impl SizeWords {
    /// Returns the words for an axis.
    pub(crate) const fn of(axis: SizeAxis) -> Self {
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
    pub(crate) fn larger_miss(&self, count: usize, condition: &str) -> String {
        match count {
            1 => format!("1 {} {}{condition} misses", self.larger, self.noun),
            more => format!("{more} {} {}{condition} miss", self.larger, self.plural),
        }
    }
}

/// Formats a value of the axis with its name and unit.
pub(crate) fn size_label(axis: SizeAxis, value: f64) -> String {
    let words = SizeWords::of(axis);
    format!("{} {}{}", words.noun, short(value), words.unit)
}

/// Returns a row of names, then a row for each size and threshold. Shares are written with all digits, counts as
/// whole numbers:
/// ```text
/// scale,threshold,error,touches,right,certain,keys,side
/// 0.5,0.5,0.44907407407407407,864,476,108,20,16
/// ```
pub(crate) fn csv(axis: SizeAxis, curves: &[SeparationCurve]) -> String {
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
pub(crate) fn drawing(axis: SizeAxis, curves: &[SeparationCurve], wanted: Option<f64>) -> Plot {
    let one_size = curves.iter().all(|curve| curve.points.len() == 1);
    if one_size && curves.len() > 1 {
        let points = curves.iter().flat_map(|curve| &curve.points);
        let points: Vec<_> = points
            .map(|point| (point.threshold, point.error()))
            .collect();
        let size = curves[0].points[0].value;
        let plot =
            Plot::from_zero("threshold", "error").with_curve(&size_label(axis, size), &points);
        return with_wanted(plot, wanted, &points);
    }
    let label = match axis {
        SizeAxis::Pitch => "pitch / mm",
        SizeAxis::Scale => "scale",
    };
    let mut plot = Plot::from_zero(label, "error");
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
fn with_wanted(plot: Plot, wanted: Option<f64>, points: &[(f64, f64)]) -> Plot {
    let Some(wanted) = wanted else { return plot };
    let values = || points.iter().map(|point| point.0);
    let first = values().fold(f64::INFINITY, f64::min);
    let last = values().fold(0.0, f64::max);
    let line = [(first, wanted), (last, wanted)];
    plot.with_curve(&format!("wanted {}", short(wanted)), &line)
}
