use std::collections::BTreeSet;

use crate::formats::drawing::svg::{
    Axis, AxisMarks, Position, Stroke, Svg, circle, cut, line, polyline,
};

/// The marks of an axis between two ends, each with its label: at most about `steps` of them, at steps of 1, 2 or 5
/// times a power of ten, not smaller than `least`.
pub fn axis_marks((low, high): (f64, f64), least: f64, steps: u16) -> Vec<(f64, String)> {
    let smallest = ((high - low) / f64::from(steps.max(1))).max(least);
    let power = libm::pow(10.0, libm::log10(smallest).floor());
    // A small tolerance absorbs the rounding of the logarithm.
    let fits = |factor: &f64| factor * power >= smallest * (1.0 - 1e-9);
    let factor = [1.0, 2.0, 5.0].into_iter().find(fits).unwrap_or(10.0);
    let step = factor * power;
    let decimals = (1..=12_u8).find(|&n| step * 10_f64.powi(n.into()) >= 10.0 * (1.0 - 1e-9));
    let decimals = usize::from(decimals.map_or(12, |n| n - 1));
    let first = (low / step - 1e-9).ceil();
    // Adding 0.0 turns a negative zero into a positive one.
    let place = |index: u32| (first + f64::from(index)) * step + 0.0;
    let last = high + (high - low) * 1e-9;
    let places = (0..=10).map(place).take_while(|&place| place <= last);
    places
        .map(|place| (place, format!("{place:.decimals$}")))
        .collect()
}

/// The ends of an axis for some values: a little beyond the smallest and the largest, so that no point lies on the
/// frame. Without a finite value they are 0 and 1.
pub fn axis_ends(values: impl Iterator<Item = f64>) -> (f64, f64) {
    let nothing = (f64::INFINITY, f64::NEG_INFINITY);
    let (low, high) = values
        .filter(|value| value.is_finite())
        .fold(nothing, |ends, value| {
            (ends.0.min(value), ends.1.max(value))
        });
    if low > high {
        return (0.0, 1.0);
    }
    // The digits of the numbers do not show differences below a billionth of their size.
    let least = low.abs().max(high.abs()).max(1e-6) * 1e-9;
    let beyond = if high - low > least {
        (high - low) * 0.04
    } else {
        high.abs().max(1.0) * 0.1
    };
    (low - beyond, high + beyond)
}

const PLANE: Position = (324.0, 216.0);

/// The most marks of an axis, about.
const STEPS: u16 = 8;

/// The fineness of the plane's width: points closer than one part in this many are drawn once.
const RASTER: f64 = 1000.0;

/// The dashes of the measured curves, in turn; after the last they repeat.
const DASHES: [&str; 4] = ["", "6 3", "1 3", "12 4"];

/// Points and curves to draw.
///
/// ```
/// use taxel_files::formats::Plot;
/// let mut plot = Plot::new("na", "p");
/// plot.points = vec![(18.0, 18.0), (21.0, 20.0)];
/// plot.chosen = Some((18.0, 18.0));
/// assert!(plot.svg().contains(">na</text>"));
/// ```
#[derive(Clone, Debug)]
pub struct Plot {
    labels: [String; 2],
    /// What stands above; only its first 100 characters are drawn.
    pub title: String,
    /// The points; those with a coordinate that is not finite are left out.
    pub points: Vec<(f64, f64)>,
    curves: Vec<Curve>,
    /// A point with a ring around it.
    pub chosen: Option<(f64, f64)>,
    from_zero: bool,
}

#[derive(Clone, Debug)]
struct Curve {
    name: String,
    points: Vec<Position>,
    dash: &'static str,
    /// Whether a circle marks each point.
    circles: bool,
}

impl Plot {
    /// Makes a plot without points; `x` and `y` name its axes, which begin a little before the first point.
    pub fn new(x: &str, y: &str) -> Self {
        Self {
            labels: [cut(x), cut(y)],
            title: String::new(),
            points: Vec::new(),
            curves: Vec::new(),
            chosen: None,
            from_zero: false,
        }
    }

    /// Makes a plot whose axes begin at 0.
    pub fn from_zero(x: &str, y: &str) -> Self {
        Self {
            from_zero: true,
            ..Self::new(x, y)
        }
    }

    /// Adds a line through points, in their order, with a gap where a coordinate is not finite.
    #[must_use]
    pub fn with_line(mut self, name: &str, points: &[(f64, f64)], dashed: bool) -> Self {
        self.curves.push(Curve {
            name: cut(name),
            points: points.to_vec(),
            dash: if dashed { "4 3" } else { "" },
            circles: false,
        });
        self
    }

    /// Adds a line through measured points like [`Self::with_line`], with a circle at each. Each such curve has other
    /// dashes, so that they can be told apart without colours.
    #[must_use]
    pub fn with_curve(mut self, name: &str, points: &[(f64, f64)]) -> Self {
        let dash = DASHES[self.curves.len() % DASHES.len()];
        self = self.with_line(name, points, false);
        if let Some(curve) = self.curves.last_mut() {
            (curve.dash, curve.circles) = (dash, true);
        }
        self
    }

    fn axis(&self, index: usize, of: fn(&Position) -> f64, span: Position) -> Axis {
        let curves = self.curves.iter().flat_map(|curve| &curve.points);
        let all = curves.chain(&self.points).filter(is_drawable).map(of);
        let ends = if self.from_zero {
            let (low, high) = all.fold((0.0, 0.0), |(low, high): Position, value| {
                (low.min(value), high.max(value))
            });
            // Marks less than a billionth apart cannot be labelled.
            (low, if high > 1e-9 { high * 1.05 } else { 1.0 })
        } else {
            axis_ends(all)
        };
        Axis {
            title: self.labels[index].clone(),
            ends,
            span,
            marks: axis_marks(ends, 0.0, STEPS),
        }
    }

    /// The plot as SVG 1.1.
    pub fn svg(&self) -> String {
        let mut svg = Svg::new(PLANE);
        let across = self.axis(0, |point| point.0, (0.0, PLANE.0));
        let along = self.axis(1, |point| point.1, (PLANE.1, 0.0));
        let place = |&(x, y): &Position| (across.place(x), along.place(y));
        svg.axes(AxisMarks::Grid, &across, &along);
        let specks = specks(self.points.iter().filter(is_drawable).map(place));
        svg.line("points", &specks, Stroke::black(2.0));
        for curve in &self.curves {
            let stroke = Stroke::black(1.1).dashed(curve.dash);
            let pieces = curve.points.split(|point| !is_drawable(&point));
            let path: String = pieces
                .map(|piece| polyline(piece.iter().map(place)))
                .collect();
            svg.line("curve", &path, stroke);
            if curve.circles {
                let points = curve.points.iter().filter(is_drawable);
                let circles: String = points.map(|point| circle(place(point), 1.2)).collect();
                svg.line("points", &circles, Stroke::black(0.8));
            }
            svg.legend_of_line(&curve.name, stroke);
        }
        let chosen = self.chosen.iter().find(is_drawable);
        let ring = chosen.map(|chosen| circle(place(chosen), 4.0));
        svg.line("chosen", &ring.unwrap_or_default(), Stroke::black(1.1));
        let [x, y] = &self.labels;
        svg.finish(&format!("{y} against {x}"), &self.title)
    }
}

/// Lines without length, whose round ends are the points; points that lie on each other are drawn once.
#[expect(clippy::cast_possible_truncation, reason = "within the plane")]
fn specks(points: impl Iterator<Item = Position>) -> String {
    let raster = |at: f64| (at * RASTER / PLANE.0).round() as i32;
    let mut seen = BTreeSet::new();
    let new = points.filter(|point| seen.insert((raster(point.0), raster(point.1))));
    new.map(|point| line(point, point)).collect()
}

#[expect(clippy::trivially_copy_pass_by_ref, reason = "a condition of `filter`")]
fn is_drawable(point: &&Position) -> bool {
    point.0.abs() <= 1e300 && point.1.abs() <= 1e300
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn an_axis_may_begin_anywhere() {
        let labels = |low, high, steps| {
            let marks = axis_marks((low, high), 0.0, steps);
            let labels: Vec<String> = marks.into_iter().map(|(_, label)| label).collect();
            labels.join(" ")
        };
        assert_eq!(labels(-190.0, 190.0, 4), "-100 0 100");
        assert_eq!(
            labels(41.7, 43.2, 8),
            "41.8 42.0 42.2 42.4 42.6 42.8 43.0 43.2"
        );
        assert_eq!(labels(-0.02, 0.02, 4), "-0.02 -0.01 0.00 0.01 0.02");
        let ends = |values: &[f64]| axis_ends(values.iter().copied());
        assert_eq!(ends(&[]), (0.0, 1.0));
        assert_eq!(ends(&[f64::NAN]), (0.0, 1.0));
        assert_eq!(ends(&[20.0, 20.0]), (18.0, 22.0));
        assert_eq!(ends(&[0.0]), (-0.1, 0.1));
        assert_eq!(ends(&[0.0, 100.0]), (-4.0, 104.0));
        for (low, high) in [(1e12, 1e12 + 1.0), (-1e300, 1e300), (0.0, 1e-300)] {
            let (low, high) = ends(&[low, high]);
            assert!(
                low < high && axis_marks((low, high), 0.0, 8).len() <= 11,
                "{low} {high}"
            );
        }
    }

    fn labels(length: f64, least: f64) -> Vec<String> {
        let marks = axis_marks((0.0, length), least, 8);
        marks.into_iter().map(|(_, label)| label).collect()
    }

    #[test]
    fn marks_are_round_and_few() {
        let pairs = "0 2 4 6 8 10 12 14 16";
        assert_eq!(labels(16.0, 1.0).join(" "), pairs);
        assert_eq!(labels(1.0, 1.0), ["0", "1"]);
        assert_eq!(labels(64.0, 1.0).join(" "), "0 10 20 30 40 50 60");
        assert_eq!(labels(40.0, 0.0).join(" "), "0 5 10 15 20 25 30 35 40");
        assert_eq!(
            labels(1.6, 0.0).join(" "),
            "0.0 0.2 0.4 0.6 0.8 1.0 1.2 1.4 1.6"
        );
        assert_eq!(
            labels(0.001, 0.0).last().map(String::as_str),
            Some("0.0010")
        );
        for length in [1e-6, 3.7e-3, 0.9, 17.0, 640.0, 6.4e6, 1e12] {
            let labels = labels(length, 0.0);
            assert!((3..=9).contains(&labels.len()), "{length}: {labels:?}");
            let mut different = labels.clone();
            different.dedup();
            assert_eq!(different, labels);
        }
    }
}
