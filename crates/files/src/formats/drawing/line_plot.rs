//! Curves over one axis, such as an error against a size. Both axes begin at 0.

use crate::formats::drawing::plane::PlotLayout;
use crate::formats::drawing::scene::{DrawingPage, Position, Stroke, circle};

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
/// use taxel_files::formats::LinePlot;
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

    /// Returns the ends of an axis: 0 and the largest number, or 1 if that is 0.
    fn ends(&self, number: fn(&Position) -> f64) -> (f64, f64) {
        let points = self.curves.iter().flat_map(|(_, points)| points);
        let end = points.map(number).fold(0.0, f64::max);
        // Marks less than a billionth apart cannot be labelled.
        (0.0, if end > 1e-9 { end } else { 1.0 })
    }

    /// Lays out axes, grid, curves and legend.
    pub(super) fn page(&self) -> DrawingPage {
        let ends = [self.ends(|point| point.0), self.ends(|point| point.1)];
        let titles = self.labels.each_ref().map(String::as_str);
        // A twentieth of the plane stays free beyond the last point.
        let mut plot = PlotLayout::new(None, titles, ends, (PLANE, 1.05));
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
