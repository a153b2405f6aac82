//! The plane of a drawing: its frame and axes, and the page of a plot around it.
//! ```text
//!      title              title of x
//!   y +-------+           y  0   1   2
//!     |-+---+-|             +---------+
//!     |-+---+-|             |         |
//!     +-------+             +---------+
//!       0   1             outside: the marks of a matrix or map, x above
//!   title of x
//!   -- legend             grid: the marks of a plot, x below
//! ```

use std::collections::BTreeSet;

use crate::formats::drawing::svg;
use crate::formats::drawing::svg::{
    DrawingPage, Element, MARGIN, Position, ROW, Segment, Stroke, TEXT, TextAnchor, circle, cut,
    label, path_of, rectangle, upright_title, width,
};

const GRID: Stroke = Stroke {
    width: 0.4,
    grey: 200,
    dash: None,
};

/// The marks of the two axes of a plane.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) enum AxisMarks {
    /// Lines across the plane; those of x have their numbers below.
    Grid,
    /// Short lines outside; those of x are above, so that y runs downwards from them.
    Outside,
}

/// Returns the width of everything to the left of a plane, for an upright axis with these marks.
pub(super) fn left_of(upright: &Ticks) -> f64 {
    MARGIN + TEXT * 2.0 + width(upright.width()) + 6.0
}

/// Draws the frame between two corners, and the axes with their titles: x, y. `place` maps numbers to the page.
pub(super) fn axes(
    kind: AxisMarks,
    titles: [&str; 2],
    (across, upwards): (&Ticks, &Ticks),
    (from, to): (Position, Position),
    place: impl Fn(Position) -> Position,
) -> Vec<Element> {
    // The ends of the lines at the marks, and the base lines of the numbers and of the title of x.
    let (start, end, numbers, title) = match kind {
        AxisMarks::Grid => (from, to, to.1 + TEXT + 3.0, to.1 + TEXT * 2.0 + 6.0),
        AxisMarks::Outside => {
            let (start, numbers) = ((from.0 - 3.0, from.1 - 3.0), from.1 - 5.0);
            (start, from, numbers, numbers - TEXT * 1.5)
        }
    };
    let (mut marks, mut lines) = (Vec::new(), Vec::new());
    for (value, text) in &across.0 {
        let (x, _) = place((*value, 0.0));
        lines.extend([Segment::Move((x, start.1)), Segment::Line((x, end.1))]);
        marks.push(label(text, (x, numbers), TextAnchor::Middle));
    }
    for (value, text) in &upwards.0 {
        let (_, y) = place((0.0, *value));
        lines.extend([Segment::Move((start.0, y)), Segment::Line((end.0, y))]);
        let at = (from.0 - 5.0, y + TEXT * 0.35);
        marks.push(label(text, at, TextAnchor::End));
    }
    let mut frame = rectangle(from, to);
    match kind {
        AxisMarks::Grid => marks.push(path_of("grid", lines, GRID)),
        AxisMarks::Outside => frame.extend(lines),
    }
    marks.push(path_of("axes", frame, Stroke::black(0.6)));
    let middle = (f64::midpoint(from.0, to.0), f64::midpoint(from.1, to.1));
    marks.push(label(titles[0], (middle.0, title), TextAnchor::Middle));
    marks.push(upright_title(titles[1], middle.1));
    marks
}

pub(super) struct PlotLayout {
    /// The title of the page, for screen readers.
    title: String,
    /// The top left and the bottom right corner of the plane.
    plane: (Position, Position),
    /// The numbers at the bottom left corner.
    origin: Position,
    /// The points for each unit of the numbers.
    scale: Position,
    marks: Vec<Element>,
    /// The right end of everything so far.
    right: f64,
    /// The middle of the last line of text so far.
    bottom: f64,
    rows: u32,
}

impl PlotLayout {
    /// Draws a plane of this size with its title and the titles of its axes: x, y. The axes have marks between `ends`;
    /// `stretch` is the length of an axis as a multiple of the distance between its ends.
    pub(super) fn new(
        title: Option<&str>,
        titles: [&str; 2],
        [across, upwards]: [(f64, f64); 2],
        (size, stretch): (Position, f64),
    ) -> Self {
        let (x, y) = (Ticks::new(across, 0.0), Ticks::new(upwards, 0.0));
        let above = title.filter(|title| !title.is_empty());
        let above = above.map_or(0.0, |_| ROW);
        let from = (left_of(&y), MARGIN + TEXT + above);
        let to = (from.0 + size.0, from.1 + size.1);
        let length = |(low, high): (f64, f64)| (high - low) * stretch;
        let mut plot = Self {
            title: format!("{} against {}", titles[1], titles[0]),
            plane: (from, to),
            origin: (across.0, upwards.0),
            scale: (size.0 / length(across), size.1 / length(upwards)),
            marks: Vec::new(),
            right: to.0,
            bottom: to.1 + TEXT * 2.0 + 6.0,
            rows: 0,
        };
        if let Some(title) = title {
            plot.text(title, (from.0, MARGIN + TEXT));
        }
        let place = |point| plot.place(point);
        let axes = axes(AxisMarks::Grid, titles, (&x, &y), (from, to), place);
        plot.marks.extend(axes);
        plot
    }

    pub(super) fn place(&self, (x, y): Position) -> Position {
        let ((left, _), (_, bottom)) = self.plane;
        (
            left + (x - self.origin.0) * self.scale.0,
            bottom - (y - self.origin.1) * self.scale.1,
        )
    }

    pub(super) fn draw(&mut self, what: &'static str, path: Vec<Segment>, line: Stroke) {
        self.marks.push(path_of(what, path, line));
    }

    /// Adds a line through points of the plot, broken at those that cannot be drawn.
    pub(super) fn curve(&mut self, points: &[Position], line: Stroke) {
        let mut drawn = false;
        let mut path = Vec::new();
        for point in points {
            if is_drawable(point) {
                let to = self.place(*point);
                path.push(if drawn {
                    Segment::Line(to)
                } else {
                    Segment::Move(to)
                });
            }
            drawn = is_drawable(point);
        }
        self.draw("curve", path, line);
    }

    /// Adds a row of the legend: a piece of a curve's line, and its name.
    pub(super) fn legend(&mut self, name: &str, line: Stroke) {
        let ((left, _), (_, bottom)) = self.plane;
        self.bottom = bottom + TEXT * 4.0 + ROW * f64::from(self.rows);
        self.rows += 1;
        let y = self.bottom;
        let sample = [Segment::Move((left, y)), Segment::Line((left + 24.0, y))];
        self.draw("legend", sample.to_vec(), line);
        self.text(name, (left + 30.0, y + TEXT * 0.35));
    }

    /// Adds a text, which may widen the page.
    fn text(&mut self, text: &str, place: Position) {
        self.right = self.right.max(place.0 + width(text.chars().count()));
        self.marks.push(label(text, place, TextAnchor::Start));
    }

    pub(super) fn page(self) -> DrawingPage {
        DrawingPage {
            size: (self.right + MARGIN, self.bottom + TEXT * 0.5 + MARGIN),
            plane: self.plane,
            title: self.title,
            marks: self.marks,
        }
    }
}

fn is_drawable(point: &Position) -> bool {
    point.0.abs() <= 1e300 && point.1.abs() <= 1e300
}

const STEPS: f64 = 8.0;

/// The marks of an axis: their places in its unit, and their labels.
#[derive(Clone, Debug, PartialEq)]
pub(super) struct Ticks(pub(super) Vec<(f64, String)>);

impl Ticks {
    /// Makes marks from one number to another, at steps of 1, 2 or 5 times a power of ten, none smaller than
    /// `least`; at most about eight steps.
    pub(super) fn new(ends: (f64, f64), least: f64) -> Self {
        Self::between(ends, least, STEPS)
    }

    pub(super) fn between((low, high): (f64, f64), least: f64, steps: f64) -> Self {
        let smallest = ((high - low) / steps).max(least);
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
        Self(
            places
                .map(|place| (place, format!("{place:.decimals$}")))
                .collect(),
        )
    }

    pub(super) fn width(&self) -> usize {
        let widths = self.0.iter().map(|(_, label)| label.chars().count());
        widths.max().unwrap_or(0)
    }
}

/// Returns the marks of an axis between two ends, each with its label: at most about `steps` of them.
pub fn axis_marks(ends: (f64, f64), steps: u16) -> Vec<(f64, String)> {
    let steps = f64::from(steps.max(1));
    Ticks::between(ends, 0.0, steps).0
}

/// Returns the ends of an axis for some values: a little beyond the smallest and the largest, so that no point lies
/// on the frame. Without a finite value they are 0 and 1.
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

const LINES: Position = (324.0, 200.0);

/// The dashes of the curves, in turn; after the last they repeat.
const DASHES: [Option<[f64; 2]>; 4] = [None, Some([6.0, 3.0]), Some([1.0, 3.0]), Some([12.0, 4.0])];

const MOST: usize = 32;

/// Curves to draw.
///
/// ```
/// use taxel_files::formats::LinePlot;
/// let plot = LinePlot::new("scale", "error").with_curve("threshold 0.5", &[(1.0, 0.6), (2.0, 0.1)]);
/// assert!(plot.svg().contains(">scale</text>"));
/// ```
#[derive(Clone, Debug)]
pub struct LinePlot {
    labels: [String; 2],
    curves: Vec<(String, Vec<Position>)>,
}

impl LinePlot {
    /// Makes a plot without curves; `x` and `y` name its axes.
    pub fn new(x: &str, y: &str) -> Self {
        Self {
            labels: [cut(x), cut(y)],
            curves: Vec::new(),
        }
    }

    /// Adds a curve through points, in their order; points that are below 0 or not finite are left out. Only the
    /// first 32 curves are kept.
    #[must_use]
    pub fn with_curve(mut self, name: &str, points: &[(f64, f64)]) -> Self {
        if self.curves.len() < MOST {
            let shown = |number: f64| (0.0..=1e9).contains(&number);
            let points = points
                .iter()
                .copied()
                .filter(|&(x, y)| shown(x) && shown(y));
            self.curves.push((cut(name), points.collect()));
        }
        self
    }

    fn ends(&self, number: fn(&Position) -> f64) -> (f64, f64) {
        let points = self.curves.iter().flat_map(|(_, points)| points);
        let end = points.map(number).fold(0.0, f64::max);
        // Marks less than a billionth apart cannot be labelled.
        (0.0, if end > 1e-9 { end } else { 1.0 })
    }

    /// The plot as SVG 1.1.
    pub fn svg(&self) -> String {
        svg::write(&self.page())
    }

    fn page(&self) -> DrawingPage {
        let ends = [self.ends(|point| point.0), self.ends(|point| point.1)];
        let titles = self.labels.each_ref().map(String::as_str);
        // A twentieth of the plane stays free beyond the last point.
        let mut plot = PlotLayout::new(None, titles, ends, (LINES, 1.05));
        for ((name, points), dash) in self.curves.iter().zip(DASHES.iter().cycle()) {
            let line = Stroke {
                dash: *dash,
                ..Stroke::black(1.1)
            };
            plot.curve(points, line);
            let dots = points
                .iter()
                .flat_map(|&point| circle(plot.place(point), 1.2));
            plot.draw("points", dots.collect(), Stroke::black(0.8));
            plot.legend(name, line);
        }
        plot.page()
    }
}

const POINTS: Position = (324.0, 243.0);

/// The fineness of the plane's width: points closer than one part in this many are drawn once.
const RASTER: f64 = 1000.0;

/// Points and curves to draw.
///
/// ```
/// use taxel_files::formats::PointPlot;
/// let plot = PointPlot::new("na", "p").with_points(&[(18.0, 18.0), (21.0, 20.0)]).with_chosen(18.0, 18.0);
/// assert!(plot.svg().contains(">na</text>"));
/// ```
#[derive(Clone, Debug)]
pub struct PointPlot {
    labels: [String; 2],
    title: String,
    points: Vec<Position>,
    curves: Vec<(String, Vec<Position>, bool)>,
    chosen: Option<Position>,
}

impl PointPlot {
    /// Makes a plot without points; `x` and `y` name its axes.
    pub fn new(x: &str, y: &str) -> Self {
        Self {
            labels: [cut(x), cut(y)],
            title: String::new(),
            points: Vec::new(),
            curves: Vec::new(),
            chosen: None,
        }
    }

    /// Adds a title above; only its first 100 characters are kept.
    #[must_use]
    pub fn with_title(mut self, title: &str) -> Self {
        self.title = cut(title);
        self
    }

    /// Adds points; those with a coordinate that is not finite are left out.
    #[must_use]
    pub fn with_points(mut self, points: &[(f64, f64)]) -> Self {
        self.points
            .extend(points.iter().filter(|point| is_drawable(point)));
        self
    }

    /// Adds a curve through points, in their order, with a gap where a coordinate is not finite.
    #[must_use]
    pub fn with_curve(mut self, name: &str, points: &[(f64, f64)]) -> Self {
        self.curves.push((cut(name), points.to_vec(), false));
        self
    }

    /// Adds a curve like [`Self::with_curve`], but dashed: it can be told from the others without colours.
    #[must_use]
    pub fn with_dashed_curve(mut self, name: &str, points: &[(f64, f64)]) -> Self {
        self.curves.push((cut(name), points.to_vec(), true));
        self
    }

    /// Adds a ring around a point.
    #[must_use]
    pub fn with_chosen(mut self, x: f64, y: f64) -> Self {
        self.chosen = Some((x, y)).filter(is_drawable);
        self
    }

    fn all(&self) -> impl Iterator<Item = &Position> {
        let curves = self.curves.iter().flat_map(|(_, points, _)| points);
        curves
            .filter(|point| is_drawable(point))
            .chain(&self.points)
    }

    /// The plot as SVG 1.1.
    pub fn svg(&self) -> String {
        svg::write(&self.page())
    }

    fn page(&self) -> DrawingPage {
        let ends = [
            axis_ends(self.all().map(|point| point.0)),
            axis_ends(self.all().map(|point| point.1)),
        ];
        let titles = self.labels.each_ref().map(String::as_str);
        let mut plot = PlotLayout::new(Some(&self.title), titles, ends, (POINTS, 1.0));
        plot.draw("points", self.specks(&plot), Stroke::black(2.0));
        for (name, points, dashed) in &self.curves {
            let line = Stroke {
                dash: dashed.then_some([4.0, 3.0]),
                ..Stroke::black(1.1)
            };
            plot.curve(points, line);
            plot.legend(name, line);
        }
        if let Some(chosen) = self.chosen {
            let ring = circle(plot.place(chosen), 4.0);
            plot.draw("chosen", ring, Stroke::black(1.1));
        }
        plot.page()
    }

    /// Returns lines without length, whose round ends are the points; points that lie on each other are drawn once.
    #[expect(clippy::cast_possible_truncation, reason = "within the plane")]
    fn specks(&self, plot: &PlotLayout) -> Vec<Segment> {
        let raster = |at: f64| (at * RASTER / POINTS.0).round() as i32;
        let mut seen = BTreeSet::new();
        let mut specks = Vec::new();
        for point in self.points.iter().map(|&point| plot.place(point)) {
            if seen.insert((raster(point.0), raster(point.1))) {
                specks.extend([Segment::Move(point), Segment::Line(point)]);
            }
        }
        specks
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn an_axis_may_begin_anywhere() {
        let labels = |low, high, steps| {
            let marks = axis_marks((low, high), steps);
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
                low < high && axis_marks((low, high), 8).len() <= 11,
                "{low} {high}"
            );
        }
    }

    fn labels(length: f64, least: f64) -> Vec<String> {
        let Ticks(marks) = Ticks::new((0.0, length), least);
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
