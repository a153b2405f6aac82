//! Curves over one axis, such as an error against a size. Both axes begin at 0.

use crate::formats::drawing::axis::Ticks;
use crate::formats::drawing::page::{DrawingPage, MARGIN, ROW, TEXT, width};
use crate::formats::drawing::plane::axes;
use crate::formats::drawing::scene::{
    Position, Segment, Stroke, TextAnchor, circle, label, path_of,
};

/// The width and height of the plane, in points.
const PLANE: Position = (324.0, 200.0);

/// The dashes of the curves, in turn; after the last they repeat.
const DASHES: [Option<[f64; 2]>; 4] = [None, Some([6.0, 3.0]), Some([1.0, 3.0]), Some([12.0, 4.0])];

/// The most curves.
const MOST: usize = 32;

/// The most characters of a name; longer ones are cut.
const LONGEST: usize = 60;

/// Curves to draw.
///
/// ```
/// use taxel::formats::LinePlot;
/// let plot = LinePlot::new("scale", "error").with_curve("threshold 0.5", &[(1.0, 0.6), (2.0, 0.1)]);
/// assert!(plot.svg().contains(">scale</text>"));
/// ```
#[derive(Clone, Debug)]
pub struct LinePlot {
    /// The names of the axes with their units: x, y.
    labels: [String; 2],
    /// The name of each curve in the legend, and its points in their order.
    curves: Vec<(String, Vec<Position>)>,
}

impl LinePlot {
    /// Makes a plot without curves; `x` and `y` name its axes.
    pub fn new(x: &str, y: &str) -> Self {
        let cut = |text: &str| text.chars().take(LONGEST).collect();
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
            let name = name.chars().take(LONGEST).collect();
            self.curves.push((name, points.collect()));
        }
        self
    }

    /// Returns the largest number on each axis, above 0.
    fn ends(&self) -> Position {
        let points = self.curves.iter().flat_map(|(_, points)| points);
        let ends = points.fold((0.0_f64, 0.0_f64), |end, point| {
            (end.0.max(point.0), end.1.max(point.1))
        });
        // Marks less than a billionth apart cannot be labelled.
        let end = |end: f64| if end > 1e-9 { end } else { 1.0 };
        (end(ends.0), end(ends.1))
    }

    /// Lays out axes, grid, curves and legend.
    pub(super) fn page(&self) -> DrawingPage {
        let (end_x, end_y) = self.ends();
        let (across, upwards) = (Ticks::new(end_x, 0.0), Ticks::new(end_y, 0.0));
        let corner = (
            MARGIN + TEXT * 2.0 + width(upwards.width()) + 6.0,
            MARGIN + TEXT,
        );
        let end = (corner.0 + PLANE.0, corner.1 + PLANE.1);
        // A twentieth of the plane stays free beyond the last point.
        let scale = (PLANE.0 / (end_x * 1.05), PLANE.1 / (end_y * 1.05));
        let place = |(x, y): Position| (corner.0 + x * scale.0, end.1 - y * scale.1);
        let labels = [&self.labels[0], &self.labels[1]].map(String::as_str);
        let mut marks = axes(labels, (&across, &upwards), (corner, end), &place);
        let (mut right, mut last) = (end.0, end.1 + TEXT * 2.0 + 6.0);
        for (index, (name, points)) in (0_u8..).zip(&self.curves) {
            let line = Stroke {
                dash: DASHES[usize::from(index) % DASHES.len()],
                ..Stroke::black(1.1)
            };
            let points: Vec<Position> = points.iter().map(|&point| place(point)).collect();
            let rest = points.iter().skip(1).map(|&to| Segment::Line(to));
            let path = points.first().map(|&from| Segment::Move(from));
            let path: Vec<Segment> = path.into_iter().chain(rest).collect();
            marks.push(path_of("curve", path, line));
            let dots = points.iter().flat_map(|&point| circle(point, 1.2));
            marks.push(path_of("points", dots.collect(), Stroke::black(0.8)));
            let y = end.1 + TEXT * 4.0 + ROW * f64::from(index);
            last = y;
            let sample = [
                Segment::Move((corner.0, y)),
                Segment::Line((corner.0 + 24.0, y)),
            ];
            marks.push(path_of("legend", sample.to_vec(), line));
            let at = (corner.0 + 30.0, y + TEXT * 0.35);
            marks.push(label(name, at, TextAnchor::Start));
            right = right.max(at.0 + width(name.chars().count()));
        }
        DrawingPage {
            size: (right + MARGIN, last + TEXT * 0.5 + MARGIN),
            plane: (corner, end),
            title: format!("{} against {}", self.labels[1], self.labels[0]),
            marks,
        }
    }
}
