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

use crate::formats::drawing::axis::Ticks;
use crate::formats::drawing::scene::{
    DrawingPage, Element, MARGIN, Position, ROW, Segment, Stroke, TEXT, TextAnchor, label, path_of,
    rectangle, upright_title, width,
};

/// The lines of a grid.
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

/// The page of a plot while it is being laid out.
pub(super) struct PlotLayout {
    /// The title of the page, for screen readers.
    title: String,
    /// The top left and the bottom right corner of the plane.
    plane: (Position, Position),
    /// The numbers at the bottom left corner.
    origin: Position,
    /// The points for each unit of the numbers.
    scale: Position,
    /// The marks so far.
    marks: Vec<Element>,
    /// The right end of everything so far.
    right: f64,
    /// The middle of the last line of text so far.
    bottom: f64,
    /// The number of rows of the legend so far.
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

    /// Returns the position on the page of a point of the plot.
    pub(super) fn place(&self, (x, y): Position) -> Position {
        let ((left, _), (_, bottom)) = self.plane;
        (
            left + (x - self.origin.0) * self.scale.0,
            bottom - (y - self.origin.1) * self.scale.1,
        )
    }

    /// Adds a path on the page; `what` is the class in SVG.
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

    /// Returns the page.
    pub(super) fn page(self) -> DrawingPage {
        DrawingPage {
            size: (self.right + MARGIN, self.bottom + TEXT * 0.5 + MARGIN),
            plane: self.plane,
            title: self.title,
            marks: self.marks,
        }
    }
}

/// Returns true if a point can be drawn.
pub(super) fn is_drawable(point: &Position) -> bool {
    point.0.abs() <= 1e300 && point.1.abs() <= 1e300
}
