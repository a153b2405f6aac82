//! The boundary of a solid as a path, in cell sides.

use std::collections::VecDeque;

use crate::formats::drawing::scene;
use crate::formats::drawing::scene::{Position, Segment};
use crate::geometry::{Ellipse, Pen, Point, Side, Solid};

/// Returns the whole boundary. Edges that follow each other form one piece, so that the corners between them are
/// drawn whole.
pub(super) fn steps(solid: &impl Solid) -> Vec<Segment> {
    let mut tracer = Tracer::default();
    solid.draw(&mut tracer);
    tracer.end(false);
    tracer.steps
}

/// A pen that records the path it draws.
#[derive(Debug, Default)]
struct Tracer {
    /// The path so far.
    steps: Vec<Segment>,
    /// The corners of the current piece. It grows at its end, or at its start if a ring is drawn backwards.
    piece: VecDeque<Position>,
}

impl Tracer {
    /// Adds the current piece to the path.
    fn end(&mut self, closed: bool) {
        let mut corners = self.piece.drain(..);
        self.steps.extend(corners.next().map(Segment::Move));
        self.steps.extend(corners.map(Segment::Line));
        if closed {
            self.steps.push(Segment::Close);
        }
    }
}

impl Pen<f64> for Tracer {
    fn edge(&mut self, from: Point<f64>, to: Point<f64>) {
        let (from, to) = ((from.x, from.y), (to.x, to.y));
        let follows = self.piece.back() == Some(&from);
        let leads = self.piece.front() == Some(&to);
        match (follows, leads) {
            (true, true) => self.end(true),
            (true, false) => self.piece.push_back(to),
            (false, true) => self.piece.push_front(from),
            (false, false) => {
                self.end(false);
                self.piece.extend([from, to]);
            }
        }
    }

    /// Adds the curves of an ellipse. As a single cubic curve, a quarter of an ellipse would be off by 0.03 %; an
    /// eighth is off by far less than a printer can show.
    fn ellipse(&mut self, ellipse: &Ellipse<f64>, _material: Side) {
        let pair = |point: Point<f64>| (point.x, point.y);
        self.end(false);
        self.steps.extend(scene::ellipse(
            pair(ellipse.centre),
            pair(ellipse.across),
            pair(ellipse.along),
        ));
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::figure::Figure;
    use crate::sensor::Sensor;

    #[test]
    fn rings_are_closed_pieces_in_either_sense() {
        let frame = Figure::rectangle(6.0, 3.0)
            .thickness(1.0)
            .on(&Sensor::default())
            .expect("in range");
        let steps = steps(&frame);
        let count = |wanted: fn(&Segment) -> bool| steps.iter().filter(|step| wanted(step)).count();
        assert_eq!(
            count(|step| matches!(step, Segment::Move(_))),
            2,
            "{steps:?}"
        );
        assert_eq!(
            count(|step| matches!(step, Segment::Line(_))),
            6,
            "{steps:?}"
        );
        assert_eq!(count(|step| matches!(step, Segment::Close)), 2, "{steps:?}");
    }

    #[test]
    fn the_curves_of_an_ellipse_stay_close_to_it() {
        let circle = scene::ellipse((1.0, 2.0), (3.0, 0.0), (0.0, 3.0));
        let mut from = (4.0, 2.0);
        for step in circle {
            let Segment::Curve(a, b, to) = step else {
                continue;
            };
            for part in 0..=10 {
                let ahead = f64::from(part) / 10.0;
                let mix = |p: f64, q: f64| p + (q - p) * ahead;
                // De Casteljau's algorithm: interpolate between the corners, then between these points, then again.
                let bend = |corners: [f64; 4]| {
                    let [start, first, second, end] = corners;
                    let middle = mix(first, second);
                    mix(
                        mix(mix(start, first), middle),
                        mix(middle, mix(second, end)),
                    )
                };
                let (x, y) = (
                    bend([from.0, a.0, b.0, to.0]),
                    bend([from.1, a.1, b.1, to.1]),
                );
                let strays = (libm::hypot(x - 1.0, y - 2.0) - 3.0).abs();
                assert!(strays < 3.0 * 1e-5, "{strays}");
            }
            from = to;
        }
    }
}
