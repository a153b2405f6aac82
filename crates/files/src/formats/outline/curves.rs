//! Paths as rings of points: curves become chords.

use std::f64::consts::{PI, TAU};

use kurbo::{Affine, Arc, Point, SvgArc};
use taxel_core::outline::MOST_POINTS;

use crate::error::ReadError;

/// A closed ring of a path.
#[derive(Debug, Default)]
pub(super) struct PathRing {
    pub(super) points: Vec<Point>,
    /// Maps the unit circle to the ellipse whose chords these are.
    pub(super) ellipse: Option<Affine>,
}

/// Draws paths, each mapped to the plane of the outline.
#[derive(Debug, Default)]
pub(super) struct Chords {
    /// The largest distance between a curve and its chords.
    flatness: f64,
    /// The number of points of all paths.
    count: usize,
    map: Affine,
    rings: Vec<PathRing>,
    /// Where the last segment ended, and the ring began, before they are mapped.
    pub(super) end: Point,
    start: Point,
    /// The arc of the ring that is drawn, if all its segments are arcs of one ellipse.
    arc: Option<Arc>,
}

impl Chords {
    pub(super) fn new(flatness: f64) -> Self {
        Self {
            flatness,
            ..Self::default()
        }
    }

    /// Begins a path that is mapped so.
    pub(super) fn begin(&mut self, map: Affine) {
        self.map = map;
        self.move_to(Point::ZERO);
    }

    /// Returns the rings of the path.
    pub(super) fn finish(&mut self) -> Vec<PathRing> {
        self.close();
        std::mem::take(&mut self.rings)
    }

    pub(super) fn move_to(&mut self, to: Point) {
        self.close();
        (self.start, self.end) = (to, to);
    }

    /// Ends a ring. What follows without a move begins where it began.
    pub(super) fn close(&mut self) {
        let whole = self
            .arc
            .take()
            .filter(|arc| (arc.sweep_angle.abs() - TAU).abs() < 1e-6);
        let ellipse = whole.map(|arc| self.of_circle(&arc));
        if let Some(ring) = self.rings.last_mut() {
            ring.ellipse = ring.ellipse.or(ellipse);
        }
        self.rings.push(PathRing::default());
        self.end = self.start;
    }

    pub(super) fn line_to(&mut self, to: Point) -> Result<(), ReadError> {
        self.begin_segment(None)?;
        self.end_at(to)
    }

    pub(super) fn cubic_to(&mut self, [one, other, to]: [Point; 3]) -> Result<(), ReadError> {
        self.begin_segment(None)?;
        let [a, b, c, d] = [self.end, one, other, to].map(|point| (self.map * point).to_vec2());
        // The second derivative bounds the distance between a curve and its chord.
        let bend = (a - 2.0 * b + c).hypot().max((b - 2.0 * c + d).hypot());
        self.add_between((0.75 * bend / self.flatness).sqrt(), |t| {
            let rest = 1.0 - t;
            let (near, far) = (rest * a + 3.0 * t * b, 3.0 * rest * c + t * d);
            (rest * rest * near + t * t * far).to_point()
        })?;
        self.end_at(to)
    }

    pub(super) fn quadratic_to(&mut self, control: Point, to: Point) -> Result<(), ReadError> {
        let towards = |end: Point| end.lerp(control, 2.0 / 3.0);
        self.cubic_to([towards(self.end), towards(to), to])
    }

    pub(super) fn arc_to(&mut self, own: &SvgArc) -> Result<(), ReadError> {
        match Arc::from_svg_arc(own) {
            Some(arc) => self.arc(arc)?,
            None => self.begin_segment(None)?,
        }
        self.end_at(own.to)
    }

    fn arc(&mut self, arc: Arc) -> Result<(), ReadError> {
        self.begin_segment(Some(arc))?;
        let map = self.of_circle(&arc);
        // The middle of a chord is 1 − cos(half of its angle) radii away from the circle.
        let part = (1.0 - self.flatness / map.spectral_norm()).max(-1.0);
        let half = libm::acos(part).min(PI / 8.0);
        self.add_between(arc.sweep_angle.abs() / (2.0 * half), |t| {
            let (sin, cos) = libm::sincos(arc.start_angle + t * arc.sweep_angle);
            map * Point::new(cos, sin)
        })
    }

    /// Maps the unit circle to the ellipse of an arc.
    fn of_circle(&self, arc: &Arc) -> Affine {
        self.map
            * Affine::translate(arc.center.to_vec2())
            * Affine::rotate(arc.x_rotation)
            * Affine::scale_non_uniform(arc.radii.x, arc.radii.y)
    }

    /// Adds the first point of a ring. If a segment goes on along the same ellipse, both are one arc.
    fn begin_segment(&mut self, arc: Option<Arc>) -> Result<(), ReadError> {
        if self.rings.last().is_none_or(|ring| ring.points.is_empty()) {
            self.arc = arc;
            return self.add(self.map * self.end);
        }
        let near = self.flatness / self.map.spectral_norm();
        self.arc = self.arc.zip(arc).and_then(|(first, next)| {
            let is_same = (first.center - next.center).hypot() < near
                && (first.radii - next.radii).hypot() < near
                && first.x_rotation == next.x_rotation;
            let sweep_angle = first.sweep_angle + next.sweep_angle;
            is_same.then_some(Arc {
                sweep_angle,
                ..first
            })
        });
        Ok(())
    }

    /// Adds the points between this number of chords, rounded up.
    fn add_between(&mut self, chords: f64, at: impl Fn(f64) -> Point) -> Result<(), ReadError> {
        let chords = chords.ceil();
        let mut step = 1.0;
        while step < chords {
            self.add(at(step / chords))?;
            step += 1.0;
        }
        Ok(())
    }

    fn end_at(&mut self, to: Point) -> Result<(), ReadError> {
        self.end = to;
        self.add(self.map * to)
    }

    fn add(&mut self, point: Point) -> Result<(), ReadError> {
        if !(point.x.abs() <= 1e6 && point.y.abs() <= 1e6) {
            let message = "a number is not finite, or a point beyond ±1,000,000";
            return Err(ReadError::new(message));
        }
        self.count += 1;
        if self.count > MOST_POINTS {
            return Err(too_many());
        }
        if let Some(ring) = self.rings.last_mut() {
            ring.points.push(point);
        }
        Ok(())
    }
}

pub(super) fn too_many() -> ReadError {
    let hint = "a larger --flatness makes fewer of curves";
    ReadError::new(format!("more than {MOST_POINTS} points; {hint}"))
}
