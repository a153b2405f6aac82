//! The errors of a set at several sizes and thresholds: as a table and a plot for people, and as JSON.
//!
//! Each row is a training of its own: all shapes at this scale, or in cells of this pitch, on the smallest sensor that
//! holds them. A plot has the error on the y axis, from 0, and the size on the x axis, or the threshold if there is only
//! one size.

use std::fmt::Write;

use serde::Serialize;
use serde_json::Value;

use crate::cli::output::charset::Charset;
use crate::cli::output::evaluation::number;
use crate::cli::output::plot;
use crate::formats::json;
use crate::formats::separation::{SeparationCurve, SizeWords, short};
use crate::formats::value::{grouped, percent};
use crate::pose::DecimalRange;
use crate::recognition::{SeparationPoint, SizeAxis};

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
