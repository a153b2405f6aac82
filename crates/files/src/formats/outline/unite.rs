//! The union of paths that overlap, as rings that do not cross.

use std::collections::{BTreeMap, HashMap};

use i_overlay::core::fill_rule::FillRule;
use i_overlay::core::overlay::{IntOverlayOptions, Overlay};
use i_overlay::core::overlay_rule::OverlayRule;
use i_overlay::core::simplify::Simplify;
use i_overlay::core::solver::Solver;
use i_overlay::i_float::int::point::IntPoint;
use kurbo::{Affine, Ellipse, Point, Rect};
use taxel_core::outline::{EllipseRing, MOST_POINTS, Outline, Ring};

use super::curves::{PathRing, too_many};
use crate::error::ReadError;

/// A filled path.
#[derive(Debug)]
pub(super) struct Path {
    pub(super) rings: Vec<PathRing>,
    pub(super) rule: FillRule,
}

/// How often edges may meet, which those of one ring do, too: each crossing takes memory.
const MOST_CROSSINGS: usize = 200_000;

type Points = Vec<IntPoint<i64>>;
type Edge = [IntPoint<i64>; 2];

/// Unites paths. Ellipses whose chords are this close to them, and that nothing touches, stay ellipses.
///
/// Points are rounded to a decimal grid of 10⁹ to 10¹⁰ steps in the drawing's size, and united as whole numbers. On such a
/// grid, rings may come so close to each other that an outline is refused; they are then united on a slightly finer one.
pub(super) fn unite(paths: &[Path], flatness: f64) -> Result<Vec<Ring>, ReadError> {
    let rings = paths.iter().flat_map(|path| &path.rings);
    let mut points = rings.flat_map(|ring| &ring.points);
    let Some(&first) = points.next() else {
        return Ok(Vec::new());
    };
    let seen = points.fold(Rect::from_points(first, first), |seen, &point| {
        seen.union_pt(point)
    });
    let size = seen.width().max(seen.height());
    let mut steps = 1.0;
    let sides = [seen.x0, seen.y0, seen.x1, seen.y1].map(f64::abs);
    let farthest = sides.into_iter().fold(1e-6, f64::max);
    // Whole numbers beyond that would have more digits than the points.
    while size * steps < 1e9 && farthest * steps < 1e15 {
        steps *= 10.0;
    }
    let mut refused = None;
    for stretch in [1.0, 1.1, 1.3, 1.7, 2.3] {
        let rings = Grid(steps * stretch).unite(paths, size, flatness)?;
        if rings.is_empty() {
            return Ok(rings);
        }
        match Outline::new(rings.clone(), None) {
            Ok(_) => return Ok(rings),
            Err(error) => refused = Some(error),
        }
    }
    let reason = refused.map_or_else(String::new, |error| error.to_string());
    Err(ReadError::new(format!("paths cannot be united: {reason}")))
}

/// The number of steps in a unit of the drawing.
#[derive(Clone, Copy)]
struct Grid(f64);

#[expect(
    clippy::cast_possible_truncation,
    clippy::cast_precision_loss,
    reason = "the steps of a drawing are far below the largest whole number"
)]
impl Grid {
    fn unite(self, paths: &[Path], size: f64, flatness: f64) -> Result<Vec<Ring>, ReadError> {
        let steps = |ring: &PathRing| -> Points {
            let points = ring.points.iter();
            points.map(|&point| self.step(point)).collect()
        };
        let rings_of = |path: &Path| -> Vec<Points> { path.rings.iter().map(steps).collect() };
        check_crossings(&paths.iter().flat_map(rings_of).collect::<Vec<_>>())?;
        // Points along an edge stay, where another ring may touch it.
        let options = IntOverlayOptions::keep_all_points();
        let part = |path: &Path| rings_of(path).simplify(path.rule, options);
        let parts: Vec<Points> = paths.iter().flat_map(part).flatten().collect();
        // Each part runs around its material in the same sense, so what any of them covers is not zero.
        let mut union = Overlay::from_subj_custom(&parts, options, Solver::default());
        let shapes = union.overlay(OverlayRule::Subject, FillRule::NonZero);
        let mut united: Vec<Points> = shapes.into_iter().flatten().collect();
        united.retain(|ring| !self.is_sliver(ring, size));
        straighten(&mut united);
        let drawn = paths.iter().flat_map(|path| &path.rings);
        let ellipses: BTreeMap<_, _> = drawn
            .filter_map(|ring| Some((sorted(&steps(ring)), ring.ellipse?)))
            .collect();
        let rings: Vec<Ring> = united
            .iter()
            .map(|ring| {
                let ellipse = ellipses.get(&sorted(ring));
                let mut others = united.iter().filter(|other| !std::ptr::eq(*other, ring));
                match ellipse {
                    Some(&map) if !others.any(|other| self.touches(map, flatness, other)) => {
                        self.ellipse(map)
                    }
                    _ => Ring::Polygon(
                        ring.iter()
                            .map(|&own| <(f64, f64)>::from(self.point(own)).into())
                            .collect(),
                    ),
                }
            })
            .collect();
        let count = |ring: &Ring| match ring {
            Ring::Polygon(points) => points.len(),
            Ring::Ellipse(_) => 0,
        };
        if rings.iter().map(count).sum::<usize>() > MOST_POINTS {
            return Err(too_many());
        }
        Ok(rings)
    }

    fn step(self, point: Point) -> IntPoint<i64> {
        let [x, y] = [point.x, point.y].map(|own| (own * self.0).round() as i64);
        IntPoint::new(x, y)
    }

    fn point(self, own: IntPoint<i64>) -> Point {
        Point::new(own.x as f64 / self.0, own.y as f64 / self.0)
    }

    fn round(self, length: f64) -> f64 {
        (length * self.0).round() / self.0
    }

    /// Returns true if a ring is thinner than two steps, or has less area than an outline may have.
    fn is_sliver(self, ring: &Points, size: f64) -> bool {
        let next = ring.iter().cycle().skip(1);
        let (mut area, mut length) = (0.0, 0.0);
        let first = self.point(ring[0]);
        for (&from, &to) in ring.iter().zip(next) {
            let (from, to) = (self.point(from), self.point(to));
            area += (from - first).cross(to - first) / 2.0;
            length += (to - from).hypot();
        }
        area.abs() < (length / self.0).max(2e-12 * size * size)
    }

    /// Whether the ring of an ellipse touches another ring, or nearly does.
    fn touches(self, map: Affine, flatness: f64, ring: &Points) -> bool {
        let [one, other] = ellipse(map).radii;
        // Outlines are checked for crossings with 256 chords, which are up to 0.0001 radii away.
        let margin = 2.0 * flatness / one.min(other) + 1e-4;
        let to_circle = map.inverse();
        let mapped = |own: &IntPoint<i64>| (to_circle * self.point(*own)).to_vec2();
        let next = ring.iter().cycle().skip(1);
        margin > 0.5
            || ring.iter().zip(next).any(|(from, to)| {
                let (from, to) = (mapped(from), mapped(to));
                let way = to - from;
                let part = (-from.dot(way) / way.hypot2()).clamp(0.0, 1.0);
                let nearest = (from + part * way).hypot();
                let farthest = from.hypot().max(to.hypot());
                nearest < 1.0 + margin && farthest > 1.0 - margin
            })
    }

    fn ellipse(self, map: Affine) -> Ring {
        let own = ellipse(map);
        let [one, other] = own.radii.map(|radius| self.round(radius));
        // A circle looks the same however it is turned.
        let turns = if one == other { 0.0 } else { own.angle };
        Ring::Ellipse(EllipseRing {
            centre: own.centre.map(|place| self.round(place)),
            radii: [one, other],
            angle: (turns * 1e9).round() / 1e9,
        })
    }
}

/// Returns the ellipse to which the unit circle is mapped.
fn ellipse(map: Affine) -> EllipseRing {
    let [a, b, c, d, ..] = map.as_coeffs();
    let radii = [libm::hypot(a, b), libm::hypot(c, d)];
    let are_axes = (a * c + b * d).abs() < 1e-12 * radii[0] * radii[1];
    let (radii, angle) = if are_axes {
        (radii, libm::atan2(b, a))
    } else {
        let circle = Ellipse::new(Point::ZERO, (1.0, 1.0), 0.0);
        let (radii, angle) = (map * circle).radii_and_rotation();
        ([radii.x, radii.y], angle)
    };
    EllipseRing {
        centre: <(f64, f64)>::from(map.translation()).into(),
        radii,
        angle: angle.to_degrees().rem_euclid(180.0),
    }
}

/// Leaves out points within a step of the line between their neighbours, unless another ring meets them there.
fn straighten(rings: &mut [Points]) {
    let mut counts = HashMap::new();
    for point in rings.iter().flatten() {
        *counts.entry(*point).or_insert(0) += 1;
    }
    for ring in rings {
        // The first point stays: of two that nearly coincide, each could otherwise be left out because of the other.
        let first = (0..ring.len()).min_by_key(|&index| (ring[index].x, ring[index].y));
        ring.rotate_left(first.unwrap_or_default());
        let old = std::mem::take(ring);
        ring.extend(old.first());
        let Some(mut before) = old.first().copied() else {
            continue;
        };
        let next = old.iter().cycle().skip(2);
        for (&point, &next) in old.iter().skip(1).zip(next) {
            let [to_point, to_next] = [point - before, next - before];
            let beside = to_point.cross_product(to_next).unsigned_abs();
            if counts[&point] > 1 || beside.saturating_pow(2) > to_next.sqr_length() {
                ring.push(point);
                before = point;
            }
        }
    }
}

/// The points of a ring, wherever it begins and however it runs.
fn sorted(ring: &Points) -> Vec<[i64; 2]> {
    let mut points: Vec<[i64; 2]> = ring.iter().map(|point| [point.x, point.y]).collect();
    points.sort_unstable();
    points.dedup();
    points
}

/// Checks that uniting the rings does not take too long.
fn check_crossings(rings: &[Points]) -> Result<(), ReadError> {
    let ends = |ring: &Points| {
        let next = ring.iter().cycle().skip(1);
        let ends = ring.iter().copied().zip(next.copied());
        ends.map(|(from, to)| {
            if from.x < to.x {
                [from, to]
            } else {
                [to, from]
            }
        })
        .collect()
    };
    let mut edges: Vec<Edge> = rings.iter().flat_map::<Vec<Edge>, _>(ends).collect();
    edges.sort_unstable_by_key(|[left, _]| left.x);
    let mut count = 0;
    for (number, one) in edges.iter().enumerate() {
        let others = edges[number + 1..].iter();
        let near = others.take_while(|[left, _]| left.x <= one[1].x);
        count += near.filter(|other| meet(one, other)).count();
        if count > MOST_CROSSINGS {
            let message = format!("paths cross more than {MOST_CROSSINGS} times");
            return Err(ReadError::new(message));
        }
    }
    Ok(())
}

fn meet(one: &Edge, other: &Edge) -> bool {
    let side = |[from, to]: &Edge, point: IntPoint<i64>| {
        let along = *to - *from;
        along.cross_product(point - *from).signum()
    };
    let [low, high] = [one[0].y.min(one[1].y), one[0].y.max(one[1].y)];
    other.iter().any(|end| end.y >= low)
        && other.iter().any(|end| end.y <= high)
        && side(one, other[0]) * side(one, other[1]) <= 0
        && side(other, one[0]) * side(other, one[1]) <= 0
}
