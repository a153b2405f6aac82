//! Coverages by a second, slower method, written independently of the first: clip the outline to each cell and measure
//! it.
//!
//! Polygons are clipped by I. E. Sutherland and G. W. Hodgman, *Reentrant polygon clipping* (1974), and measured by
//! the shoelace formula. An ellipse is mapped to the unit disc together with the cell, and the disc's share of the
//! resulting parallelogram is a sum of triangles and sectors about its centre. Vertices come from the definitions of
//! the figures, not from the code under test. If a cell's coverage equals the threshold, the methods may differ in
//! `f64`; then the taxel must be active, because the decimals drawn here have two digits, and no near miss comes that
//! close.

use std::f64::consts::PI;

use taxel_core::figure::{Figure, FigureKind};
use taxel_core::geometry::Solid;
use taxel_core::imprint::Imprint;
use taxel_core::parameter::Parameter;
use taxel_core::picture::Picture;
use taxel_core::source::Source;
use taxel_core::touch::Plane;

use crate::common::{Random, sensor, size};

/// The number of poses of each of the seven kinds; that of pictures follows.
const POSES: u32 = 30_000;
const PICTURES: u32 = 20_000;

/// The largest difference between the methods, as a share of a cell.
const AGREEMENT: f64 = 1e-9;
/// A coverage that is this close to the threshold is a tie.
const TIE: f64 = 1e-11;

type Point = (f64, f64);

/// A convex outline.
enum Outline {
    Polygon(Vec<Point>),
    /// The centre, and the images of the unit disc's two axes.
    Ellipse(Point, Point, Point),
}

impl Outline {
    fn box_around(&self) -> [f64; 4] {
        match self {
            Self::Polygon(points) => points.iter().fold(
                [f64::MAX, f64::MAX, f64::MIN, f64::MIN],
                |[left, top, right, bottom], &(x, y)| {
                    [left.min(x), top.min(y), right.max(x), bottom.max(y)]
                },
            ),
            &Self::Ellipse((x, y), a, b) => {
                // A generous box: half of its size is the sum of both axes.
                let (width, height) = (a.0.abs() + b.0.abs(), a.1.abs() + b.1.abs());
                [x - width, y - height, x + width, y + height]
            }
        }
    }

    /// Returns the area inside the cell whose top left corner is at (`x`, `y`).
    fn area_in_cell(&self, x: f64, y: f64) -> f64 {
        match self {
            Self::Polygon(points) => {
                let near: Vec<Point> = points.iter().map(|p| (p.0 - x, p.1 - y)).collect();
                shoelace(&clipped_to_unit_square(&near)).abs()
            }
            &Self::Ellipse(centre, a, b) => {
                let area = a.0 * b.1 - a.1 * b.0;
                let corner = |dx: f64, dy: f64| {
                    let (dx, dy) = (x + dx - centre.0, y + dy - centre.1);
                    ((dx * b.1 - dy * b.0) / area, (dy * a.0 - dx * a.1) / area)
                };
                let corners = [
                    corner(0.0, 0.0),
                    corner(1.0, 0.0),
                    corner(1.0, 1.0),
                    corner(0.0, 1.0),
                ];
                let pairs = corners.iter().zip(corners.iter().cycle().skip(1));
                let share: f64 = pairs.map(|(&p, &q)| triangle_in_disc(p, q)).sum();
                (share * area).abs()
            }
        }
    }
}

fn clipped_to_unit_square(points: &[Point]) -> Vec<Point> {
    // Each side of the square as a distance that is positive inside.
    let sides: [fn(Point) -> f64; 4] = [|p| p.0, |p| p.1, |p| 1.0 - p.0, |p| 1.0 - p.1];
    let mut ring = points.to_vec();
    for side in sides {
        let mut kept = Vec::with_capacity(ring.len() + 2);
        let Some(&(mut from)) = ring.last() else {
            break;
        };
        for &to in &ring {
            let (before, after) = (side(from), side(to));
            if (before < 0.0) != (after < 0.0) {
                let t = before / (before - after);
                kept.push((from.0 + (to.0 - from.0) * t, from.1 + (to.1 - from.1) * t));
            }
            if after >= 0.0 {
                kept.push(to);
            }
            from = to;
        }
        ring = kept;
    }
    ring
}

fn cross(p: Point, q: Point) -> f64 {
    p.0 * q.1 - p.1 * q.0
}

fn dot(p: Point, q: Point) -> f64 {
    p.0 * q.0 + p.1 * q.1
}

fn shoelace(ring: &[Point]) -> f64 {
    let pairs = ring.iter().zip(ring.iter().cycle().skip(1));
    pairs.map(|(&p, &q)| cross(p, q)).sum::<f64>() / 2.0
}

/// Returns the signed area of the part in the unit disc of the triangle between the origin, `p` and `q`.
fn triangle_in_disc(p: Point, q: Point) -> f64 {
    let sector = |from: Point, to: Point| cross(from, to).atan2(dot(from, to)) / 2.0;
    let way = (q.0 - p.0, q.1 - p.1);
    let squared = dot(way, way);
    let foot = -dot(p, way) / squared;
    let room = 1.0 - cross(p, way).powi(2) / squared;
    if room <= 0.0 {
        return sector(p, q);
    }
    let half = (room / squared).sqrt();
    let (enter, leave) = ((foot - half).max(0.0), (foot + half).min(1.0));
    if enter >= leave {
        return sector(p, q);
    }
    let at = |t: f64| (p.0 + way.0 * t, p.1 + way.1 * t);
    let (first, last) = (at(enter), at(leave));
    sector(p, first) + cross(first, last) / 2.0 + sector(last, q)
}

/// Turns a point clockwise as seen, with y downwards.
fn turned((x, y): Point, degrees: f64) -> Point {
    let (sin, cos) = degrees.to_radians().sin_cos();
    (x * cos - y * sin, x * sin + y * cos)
}

/// Returns the outline of a figure and of its hole.
fn outlines(figure: &Figure) -> (Outline, Option<Outline>) {
    let get = |parameter| figure.get(parameter).expect("a parameter of this kind");
    let (x0, y0, angle) = (
        get(Parameter::X0),
        get(Parameter::Y0),
        get(Parameter::Angle),
    );
    let wall = figure.get(Parameter::Thickness).unwrap_or(f64::MAX);
    let ring = |centre: Point, points: &[Point], scale: f64| {
        let place = |&(x, y): &Point| {
            let (x, y) = turned((x * scale, y * scale), angle);
            (centre.0 + x, centre.1 + y)
        };
        Outline::Polygon(points.iter().map(place).collect())
    };
    let corners = match figure.kind() {
        FigureKind::Ellipse => {
            let (rx, ry) = (get(Parameter::RadiusX), get(Parameter::RadiusY));
            let ellipse = |rx: f64, ry: f64| {
                let centre = (x0 + get(Parameter::RadiusX), y0 + get(Parameter::RadiusY));
                Outline::Ellipse(centre, turned((rx, 0.0), angle), turned((0.0, ry), angle))
            };
            let hole = (wall < rx.min(ry)).then(|| ellipse(rx - wall, ry - wall));
            return (ellipse(rx, ry), hole);
        }
        FigureKind::Rectangle => {
            let (length, width) = (get(Parameter::Length), get(Parameter::Width));
            let centre = (x0 + length / 2.0, y0 + width / 2.0);
            let rectangle = |length: f64, width: f64| {
                let (x, y) = (length / 2.0, width / 2.0);
                ring(centre, &[(-x, -y), (x, -y), (x, y), (-x, y)], 1.0)
            };
            let inner = (length - 2.0 * wall, width - 2.0 * wall);
            let hole = (inner.0 > 0.0 && inner.1 > 0.0).then(|| rectangle(inner.0, inner.1));
            return (rectangle(length, width), hole);
        }
        FigureKind::Triangle => 3,
        FigureKind::Pentagon => 5,
        FigureKind::Hexagon => 6,
        FigureKind::Heptagon => 7,
        FigureKind::Octagon => 8,
    };
    let step = PI / f64::from(corners);
    let circumradius = get(Parameter::Side) / 2.0 / step.sin();
    let inradius = circumradius * step.cos();
    // One side is at the bottom: its two corners lie half a step to the left and right of straight down.
    let corner = |k: i32| {
        let angle = PI / 2.0 + f64::from(2 * k + 1) * step;
        (circumradius * angle.cos(), circumradius * angle.sin())
    };
    let points: Vec<Point> = (0..corners).map(corner).collect();
    let least = |of: fn(&Point) -> f64| points.iter().map(of).fold(f64::MAX, f64::min);
    let centre = (x0 - least(|p| p.0), y0 - least(|p| p.1));
    let hole = (wall < inradius).then(|| ring(centre, &points, (inradius - wall) / inradius));
    (ring(centre, &points, 1.0), hole)
}

/// Returns the outlines of a picture's squares.
fn squares(imprint: &Imprint, placed: &Source) -> Vec<Outline> {
    let get = |parameter| placed.get(parameter).expect("a parameter of pictures");
    let (zoom_x, zoom_y) = (get(Parameter::ZoomX), get(Parameter::ZoomY));
    let Some(bounds) = imprint.bounds() else {
        return Vec::new();
    };
    let (left, top) = (get(Parameter::X0) * zoom_x, get(Parameter::Y0) * zoom_y);
    let width = f64::from(bounds.right - bounds.left) * zoom_x;
    let height = f64::from(bounds.bottom - bounds.top) * zoom_y;
    let centre = (left + width / 2.0, top + height / 2.0);
    let place = |column: u8, row: u8| {
        let x = left + f64::from(column - bounds.left) * zoom_x;
        let y = top + f64::from(row - bounds.top) * zoom_y;
        let (x, y) = turned((x - centre.0, y - centre.1), -get(Parameter::Angle));
        (centre.0 + x, centre.1 + y)
    };
    let square = |(i, j): (u8, u8)| {
        Outline::Polygon(vec![
            place(i, j),
            place(i + 1, j),
            place(i + 1, j + 1),
            place(i, j + 1),
        ])
    };
    imprint.active().map(square).collect()
}

/// Adds an outline's area in every cell, times `sign`, to `cells`.
fn add(cells: &mut [f64], (columns, rows): (u8, u8), outline: &Outline, sign: f64) {
    let [left, top, right, bottom] = outline.box_around();
    for row in (0..rows).filter(|&row| f64::from(row) < bottom && f64::from(row) + 1.0 > top) {
        let near = |&column: &u8| f64::from(column) < right && f64::from(column) + 1.0 > left;
        for column in (0..columns).filter(near) {
            let index = usize::from(row) * usize::from(columns) + usize::from(column);
            cells[index] += sign * outline.area_in_cell(f64::from(column), f64::from(row));
        }
    }
}

/// Returns a plane of random size and threshold; most have the default ones.
fn drawn_plane(random: &mut Random) -> Plane {
    let (columns, rows) = match random.whole(0, 99) {
        0..=4 => (1, 1),
        5..=9 => (1, 64),
        10..=14 => (64, 1),
        15 => (64, 64),
        16..=49 => (random.side(1, 24), random.side(1, 24)),
        _ => (16, 16),
    };
    let threshold = if random.chance(600) {
        0.5
    } else {
        random.size(1)
    };
    Plane::new(sensor(columns, rows, threshold))
}

fn drawn_figure(
    random: &mut Random,
    kind: FigureKind,
    sensor: &taxel_core::sensor::Sensor,
) -> Figure {
    let side = sensor.side();
    let wall = random.chance(400);
    // Small sensors get large figures, which reach beyond them; large sensors get mostly small ones.
    let most = i32::from(side.min(if random.chance(100) { 64 } else { 9 }));
    Figure::new(kind, sensor, |parameter| match parameter {
        Parameter::X0 | Parameter::Y0 => {
            let low = if random.chance(150) {
                -i32::from(side)
            } else {
                -1
            };
            Some(random.decimal(low.max(-12), i32::from(side)))
        }
        Parameter::Angle => Some(random.angle()),
        Parameter::Thickness => wall.then(|| random.size(most.min(3))),
        _ => Some(random.size(most)),
    })
    .expect("drawn within the ranges")
}

/// Compares the coverages and the imprint of one touch, and returns the number of ties.
fn compare(plane: &mut Plane, solid: &(impl Solid + ToString), slow: &[f64]) -> u32 {
    let threshold = plane.sensor().threshold();
    let imprint = plane.touch(solid);
    let coverages = plane.coverages();
    let mut ties = 0;
    let cells = (0..imprint.rows()).flat_map(|j| (0..imprint.columns()).map(move |i| (i, j)));
    for (((column, row), &fast), &slow) in cells.zip(coverages.values()).zip(slow) {
        let place = || {
            let (text, sensor) = (solid.to_string(), plane.sensor());
            format!("{text}, taxel {column}, {row}: {fast} and {slow}, {sensor:?}")
        };
        assert!((fast - slow).abs() < AGREEMENT, "{}", place());
        let above = slow - threshold;
        if above.abs() < TIE {
            ties += 1;
            assert!(imprint.get(column, row), "a tie, {}", place());
        } else if above.abs() > AGREEMENT {
            assert_eq!(imprint.get(column, row), above > 0.0, "{}", place());
        }
    }
    ties
}

fn compare_figures(kind: FigureKind, seed: u64) {
    let mut random = Random::new(seed);
    let mut ties = 0;
    for _ in 0..POSES {
        let mut plane = drawn_plane(&mut random);
        let figure = drawn_figure(&mut random, kind, plane.sensor());
        let size = (plane.sensor().columns(), plane.sensor().rows());
        let mut slow = vec![0.0; usize::from(size.0) * usize::from(size.1)];
        let (outline, hole) = outlines(&figure);
        add(&mut slow, size, &outline, 1.0);
        if let Some(hole) = hole {
            add(&mut slow, size, &hole, -1.0);
        }
        ties += compare(&mut plane, &figure, &slow);
    }
    println!("{}: {ties} ties in {POSES} poses", kind.name());
    assert!(ties > POSES / 10, "too few ties to test them");
}

#[test]
fn ellipses_agree() {
    compare_figures(FigureKind::Ellipse, 1);
}

#[test]
fn rectangles_agree() {
    compare_figures(FigureKind::Rectangle, 2);
}

#[test]
fn triangles_agree() {
    compare_figures(FigureKind::Triangle, 3);
}

#[test]
fn pentagons_agree() {
    compare_figures(FigureKind::Pentagon, 4);
}

#[test]
fn hexagons_agree() {
    compare_figures(FigureKind::Hexagon, 5);
}

#[test]
fn heptagons_agree() {
    compare_figures(FigureKind::Heptagon, 6);
}

#[test]
fn octagons_agree() {
    compare_figures(FigureKind::Octagon, 7);
}

#[test]
fn pictures_agree() {
    let mut random = Random::new(8);
    let mut ties = 0;
    for _ in 0..PICTURES {
        let mut plane = drawn_plane(&mut random);
        let mut imprint = Imprint::empty(size(random.side(1, 8), random.side(1, 8)));
        for row in 0..usize::from(imprint.rows()) {
            let word = random.word() | random.word();
            imprint.set_word(row, word);
        }
        let size = (plane.sensor().columns(), plane.sensor().rows());
        let side = plane.sensor().side();
        let home = Source::from(Picture::at_home(imprint));
        let picture = home.placed(plane.sensor(), |parameter| match parameter {
            Parameter::X0 | Parameter::Y0 => Some(random.decimal(-1, i32::from(side))),
            Parameter::Angle => Some(random.angle()),
            _ if random.chance(50) => Some(random.size(64)),
            _ => Some(random.size(2)),
        });
        let picture = picture.expect("drawn within the ranges");
        let mut slow = vec![0.0; usize::from(size.0) * usize::from(size.1)];
        for square in squares(&imprint, &picture) {
            add(&mut slow, size, &square, 1.0);
        }
        ties += compare(&mut plane, &picture, &slow);
    }
    println!("pictures: {ties} ties in {PICTURES} poses");
    assert!(ties > PICTURES / 20, "too few ties to test them");
}
