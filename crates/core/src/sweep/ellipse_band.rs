//! One ellipse, cut to bands: the height of its section at a place, and the area to the left of it.
//!
//! Inside of a band the ellipse is bounded by arcs and by the band's two lines; between the places where an arc
//! meets a line the area has a closed form. Frame: the anchor at the origin; cell sides.

use std::f64::consts::FRAC_PI_4;

use crate::geometry::Ellipse;

/// The amount by which bounds of sections are widened.
const SLACK: f64 = 1e-12;

/// An ellipse prepared for bands; see `geometry::ellipse_cuts` for the formulas.
#[derive(Clone, Debug)]
pub(crate) struct EllipseBand {
    pub(crate) x: f64,
    y: f64,
    /// Half of the extent along x.
    pub(crate) reach_x: f64,
    /// Half of the extent along y.
    reach_y: f64,
    /// The slope, y by x, of the line through the middles of the vertical sections.
    middle_y: f64,
    /// The slope, x by y, of the line through the middles of the horizontal sections.
    middle_x: f64,
    /// Half of the vertical section at distance d from the centre is this times the root of `reach_x`² − d².
    scale_y: f64,
    scale_x: f64,
    top: f64,
    stretches: [EllipseStretch; 5],
    /// The number of stretches in use, at most five: the band's lines cross the ellipse at up to four places.
    count: usize,
    /// The places between which the section is highest; `highest` is its height there.
    peak: (f64, f64),
    highest: f64,
    /// The area of the ellipse in the band.
    total: f64,
}

/// A closed form `W = area + linear·d + square·d² + round·Φ(d)` between two places, relative to the centre.
#[derive(Clone, Copy, Debug, Default)]
struct EllipseStretch {
    left: f64,
    right: f64,
    area: f64,
    linear: f64,
    square: f64,
    round: f64,
}

/// The section at a place: its height, the area on the left of it, and half of the ellipse's own section.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Section {
    /// The height of the shape here, inside the band.
    pub(crate) height: f64,
    /// The area on the left of the place.
    area: f64,
    half: f64,
    /// The index of its stretch; None outside the ellipse.
    stretch: Option<usize>,
}

impl EllipseBand {
    pub(crate) fn new(ellipse: &Ellipse<f64>) -> Self {
        let (centre, reach) = (ellipse.centre, ellipse.reach());
        let (x_square, y_square) = (reach.x * reach.x, reach.y * reach.y);
        let (mixed, area) = (ellipse.skew(), ellipse.span());
        Self {
            x: centre.x,
            y: centre.y,
            reach_x: reach.x,
            reach_y: reach.y,
            middle_y: mixed / x_square,
            middle_x: mixed / y_square,
            scale_y: area / x_square,
            scale_x: area / y_square,
            top: 0.0,
            stretches: [EllipseStretch::default(); 5],
            count: 0,
            peak: (0.0, 0.0),
            highest: 0.0,
            total: 0.0,
        }
    }

    /// Returns half of the height at a distance from the centre, divided by `scale_y`.
    fn half(&self, d: f64) -> f64 {
        ((self.reach_x - d) * (self.reach_x + d)).max(0.0).sqrt()
    }

    /// Returns the integral of [`Self::half`] from the centre on; `half` is its value at `d`.
    fn round(&self, d: f64, half: f64) -> f64 {
        let reach = self.reach_x;
        0.5 * (d * half + reach * reach * libm::atan2(d, half))
    }

    /// Prepares the band from `top` to `top + 1`. Returns false if the ellipse does not reach it.
    pub(crate) fn cut(&mut self, top: f64) -> bool {
        let (top, bottom) = (top - self.y, top - self.y + 1.0);
        (self.top, self.count, self.total, self.highest) = (top, 0, 0.0, -1.0);
        if top >= self.reach_y || bottom <= -self.reach_y {
            return false;
        }
        // The ends and the crossings with the lines, in order.
        let mut places = [-self.reach_x; 6];
        let mut last = 0;
        for line in [top, bottom] {
            if line.abs() < self.reach_y {
                let root = self.scale_x * ((self.reach_y - line) * (self.reach_y + line)).sqrt();
                let middle = self.middle_x * line;
                for place in [middle - root, middle + root] {
                    let mut at = last + 1;
                    while at > 1 && places[at - 1] > place {
                        places[at] = places[at - 1];
                        at -= 1;
                    }
                    places[at] = place;
                    last += 1;
                }
            }
        }
        last += 1;
        places[last] = self.reach_x;
        let end = FRAC_PI_4 * self.reach_x * self.reach_x;
        let (mut left, mut round) = (-self.reach_x, -end);
        for &right in &places[1..=last] {
            let right = right.min(self.reach_x);
            if right > left {
                let next = if right < self.reach_x {
                    self.round(right, self.half(right))
                } else {
                    end
                };
                self.stretch((left, right), (round, next));
                (left, round) = (right, next);
            }
        }
        self.count > 0
    }

    fn stretch(&mut self, (left, right): (f64, f64), (round, next): (f64, f64)) {
        let (top, bottom) = (self.top, self.top + 1.0);
        let middle = f64::midpoint(left, right);
        let half = self.scale_y * self.half(middle);
        let (upper, lower) = (self.middle_y * middle - half, self.middle_y * middle + half);
        if upper >= bottom || lower <= top {
            return;
        }
        // A line that does not cross the ellipse may touch it right here; then the middle does not show on which side
        // it lies.
        let (upper, lower) = (
            top <= -self.reach_y || upper > top,
            bottom >= self.reach_y || lower < bottom,
        );
        let (linear, square, arcs) = match (upper, lower) {
            (true, true) => (0.0, 0.0, 2.0),
            (true, false) => (bottom, -0.5 * self.middle_y, 1.0),
            (false, true) => (-top, 0.5 * self.middle_y, 1.0),
            (false, false) => (1.0, 0.0, 0.0),
        };
        let mut stretch = EllipseStretch {
            left,
            right,
            area: 0.0,
            linear,
            square,
            round: arcs * self.scale_y,
        };
        stretch.area = self.total - stretch.grown(left, round);
        self.total = stretch.area + stretch.grown(right, next);
        // Between two lines the section has its full height all along; otherwise it is highest above or below an
        // extreme point of the ellipse, or at an end. `skew` is the place of the lowest point.
        let skew = self.middle_x * self.reach_y;
        let (from, to) = match (upper, lower) {
            (true, true) => (0.0, 0.0),
            (true, false) => (-skew, -skew),
            (false, true) => (skew, skew),
            (false, false) => (left, right),
        };
        let (from, to) = (from.max(left).min(right), to.max(left).min(right));
        let height = if arcs > 0.0 {
            self.height(self.x + from)
        } else {
            1.0
        };
        if height > self.highest {
            (self.highest, self.peak) = (height, (self.x + from, self.x + to));
        }
        // An ellipse and two lines: at most four places strictly inside, so at most five stretches.
        if let Some(slot) = self.stretches.get_mut(self.count) {
            *slot = stretch;
            self.count += 1;
        }
    }

    /// Returns the height of the section inside the band, given half of the ellipse's own section.
    fn clipped(&self, d: f64, half: f64) -> f64 {
        let (middle, half) = (self.middle_y * d, self.scale_y * half);
        ((middle + half).min(self.top + 1.0) - (middle - half).max(self.top)).max(0.0)
    }

    pub(crate) fn height(&self, x: f64) -> f64 {
        let d = x - self.x;
        if d.abs() >= self.reach_x {
            return 0.0;
        }
        self.clipped(d, self.half(d))
    }

    pub(crate) fn at(&self, x: f64) -> Section {
        let d = x - self.x;
        let stretches = &self.stretches[..self.count];
        let outside = |area: f64| Section {
            height: 0.0,
            area,
            half: 0.0,
            stretch: None,
        };
        // The stretches of a convex set follow on each other without a gap.
        let Some(index) = stretches.iter().position(|stretch| d <= stretch.right) else {
            return outside(self.total);
        };
        if d <= stretches[0].left {
            return outside(0.0);
        }
        let stretch = &stretches[index];
        let half = self.half(d);
        let round = if stretch.round > 0.0 {
            self.round(d, half)
        } else {
            0.0
        };
        Section {
            height: self.clipped(d, half),
            area: stretch.area + stretch.grown(d, round),
            half,
            stretch: Some(index),
        }
    }

    pub(crate) fn coverage(&self, left: &Section, right: &Section) -> f64 {
        match (left.stretch, right.stretch) {
            // Between the lines all along: full, without any rounding.
            (Some(first), Some(last)) if first == last && self.stretches[first].round == 0.0 => 1.0,
            _ => right.area - left.area,
        }
    }

    /// Returns how much `w` may change within `way` of a place.
    ///
    /// Half of the ellipse's own section is `√((R − d)(R + d))`, with slope `d / half`; within `way` of `d` it stays
    /// above 0.7 of itself where `half² ≥ 4·R·way`. Near an end of the ellipse it changes by the root of `2·R·way` at
    /// most. Clipping by the band's lines only makes a change smaller.
    pub(crate) fn change(&self, place: &Section, way: f64) -> f64 {
        let reach = self.reach_x;
        let half = if place.half * place.half >= 4.0 * reach * way {
            1.5 * reach / place.half * way
        } else {
            (2.0 * reach * way).sqrt()
        };
        2.0 * self.scale_y * half + self.middle_y.abs() * way
    }

    /// Returns bounds of `w` from `x` to `end`: it is concave where it is not 0, so it is least at an end.
    pub(crate) fn bounds(&self, x: f64, end: f64) -> (f64, f64) {
        if self.count == 0 {
            return (0.0, 0.0);
        }
        let (one, other) = (self.height(x), self.height(end));
        let most = if x <= self.peak.1 && end >= self.peak.0 {
            self.highest
        } else {
            one.max(other)
        };
        // 0 and 1 are exact; elsewhere rounding errors count.
        let least = one.min(other);
        let least = if least < 1.0 { least - SLACK } else { least };
        let most = if most > 0.0 { most + SLACK } else { most };
        (least.max(0.0), most.min(1.0))
    }

    pub(crate) fn is_here(&self) -> bool {
        self.count > 0
    }

    pub(crate) fn reach(&self) -> (f64, f64) {
        let stretches = &self.stretches[..self.count];
        match (stretches.first(), stretches.last()) {
            (Some(first), Some(last)) => (self.x + first.left, self.x + last.right),
            _ => (self.x, self.x),
        }
    }

    pub(crate) fn highest(&self) -> f64 {
        self.highest
    }

    /// Returns the places between which a cell is full; None if no cell is.
    pub(crate) fn full(&self) -> Option<(f64, f64)> {
        let full =
            |stretch: &&EllipseStretch| stretch.round == 0.0 && stretch.right - stretch.left > 1.0;
        let stretch = self.stretches[..self.count].iter().find(full)?;
        Some((self.x + stretch.left, self.x + stretch.right - 1.0))
    }
}

impl EllipseStretch {
    /// Returns `W` without its constant.
    fn grown(&self, d: f64, round: f64) -> f64 {
        (self.linear + self.square * d) * d + self.round * round
    }
}
