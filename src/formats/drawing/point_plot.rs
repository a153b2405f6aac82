//! Points over two axes that begin where the points do: a scatter plot, or curves of a value that has no natural zero.

use std::collections::BTreeSet;

use crate::formats::drawing::axis::{Ticks, axis_ends};
use crate::formats::drawing::page::{DrawingPage, MARGIN, ROW, TEXT, cut, width};
use crate::formats::drawing::plane::axes;
use crate::formats::drawing::scene::{
    Position, Segment, Stroke, TextAnchor, circle, label, path_of,
};

/// The width and height of the plane, in points.
const PLANE: Position = (324.0, 243.0);

/// The most steps between the marks of an axis.
const STEPS: f64 = 8.0;

/// The fineness of the plane's width: points closer than one part in this many are drawn once.
const RASTER: f64 = 1000.0;

/// Points and curves to draw.
///
/// ```
/// use taxel::formats::PointPlot;
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
            .extend(points.iter().filter(|point| finite(point)));
        self
    }

    /// Adds a curve through points, in their order, with a gap where a coordinate is not finite. A dashed curve can
    /// be told from the others without colours.
    #[must_use]
    pub fn with_curve(mut self, name: &str, points: &[(f64, f64)], dashed: bool) -> Self {
        self.curves.push((cut(name), points.to_vec(), dashed));
        self
    }

    /// Adds a ring around a point.
    #[must_use]
    pub fn with_chosen(mut self, x: f64, y: f64) -> Self {
        self.chosen = Some((x, y)).filter(finite);
        self
    }

    /// Returns all points, including those of the curves.
    fn all(&self) -> impl Iterator<Item = &Position> {
        let curves = self.curves.iter().flat_map(|(_, points, _)| points);
        curves.filter(|point| finite(point)).chain(&self.points)
    }

    /// Lays out frame, marks, points and the legend of the curves.
    pub(super) fn page(&self) -> DrawingPage {
        let (from_x, to_x) = axis_ends(self.all().map(|point| point.0));
        let (from_y, to_y) = axis_ends(self.all().map(|point| point.1));
        let across = Ticks::between((from_x, to_x), 0.0, STEPS);
        let upwards = Ticks::between((from_y, to_y), 0.0, STEPS);
        let above = if self.title.is_empty() { 0.0 } else { ROW };
        let corner = (
            MARGIN + TEXT * 2.0 + width(upwards.width()) + 6.0,
            MARGIN + TEXT + above,
        );
        let end = (corner.0 + PLANE.0, corner.1 + PLANE.1);
        let scale = (PLANE.0 / (to_x - from_x), PLANE.1 / (to_y - from_y));
        let place = |(x, y): Position| {
            (
                corner.0 + (x - from_x) * scale.0,
                end.1 - (y - from_y) * scale.1,
            )
        };
        let mut marks = vec![label(
            &self.title,
            (corner.0, MARGIN + TEXT),
            TextAnchor::Start,
        )];
        let labels = [&self.labels[0], &self.labels[1]].map(String::as_str);
        marks.extend(axes(labels, (&across, &upwards), (corner, end), &place));
        marks.push(path_of("points", self.specks(&place), Stroke::black(2.0)));
        let mut last = end.1 + TEXT * 2.0 + 6.0;
        let mut right = end.0.max(corner.0 + width(self.title.chars().count()));
        for (index, (name, points, dashed)) in (0_u32..).zip(&self.curves) {
            let line = Stroke {
                dash: dashed.then_some([4.0, 3.0]),
                ..Stroke::black(1.1)
            };
            marks.push(path_of("curve", curve(points, &place), line));
            last = end.1 + TEXT * 4.0 + ROW * f64::from(index);
            let sample = [(corner.0, last), (corner.0 + 24.0, last)];
            marks.push(path_of("legend", curve(&sample, &|place| place), line));
            let at = (corner.0 + 30.0, last + TEXT * 0.35);
            marks.push(label(name, at, TextAnchor::Start));
            right = right.max(at.0 + width(name.chars().count()));
        }
        if let Some(chosen) = self.chosen {
            marks.push(path_of(
                "chosen",
                circle(place(chosen), 4.0),
                Stroke::black(1.1),
            ));
        }
        DrawingPage {
            size: (right + MARGIN, last + TEXT * 0.5 + MARGIN),
            plane: (corner, end),
            title: format!("{} against {}", self.labels[1], self.labels[0]),
            marks,
        }
    }

    /// Returns lines without length, whose round ends are the points; points that lie on each other are drawn once.
    #[expect(clippy::cast_possible_truncation, reason = "within the plane")]
    fn specks(&self, place: &dyn Fn(Position) -> Position) -> Vec<Segment> {
        let raster = |at: f64| (at * RASTER / PLANE.0).round() as i32;
        let mut seen = BTreeSet::new();
        let mut specks = Vec::new();
        for point in self.points.iter().map(|&point| place(point)) {
            if seen.insert((raster(point.0), raster(point.1))) {
                specks.extend([Segment::Move(point), Segment::Line(point)]);
            }
        }
        specks
    }
}

/// Returns true if a point can be drawn.
fn finite(point: &Position) -> bool {
    point.0.abs() <= 1e300 && point.1.abs() <= 1e300
}

/// Returns the path through points, broken where one cannot be drawn.
fn curve(points: &[Position], place: &dyn Fn(Position) -> Position) -> Vec<Segment> {
    let mut drawn = false;
    let mut path = Vec::new();
    for point in points {
        if finite(point) {
            let to = place(*point);
            path.push(if drawn {
                Segment::Line(to)
            } else {
                Segment::Move(to)
            });
        }
        drawn = finite(point);
    }
    path
}
