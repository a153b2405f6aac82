//! The plane of a plot: its frame, and its axes with their marks.

use crate::formats::drawing::axis::Ticks;
use crate::formats::drawing::page::{TEXT, upright_title};
use crate::formats::drawing::scene::{
    Element, Position, Segment, Stroke, TextAnchor, label, path_of, rectangle,
};

/// The lines at the marks of both axes.
const GRID: Stroke = Stroke {
    width: 0.4,
    grey: 200,
    dash: None,
};

/// Draws the frame between two corners, lines at the marks of both axes, and the labels of the axes: x, y.
pub(super) fn axes(
    labels: [&str; 2],
    (across, upwards): (&Ticks, &Ticks),
    (from, to): (Position, Position),
    place: &dyn Fn(Position) -> Position,
) -> Vec<Element> {
    let (mut marks, mut grid) = (Vec::new(), Vec::new());
    for (value, text) in &across.0 {
        let (x, _) = place((*value, 0.0));
        grid.extend([Segment::Move((x, from.1)), Segment::Line((x, to.1))]);
        marks.push(label(text, (x, to.1 + TEXT + 3.0), TextAnchor::Middle));
    }
    for (value, text) in &upwards.0 {
        let (_, y) = place((0.0, *value));
        grid.extend([Segment::Move((from.0, y)), Segment::Line((to.0, y))]);
        let at = (from.0 - 5.0, y + TEXT * 0.35);
        marks.push(label(text, at, TextAnchor::End));
    }
    marks.push(path_of("grid", grid, GRID));
    marks.push(path_of("axes", rectangle(from, to), Stroke::black(0.6)));
    let middle = (f64::midpoint(from.0, to.0), f64::midpoint(from.1, to.1));
    let below = (middle.0, to.1 + TEXT * 2.0 + 6.0);
    marks.push(label(labels[0], below, TextAnchor::Middle));
    marks.push(upright_title(labels[1], middle.1));
    marks
}
