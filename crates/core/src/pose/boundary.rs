//! The stored boundary of a shape: drawn once, and used for all positions that differ by a shift.
//!
//! Sweeps cut bands from it in `f64`; for cases that `f64` cannot decide, it is drawn as
//! [`Double`](crate::geometry::Double). The frame and the units are those of the plane; the anchor of the shape is at
//! the origin.

use crate::geometry::Real;
use crate::geometry::{Ellipse, Extent, Moving, Pen, Point, Side, Solid};

/// The boundary of a shape: straight edges with the material on their right, and ellipses.
#[derive(Clone, Debug)]
pub(crate) struct Boundary<T> {
    pub(crate) edges: Vec<(Point<T>, Point<T>)>,
    pub(crate) ellipses: Vec<(Ellipse<T>, Side)>,
}

impl<T: Real> Boundary<T> {
    pub(crate) fn of(solid: &impl Solid) -> Self {
        let mut boundary = Self {
            edges: Vec::new(),
            ellipses: Vec::new(),
        };
        solid.draw(&mut boundary);
        boundary
    }

    /// Draws the stored boundary, shifted.
    pub(crate) fn draw(&self, by: Point<T>, pen: &mut impl Pen<T>) {
        let mut pen = Moving { by, pen };
        for &(from, to) in &self.edges {
            pen.edge(from, to);
        }
        for (ellipse, material) in &self.ellipses {
            pen.ellipse(ellipse, *material);
        }
    }

    /// Returns the centre of a figure: that of its ellipse, or the mean of its corners. A concentric hole does not
    /// change it.
    pub(crate) fn mean(&self) -> Point<T> {
        if let Some((ellipse, _)) = self.ellipses.first() {
            return ellipse.centre;
        }
        let (mut sum, mut count) = (Point::new(T::ZERO, T::ZERO), 0);
        for &(from, _) in &self.edges {
            sum = sum.moved(from);
            count += 1;
        }
        let count = T::whole(count.max(1));
        Point::new(sum.x / count, sum.y / count)
    }

    /// Returns the middle of the bounding rectangle of the edges; the origin if there are none.
    pub(crate) fn middle(&self) -> Point<T> {
        let Some(&(first, _)) = self.edges.first() else {
            return Point::new(T::ZERO, T::ZERO);
        };
        let (mut low, mut high) = (first, first);
        for &(from, _) in &self.edges {
            low = Point::new(low.x.min(from.x), low.y.min(from.y));
            high = Point::new(high.x.max(from.x), high.y.max(from.y));
        }
        Point::new((low.x + high.x) * T::HALF, (low.y + high.y) * T::HALF)
    }
}

impl Boundary<f64> {
    pub(crate) fn extent(&self) -> Option<Extent> {
        Extent::drawn(|pen| self.draw(Point::new(0.0, 0.0), pen))
    }
}

impl<T: Real> Pen<T> for Boundary<T> {
    fn edge(&mut self, from: Point<T>, to: Point<T>) {
        self.edges.push((from, to));
    }
    fn ellipse(&mut self, ellipse: &Ellipse<T>, material: Side) {
        self.ellipses.push((*ellipse, material));
    }
}
