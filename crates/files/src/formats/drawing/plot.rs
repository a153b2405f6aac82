use crate::formats::drawing::svg::{Axis, AxisMarks, Position, Stroke, Svg, circle, cut, polyline};

/// The marks of an axis between two ends, each with its label: at most about `steps` of them, at steps of 1, 2 or 5
/// times a power of ten, not smaller than `least`.
pub(super) fn axis_marks((low, high): (f64, f64), least: f64, steps: u16) -> Vec<(f64, String)> {
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

const PLANE: Position = (324.0, 216.0);

/// The most marks of an axis, about.
const STEPS: u16 = 8;

/// The dashes of the measured curves, in turn; after the last they repeat.
const DASHES: [&str; 4] = ["", "6 3", "1 3", "12 4"];

/// Curves through measured points, on axes that begin at 0.
///
/// ```
/// use taxel_files::formats::Plot;
/// let plot = Plot::new("pitch", "error").with_curve("0.5", &[(1.0, 0.02), (2.0, 0.3)]);
/// assert!(plot.svg().contains(">error</text>"));
/// ```
#[derive(Clone, Debug)]
pub struct Plot {
    labels: [String; 2],
    curves: Vec<Curve>,
}

#[derive(Clone, Debug)]
struct Curve {
    name: String,
    points: Vec<Position>,
}

impl Plot {
    /// Makes a plot without curves; `x` and `y` name its axes.
    pub fn new(x: &str, y: &str) -> Self {
        Self {
            labels: [cut(x), cut(y)],
            curves: Vec::new(),
        }
    }

    /// Adds a line through points, in their order, with a gap where a coordinate is not finite, and a circle at each.
    /// Each curve has other dashes, so that they can be told apart without colours.
    #[must_use]
    pub fn with_curve(mut self, name: &str, points: &[(f64, f64)]) -> Self {
        self.curves.push(Curve {
            name: cut(name),
            points: points.to_vec(),
        });
        self
    }

    fn axis(&self, index: usize, of: fn(&Position) -> f64, span: Position) -> Axis {
        let points = self.curves.iter().flat_map(|curve| &curve.points);
        let all = points.filter(is_drawable).map(of);
        let (low, high) = all.fold((0.0, 0.0), |(low, high): Position, value| {
            (low.min(value), high.max(value))
        });
        // Marks less than a billionth apart cannot be labelled.
        let ends = (low, if high > 1e-9 { high * 1.05 } else { 1.0 });
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
        for (curve, dash) in self.curves.iter().zip(DASHES.iter().cycle()) {
            let stroke = Stroke::black(1.1).dashed(dash);
            let pieces = curve.points.split(|point| !is_drawable(&point));
            let path: String = pieces
                .map(|piece| polyline(piece.iter().map(place)))
                .collect();
            svg.line("curve", &path, stroke);
            let points = curve.points.iter().filter(is_drawable);
            let circles: String = points.map(|point| circle(place(point), 1.2)).collect();
            svg.line("points", &circles, Stroke::black(0.8));
            svg.legend_of_line(&curve.name, stroke);
        }
        let [x, y] = &self.labels;
        svg.finish(&format!("{y} against {x}"), "")
    }
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
