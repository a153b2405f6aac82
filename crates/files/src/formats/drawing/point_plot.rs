//! Points over two axes that begin where the points do: a scatter plot, or curves of a value that has no natural zero.

use std::collections::BTreeSet;

use crate::formats::drawing::axis::axis_ends;
use crate::formats::drawing::plane::{PlotLayout, is_drawable};
use crate::formats::drawing::scene::{DrawingPage, Position, Segment, Stroke, circle, cut};

/// The width and height of the plane, in points.
const PLANE: Position = (324.0, 243.0);

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
    /// The curves: their names, their points, and whether each is dashed.
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

    /// Returns all points, including those of the curves.
    fn all(&self) -> impl Iterator<Item = &Position> {
        let curves = self.curves.iter().flat_map(|(_, points, _)| points);
        curves
            .filter(|point| is_drawable(point))
            .chain(&self.points)
    }

    /// Lays out frame, marks, points and the legend of the curves.
    pub(super) fn page(&self) -> DrawingPage {
        let ends = [
            axis_ends(self.all().map(|point| point.0)),
            axis_ends(self.all().map(|point| point.1)),
        ];
        let titles = self.labels.each_ref().map(String::as_str);
        let mut plot = PlotLayout::new(Some(&self.title), titles, ends, (PLANE, 1.0));
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
        let raster = |at: f64| (at * RASTER / PLANE.0).round() as i32;
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
